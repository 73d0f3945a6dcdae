"""What tests in several folders share."""

import numpy as np
from numpy.typing import ArrayLike


def order(steps: ArrayLike, errors: ArrayLike) -> float:
    """Order of convergence: slope of the errors over the steps, both in logarithms.

    Of refinement by a number of elements or steps, `steps` are the inverses of these numbers.
    """
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def multipliers_first(number):
    """A numbering with multipliers before what they act on: their pivots are zero.

    In place of `sebody.assembly.build.number` it makes every large matrix need row exchanges.
    """
    def changed(model):
        old = number(model)
        order = sorted(range(old.total),
                       key=lambda i: (i >= old.free, not old.names[i].startswith("multiplier")))
        place = {i: k for k, i in enumerate(order)}

        def moved(firsts):
            return {key: place.get(first, first) for key, first in firsts.items()}
        return old._replace(dof_blocks=moved(old.dof_blocks), modes=moved(old.modes),
                            multipliers=moved(old.multipliers),
                            names=[old.names[i] for i in order])
    return changed
