"""``sebody chart``: error against computing time."""

import argparse
from dataclasses import replace
from pathlib import Path

from sebody.cli.number_arguments import real
from sebody.cli.scene_arguments import build_scene, check_distinct, check_picture


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "chart", help="draw error against computing time of the model variants of a scene")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene or a file, FILE.py")
    parser.add_argument("--output", type=Path, metavar="FILE.png", help="draw it")
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help="write the points")
    parser.add_argument("--quantity", action="append", default=[], metavar="NAME",
                        help="compared quantity, such as tip.position (default: position of the "
                             "scene's tip); may be repeated: a panel each")
    parser.add_argument("--tolerance", type=real, metavar="E",
                        help="of the model that is advised and marked (default 1e-2)")
    parser.add_argument("--t-end", type=real, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=real, metavar="H", help="time step, the scene's by default")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    return parser


def run(options: argparse.Namespace) -> int:
    """Measure, print, write and draw."""
    from sebody.basics import inputs
    from sebody.basics.files import check_target
    from sebody.verify import chart

    check_picture(options.output)
    if options.csv:
        check_target(options.csv, "table")
    check_distinct({"--output": options.output, "--csv": options.csv})
    scene = build_scene(options.scene, options.changes)
    given = {"h": options.step, "t_end": options.t_end}
    changed = {name: inputs.number(value, name, above=0) for name, value in given.items()
               if value is not None}
    tolerance = {} if options.tolerance is None else {
        "tolerance": inputs.number(options.tolerance, "tolerance", above=0, below=1)}
    if options.scene in chart.SCENES and not (options.quantity or changed or options.changes):
        studies = [chart.measure(options.scene, **tolerance)]
    else:
        studies = chart.measure_any(replace(scene, **changed), options.quantity, **tolerance)
    for study in studies:
        print(chart.report(f"{scene.name}, {study.quantity}", study.points, study.error))
    if options.csv:
        chart.write_csv(studies, options.csv)
        print(f"table: {options.csv}")
    if options.output:
        chart.draw_panels(f"{scene.name}: error and computing time", chart.panels(studies),
                          options.output, studies[0].notes)
        print(f"picture: {options.output}")
    return 0
