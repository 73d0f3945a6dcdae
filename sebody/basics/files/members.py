"""Requirements of the members of a file of named arrays: a table that they are compared with.

    headers -> names, types, shapes -> memory -> values -> range, order

Lengths that members share have names: of ``("n", "n")`` and ``("n",)`` all three are the same.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs, memory
from sebody.basics.errors import InputError

KINDS = {"f": "real numbers", "i": "whole numbers", "b": "truth values", "U": "a text"}
_FITTING = {"f": "fiu", "i": "iu", "b": "b", "U": "U"}
LONGEST_TEXT = 2**28        # bytes


class Header(NamedTuple):
    """Shape and type of a member that is not read yet."""

    shape: tuple[int, ...]
    dtype: np.dtype

    @property
    def size(self) -> int:
        """Bytes of its numbers."""
        item_size = self.dtype.itemsize
        for length in self.shape:
            item_size *= length
        return item_size


class Member(NamedTuple):
    """Requirements of a member.

    Parameters
    ----------
    shape : tuple of int, str or None
        Lengths: numbers, names of lengths that members share, None for any; an Ellipsis in the
        last place stands for any further axes.
    kind : str
        One of `KINDS`.
    finite : bool
        Whether NaN and infinity are refused.
    least : int, optional
        Of its numbers.
    below : str, optional
        Name of the length that its numbers are below, as indices are.
    rising : bool
        Whether its numbers are in order, each above the one before.
    needed : bool
        Whether a file without it is refused.
    """

    shape: tuple
    kind: str = "f"
    finite: bool = True
    least: int | None = None
    below: str | None = None
    rising: bool = False
    needed: bool = True


class Reader(Protocol):
    """An open file."""

    headers: Mapping[str, Header]

    def read(self, name: str) -> NDArray:
        """A member by name."""


class Table:
    """The members of a file of one kind.

    Parameters
    ----------
    file : str
        Kind and path of the file, for messages.
    remedy : str
        What to do with a file that does not fit.
    members : mapping of Member
        By name.
    lengths : mapping of int, optional
        Those that are known before.
    """

    def __init__(self, file: str, remedy: str, members: Mapping[str, Member],
                 lengths: Mapping[str, int] | None = None):
        self.file, self.remedy, self.members = file, remedy, members
        self.lengths = dict(lengths or {})

    def read(self, reader: Reader, others: Iterable[str] = ()) -> dict[str, NDArray]:
        """All members of a file that fits.

        Parameters
        ----------
        others : iterable of str
            Members that are left alone.

        Raises
        ------
        InputError
            Members that are missing or unknown, types, shapes, sizes or values that do not fit.
        """
        headers = {name: one for name, one in reader.headers.items() if name not in others}
        self.check_headers(headers)
        arrays = {name: reader.read(name) for name in headers}
        for name, values in arrays.items():
            self._check_values(name, values)
        return arrays

    def check_headers(self, headers: Mapping[str, Header]) -> None:
        """Refuse members that are missing, unknown, too large, or of another type or shape.

        Raises
        ------
        InputError
            They are.
        """
        missing = [name for name, one in self.members.items()
                   if one.needed and name not in headers]
        if missing:
            raise self.fault(f"has no member {missing[0]}")
        unknown = [name for name in headers if name not in self.members]
        if unknown:
            raise self.fault(f"has a member {inputs.shown(unknown[0])}, which is unknown")
        for name, member in self.members.items():
            if name in headers:
                self._check_type(name, headers[name], member)
                self._check_shape(name, headers[name].shape, member)
        memory.check(2.0 * sum(one.size for one in headers.values()), self.file, self.remedy)

    def fault(self, what: str) -> InputError:
        """The exception for a file that does not fit."""
        return InputError(f"{self.file} {what}: {self.remedy}")

    def _check_type(self, name: str, header: Header, member: Member) -> None:
        if header.dtype.kind not in _FITTING[member.kind]:
            raise self.fault(f"holds {header.dtype} in {name}, in place of {KINDS[member.kind]}")
        if member.kind == "U" and header.size > LONGEST_TEXT:
            raise self.fault(f"has a text {name} of {memory.size(header.size)}")

    def _check_shape(self, name: str, shape: tuple[int, ...], member: Member) -> None:
        wanted = member.shape
        if wanted[-1:] == (...,):
            wanted = (*wanted[:-1], *[None] * (len(shape) - len(wanted) + 1))
        fits = len(wanted) == len(shape)
        for length, one in zip(shape, wanted, strict=False):
            known = self.lengths.setdefault(one, length) if isinstance(one, str) else one
            fits = fits and known in (None, length)
        if not fits:
            sizes = [str(self.lengths.get(one, one)) if one is not None else "any"
                     for one in member.shape]
            raise self.fault(f"has {name} of shape {shape}, in place of ({', '.join(sizes)})")

    def _check_values(self, name: str, values: NDArray) -> None:
        member = self.members[name]
        if member.kind in "Ub" or not values.size:
            return
        if member.finite and values.dtype.kind == "f" and not np.isfinite(values).all():
            at = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
            raise self.fault(f"holds numbers in {name} that are not finite ({values[at]} at "
                             f"{list(at)})")
        if member.least is not None and values.min() < member.least:
            raise self.fault(f"holds {values.min()} in {name}, where the least is {member.least}")
        if member.below is not None and values.max() >= self.lengths[member.below]:
            raise self.fault(f"holds {values.max()} in {name}, where the largest is "
                             f"{self.lengths[member.below] - 1}")
        if member.rising and not (np.diff(values) > 0).all():
            k = int(np.argmin(np.diff(values) > 0))
            raise self.fault(f"holds {name} that do not rise: {values[k]:g} is followed by "
                             f"{values[k + 1]:g}")
