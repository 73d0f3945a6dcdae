"""Warnings of ropes that should have left a sheave."""

import numpy as np

from sebody.results.result import Result

OFF = 1e-6          # angle of contact below zero that is rounding [rad]


def off_sheaves(result: Result) -> dict[str, str]:
    """Ropes whose angle of contact on a sheave was negative, where it was so first."""
    found = {}
    for rope in result.model.ropes.values():
        passed = [place.sheave for place in rope.places[1:-1] if place.sheave is not None]
        if not passed:
            continue
        wraps = np.asarray(result[f"{rope.name}.wraps"]).reshape(len(result.t), -1)
        for sheave, angles in zip(passed, wraps.T, strict=True):
            if (angles < -OFF).any():
                t = result.t[int(np.argmax(angles < -OFF))]
                found[f"{rope.name} off {sheave.name}"] = (
                    f"rope {rope.name!r} should have left sheave {sheave.name!r} at t = {t:.6g}, "
                    "where its angle of contact becomes negative, and is held on it all the same: "
                    "begin with more contact, lead it over a point in place of the sheave, or "
                    "leave the sheave out")
    return found
