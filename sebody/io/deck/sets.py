"""Named sets of nodes and elements."""

from collections.abc import Iterable, Iterator

from sebody.io.deck.cards import Card, Row, plain_name

MOST_LABELS = 20_000_000        # of a line with GENERATE


class Sets:
    """Named sets of labels, whose members may be other sets, defined before or behind them.

    Parameters
    ----------
    of : str
        What is in them, for messages: 'node' or 'element'.
    """

    def __init__(self, of: str):
        self._of = of
        self._members: dict[str, list[int | tuple[str, Row]]] = {}
        self._found: dict[str, tuple[int, ...]] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._members

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def add(self, name: str, labels: Iterable[int]) -> None:
        """Labels to a set, which is made if it is new."""
        self._members.setdefault(name, []).extend(labels)

    def read(self, card: Card, name: str) -> None:
        """The data lines of *NSET or *ELSET: labels and names of sets, or first, last and step."""
        members = self._members.setdefault(name, [])
        for row in card.data:
            words = [word for word in row.words if word]
            if "GENERATE" in card.parameters:
                members += _generated(row, words)
            else:
                members += [int(word) if word.isdecimal() else (plain_name(word), row)
                            for word in words]

    def labels(self, name: str) -> tuple[int, ...]:
        """Labels of a set, each once and in order.

        Raises
        ------
        InputError
            It has a member that is no label and no set, or it has itself as a member.
        """
        if name not in self._found:
            self._found[name] = tuple(dict.fromkeys(self._resolved(name, ())))
        return self._found[name]

    def member(self, row: Row, word: str) -> tuple[int, ...]:
        """Labels that a word of a data line means: its own, or those of a set."""
        if word.isdecimal():
            return (int(word),)
        if plain_name(word) not in self._members:
            raise row.fault(f"{word!r} is neither a label nor a set of {self._of}s",
                            "define the set in this deck, flattened (no parts and instances)")
        return self.labels(plain_name(word))

    def _resolved(self, name: str, outer: tuple[str, ...]) -> list[int]:
        labels: list[int] = []
        for member in self._members[name]:
            if isinstance(member, int):
                labels.append(member)
                continue
            other, row = member
            if other == name or other in outer:
                raise row.fault(f"{self._of} set {other} has itself as a member", "take it out")
            if other not in self._members:
                raise row.fault(f"{other!r} is neither a label nor a set of {self._of}s",
                                "define the set in this deck, flattened (no parts and instances)")
            labels += self._resolved(other, (*outer, name))
        return labels


def _generated(row: Row, words: list[str]) -> range:
    if not 2 <= len(words) <= 3:
        raise row.fault(f"GENERATE has {len(words)} numbers", "give first, last and, if it is not "
                        "1, step")
    first, last, step = [*(row.label(word) for word in words), 1][:3]
    if step < 1:
        raise row.fault(f"the step of GENERATE is {step}", "give a positive step")
    labels = range(first, last + 1, step)
    if len(labels) > MOST_LABELS:
        raise row.fault(f"GENERATE from {first} to {last} makes {len(labels)} labels, more than "
                        f"{MOST_LABELS}", "name labels that the mesh has")
    return labels
