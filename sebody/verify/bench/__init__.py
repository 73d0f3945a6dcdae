"""``sebody bench``: cost and error of scenes, beside Exudyn where it is installed."""

import json
from collections.abc import Iterable

from sebody.basics.errors import InputError
from sebody.runs.first_run import prepare
from sebody.verify.bench import ensemble, following, gradient, machine, own, peer
from sebody.verify.bench.measurement import Measurement
from sebody.verify.bench.parts import Cost, cost

__all__ = ["NAMES", "Cost", "cost", "machine_rate", "measure", "report", "to_json"]

SCENES = ("hinged-beam", "planar-hinged-beam", "spherical-beam", "chain", "slider-crank",
          "four-bar", "heavy-top")
ALONE = {one.SCENE: one.measure for one in (ensemble, gradient, following)}
EXTRA = "modes", *ALONE         # only by name
NAMES = SCENES + EXTRA


def measure(scenes: Iterable[str] = ()) -> list[Measurement]:
    """Measure scenes, all by default, each beside the peer's models in the same run.

    "modes" is the hinged beam by the number of its internal modes, "ensemble" ten thousand short
    runs of it, "gradient" exact gradients of it beside its run, "following-steps" a pendulum by
    planned steps, by as many equal ones, and by steps that are chosen one by one.

    Raises
    ------
    InputError
        A scene that has no benchmark.
    """
    chosen = list(scenes) or list(SCENES)
    for name in chosen:
        if name not in NAMES:
            raise InputError(f"there is no benchmark of scene {name!r}: use {', '.join(NAMES)}, or "
                             "`cost` for the parts of its steps")
    others = [name for name in chosen if name not in ALONE]
    prepare(case.build().model for name in others for case in own.cases(name)[:4])
    rows = [row for name, own in ALONE.items() if name in chosen for row in own()]
    for name in others:
        rows += [own.measure(case) for case in own.cases(name)]
        if peer.available():
            rows += peer.measure(name)
    return rows


def report(measurements: list[Measurement], rate: float) -> str:
    """The table: cost, error, ratio to the peer, fraction of the machine's rate."""
    lines = [f"{'scene':20} {'variant':34} {'unknowns':>8} {'h':>7} {'us/step':>9} {'iter':>5} "
             f"{'tip error':>9} {'ms/run':>8} {'kflop':>7} {'of limit':>8}"]
    for m in measurements:
        lines.append(
            f"{m.scene:20} {m.variant:34} {m.unknowns:8d} {m.h:7.4g} {m.us_per_step:9.2f} "
            f"{_number(m.iterations_per_step, '5.2f')} {_number(m.tip_error, '9.2e')} "
            f"{1e3 * m.wall_seconds:8.2f} {_number(_kilo(m.flops_per_step), '7.2f')} "
            f"{_number(_fraction(m, rate), '8.0%')}")
    lines += [f"{m.scene}, {m.variant}: {m.wall_seconds:.2f} s for all runs" + (
        "" if m.thread_efficiency is None else f", thread efficiency {m.thread_efficiency:.2f}")
        for m in measurements if m.scene == ensemble.SCENE]
    lines += gradient.in_runs([m for m in measurements if m.scene == gradient.SCENE])
    lines += following.drifts(measurements)
    lines += ["", f"this machine: {rate / 1e9:.2f} Gflop/s on 16 x 16 products, one core"]
    return "\n".join([*lines, *ratios(measurements)])


def ratios(measurements: list[Measurement]) -> list[str]:
    """Ratio of the peer's time to ours for each scene, and for a tip error of 1e-3."""
    lines = []
    for m in measurements:
        rivals = [p for p in measurements if p.scene == m.scene and _is_peer(p)
                  and p.h == m.h and (m.scene not in ("chain", "four-bar", "modes")
                                       or p.variant.endswith(m.variant.removesuffix(own.OPTION_B)))]
        if not _is_peer(m) and rivals:
            best = min(rivals, key=lambda p: p.us_per_step)
            lines.append(f"{m.scene}, {m.variant}: {best.variant} takes "
                         f"{best.us_per_step / m.us_per_step:.1f} times as long a step")
    for scene, share in (("hinged-beam", 20), ("planar-hinged-beam", 5)):
        good = [m for m in measurements if m.scene == scene and m.tip_error is not None
                and m.tip_error <= 1e-3]
        mine = [m.wall_seconds for m in good if not _is_peer(m)]
        theirs = [m for m in good if _is_peer(m)]
        if mine and theirs:
            best = min(theirs, key=lambda m: m.wall_seconds)
            lines.append(f"{scene} to a tip error of 1e-3: {1e3 * min(mine):.2f} ms, "
                         f"{best.variant} (h {best.h:g}) {1e3 * best.wall_seconds:.1f} ms: "
                         f"{best.wall_seconds / min(mine):.1f} times as long (aim {share})")
        elif mine and any(_is_peer(m) for m in measurements if m.scene == scene):
            lines.append(f"{scene} to a tip error of 1e-3: {1e3 * min(mine):.2f} ms; no Exudyn "
                         "model reaches it")
    return lines


def to_json(measurements: list[Measurement], rate: float, costs: Iterable[Cost] = ()) -> str:
    """The results as JSON, for other programs."""
    return json.dumps({"flops_per_second": rate, "exudyn": peer.version(),
                       "measurements": [m.as_dict() for m in measurements],
                       "costs": [one.as_dict() for one in costs]}, indent=1)


def machine_rate() -> float:
    """Floating-point operations a second, measured now."""
    return machine.flops_per_second()


def _is_peer(m: Measurement) -> bool:
    return m.variant.startswith(peer.NAME)


def _kilo(value: float | None) -> float | None:
    return None if value is None else value / 1e3


def _fraction(m: Measurement, rate: float) -> float | None:
    return None if m.flops_per_step is None else m.flops_per_step / rate / (1e-6 * m.us_per_step)


def _number(value: float | None, form: str) -> str:
    return format(value, form) if value is not None else "-".rjust(int(form.split(".")[0]))
