"""``sebody chart``: error against computing time of all that a scene can be built from."""

import csv
from dataclasses import astuple, fields
from functools import partial
from io import StringIO
from pathlib import Path

import numpy as np

from sebody.errors import SimulationError
from sebody.files import check_target, replacing
from sebody.runs.first_run import prepare
from sebody.runs.simulation import Simulation
from sebody.verify.bench import peer
from sebody.verify.chart.any_scene import measure_any
from sebody.verify.chart.cases import COARSEST, SCENES, Variant, builder, variants
from sebody.verify.chart.draw import draw
from sebody.verify.chart.points import Point, Study, front
from sebody.verify.chart.references import Reference, reference
from sebody.verify.chart.timing import poor_variants, processor_seconds, repeated

T_END = 30.0                    # of the peer's runs
LEVELS = (1e-2, 1e-3, 3e-4)     # of error, at which front and peer are compared


def measure(scene: str) -> Study:
    """Run all variants of one of `SCENES`, and the peer where it is installed."""
    chosen = variants(scene)
    prepare(builder(scene)(**v.parameters).model for v in chosen)
    exact = reference(scene)
    with poor_variants():
        points = _points(scene, chosen, exact)
    if peer.available():
        points += _peer(scene, exact)
    return Study(points, SCENES[scene], exact.error)


def _points(scene: str, chosen: list[Variant], exact: Reference) -> list[Point]:
    """Measure variants; those whose runs fail are left out."""
    found, runs = [], []
    for variant in chosen:
        built = builder(scene)(**variant.parameters)
        begin = partial(Simulation, built.model, built.h / variant.finer, variant.scheme,
                        round(COARSEST * variant.finer))
        try:
            result = begin().run_to(built.t_end).result()
        except SimulationError:
            continue
        found.append((variant, result, built))
        runs.append(lambda begin=begin, t_end=built.t_end: processor_seconds(begin(), t_end))
    return [Point(variant.family, variant.label, _error(result[SCENES[scene]], exact),
                  times.quickest / built.t_end, result.numbering.free, built.h / variant.finer,
                  result.iterations_per_step, times.slowest / built.t_end)
            for (variant, result, built), times in zip(found, repeated(runs), strict=True)]


def _error(values, exact: Reference) -> float:
    error = np.linalg.norm(values - exact.values) / np.linalg.norm(exact.values)
    return float(max(error, exact.error))


def _peer(scene: str, exact: Reference) -> list[Point]:
    """Points of the bench, over 30 s; its own references are of higher order."""
    if scene not in ("hinged-beam", "planar-hinged-beam", "spherical-beam"):
        return []
    names = (scene, "planar-hinged-beam") if scene == "hinged-beam" else (scene,)
    return [Point(peer.NAME, m.variant.removeprefix(peer.NAME).strip() + f", h {m.h:g}",
                  max(m.tip_error, exact.error), m.processor_seconds / T_END, m.unknowns, m.h,
                  m.iterations_per_step or 0.0)
            for name in names for m in peer.measure(name) if m.tip_error is not None]


def own(points: list[Point]) -> list[Point]:
    """Points of this package."""
    return [p for p in points if p.family != peer.NAME]


def report(name: str, points: list[Point], limit: float) -> str:
    """The points of the front by name, and the ratios of cost to the peer's."""
    lines = [f"{name}: reference good to {limit:.1e}, {len(own(points))} points",
             f"{'front':44} {'error':>9} {'ms per second':>14}"]
    lines += [f"{p.label:44} {p.error:9.1e} {1e3 * p.cost:14.4f}" for p in front(own(points))]
    for level in LEVELS:
        mine = [p.cost for p in own(points) if p.error <= level]
        theirs = [p.cost for p in points if p.family == peer.NAME and p.error <= level]
        if mine and theirs:
            lines.append(f"at an error of {level:.0e} Exudyn's best takes "
                         f"{min(theirs) / min(mine):.1f} times as long")
        elif mine and any(p.family == peer.NAME for p in points):
            lines.append(f"at an error of {level:.0e} there is no point of Exudyn")
    return "\n".join(lines)


def write_csv(points: list[Point], path: Path) -> None:
    """One line a point.

    Raises
    ------
    InputError
        A target that cannot be written, see `check_target`.
    WriteError
        Writing fails; an older file is unchanged.
    """
    table = StringIO(newline="")
    writer = csv.writer(table)
    writer.writerow([f.name for f in fields(Point)])
    writer.writerows(astuple(p) for p in points)
    with replacing(check_target(path, "table"), "table") as file:
        file.write(table.getvalue().encode())


__all__ = ["SCENES", "Point", "Study", "draw", "front", "measure", "measure_any", "own", "report",
           "write_csv"]
