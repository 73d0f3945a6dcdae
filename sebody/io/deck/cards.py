"""Keywords of a deck with their parameters and data lines, files that it includes in their place.

    *SOLID SECTION, ELSET=ROD,
     MATERIAL=STEEL
    1.0
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from sebody.basics.errors import InputError
from sebody.io.text import fault, read_text

_DEEPEST = 100  # of files that include others
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")     # a word of a line, as messages show it
_REMEDY = "give the deck that the matrices were computed from"


class Row(NamedTuple):
    """A line of a file, cut at its commas."""

    path: Path
    number: int
    words: list[str]
    included: bool = False      # the line is of a file that another one includes

    def fault(self, what: str, remedy: str) -> InputError:
        """The exception for a line that cannot be used.

        Of an included file, which may be any file of the machine, no text is shown.
        """
        shown = _QUOTED.sub("a word", what) if self.included else what
        return fault(self.path, self.number, shown, remedy)

    def label(self, word: str) -> int:
        """A word as the label of a node or element."""
        try:
            return int(word)
        except ValueError as error:
            raise self.fault(f"{word!r} is not a label of a node or element", "write the deck again"
                             ) from error

    def real(self, word: str) -> float:
        """A word as a number; 0 for an empty one."""
        try:
            return float(word.upper().replace("D", "E")) if word else 0.0
        except ValueError as error:
            raise self.fault(f"{word!r} is not a number", "write the deck again") from error


class Card(NamedTuple):
    """A keyword in capitals, its parameters, and the data lines up to the next one."""

    row: Row
    keyword: str
    parameters: dict[str, str]
    data: list[Row]

    def name(self, parameter: str) -> str:
        """A parameter that must be there, as the name of a set, surface or material.

        Raises
        ------
        InputError
            It is not there.
        """
        set_name = plain_name(self.parameters.get(parameter.replace(" ", ""), ""))
        if not set_name:
            raise self.row.fault(f"*{self.keyword} has no {parameter}", f"give {parameter}=")
        return set_name

    def label(self, parameter: str) -> int:
        """A parameter that must be there, as the label of a node."""
        return self.row.label(self.name(parameter))

    def reals(self) -> list[float]:
        """Numbers of all data lines; 0 for words left empty before the last of a line."""
        return [row.real(word) for row in self.data for word in _filled(row.words)]


def plain_name(word: str) -> str:
    """A name as programs compare it: in capitals, without quotes and blanks."""
    return "".join(word.strip("\"'").upper().split())


def read_cards(path: Path) -> Iterator[Card]:
    """The cards of a deck.

    Raises
    ------
    InputError
        A file that cannot be read, or that includes itself.
    """
    card = None
    for row, text in _statements(path):
        if not text.startswith("*"):
            if card:
                card.data.append(row._replace(words=[word.strip() for word in text.split(",")]))
            continue
        if card:
            yield card
        keyword, parameters = _parsed(text)
        card = Card(row, keyword, parameters, [])
    if card:
        yield card


def _statements(path: Path) -> Iterator[tuple[Row, str]]:
    """Data lines and whole keyword lines, which continue after a comma at their end."""
    begun: tuple[Row, str] | None = None
    for row, text in _lines(path, path.parent, ()):
        if begun:
            row, text = begun[0], begun[1] + text.strip()
            begun = None
        if text.startswith("*") and text.rstrip().endswith(","):
            begun = row, text.rstrip()
            continue
        yield row, text
    if begun:
        yield begun


def _lines(path: Path, home: Path, includers: tuple[Path, ...]) -> Iterator[tuple[Row, str]]:
    """Lines that are no comments, those of included files in the place of their *INCLUDE.

    Parameters
    ----------
    includers : tuple of Path
        The files, from the deck on, that include this one.
    """
    own = path.resolve()
    if own in includers:
        raise InputError(f"deck {path} is included by itself: remove the circular *INCLUDE")
    if len(includers) > _DEEPEST:
        raise InputError(f"deck {includers[0]} has files that include each other {_DEEPEST} deep: "
                         "put them into one")
    for number, line in enumerate(read_text(path, "deck", _REMEDY).splitlines(), 1):
        if line.startswith("**") or not line.strip():
            continue
        row = Row(path, number, [], bool(includers))
        if not line.upper().startswith("*INCLUDE"):
            yield row, line
            continue
        name = _parsed(line)[1].get("INPUT", "").strip("\"'")
        if not name:
            raise row.fault("*INCLUDE has no INPUT", "give INPUT=FILE")
        beside = path.parent / name
        yield from _lines(beside if beside.exists() else home / name, home, (*includers, own))


def _parsed(line: str) -> tuple[str, dict[str, str]]:
    """Keyword and parameters of a line."""
    keyword, *rest = line[1:].split(",")
    pairs = (word.partition("=") for word in rest)
    return (" ".join(keyword.upper().split()),
            {name.strip().upper().replace(" ", ""): value.strip() for name, _, value in pairs})


def _filled(words: list[str]) -> list[str]:
    """Words without the empty ones behind a last comma."""
    count = len(words)
    while count and not words[count - 1]:
        count -= 1
    return words[:count]
