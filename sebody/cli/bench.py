"""``sebody bench``: cost and error of scenes."""

import argparse


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "bench", help="measure cost and error of scenes, beside Exudyn where it is installed")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="scenes (default: all with a "
                                                                   "benchmark)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    return parser


def run(options: argparse.Namespace) -> int:
    """Measure and print."""
    from sebody.verify import bench

    rate = bench.machine_rate()
    measured = bench.measure(options.scenes)
    print(bench.to_json(measured, rate) if options.json else bench.report(measured, rate))
    return 0
