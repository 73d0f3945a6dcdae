"""Constants of a kernel: the table it publishes, and where it finds them."""

from collections.abc import Iterable

from sebody.derive.printing.expressions import WIDTH, indented
from sebody.kernels.layout import Counts, Part, axes_of


def table(parts: Iterable[Part], levels: int = 0) -> str:
    """A tuple of parts, written out over lines."""
    lines = [line for part in parts for line in _part(part, 4 * (levels + 1))]
    return "\n".join(["(", indented(lines, levels + 1), indented([")"], levels)]) if lines else "()"


def _part(part: Part, indent: int) -> list[str]:
    """A part as the call that makes it, what is default left out; in two lines if it is long."""
    given = [repr(part.name)]
    given += [repr(part.shape)] if part.shape or part.meaning else []
    given += [repr(part.meaning)] if part.meaning else []
    given += [f"{flag}=True" for flag in ("columns", "packed") if getattr(part, flag)]
    line = f"Part({', '.join(given)}),".replace("'", '"')
    if indent + len(line) <= WIDTH:
        return [line]
    head = f"Part({', '.join(given[:2])},".replace("'", '"')
    return [head, f"     {', '.join(given[2:])}),".replace("'", '"')]


def chain(parts: tuple[Part, ...], planar: bool) -> list[str]:
    """Pointers to the constants of a superelement, one after the other."""
    known = axes_of(planar)
    starts = ["constants, index[first + AT_CONSTANTS]"]
    starts += [f"{part.name}, {part.expression(known)}" for part in parts[:-1]]
    lines = []
    for part, start in zip(parts, starts, strict=True):
        lines.append(f"{part.name} = at({start})")
        if part.name == "sizes":        # of all parts that follow
            lines += _counts(known)
        if part.name == "columns":
            lines.append("damped = int(columns[0])")
    return lines


def _counts(known: Counts) -> list[str]:
    """Counts of option C: slaved coordinates, resultants, and what follows from them."""
    motions = known["motions"]
    return ["slaved, resultants, damped = int(sizes[0]), int(sizes[1]), int(sizes[2])",
            f"free, bound, bound_free = n - {motions}, MODES, MODES - {motions}",
            "N, stretching = free + slaved, resultants + 1",
            f"hn, hN, deep = padded(free), padded(N), padded(N + {motions})"]
