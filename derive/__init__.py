"""Derivation of the kernels: from symbols to text.

The pipeline is the list of modules, each reading only from those before it:

1. `rotations`, `variation`: the maps of SO(3), the chain rule on the manifold, `check_same`
2. `layouts`, `stages`, `quantities`: what a body keeps, named quantities, stages and differentials
3. `kinematics`, `frames`, `elastic`, `inertia`, `elements`: formulas, from kinematics and energies
4. `superelement`: the stages of a kernel in order, and their linearization
5. `printer`, `templates`, `emit`, `emit_element`: text, a pure function of the description
6. `manifest`, `__main__`: what is shipped, and the command that writes or checks it
"""
