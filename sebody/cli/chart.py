"""``sebody chart``: error against computing time."""

import argparse
from pathlib import Path

from sebody.cli.inputs import check_distinct, check_picture
from sebody.files import check_target


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "chart", help="error against computing time, over formulations, divisions and steps")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene that has a chart")
    parser.add_argument("--output", type=Path, metavar="FILE.png", help="draw it")
    parser.add_argument("--csv", type=Path, metavar="FILE.csv", help="write the points")
    return parser


def run(options: argparse.Namespace) -> int:
    """Measure, print, write and draw."""
    from sebody.studies import chart

    check_picture(options.output)
    if options.csv:
        check_target(options.csv, "table")
    check_distinct({"--output": options.output, "--csv": options.csv})
    points, exact = chart.measure(options.scene)
    print(chart.report(options.scene, points, exact))
    if options.csv:
        chart.write_csv(points, options.csv)
        print(f"table: {options.csv}")
    if options.output:
        chart.draw(options.scene, points, chart.front(chart.own(points)), exact.error,
                   options.output)
        print(f"picture: {options.output}")
    return 0
