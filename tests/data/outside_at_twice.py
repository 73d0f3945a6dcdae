"""Differences of the cases of others at twice the division, of which tolerances are ten times.

    python tests/data/outside_at_twice.py [CASE ...]

Twice as many elements, bodies or steps. It writes sebody/verify/outside/at_twice.json: all cases,
or those that are named, two digits.
"""

import json
import sys

from sebody.verify import outside
from sebody.verify.outside.case import AT_TWICE


def main(names: list[str]) -> None:
    """Measure and write, case by case."""
    outside.check_names(names)
    table = json.loads(AT_TWICE.read_text())
    for name in names or outside.CASES:
        found = outside.measure(name, division=2)
        table[name] = {row.quantity: float(f"{row.difference:.1e}") for row in found}
        ordered = {one: table[one] for one in outside.CASES if one in table}
        AT_TWICE.write_text(json.dumps(ordered, indent=1) + "\n")
        print(f"{name}: {max(table[name].values()):.1e}, {found[0].seconds:.1f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
