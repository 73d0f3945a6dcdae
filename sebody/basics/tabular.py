"""Tables of what is shown instead of arrays: as text, and as HTML for notebooks and reports."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from html import escape
from typing import Any

import numpy as np

MOST_ROWS = 40          # of a table of text, and of one of HTML that is not folded
MOST_SHOWN = 4          # entries of a list that are shown


def text(title: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A title and a table with columns as wide as they need, numbers to the right.

    Of many rows the first ones are shown, with how many more there are.
    """
    cells = [[str(one) for one in row] for row in rows]
    left = len(cells) - MOST_ROWS
    shown = [list(heads), *cells[:MOST_ROWS]]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    numbers = [bool(cells) and all(_is_number(row[k]) for row in cells) for k in range(len(heads))]
    lines = ["  ".join(one.rjust(width) if right else one.ljust(width)
                       for one, width, right in zip(row, widths, numbers, strict=True)).rstrip()
             for row in shown]
    return "\n".join([title, *lines, *([f"... and {left} more"] if left > 0 else [])])


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table of HTML; one of many rows is folded."""
    rows = list(rows)
    head = "".join(f"<th>{escape(one)}</th>" for one in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(one))}</td>" for one in row) + "</tr>"
                   for row in rows)
    made = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    if len(rows) <= MOST_ROWS:
        return made
    return f"<details><summary>{len(rows)} rows</summary>{made}</details>"


def titled(title: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A title and a table of HTML."""
    return f"<p>{escape(title)}</p>{table(heads, rows)}"


def brief(self: Any) -> str:
    """A `repr` of a dataclass or named tuple that has shapes in place of arrays."""
    names = getattr(self, "_fields", None) or [
        one.name for one in fields(self) if not one.name.startswith("_")]
    shown = ", ".join(f"{name} {_short(getattr(self, name))}" for name in names
                      if getattr(self, name) is not None)
    return f"<{type(self).__name__}: {shown}>"


def _short(value: object) -> str:
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple) and shape:
        return f"({', '.join(map(str, shape))})"
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_short(one)}" for key, one in value.items()) + "}"
    if isinstance(value, tuple | list) and len(value) > MOST_SHOWN:
        return f"of {len(value)}"
    shown = repr(value)
    opaque = "array(" in shown or " object at " in shown
    return f"of class {type(value).__name__}" if opaque else shown


def counted(count: int, what: str) -> str:
    """A count with its noun: 1 body, 2 bodies."""
    return f"{count} {what if count == 1 else plural(what)}"


def plural(what: str) -> str:
    """The plural of a noun."""
    return what[:-1] + "ies" if what.endswith("y") else what + "s"


def vector(values: Iterable[float]) -> str:
    """A vector in brackets, with six digits."""
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return cell in ("", "-")
    return True
