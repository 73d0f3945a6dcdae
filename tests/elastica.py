"""Deflection of a clamped column by the elastica, which neither stretches nor shears."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def deflection(share, side):
    """Of the tip, across a column of length one.

    Under a share of Euler's load along it and `side` of that across: ``EI th'' = -P (sin th +
    side cos th)`` with ``th(0) = 0, th'(1) = 0``, by shooting for the first curvature.
    """
    load = share * np.pi**2 / 4.0

    def ends(curvature):
        found = solve_ivp(lambda s, y: [y[1], -load * (np.sin(y[0]) + side * np.cos(y[0])),
                                        np.sin(y[0])], (0.0, 1.0), [0.0, curvature, 0.0],
                          rtol=1e-10, atol=1e-12)
        return found.y[:, -1]
    tried = np.geomspace(1e-9, 6.0, 60)
    moments = [ends(k)[1] for k in tried]
    # the largest curvature is that of the stable state
    k = max(i for i in range(len(tried) - 1) if moments[i] * moments[i + 1] < 0.0)
    curvature = brentq(lambda k: ends(k)[1], tried[k], tried[k + 1], xtol=1e-13)
    return float(ends(curvature)[2])
