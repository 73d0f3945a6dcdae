"""Kinds of numbers that quantities read of a state.

Of the recorded row, forces of elements, their sums on coordinates, energies, largest residuals of
constraints, loads, and motions of bodies.
"""

NOW, FORCE, TOTAL, ENERGY, RESIDUE, LOAD, MOTION = range(7)
