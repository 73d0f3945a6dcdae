"""``sebody run``: run a scene, print its summary, save and draw its histories."""

import argparse
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

from sebody.basics.errors import InputError, Interrupted, LimitWarning, SebodyError, SimulationError
from sebody.cli import interrupts
from sebody.cli.number_arguments import real, whole
from sebody.cli.scene_arguments import build_scene, check_distinct, check_picture

if TYPE_CHECKING:
    from sebody.results.result import Result
    from sebody.runs.phased_simulation import PhasedSimulation
    from sebody.runs.simulation import Simulation
    from sebody.scenes.scene import Scene


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("run", help="run a scene")
    parser.add_argument("scene", metavar="SCENE",
                        help="name of a scene, see 'sebody list', or your own FILE.py")
    parser.add_argument("--output", type=Path, metavar="FILE.npz",
                        help="save the result: FILE.npz, or FILE.h5 with h5py")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw the standard plot")
    parser.add_argument("--t-end", type=real, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=real, metavar="H", help="time step, the scene's by default")
    parser.add_argument("--accuracy", type=real, metavar="E",
                        help="allowed error of the run, relative to the model's characteristic "
                             "length, and in radians: steps are chosen, --step is the output "
                             "interval")
    parser.add_argument("--every", type=whole, metavar="N", help="keep every N-th step only")
    parser.add_argument("--index", type=whole, default=None, metavar="I",
                        help="index of the constraints; 2: satisfied for velocities as well "
                             "(default 3, with --accuracy 2)")
    parser.add_argument("--equilibrium", action="store_true",
                        help="start from the equilibrium under gravity and the loads of t = 0")
    parser.add_argument("--save", type=Path, metavar="FILE.npz",
                        help="save the final state for --resume")
    parser.add_argument("--resume", type=Path, metavar="FILE.npz",
                        help="continue from a saved state, with its step, scheme and accuracy")
    parser.add_argument("--rho", type=real, metavar="R",
                        help="spectral radius of generalized-alpha at infinity (default 0.9)")
    parser.add_argument("--threads", type=whole, default=1, metavar="N",
                        help="threads that share the steps of a large model (default 1)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    return parser


def run(options: argparse.Namespace) -> int:
    """Run the scene; 1 if the run fails, with the results computed until then."""
    scene = build_scene(options.scene, options.changes)
    _check(options, scene)
    print(f"{scene.name}: {scene.summary}")
    outcome = _simulated(scene, options)
    print(outcome.result.summary())
    for line in outcome.written:
        print(line)
    sys.stdout.flush()
    for message in outcome.errors:
        print(f"error: {message}", file=sys.stderr)
    for message in outcome.result.warnings:
        print(f"warning: {message}", file=sys.stderr)
    return interrupts.exit_code() or int(bool(outcome.errors))


class Outcome(NamedTuple):
    """Files and words after a run, also of one that failed or was interrupted."""

    result: "Result"
    written: list[str]      # lines that name the files
    errors: list[str]


def _simulated(scene: "Scene", options: argparse.Namespace) -> Outcome:
    """Run the scene and write the files asked for.

    They are written before anything is printed: whoever reads may stop reading.
    """
    from sebody.basics.progress import Progress

    warnings.simplefilter("ignore", LimitWarning)   # they are printed after the summary
    t_end = _t_end(scene, options)
    start = _start(scene, options)
    simulation = None if options.accuracy is not None else _simulation(scene, options, start)
    bar, errors = Progress(t_end), []

    def progress(fraction: float) -> None:
        bar(fraction)
        interrupts.look()

    with interrupts.held():
        try:
            if simulation:
                result = simulation.run_to(t_end, progress).result()
            else:
                result = _within(scene, options, t_end, progress, start)
        except (SimulationError, Interrupted) as stop:
            result = cast("Result", stop.result)
            errors.append(str(stop))
        finally:
            bar.close()
        return Outcome(result, *_written(options, scene, simulation, result, errors))


def _simulation(scene: "Scene", options: argparse.Namespace,
                start: "Result | None") -> "Simulation | PhasedSimulation":
    from sebody.runs.phased_simulation import PhasedSimulation
    from sebody.runs.restart import resume
    from sebody.runs.schemes import generalized_alpha
    from sebody.runs.simulation import Simulation

    if options.resume:
        return resume(scene.model, options.resume, options.threads)
    index = 3 if options.index is None else options.index
    scheme = generalized_alpha(_rho(options), index=index)
    every = 1 if options.every is None else options.every
    kind = PhasedSimulation if scene.model.switches else Simulation
    return kind(scene.model, _step(scene, options), scheme, every, start=start,
                threads=options.threads)


def _within(scene: "Scene", options: argparse.Namespace, t_end: float,
            progress: Callable[[float], None], start: "Result | None") -> "Result":
    from sebody.runs.accuracy import simulate_within
    from sebody.runs.schemes import generalized_alpha
    from sebody.runs.tolerance import Tolerance

    index = 2 if options.index is None else options.index
    return simulate_within(scene.model, _step(scene, options), t_end, Tolerance(options.accuracy),
                           generalized_alpha(_rho(options), index=index), progress, start,
                           options.threads)


def _start(scene: "Scene", options: argparse.Namespace) -> "Result | None":
    """The state to start from, if it is not the scene's own."""
    if not options.equilibrium:
        return None
    from sebody.runs.statics import equilibrium

    return equilibrium(scene.model)


def _step(scene: "Scene", options: argparse.Namespace) -> float:
    return scene.h if options.step is None else options.step


def _rho(options: argparse.Namespace) -> float:
    return 0.9 if options.rho is None else options.rho


def _t_end(scene: "Scene", options: argparse.Namespace) -> float:
    t_end = scene.t_end if options.t_end is None else options.t_end
    if not 0.0 <= t_end < float("inf"):
        raise InputError(f"the end time is {t_end}: give a number >= 0")
    return t_end


def _written(options: argparse.Namespace, scene: "Scene",
             simulation: "Simulation | PhasedSimulation | None", result: "Result",
             errors: list[str]) -> tuple[list[str], list[str]]:
    """Write every file that is asked for, even if another one cannot be written."""
    from sebody.pictures.plots import save_picture
    from sebody.runs.restart import save_state

    files = (("state", options.save, lambda path: save_state(
                 cast("Simulation | PhasedSimulation", simulation), path)),
             ("histories", options.output, result.save),
             ("picture", options.plot,
              lambda path: save_picture(result, path, scene.base, scene.tip)))
    written = []
    for what, path, write in files:
        try:
            if path:
                written.append(f"{what:20} {write(path)}")
        except SebodyError as error:
            errors.append(str(error))
    return written, errors


def _check(options: argparse.Namespace, scene: "Scene") -> None:
    """Refuse before the run what cannot be written, and options that contradict others."""
    from sebody.basics.files import check_target
    from sebody.results.saving import check_output
    from sebody.runs.restart import TARGET

    if options.output:
        check_output(options.output)
    if options.save:
        check_target(options.save, *TARGET)
    check_distinct({"--output": options.output, "--save": options.save})
    check_distinct({"--output": options.output, "--resume": options.resume})
    check_picture(options.plot)
    for name in (scene.base, scene.tip) if options.plot else ():
        if name not in scene.model.nodes:
            raise InputError(f"the picture shows node {name!r}, which scene {scene.name!r} does "
                             f"not have: give its Scene base= and tip=, of "
                             f"{', '.join(scene.model.nodes)}")
    if options.accuracy is not None:
        if options.save or options.resume:
            raise InputError("--accuracy repeats the run with finer steps: leave out --save and "
                             "--resume")
        if options.every is not None:
            raise InputError("with --accuracy --step is the grid of the output: give a longer "
                             "one in place of --every")
    if options.resume:
        for name in ("step", "rho", "index", "every", "equilibrium"):
            if getattr(options, name) not in (None, False):
                raise InputError(f"--resume continues with the {name} that was saved: leave out "
                                 f"--{name}")
