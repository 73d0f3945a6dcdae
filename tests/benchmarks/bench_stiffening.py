"""What one body does with every inertia option, beside exact values: the table of the README here.

    python tests/benchmarks/bench_stiffening.py [--json] [ROW ...]

Every row is a test case with named numbers; the columns are exact values and the options B, D, C
without and C with geometric stiffening. A dash stands where a run or an equilibrium fails, "none"
where no critical load is found. Some minutes.
"""

import argparse
import json
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sebody import LimitWarning, SebodyError
from sebody.verify import references

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parent))
import stiffening_beams as beams
import stiffening_bodies as bodies
from stiffening_beams import Values

OPTIONS = {"B": {"inertia": "material"}, "D": {"inertia": "rigid_part"},
           "C": {"inertia": "floating_field", "stiffening": False},
           "C + stiffening": {"inertia": "floating_field"}}
NO_SPREAD = {f"{what}, h {h:g}": 0.0 for h in (0.01, 0.005, 0.0025)
             for what in ("tip", "energy spread")}


def cases() -> dict[str, tuple[Values, Callable[[dict], Values]]]:
    """Exact values and measurement of every row."""
    strong = references.reference("spherical_beam_strong")
    more = {f"{n} nodes, {name}": beams.SPINNING[name] for n in (3, 5, 8)
            for name in ("flap 1", "lag 1")}

    def blow(force: float) -> Values:
        energy = strong[f"kinetic_{force:g}"] + strong[f"strain_{force:g}"]
        after = np.interp(15.2, strong["t"], energy)
        return {"tip": 0.0, "energy at 15.2": after, "energy at 30": after,
                "peak strain": float(strong[f"peak_strain_{force:g}"])}
    return {
        "hinged beam at its spin, 8 modes": ({"bending": 11.142}, beams.hinged),
        "hinged beam, 30 s, 4 modes": (NO_SPREAD, beams.hinged_run),
        "struck beam, 700, 8 modes": (blow(700.0), beams.struck(700.0, 30.0)),
        "struck beam, 2800, 8 modes, tip to 20 s": (blow(2800.0), beams.struck(2800.0, 20.0)),
        "cantilever at eta 6, 4 modes": (beams.SPINNING, beams.spinning),
        "spin-up, Kane, 2 modes": ({"min v": -0.53366}, beams.spun_up("kane")),
        "spin-up, Simo, 2 modes": ({"min v": -0.57392}, beams.spun_up("simo")),
        "slider-crank rod, 5 modes": ({"max": 0.015422, "min": -0.015543}, beams.rod),
        "Euler, 4 modes": ({"load": np.pi**2 / 4}, beams.column("dead", 2.0, 4.0)),
        "Beck, 4 modes": ({"load": 20.0510}, beams.column("follower", 15.0, 24.0)),
        "own weight, 4 modes": ({"load": 7.8373}, beams.column("weight", 6.0, 9.0)),
        "lateral buckling, 8 modes": ({"load": 4.0126}, beams.sideways),
        "shaft at half its frequency, 4 modes": (beams.SHAFT, beams.shaft),
        "stretch of a turning arm": ({"stretch": 0.33454}, beams.stretch),
        "solid at eta 6, 6 modes": (bodies.SOLID, bodies.spinning_solid),
        "thin solid, Euler, 6 modes": ({"load": 6.9696}, bodies.strip),
        "blade with soft torsion, growth": (
            {f"GJ / EI {t:g}": 0.0 for t in (0.1, 0.01, 1e-3)}, bodies.soft_blade),
        "propeller moment": ({"square section": 0.0, "thin section": 0.9}, bodies.propeller),
        "block by its corners, acceleration of an unstrained start": (
            bodies.START, bodies.started),
        "block by its corners, in equilibrium": (
            {"error": 0.0, "change by a speed": 0.0}, bodies.corners),
        "coupler between ball joints, 6 modes": ({}, bodies.coupler),
        "more boundary nodes at eta 6": (more, beams.many_nodes),
        "elbow, 3 nodes, 6 modes: errors": (
            {f"at {s:g} omega 1": 0.0 for s in (0.21, 0.42, 0.63)}, bodies.bent),
        "plate on four interfaces, 8 modes: errors": (
            {f"at {s:g} omega 1": 0.0 for s in (0.5, 1.0, 2.0)}, bodies.corner_plate),
        "four bodies with 2 modes at eta 6": (beams.SPINNING, beams.four_bodies),
    }


def measure(exact: Values, measured: Callable[[dict], Values]) -> dict[str, Values]:
    """By option; NaN for all numbers where there is no equilibrium or the run stops."""
    found = {}
    for name, option in OPTIONS.items():
        try:
            found[name] = {key: float(value) for key, value in measured(option).items()}
        except SebodyError:
            found[name] = {key: np.nan for key in exact}
    return found


def table(name: str, exact: Values, found: dict[str, Values]) -> str:
    """Lines of the README's table."""
    def cell(value: float | None) -> str:
        if value is None or np.isnan(value):
            return "-"
        return "none" if np.isinf(value) else f"{value:.5g}"
    return "\n".join(
        f"| {name}: {key} | {cell(exact.get(key))} | "
        + " | ".join(cell(values.get(key)) for values in found.values()) + " |"
        for key in exact)


def main(arguments: list[str] | None = None) -> None:
    """Measure the named rows, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", help="parts of the names of rows")
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_args(arguments)
    everything = {}
    if not chosen.json:
        print("| | exact | " + " | ".join(OPTIONS) + " |\n|---|---|" + "---|" * len(OPTIONS))
    for name, (exact, measured) in cases().items():
        if chosen.rows and not any(part in name for part in chosen.rows):
            continue
        exact = exact or bodies.divided_coupler()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LimitWarning)
            found = measure(exact, measured)
        everything[name] = {"exact": exact} | found
        if not chosen.json:
            print(table(name, exact, found), flush=True)
    if chosen.json:
        print(json.dumps(everything))


if __name__ == "__main__":
    main()
