"""The OC4 jacket of OpenFAST's regression tests as numbers: mass, stiffness, damping, loads.

From ``glue-codes/openfast/5MW_OC4Jckt_ExtPtfm/ExtPtfm_SE.dat`` of OpenFAST/r-test, commit 1c334a71
(Apache License 2.0): six coordinates of the interface, 25 modes of unit modal mass, SI units;
entries below 1e-8 are zero. The damping of the file is ``0.10671 M + 6.1e-4 K`` to its digits.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sebody import Model
from sebody.analysis import equilibrium, modes, vibrations
from sebody.io import LoadSeries
from sebody.reduction import ReducedBody, grounded_body
from sebody.verify.outside.case import Case, Quantity

MODES = 25
NAMES = ["x", "y", "z", "rx", "ry", "rz", *(f"mode {k}" for k in range(MODES))]
INTERFACE, BASE, HUB = (0.0, 0.0, 20.15), (0.0, 0.0, -50.0), (0.0, 0.0, 90.15)
UNITS = "m kg N s"
SQUARES = [
    827.071909, 827.135704, 1077.85834, 1313.73750, 1422.00736, 1644.05336, 1682.70024, 1682.85762,
    2177.65046, 2744.50663, 3057.00783, 3057.31505, 3739.72065, 3860.89760, 3860.96001, 4057.59493,
    4229.83825, 4499.29678, 4499.48480, 5339.47790, 5438.41131, 6514.57159, 7046.41399, 7046.95067,
    7976.34193]
# by row of the interface: columns counted from 1
COUPLING = {
    0: {7: 360.609453, 13: 171.286635, 17: 66.1626264, 20: -176.164254, 25: -95.4272988,
        29: -49.5956670},
    1: {8: 360.594532, 14: 171.280791, 18: 66.1575677, 21: 176.097008, 24: 95.5355779,
        30: -49.5618190},
    2: {11: 2.89310003e-2, 12: 82.9517478, 15: 2.84061752e-2, 16: -133.171368, 19: -80.9101576,
        22: -5.45693239e-2, 26: 2.16574646e-2, 28: 116.342863, 31: -161.684683},
    3: {8: 6825.13608, 14: 2572.58734, 18: 1118.87783, 21: 1801.41709, 24: 1020.76670,
        30: -790.339629},
    4: {7: -6825.40351, 13: -2572.68757, 17: -1118.95113, 20: 1802.13474, 25: 1019.64602,
        29: 790.657287},
    5: {9: 0.563008746, 10: -2553.42290, 23: -0.198408716, 27: -1149.81199}}


def matrices() -> tuple[NDArray, NDArray, NDArray]:
    """Mass, stiffness and damping, (31, 31)."""
    M, K = np.zeros((2, 31, 31))
    for i, row in COUPLING.items():
        for j, value in row.items():
            M[i, j - 1] = value
    M[0, 4], M[1, 3] = -5.28236955e6, 5.28204269e6
    K[0, 4], K[1, 3] = -2.32742574e9, 2.32742570e9
    M, K = M + M.T, K + K.T
    M[range(31), range(31)] = [9.62349663e5, 9.62255787e5, 9.38302373e5, 6.71710431e7,
                               6.71760707e7, 1.02967449e7, *[1.0] * MODES]
    K[range(31), range(31)] = [8.43408083e7, 8.43407974e7, 1.96653266e9, 1.09880894e11,
                               1.09880894e11, 8.20023159e9, *SQUARES]
    alpha = 38.4806348 / 360.609453
    return M, K, alpha * M + (1.54140226e5 - alpha * M[0, 0]) / K[0, 0] * K


def body(damped: bool = True) -> ReducedBody:
    """The jacket as a body that is held to the ground."""
    M, K, C = matrices()
    return grounded_body(K, M, [INTERFACE], ("full",), MODES, C if damped else None, BASE,
                         units=UNITS)


def jacket(damped: bool = True, top: bool = False) -> Model:
    """A model of the jacket, perhaps with 350 t on a rigid link 70 m above its interface."""
    model = Model()
    node = model.node("interface", INTERFACE)
    model.foundation("jacket", body(damped), node)
    if top:
        model.rigid_body("turbine", node, 350e3, np.zeros((3, 3)), centre=HUB)
    return model


def loads(step: float = 0.05, end: float = 25.0, size: float = 1.0, smooth: bool = False
          ) -> LoadSeries:
    """A series of loads on all coordinates, from rest: filtered noise, or a few harmonics."""
    random, t = np.random.default_rng(1), np.arange(0.0, end + step / 2, step)
    scale = size * np.r_[[1e5] * 3, [1e6] * 3, [50.0] * MODES]
    if smooth:
        rates, phases = random.uniform(0.5, 3.0, (3, 31)), random.uniform(0, 6.3, (3, 31))
        values = scale * sum(np.sin(t[:, None] * w + p) for w, p in zip(rates, phases, strict=True))
        begun = np.clip(t / 5.0, 0.0, 1.0)[:, None]
        values = values * (begun**3 * (10 - 15 * begun + 6 * begun**2))
    else:
        noise = random.standard_normal((len(t) + 20, 31))
        window = np.hanning(21)
        values = scale * np.array([np.convolve(one, window, "same") for one in noise.T]).T[10:-10]
        values[0] = 0.0
    return LoadSeries(t, values, NAMES)


INTERFACE_CLAMPED = 4.577114, 4.577291, 5.225177, 5.768653, 6.001655, 6.453244
INTERFACE_FREE = 1.067671, 1.067727, 3.713898, 4.150379, 4.150553, 5.225177, 6.001655, 6.366261
WITH_MASS = 0.518263, 0.518268, 2.101890, 2.101967
DAMPED = (0.518265, 0.518271, 2.101880, 2.101957), (0.0041356, 0.0041353, 0.0074137, 0.0074138)
DISPLACED, TURNED = 0.02853654, 6.0444e-4       # m and rad under 1 MN


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities; there is nothing to divide."""
    held = jacket(damped=False)
    held.fix("interface")
    pushed = jacket()
    pushed.force("interface", (1e6, 0.0, 0.0))
    rest = equilibrium(pushed, 1)
    damped = modes(equilibrium(jacket(top=True), 1))
    found = {"interface clamped": vibrations(held, 6).frequency,
             "interface free": vibrations(jacket(damped=False), 8).frequency,
             "with 350 t": vibrations(jacket(False, top=True), 4).frequency,
             "with 350 t, damped": np.abs(damped.values[:4]) / (2 * np.pi)}
    return ({f"{label}, mode {k + 1} [Hz]": value for label, values in found.items()
             for k, value in enumerate(values)}
            | {f"with 350 t, ratio {k + 1}": value for k, value in enumerate(damped.damping[:4])}
            | {"x under 1 MN [m]": rest["interface.position"][-1, 0] - INTERFACE[0],
               "ry under 1 MN [rad]": rest["interface.rotation"][-1][0, 2]})


CASE = Case(
    "Jacket as a foundation superelement", "OpenFAST r-test, glue-codes/openfast/"
    "5MW_OC4Jckt_ExtPtfm/ExtPtfm_SE.dat (commit 1c334a71)", measure,
    (*(Quantity(f"{label}, mode {k + 1} [Hz]", value, printed=5e-7) for label, row in (
        ("interface clamped", INTERFACE_CLAMPED), ("interface free", INTERFACE_FREE),
        ("with 350 t", WITH_MASS), ("with 350 t, damped", DAMPED[0]))
       for k, value in enumerate(row)),
     *(Quantity(f"with 350 t, ratio {k + 1}", value, printed=5e-8)
       for k, value in enumerate(DAMPED[1])),
     Quantity("x under 1 MN [m]", DISPLACED, printed=5e-9),
     Quantity("ry under 1 MN [rad]", TURNED, printed=5e-9)),
    "matrices of the file; the numbers are those of an eigenvalue solver on them")
