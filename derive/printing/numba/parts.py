"""The table of constants that a kernel publishes."""

import json
from collections.abc import Iterable

from sebody.contract.counts import Size
from sebody.contract.layout import Part
from sebody.derive.printing.lines import INDENT, WIDTH, nested


def table(parts: Iterable[Part], levels: int = 0) -> str:
    """A tuple of parts, written out over lines."""
    lines = [line for part in parts for line in nested(_part(part, levels + 1), levels + 1)]
    return "\n".join(["(", *lines, INDENT * levels + ")"]) if lines else "()"


def _part(part: Part, level: int) -> list[str]:
    """A part as the call that makes it, what is default left out; in two lines if it is long."""
    given = [json.dumps(part.name)]
    given += [_shape(part.shape)] if part.shape or part.meaning else []
    given += [json.dumps(part.meaning)] if part.meaning else []
    given += [f"{flag}=True" for flag in ("columns", "packed") if getattr(part, flag)]
    line = f"Part({', '.join(given)}),"
    if len(INDENT * level) + len(line) <= WIDTH:
        return [line]
    return [f"Part({', '.join(given[:2])},", f"     {', '.join(given[2:])}),"]


def _shape(sizes: tuple[Size, ...]) -> str:
    items = list(map(json.dumps, sizes))
    return f"({items[0]},)" if len(items) == 1 else f"({', '.join(items)})"
