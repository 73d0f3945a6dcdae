"""What corrections of redundant constraints leave: see `sebody.engine.regularization`."""

import math

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import spread
from sebody.engine.matrix import ROUNDING
from sebody.engine.newton import WIDEST_GAP


@compiled
def leaves_gap(system, state, norm, stabilized):
    """Which members keep a residual that no correction removes."""
    n, left = system.diagonal.size, spread(0.0)
    for i in range(n):
        residual = state.residual[i]
        if stabilized:
            residual += state.constraint_residuals[i]
        left += residual * residual * state.scale[i] * state.scale[i]
    return math.sqrt(left) > n * norm + WIDEST_GAP / ROUNDING * state.clock.floor
