"""What tests of several rooms share."""

import numpy as np
from numpy.typing import ArrayLike


def order(steps: ArrayLike, errors: ArrayLike) -> float:
    """Order of convergence: slope of the errors over the steps, both in logarithms.

    Of refinement by a number of elements or steps, `steps` are the inverses of these numbers.
    """
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
