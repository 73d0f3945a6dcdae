"""``sebody bench``: cost and error of scenes."""

import argparse
import json

from sebody.cli.scene_arguments import build_scene


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "bench", help="measure cost and error of scenes, beside Exudyn where it is installed")
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help="scenes (default: all with a benchmark); of others and of your own "
                             "FILE.py the cost of the parts of a step")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    return parser


def run(options: argparse.Namespace) -> int:
    """Measure and print."""
    from sebody.verify import bench

    with_rows = [name for name in options.scenes if name in bench.NAMES]
    others = [name for name in options.scenes if name not in bench.NAMES]
    scenes = [build_scene(name, ()) for name in others]
    costs = [bench.cost(scene) for scene in scenes]
    if others and not with_rows:
        print(json.dumps({"costs": [one.as_dict() for one in costs]}, indent=1) if options.json
              else "\n\n".join(map(str, costs)))
        return 0
    rate = bench.machine_rate()
    measured = bench.measure(with_rows)
    print(bench.to_json(measured, rate, costs) if options.json else
          "\n\n".join([bench.report(measured, rate), *map(str, costs)]))
    return 0
