"""``sebody advise``: the cheapest model of a scene that keeps some quantities."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.cli import interrupts, scene_files
from sebody.cli.number_arguments import real
from sebody.cli.scene_arguments import build_scene, check_picture, given_arguments, source

if TYPE_CHECKING:
    from sebody.analysis import Advice
    from sebody.explore.advice.outcome import Trial
    from sebody.scenes.scene import Scene

KINDS = {"reference": "reference model", "alone": "one part alone", "together": "together",
         "confirmation": "half the step", "given": "as given", "guard": "guard of the reference"}

NOTES = ("error: largest difference from the reference model at any time, or of what is measured, "
         "relative to the quantity's size, with the reference's own",
         "time: of the loop, of single runs; the chosen one's is the least of several",
         "guards: the reference model off the grid, disturbed, or with more bodies")
AUTO = "auto"           # of a step: chosen by the search
NOT_CONFIRMED = 3       # exit code of advice that is as uncertain as the reference


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "advise", help="the cheapest model that keeps some quantities of a scene")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene or a file, FILE.py")
    parser.add_argument("--quantity", action="append", required=True, metavar="NAME",
                        help="quantity to keep, such as tip.position, hinge.force, "
                             "'tip.position rms', 'tip.velocity < 50 Hz' or 'frequency 1'; may be "
                             "repeated")
    parser.add_argument("--tolerance", default="1e-3", metavar="E",
                        help="largest error, relative to a quantity's largest change (default "
                             "1e-3), or with a unit, such as 2mm")
    parser.add_argument("--t-end", type=real, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=_step, metavar="H",
                        help="usual time step, the scene's by default; the reference has a "
                             "quarter; 'auto' begins with a 128th of the time")
    parser.add_argument("--budget", type=real, default=20.0, metavar="N",
                        help="work of the search, in runs of the reference model (default 20)")
    parser.add_argument("--start", choices=["equilibrium"],
                        help="start runs from the equilibrium under the loads of t = 0")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    parser.add_argument("--output", type=Path, metavar="FILE.png",
                        help="draw error against time of all runs, with the choice")
    parser.add_argument("--code", action="store_true", help="print the chosen model as Python")
    return parser


def _step(text: str) -> float | str:
    """A time step, or ``auto``."""
    if text == AUTO:
        return text
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"step is {text!r}: give a number, or {AUTO}") from None


def run(options: argparse.Namespace) -> int:
    """Print all runs of the search and the advice; draw them.

    Raises
    ------
    InputError
        Also where no model is good enough: then the best is printed before.
    """
    from sebody.explore.advice import Unreached

    check_picture(options.output)
    scene = build_scene(options.scene, options.changes)
    try:
        advice = _advised(options, scene)
    except Unreached as reason:
        _print(reason.advice)
        raise
    last = _print(advice)
    if options.code:
        print("\n" + advice.code(_given(options)) + "\n")
    if options.output:
        _draw(advice, scene.name, options.quantity, options.output)
        print(f"picture: {options.output}")
    print(last)
    return interrupts.exit_code() or (0 if advice.confirmed else NOT_CONFIRMED)


def _print(advice: "Advice") -> str:
    """Print runs and advice but for the last line, which is returned."""
    print(f"{'predicted':>9} {'error':>9} {'step':>9} {'seconds':>9}  change")
    for trial in advice.table:
        local = f"; {_steps(trial)}" if trial.local else ""
        print(f"{trial.predicted:9.2g} {trial.error:9.2g} {trial.step:9.3g} {trial.seconds:9.2g}  "
              f"{trial.change}{local}")
    *lines, last = advice.summary().splitlines()
    print("\n".join(lines))
    return last


def _steps(trial: "Trial") -> str:
    """Its steps in a few words."""
    if trial.local is None:
        return f"step {trial.step:.3g}"
    return f"variable steps, local tolerance {trial.local:.2g}"


def _advised(options: argparse.Namespace, scene: "Scene") -> "Advice":
    """The advice, also of a search that Ctrl-C has ended."""
    from sebody.analysis import advise
    from sebody.basics.progress import Progress

    bar = Progress()

    def progress(fraction: float) -> None:
        bar(fraction)
        interrupts.look()

    with interrupts.held():
        try:
            given = scene.h if options.step is None else options.step
            return advise(scene.model, None if given == AUTO else given,
                          scene.t_end if options.t_end is None else options.t_end,
                          options.quantity, options.tolerance, options.budget, progress,
                          options.start)
        finally:
            bar.close()


def _given(options: argparse.Namespace) -> list[str]:
    """Lines of Python that build the scene."""
    build, _, file = source(options.scene)
    arguments = ", ".join(f"{name}={value!r}" for name, value in
                          given_arguments(options.scene, build, options.changes).items())
    if scene_files.is_file(options.scene):
        return ["from runpy import run_path",
                f"model = run_path({file!r})['build']({arguments}).model"]
    return [f"from {build.__module__} import build", f"model = build({arguments}).model"]


def _draw(advice: "Advice", name: str, quantities: list[str], path: Path) -> None:
    """The runs of the search on a chart, each once; guards are no models to choose from."""
    from sebody.verify import chart

    chosen = advice.trial
    points = {one: chart.Point(
        KINDS[one.kind], f"{one.change}; {_steps(one)}", one.error,
        (advice.seconds if one is chosen else one.seconds) / advice.t_end, 0, one.step, 0.0)
        for one in advice.table}
    choice = points.get(chosen)
    best = [points[one] for one in advice.table if one.kind != "guard"]
    chart.draw(f"{name}, {', '.join(quantities)}", points.values(), chart.front(best), 0.0, path,
               choice, advice.tolerance, NOTES)
