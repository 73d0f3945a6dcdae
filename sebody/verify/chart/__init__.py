"""``sebody chart``: error against computing time of all that a scene can be built from."""

import csv
from collections.abc import Callable, Iterator
from dataclasses import astuple, fields
from functools import partial
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sebody.basics.errors import SimulationError
from sebody.basics.files import check_target, replacing
from sebody.explore.advice.quantities import history_in_space
from sebody.runs.first_run import prepare
from sebody.runs.simulation import Simulation
from sebody.verify.bench import peer
from sebody.verify.chart.advised import FAMILY, Advised, advised
from sebody.verify.chart.any_scene import measure_any
from sebody.verify.chart.cases import COARSEST, SCENES, TOLERANCE, Variant, builder, variants
from sebody.verify.chart.draw import Panel, draw, draw_panels
from sebody.verify.chart.points import Point, Study, front
from sebody.verify.chart.references import Reference, reference
from sebody.verify.chart.timing import BARS, poor_variants, processor_seconds, repeated

T_END = 30.0                    # of the peer's runs
ERROR = ("error: root mean square of the difference from the reference at all times, relative to "
         "that of the quantity, never below the reference's own")
LEVELS = (1e-2, 1e-3, 3e-4)     # of error, at which front and peer are compared


def measure(scene: str, tolerance: float = TOLERANCE) -> Study:
    """Run all variants of one of `SCENES`, the advised model, and the peer where it is installed.

    Parameters
    ----------
    scene : str
    tolerance : float
        Of the advice.
    """
    chosen = variants(scene)
    prepare(builder(scene)(**v.parameters).model for v in chosen)
    exact, base = reference(scene), builder(scene)()
    with poor_variants():
        advice = advised(base.model, base.h, base.t_end, [SCENES[scene]], tolerance)
        points = _points(scene, chosen, exact, advice)
    choice = next((one for one in points if one.family == FAMILY), None)
    if peer.available():
        points += _peer(scene, exact)
    return Study(points, SCENES[scene], exact.error, choice, tolerance,
                 (ERROR, BARS, advice.told, peer.told(scene)))


class _Begun(NamedTuple):
    """A run to be measured: its names, how it begins, its step and end."""

    family: str
    label: str
    begin: Callable[[], Simulation]
    h: float
    t_end: float


def _points(scene: str, chosen: list[Variant], exact: Reference, found: Advised) -> list[Point]:
    """Measure variants and the advised model; those whose runs fail are left out."""
    kept, runs = [], []
    for one in _begun(scene, chosen, found):
        try:
            result = one.begin().run_to(one.t_end).result()
        except SimulationError:
            continue
        kept.append((one, result))
        runs.append(lambda one=one: processor_seconds(one.begin(), one.t_end))
    return [Point(one.family, one.label, _error(history_in_space(result, SCENES[scene]), exact),
                  times.quickest / one.t_end, result.numbering.free, one.h,
                  result.iterations_per_step, times.slowest / one.t_end)
            for (one, result), times in zip(kept, repeated(runs), strict=True)]


def _begun(scene: str, chosen: list[Variant], found: Advised) -> Iterator[_Begun]:
    """All that is run; the advised model first."""
    if found.advice:
        base, advice = builder(scene)(), found.advice
        yield _Begun(FAMILY, found.label, partial(
            Simulation, advice.model, advice.step,
            output_every=max(round(COARSEST * base.h / advice.step), 1),
            tolerance=advice.local), advice.step, base.t_end)
    for variant in chosen:
        built = builder(scene)(**variant.parameters)
        h = built.h / variant.finer
        yield _Begun(variant.family, variant.label, partial(
            Simulation, built.model, h, variant.scheme, round(COARSEST * variant.finer)),
            h, built.t_end)


def _error(values, exact: Reference) -> float:
    error = np.linalg.norm(values - exact.values) / np.linalg.norm(exact.values)
    return float(max(error, exact.error))


def _peer(scene: str, exact: Reference) -> list[Point]:
    """Points of the bench, over 30 s; its own references are of higher order."""
    if scene not in peer.BEAMS:
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


def write_csv(studies: list[Study], path: Path) -> None:
    """One line a point, with the quantity it is of.

    Raises
    ------
    InputError
        A target that cannot be written, see `check_target`.
    WriteError
        Writing fails; an older file is unchanged.
    """
    table = StringIO(newline="")
    writer = csv.writer(table)
    writer.writerow([*(f.name for f in fields(Point)), "quantity"])
    writer.writerows((*astuple(p), study.quantity) for study in studies for p in study.points)
    with replacing(check_target(path, "table"), "table") as file:
        file.write(table.getvalue().encode())


def panels(studies: list[Study]) -> list[Panel]:
    """One of each study, with the front of this package's points."""
    return [Panel(one.quantity, one.points, front(own(one.points)), one.error, one.choice,
                  one.tolerance) for one in studies]


__all__ = ["SCENES", "Point", "Study", "draw", "draw_panels", "front", "measure", "measure_any",
           "own", "panels", "report", "write_csv"]
