"""The table of limits that runs, equilibria and linearisations are compared with.

None of them is reached in any of the shipped scenes but those that are there to show it.
"""

LINEAR = 0.3        # rad, local rotation: linear stiffness misses its square, a tenth
FAST = 0.25         # spin without stiffening, of the first frequency: a per cent of it
FLAT = 1e-3         # smallest ratio of the spreads of nodes that define a frame
BALANCE = 0.05      # share of the energy exchanged: speeds are off by half of it
CUT = 0.3           # share of steps that were cut: most of the time goes into failed ones
PERIOD = 6.0        # steps a period: periods are off by (2 pi / 6)^2 / 12, a tenth
EXCITED = 1e-3      # share of the largest kinetic energy: amplitudes of a thirtieth
DRIFT = 1e-5        # constraints, of the model's extent or rad: a thousand times a step's tolerance
