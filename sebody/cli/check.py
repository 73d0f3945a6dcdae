"""``sebody check``: consistency of the generated kernels, and of quantities."""

import argparse


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("check", help="check kernels: forces against energies, tangents "
                                               "against forces; and quantities")
    parser.add_argument("kernels", nargs="*", metavar="KERNEL",
                        help="show all criteria of these kernels, or of those of a joint such as "
                             "revolute, or of quantities (default: summary of all)")
    return parser


def run(options: argparse.Namespace) -> int:
    """Check the kernels; 1 if a criterion fails."""
    from sebody.verify import check

    rows = check.check_kernels(options.kernels or None)
    print(check.table(rows) if options.kernels else check.summary(rows))
    print(check.verdict(rows))
    return 0 if all(row.passed for row in rows) else 1
