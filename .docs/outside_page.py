"""Writes the tables of outside.md from a run of all cases: python .docs/outside_page.py [CASE ...]

Named cases alone are run again; rows of the others stay.
"""

import re
import sys
from pathlib import Path

from sebody.verify import outside

PAGE = Path(__file__).with_name("outside.md")


def listed(name: str, seconds: str) -> str:
    """The line of a case: title, source, note and time."""
    case = outside.load(name)
    return f"| {name} | {case.title} | {case.source} | {case.note} | {seconds} |"


def numbers(row: outside.Row) -> str:
    """The line of a number."""
    source = "-" if row.source_tolerance is None else f"{row.source_tolerance:.1e}"
    return (f"| {row.case} | {row.quantity} | {row.reference:.9g} | {row.value:.9g} | "
            f"{row.difference:.1e} | {row.tolerance:.1e} | {source} |")


def between(text: str, mark: str) -> tuple[str, list[str], str]:
    """What is before a table, its rows, and what is after it."""
    begin = text.index(f"<!-- {mark} -->")
    first = text.index("|\n", text.index("|---", begin)) + 2
    last = text.index(f"<!-- end of {mark} -->")
    return text[:first], text[first:last].splitlines(), text[last:]


def main(names: list[str]) -> None:
    """Run and write."""
    outside.check_names(names)
    found = {name: outside.measure(name) for name in names or outside.CASES}
    text = PAGE.read_text()
    for mark, made in (
            ("cases", lambda rows: [listed(rows[0].case, f"{rows[0].seconds:.1f}")]),
            ("numbers", lambda rows: [numbers(row) for row in rows])):
        before, old, after = between(text, mark)
        lines = []
        for name in outside.CASES:
            kept = [line for line in old if re.match(rf"\| {name} \|", line)]
            lines += made(found[name]) if name in found else kept
        text = before + "".join(f"{line}\n" for line in lines) + after
    PAGE.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1:])
