"""What one body does, by inertia option: frequencies, loads of buckling, whole motions.

    python tests/benchmarks/bench_one_body.py [--json]

Exact values are closed solutions, tables of rotating beams, and geometrically exact beams, whose
files `tests/data` makes; those of spin-up and slider-crank are of 12 and 8 quadratic elements.
"""

import argparse
import json
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sebody import LimitWarning, Model, SimulationError, simulate
from sebody.analysis import equilibrium, modes, vibrations
from sebody.errors import InputError
from sebody.fem import StiffnessSection
from sebody.scenes import hinged_beam, slider_crank, spherical_beam_strong, spin_up
from sebody.studies.references import reference

OPTIONS = {"C, stiffening": {}, "C": {"stiffening": False}, "D": {"inertia": "d"},
           "B": {"inertia": "b"}}
SLENDER = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=2e-7, inertia_y=1e-7, inertia_z=1e-7)
UNSTABLE = 1e-2         # rate of growth that is no rounding error


class Row(NamedTuple):
    """A number: what it is, its exact value if errors are not the number itself."""

    what: str
    exact: float | None
    of: Callable[[dict], float]     # by the options of the body


def cantilever(options: dict, planar: bool = False, section=SLENDER) -> Model:
    """Of unit length, mass and bending stiffness, with four modes."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    ends = model.node("root", np.zeros(d)), model.node("tip", np.eye(d)[0])
    model.beam("arm", ends, section, 24, 1, 4, **options)
    model.fix("root")
    return model


def nearest(model: Model, spin, expected: float, scale: float = 1.0) -> float:
    """The frequency nearest to an expected one; NaN if the motion grows."""
    found = modes(equilibrium(model, 2, spin=spin), spin)
    if found.growth.max() > UNSTABLE:
        return math.nan
    return float(found.omega[np.abs(found.omega / scale - expected).argmin()] / scale)


def of_hinged_beam(options: dict) -> float:
    """First bending frequency at the spin that it reaches."""
    model = Model()
    ends = model.node("base", (0, 0, 0)), model.node("tip", (100 * 2**0.5, 0, 0))
    model.beam("beam", ends, hinged_beam.SECTION, 40, 1, 8, **options)
    model.revolute("base", (0, 0, 1))
    return nearest(model, (0.0, 0.0, 0.906), 11.142)


def of_shaft(options: dict, expected: float) -> float:
    """Seen in axes that turn with it at half its first frequency."""
    model = Model()
    ends = model.node("a", (0, 0, 0)), model.node("b", (1, 0, 0))
    model.beam("shaft", ends, SLENDER, 24, 1, 4, **options)
    for end in "ab":
        model.fix(end, "position")
    first = vibrations(equilibrium(model, 1)).omega
    first = float(first[first > 1.0][0])
    return nearest(model, (0.5 * first, 0.0, 0.0), expected, first)


def stretch(options: dict) -> float:
    """Of an arm that turns about its root, by rho A W^2 L^2 / E A."""
    a = 0.095
    model = cantilever(options, True, replace(SLENDER, axial=1.0 / a**2))
    return float((equilibrium(model, 2, spin=1.0)["tip.position"][-1, 0] - 1.0) / a**2)


def onset(options: dict, load: Callable[[Model, float], None], exact: float) -> float:
    """Smallest load from 0.8 to 2 times the exact one at which small motion grows."""
    def grows(value: float) -> bool:
        model = cantilever(options, True)
        load(model, value)
        try:
            return modes(equilibrium(model, 2)).growth.max() > UNSTABLE
        except (SimulationError, InputError):
            return True
    values = exact * np.linspace(0.8, 2.0, 25)
    above = next((k for k, value in enumerate(values) if grows(value)), None)
    if not above:
        return math.nan
    low, high = values[above - 1], values[above]
    while high - low > 1e-4 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return float(low + high) / 2


def deepest(options: dict, case: str) -> float:
    """Deflection of the tip as the arm spins up, two modes; NaN if it folds."""
    scene = spin_up.build(case, bodies=1, modes=2, **options)
    try:
        result = simulate(scene.model, scene.h, 20.0)
    except SimulationError:
        return math.nan
    angle = np.array([spin_up.turning(spin_up.CASES[case][1])[0](t) for t in result.t])
    x, y = result["tip.position"].T
    found = (np.cos(angle) * y - np.sin(angle) * x).min()
    return float(found) if -found < spin_up.CASES[case][0] / 2 else math.nan


def middle_of_the_rod(options: dict) -> np.ndarray:
    """Off the line from pin to slider, by the length of the rod; five modes."""
    scene = slider_crank.build(modes=5, **options)
    result = simulate(scene.model, scene.h, scene.t_end)
    line = result["slider.position"] - result["pin.position"]
    chord = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    turned = [result[f"{node}.rotation"] - chord for node in ("pin", "slider")]
    y = np.column_stack([np.zeros((len(chord), 4)), *turned, result["rod.modes"]])
    shapes = scene.model.bodies["rod"].body.recovery.shapes[3 * (slider_crank.ELEMENTS // 2) + 1]
    return y @ shapes[:y.shape[1]] / slider_crank.LENGTH


def hinged_error(options: dict, finer: int) -> float:
    """Relative L2 error of the tip over 30 s, four modes."""
    scene = hinged_beam.build(**options)
    tip = simulate(scene.model, 0.01 / finer, 30.0, output_every=finer)["tip.position"]
    exact = reference("hinged_beam")["tip_position"]
    return float(np.linalg.norm(tip - exact) / np.linalg.norm(exact))


def spread(options: dict, finer: int) -> float:
    """Of the energy after the torque, relative."""
    result = simulate(hinged_beam.build(**options).model, 0.01 / finer, 30.0)
    energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > 7.6]
    return float(np.ptp(energy) / energy.mean())


def struck(options: dict, force: float, until: float, what: str) -> float:
    """The beam on a spherical joint: tip error, energy after the blow, largest strain energy."""
    scene = spherical_beam_strong.build(force, modes=8, **options)
    try:
        result = simulate(scene.model, scene.h, until)
    except SimulationError:
        return math.nan
    if what == "energy":
        total = result["energy.kinetic"] + result["energy.strain"]
        return float(total[round(15.2 / scene.h)])
    if what == "peak":
        return float(result["energy.strain"].max())
    data = reference("spherical_beam_strong")
    exact = data[f"tip_position_{force:g}"][data["t"] <= until + 1e-9]
    return float(np.linalg.norm(result["tip.position"][::20] - exact) / np.linalg.norm(exact))


def rows() -> Iterator[Row]:
    """The table, line by line."""
    yield Row("hinged beam at 0.906, first bending, 8 modes", 11.142, of_hinged_beam)
    for name, exact in (("flap 1", 7.3604), ("flap 2", 26.809), ("lag 1", 4.2632)):
        yield Row(f"cantilever at spin 6, {name}", exact, lambda o, e=exact: nearest(
            cantilever(o), (0.0, 0.0, 6.0), e))
    for exact in (0.5, 1.5):
        yield Row("shaft at half its first frequency", exact, lambda o, e=exact: of_shaft(o, e))
    yield Row("stretch of a turning arm", 0.33454, stretch)
    yield Row("Euler's load", np.pi**2 / 4, lambda o: onset(
        o, lambda m, p: m.force("tip", (-p, 0.0)), np.pi**2 / 4))
    yield Row("Beck's load", 20.051, lambda o: onset(
        o, lambda m, p: m.force("tip", (-p, 0.0), follower=True), 20.051))
    yield Row("weight of a column", 7.8373, lambda o: onset(
        o, lambda m, p: m.gravity((-p, 0.0)), 7.8373))
    for case, exact in (("kane", -0.53366), ("simo", -0.57392)):
        yield Row(f"spin-up ({case}), tip at its deepest", exact, lambda o, c=case: deepest(o, c))
    yield Row("rod of the slider-crank, largest", 0.015422, lambda o: middle_of_the_rod(o).max())
    yield Row("rod of the slider-crank, smallest", -0.015543, lambda o: middle_of_the_rod(o).min())
    for k in (1, 2, 4):
        yield Row(f"hinged beam, h {0.01 / k:g}: tip error", None,
                  lambda o, k=k: hinged_error(o, k))
    for k in (1, 2, 4):
        yield Row(f"hinged beam, h {0.01 / k:g}: spread of energy", None,
                  lambda o, k=k: spread(o, k))
    data = reference("spherical_beam_strong")
    for force, until in ((700.0, 30.0), (2800.0, 20.0)):
        energy = data[f"kinetic_{force:g}"] + data[f"strain_{force:g}"]
        for what, exact in (("tip error", None),
                            ("energy", float(np.interp(15.2, data["t"], energy))),
                            ("peak", float(data[f"peak_strain_{force:g}"]))):
            yield Row(f"struck by {force:g}, 8 modes, to t = {until:g}: {what}", exact,
                      lambda o, f=force, t=until, w=what: struck(o, f, t, w))


def main(arguments: list[str] | None = None, chosen: str = "") -> None:
    """Print the table, or its lines that contain `chosen`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    as_json = parser.parse_args(arguments).json
    warnings.simplefilter("ignore", LimitWarning)
    found = []
    if not as_json:
        print("| | exact | " + " | ".join(OPTIONS) + " |\n|" + "---|" * (2 + len(OPTIONS)))
    for row in rows():
        if chosen in row.what:
            values = {name: row.of(given) for name, given in OPTIONS.items()}
            found.append({"what": row.what, "exact": row.exact, **values})
            if not as_json:
                exact = "" if row.exact is None else f"{row.exact:.5g}"
                print(f"| {row.what} | {exact} | " + " | ".join(
                    "-" if math.isnan(v) else f"{v:.5g}" if row.exact else f"{v:.1e}"
                    for v in values.values()) + " |", flush=True)
    if as_json:
        print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
