"""Derivation of the kernels: from symbols to text. `README.md` says how to add to it.

Folders read only from those before them:

1. `symbolic`: the maps of SO(3), the chain rule on the manifold and its proofs
2. `form`: what a kernel is made of, as typed data: counts, arrays, calls, steps, statements
3. `passes`: what is done with these: differentials, transposes, statements of steps, counts
4. `formulas`: frames, kinematics, elastic forces, inertia, damping, gravity; joints, rigid bodies
   and loads; motions of bodies
5. `kernels`: layouts, the steps of a kernel in order and their linearization, the statements
   around them, and which kernels are shipped
6. `printing`: targets: text, a pure function of the statements

`compiler.compile_kernel` runs them, `names` reads what kernels are called by users, `__main__` is
the command that writes or checks the files.
"""
