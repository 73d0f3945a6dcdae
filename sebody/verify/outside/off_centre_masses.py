"""Cantilever with masses beside its tip (NAFEMS FV4): bending and torsion coupled, close modes."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sebody import Model
from sebody.analysis import vibrations
from sebody.fem import circle
from sebody.verify.outside.case import Case, Quantity

LENGTH = 10.0
SECTION = replace(circle(0.25, 200e9, 0.3, 8000.0), shear_factor=None)
MASSES = {-2.0: 10000.0, 2.0: 1000.0}
FREQUENCIES = 1.723, 1.727, 7.413, 9.972, 18.155, 26.957


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model()
    root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (LENGTH, 0.0, 0.0))
    model.beam("beam", (root, tip), SECTION, 16 * division, division, 8)
    model.fix(root)
    for k, (y, mass) in enumerate(MASSES.items()):
        model.rigid_body(f"mass {k}", tip, mass, np.zeros((3, 3)), (LENGTH, y, 0.0))
    found = vibrations(model, 6).frequency
    return {f"mode {k + 1} [Hz]": f for k, f in enumerate(found)}


CASE = Case(
    "Cantilever with off-centre masses", "NAFEMS FV4 (closed form); Altair OptiStruct, OS-V 0410",
    measure,
    tuple(Quantity(f"mode {k + 1} [Hz]", value, printed=5e-4, source_tolerance=1e-2)
          for k, value in enumerate(FREQUENCIES)),
    "one superelement of eight modes, with rotary inertia and without shear, as the closed form; "
    "OptiStruct is off by up to 0.8 %")
