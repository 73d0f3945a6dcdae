"""Kinds of numbers that quantities read of a state, and steps of the tapes that compute them.

Of the recorded row, forces of elements, their sums on coordinates, energies, largest residuals of
constraints, loads, and motions of bodies. What a number depends on as a state moves: a coordinate,
its rate or second rate, a rotation matrix, a force of an element, a sum of such forces, or nothing.
"""

NOW, FORCE, TOTAL, ENERGY, RESIDUE, LOAD, MOTION = range(7)
OF_Q, OF_V, OF_A, OF_R, OF_FORCE, OF_TOTAL, OF_NOTHING = range(7)

# functions of a tape's steps: a sum of products, and functions of such a sum; ANGLE is that of a
# vector with the components across and along, CHOICE the value whose comparison is the largest
SUM, ROOT, INVERSE, COSINE, SINE, POSITIVE, ANGLE, CHOICE = range(8)
STEP = 4                # numbers of a step: function, place, first of its products, end of these
FACTORS = 3             # of a product at most; of fewer the rest is the number one
