"""``sebody run``: run a scene, print its summary, save and draw its histories."""

import argparse
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.cli.inputs import build_scene, check_picture
from sebody.cli.progress import Progress
from sebody.errors import InputError, LimitWarning, SimulationError
from sebody.files import check_target

if TYPE_CHECKING:
    from sebody.results.result import Result
    from sebody.scenes.scene import Scene


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("run", help="run a scene")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene, see 'sebody list'")
    parser.add_argument("--output", type=Path, metavar="FILE.npz", help="save the histories")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw the standard picture")
    parser.add_argument("--t-end", type=float, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=float, metavar="H", help="time step, the scene's by default")
    parser.add_argument("--accuracy", type=float, metavar="E",
                        help="allowed error of the run, of the model's extent and in radians: "
                             "steps are chosen, --step is the grid of the output")
    parser.add_argument("--index", type=int, default=None, metavar="I",
                        help="2: constraints hold for velocities, too (default 3, with "
                             "--accuracy 2)")
    parser.add_argument("--save", type=Path, metavar="FILE.npz",
                        help="save the state to go on from")
    parser.add_argument("--resume", type=Path, metavar="FILE.npz",
                        help="go on from a saved state, with its step, scheme and accuracy")
    parser.add_argument("--rho", type=float, metavar="R",
                        help="spectral radius of generalized-alpha at infinity (default 0.9)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    return parser


def run(options: argparse.Namespace) -> int:
    """Run the scene; 1 if the run fails, with the results computed until then."""
    scene = build_scene(options.scene, options.changes)
    _check(options)
    print(f"{scene.name}: {scene.summary}")
    try:
        result, failure = _simulated(scene, options), ""
    except SimulationError as error:
        result, failure = error.result, str(error)
    print(result.summary())
    if options.output:
        print(f"histories            {result.save(options.output)}")
    if options.plot:
        from sebody.results.plots import save_picture
        print(f"picture              {save_picture(result, options.plot, scene.base, scene.tip)}")
    if failure:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failure else 0


def _simulated(scene: "Scene", options: argparse.Namespace) -> "Result":
    from sebody.analysis.accuracy import simulate_within
    from sebody.analysis.restart import resume, save_state
    from sebody.analysis.schemes import generalized_alpha
    from sebody.analysis.simulation import Simulation
    from sebody.analysis.tolerance import Tolerance

    h = scene.h if options.step is None else options.step
    t_end = scene.t_end if options.t_end is None else options.t_end
    if not 0.0 <= t_end < float("inf"):
        raise InputError(f"the end time is {t_end}: give a number >= 0")
    rho = 0.9 if options.rho is None else options.rho
    progress = Progress()
    warnings.simplefilter("ignore", LimitWarning)   # the summary prints them
    try:
        if options.accuracy is not None:
            scheme = generalized_alpha(rho, index=2 if options.index is None else options.index)
            return simulate_within(scene.model, h, t_end, Tolerance(options.accuracy), scheme,
                                   progress)
        simulation = (resume(scene.model, options.resume) if options.resume else
                      Simulation(scene.model, h, generalized_alpha(
                          rho, index=3 if options.index is None else options.index)))
        simulation.run_to(t_end, progress)
    finally:
        progress.close()
    if options.save:
        print(f"state                {save_state(simulation, options.save)}")
    return simulation.result()


def _check(options: argparse.Namespace) -> None:
    """Refuse files that cannot be written before the run, and options that contradict others."""
    from sebody.analysis.restart import TARGET
    from sebody.results.result import OUTPUT

    for path, kind in ((options.output, OUTPUT), (options.save, TARGET)):
        if path:
            check_target(path, *kind)
    check_picture(options.plot)
    if options.accuracy is not None and (options.save or options.resume):
        raise InputError("--accuracy repeats the run with finer steps: leave out --save and "
                         "--resume")
    if options.resume:
        for name in ("step", "rho", "index"):
            if getattr(options, name) is not None:
                raise InputError(f"--resume goes on with the {name} that was saved: leave out "
                                 f"--{name}")
