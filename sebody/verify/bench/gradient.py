"""Cost of exact gradients of a run: sweeps of the hinged beam beside the run itself."""

import statistics
from warnings import catch_warnings, simplefilter

import numpy as np

from sebody.basics.errors import LimitWarning
from sebody.catalogue import builder
from sebody.explore.ensembles import final
from sebody.gradients.gradient import gradient
from sebody.model.model import Model
from sebody.runs.schemes import generalized_alpha
from sebody.runs.simulation import Simulation
from sebody.verify.bench.measurement import Measurement
from sebody.verify.bench.own import OPTION_B

SCENE = "gradient"
STEPS, VALUES, RUNS = 3000, 1000, 5
TOLERANCE = 1e-8        # of the run, and of the refinement of each step of a sweep
NUMBERS = {"1 parameter": "motor.amplitude", f"{VALUES} values of a table": "motor.table"}


def measure(steps: int = STEPS, runs: int = RUNS) -> list[Measurement]:
    """The run, then gradients of the tip's last place, back and forth, for both inertia options.

    `us_per_step` is that of the loop, or of the recursion alone; `wall_seconds` of the whole call:
    set-up, run, recursion, and what the parameters change of the residuals.
    """
    return [one for inertia in (None, "material") for one in _measure(inertia, steps, runs)]


def _model(inertia: str | None, t_end: float) -> tuple[Model, float]:
    """The hinged beam with its torque as a table of many values."""
    scene = builder("hinged-beam")(**({} if inertia is None else {"inertia": inertia}))
    model, t = scene.model, np.linspace(0.0, t_end, VALUES)
    values = model.loads[0].time_function.values(t)
    model.loads.clear()
    model.torque("base", (0, 0, 1), np.column_stack([t, values]), name="motor")
    return model, scene.h


def _measure(inertia: str | None, steps: int, runs: int) -> list[Measurement]:
    h = builder("hinged-beam")().h
    model, _ = _model(inertia, steps * h)
    scheme, option = generalized_alpha(tolerance=TOLERANCE), OPTION_B if inertia else ""
    unknowns = Simulation(model, h).numbering.free
    given = model, h, steps * h, {"tip": final("tip.position.y")}

    def row(what: str, sweeps: list[float], whole: list[float]) -> Measurement:
        return Measurement(SCENE, what + option, unknowns, h,
                           1e6 * statistics.median(sweeps) / steps, None, None,
                           statistics.median(whole))
    tasks = {f"{mode}, {what}": ([name], mode) for mode in ("adjoint", "forward")
             for what, name in NUMBERS.items() if mode == "adjoint" or name.endswith("amplitude")}
    with catch_warnings():
        simplefilter("ignore", LimitWarning)    # of the scene: it is the cost that counts here
        found = {what: [gradient(*given, *task, scheme=scheme) for _ in range(runs + 1)][1:]
                 for what, task in tasks.items()}       # the first one compiles
    every = [one for own in found.values() for one in own]
    return [row("run", [one.run_seconds for one in every], [one.run_seconds for one in every]),
            *(row(what, [one.sweep_seconds for one in own], [one.seconds for one in own])
              for what, own in found.items())]


def in_runs(measurements: list[Measurement]) -> list[str]:
    """Recursions in runs, a line each."""
    lines, loop = [], 1.0
    for m in measurements:
        if m.variant.startswith("run"):
            loop = m.us_per_step
            continue
        lines.append(f"{m.scene}, {m.variant}: a sweep takes {m.us_per_step / loop:.1f} runs")
    return lines
