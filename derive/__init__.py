"""Derivation of the kernels: from symbols to text. `README.md` says how to add to it.

Folders read only from those before them:

1. `symbolic`: the maps of SO(3), the chain rule on the manifold and its proofs, named quantities,
   steps and their differentials
2. `formulas`: frames, kinematics, elastic forces, inertia, damping, gravity; joints, rigid bodies
   and loads
3. `kernels`: what a kernel is: layouts, its steps in order and their linearization, what it uses,
   and which kernels are shipped
4. `printing`: text, a pure function of the description; everything that knows the target

`compiler.compile_kernel` runs them, `__main__` is the command that writes or checks the files.
"""
