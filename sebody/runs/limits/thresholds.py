"""The table of limits that runs, equilibria and linearisations are compared with.

None of them is reached in any of the shipped scenes but those that are there to show it. Those of
constraints and of the energy balance, which reports judge by, too, are in `sebody.results`.
"""

LINEAR = 0.3        # rad, local rotation: linear stiffness misses its square, a tenth
TURNED = 0.15       # rad, between interfaces of a body that is not straight: up to 3 % of its size
MISSED = 0.25       # of the square of this, by the body's size: 0.06 to 1.5 of struck frames
BENT = 0.1          # rad, the same where the frame follows rotations of a body off its nodes' line
AXIAL = 1 / 3       # axial force, of what bending stiffness is worth: a tenth of Euler's
FOLDED = 0.1        # rad, between a body's line and its frame when its tension is too large
FAST = 0.25         # spin without stiffening, of the first frequency: a per cent of it
FLAT = 1e-3         # smallest ratio of the spreads of nodes that define a frame
CUT = 0.3           # rejected steps per accepted step: most of the time goes into rejected ones
PERIOD = 6.0        # steps a period: periods are off by (2 pi / 6)^2 / 12, a tenth
GROWN = 0.01        # energy that nothing gives, of the largest: speeds grow by half of it
WAVERS = 1e-3       # the same above its start, of the largest strain energy
EXCITED = 1e-3      # share of the largest kinetic energy: amplitudes of a thirtieth
