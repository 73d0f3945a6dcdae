"""``sebody report``: a saved result on one page."""

import argparse
from pathlib import Path

from sebody.cli.scene_arguments import check_distinct, default_output


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "report", help="write a page with audit, plots and animation of a saved result")
    parser.add_argument("result", metavar="RESULT.npz",
                        help="file written by 'sebody run SCENE --output FILE.npz'")
    parser.add_argument("quantities", nargs="*", metavar="QUANTITY",
                        help="quantities to plot, written as for 'sebody plot'")
    parser.add_argument("--output", type=Path, metavar="FILE.html",
                        help="a self-contained page (default: RESULT_report.html)")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read the result and write the report."""
    from sebody.pictures.report import check_report, report
    from sebody.results.result import Result

    output = options.output or default_output(options.result, "_report.html")
    check_report(output)
    check_distinct({"--output": output, "RESULT": Path(options.result)})
    report(Result.load(options.result), output, *options.quantities)
    print(f"report: {output}")
    return 0
