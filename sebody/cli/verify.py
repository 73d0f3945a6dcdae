"""``sebody verify``: numbers that other programs, books and benchmark libraries publish."""

import argparse
import json


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("verify", help="compare with numbers that other programs, books "
                                                "and benchmark libraries publish")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="cases (default: all)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    return parser


def run(options: argparse.Namespace) -> int:
    """Measure and print; 1 if a number exceeds its tolerance."""
    from sebody.verify import outside

    outside.check_names(options.cases)
    found = []
    for name in options.cases or outside.CASES:
        rows = outside.measure(name)
        found += rows
        if not options.json:
            print(f"{outside.report(rows)}\n", flush=True)
    print(json.dumps(outside.as_dict(found), indent=1) if options.json else outside.summary(found))
    return 0 if all(row.passed for row in found) else 1
