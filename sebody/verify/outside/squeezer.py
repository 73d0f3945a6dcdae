"""A03 of the IFToMM library, Andrews' squeezer: seven bodies in 0.03 s."""

from collections.abc import Mapping

import numpy as np

from sebody import generalized_alpha, simulate
from sebody.results.result import Result
from sebody.scenes import squeezer
from sebody.verify.outside.case import Case, Quantity

STEP = 1e-6
NODES = {"beta": ("crank", None), "Theta": ("link", "crank"), "gamma": ("frame", None),
         "Phi": ("lower rod", "lower arm"), "delta": ("lower arm", None),
         "epsilon": ("upper arm", None)}
STARTS = dict(zip(("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"), squeezer.START,
                  strict=True))
ANGLES = {"beta": 15.81077119629904, "Theta": -15.75637105984298, "gamma": 0.04082224013073101,
          "Phi": -0.5347301163226948, "delta": 0.5244099658805304, "epsilon": 1.048080741042263}
RATES = {"beta": 1139.920302151208, "Theta": -1424.379294994111, "gamma": 11.03291221937134,
         "Phi": 19.29337464421385, "delta": 0.5735699284790808, "epsilon": 0.3231791658026955}


def run(division: int = 1) -> Result:
    """0.03 s without numerical damping."""
    h = STEP / division
    return simulate(squeezer.build().model, h, 0.03, generalized_alpha(0.9, 1e-10),
                    round(1e-4 / h))


def _relative(result: Result, quantity: str, angle: str) -> float:
    """Motion of a body against the one it hangs on, at the end."""
    body, on = NODES[angle]
    value = result[f"{body}.{quantity}"][-1]
    return float(value - (result[f"{on}.{quantity}"][-1] if on else 0.0))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    return ({f"{name} at 0.03 s": _relative(result, "rotation", name) + STARTS[name]
             for name in ANGLES}
            | {f"rate of {name} at 0.03 s": _relative(result, "angular_velocity", name)
               for name in RATES})


# digits of the file: 16; the IVP test set plots errors of codes from 1e-2 to 1e-11, IFToMM admits
# 1e-3 (`iftomm`)
CASE = Case(
    "Andrews' squeezer", "IFToMM library A03; IVP test set, andrews.f (PSIDE, tolerance 1e-14)",
    measure,
    (*(Quantity(f"{name} at 0.03 s", value, max(abs(value), 1.0), source_tolerance=1e-3,
                share=1e-3, group="angles") for name, value in ANGLES.items()),
     *(Quantity(f"rate of {name} at 0.03 s", value, float(np.max(np.abs(list(RATES.values())))),
                source_tolerance=1e-3, share=1e-3, group="rates")
       for name, value in RATES.items())),
    "rates by the size of the largest")
