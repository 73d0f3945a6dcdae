"""``sebody advise``: the bodies, modes and step that some quantities of a scene need."""

import argparse

from sebody.cli.inputs import build_scene


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "advise", help="the cheapest model that keeps some quantities of a scene")
    parser.add_argument("scene", metavar="SCENE",
                        help="name of a scene or a file, FILE.py: the richest model of interest")
    parser.add_argument("--quantity", action="append", required=True, metavar="NAME",
                        help="quantity to keep, such as tip.position; may be repeated")
    parser.add_argument("--tolerance", type=float, default=1e-3, metavar="E",
                        help="largest error, relative to a quantity's largest change "
                             "(default 1e-3)")
    parser.add_argument("--t-end", type=float, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=float, metavar="H",
                        help="usual time step, the scene's by default; the reference has a quarter")
    parser.add_argument("--budget", type=float, default=20.0, metavar="N",
                        help="time of the search, in runs of the whole model (default 20)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    return parser


def run(options: argparse.Namespace) -> int:
    """Print all runs of the search and the advice."""
    from sebody.analysis.advice import advise

    scene = build_scene(options.scene, options.changes)
    advice = advise(scene.model, scene.h if options.step is None else options.step,
                    scene.t_end if options.t_end is None else options.t_end,
                    options.quantity, options.tolerance, options.budget)
    print(f"{'error':>9} {'step':>9} {'seconds':>9}  change")
    for trial in advice.table:
        print(f"{trial.error:9.2g} {trial.step:9.3g} {trial.seconds:9.2g}  {trial.change}")
    print(advice.summary())
    return 0
