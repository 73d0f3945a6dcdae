"""``sebody atlas``: known limits, with theory and measured values."""

import argparse
from pathlib import Path

from sebody.cli.scene_arguments import check_picture


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("atlas", help="known limits: theory, measured value, how sebody "
                                               "reacts")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="cases (default: all)")
    parser.add_argument("--output", type=Path, metavar="FILE.png",
                        help="draw all cases")
    return parser


def run(options: argparse.Namespace) -> int:
    """Explore the cases, print and draw; 1 if a number is not what was expected."""
    from sebody.verify import atlas

    check_picture(options.output)
    atlas.check_names(options.cases)
    if not options.cases:
        atlas.prepare()
    findings = []
    for name in options.cases or atlas.CASES:
        findings.append(atlas.explore(name))
        print(f"{name}: {atlas.report(findings[-1])}\n", flush=True)
    if options.output:
        atlas.draw(findings, options.output)
        print(f"picture: {options.output}")
    return 0 if all(row.passed for f in findings for row in f.rows) else 1
