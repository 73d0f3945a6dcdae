"""Lines of text within a width: what does not fit goes on in the next line."""

from collections.abc import Iterable

WIDTH = 100
INDENT = "    "


def filled(head: str, words: Iterable[str], tail: str, indent: str) -> list[str]:
    """Words behind a head, in as many lines as they take; further lines have an indentation.

    Parameters
    ----------
    words : iterable of str
        Each with the blank that follows it; none is divided.
    """
    lines, line = [], head
    for word in words:
        if len(line) + len(word.rstrip()) + 2 > WIDTH and line != indent:
            lines.append(line.rstrip())
            line = indent
        line += word
    return [*lines, line.rstrip() + tail]


def assigned(head: str, pieces: list[str], indent: str) -> list[str]:
    """A value behind a head in one line, or in parentheses over several."""
    line = head + "".join(pieces).rstrip()
    return [line] if len(line) <= WIDTH else filled(head + "(", pieces, ")", indent)


def words(text: str) -> list[str]:
    """An expression in pieces that may stand in lines of their own."""
    return [word + " " for word in text.split(" ")]


def listed(items: Iterable[str]) -> list[str]:
    """Items of a list in pieces, with a comma behind each but the last."""
    *others, last = items
    return [*(item + ", " for item in others), last]


def nested(lines: Iterable[str], levels: int = 1) -> list[str]:
    """Lines inside a loop or condition."""
    return [INDENT * levels + line for line in lines]
