"""Deep simply supported beam (NAFEMS FV5): shear, rotary inertia, repeated frequencies."""

from collections.abc import Mapping

from sebody import Model
from sebody.analysis import vibrations
from sebody.fem import rectangle
from sebody.verify.outside.case import Case, Quantity

LENGTH, SIDE = 10.0, 2.0
SECTION = rectangle(SIDE, SIDE, 200e9, 0.3, 8000.0)
FREQUENCIES = {"bending 1": (0, 42.650, 5e-3), "torsion 1": (2, 71.20, 5e-3),
               "tension 1": (3, 125.00, 5e-3), "bending 2": (4, 148.15, 5e-3),
               "torsion 2": (6, 213.61, 5e-3), "bending 3": (7, 283.47, 5e-3)}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model()
    a, b = model.node("a", (0.0, 0.0, 0.0)), model.node("b", (LENGTH, 0.0, 0.0))
    model.beam("beam", (a, b), SECTION, 32 * division, 4 * division, 10)
    model.universal(a, "y", "z")            # no turn about the axis of the beam
    model.slider(b, axis="x")
    found = vibrations(model, 9).frequency
    return {f"{name} [Hz]": found[k] for name, (k, *_) in FREQUENCIES.items()}


CASE = Case(
    "Deep simply supported beam", "NAFEMS FV5 (1989-01-09/1, closed form); Abaqus Benchmarks, "
    "Test 5", measure,
    tuple(Quantity(f"{name} [Hz]", value, printed=digit, source_tolerance=2e-2,
                   group=name.split()[0])
          for name, (_, value, digit) in FREQUENCIES.items()),
    "another edition (77.542, 233.10 Hz) has the polar moment in place of the torsion constant")
