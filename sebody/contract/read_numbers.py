"""Kinds of numbers that quantities read of a state.

Of the recorded row, forces of elements, their sums on coordinates, energies, largest residuals of
constraints, loads, and motions of bodies. What a number depends on as a state moves: a coordinate,
its rate or second rate, a rotation matrix, a force of an element, a sum of such forces, or nothing.
"""

NOW, FORCE, TOTAL, ENERGY, RESIDUE, LOAD, MOTION = range(7)
OF_Q, OF_V, OF_A, OF_R, OF_FORCE, OF_TOTAL, OF_NOTHING = range(7)
