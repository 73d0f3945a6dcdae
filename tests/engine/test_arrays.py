"""Groups of arrays in compiled code: members by name, in place, alive as long as their group."""

from dataclasses import FrozenInstanceError, dataclass

import numpy as np
import pytest
from numba import njit, typeof
from numpy.typing import NDArray

from sebody.engine import arrays
from sebody.engine.arrays import Arrays


@dataclass(frozen=True, eq=False)
class Inner(Arrays):
    places: NDArray
    table: NDArray


@dataclass(frozen=True, eq=False)
class Outer(Arrays):
    values: NDArray
    inner: Inner
    counts: NDArray


def group():
    return Outer(np.arange(4.0), Inner(np.array([2, 0]), np.arange(6.0).reshape(2, 3)),
                 np.array([7, 8, 9]))


@njit
def read(group):
    return (group.values[group.inner.places[0]], group.inner.table[1, 2],
            group.inner.table.shape[0], group.counts.size, group.counts[2])


@njit
def write(group):
    for i in range(group.values.size):
        group.values[i] += group.inner.table[0, 1]
    group.inner.table[1, :] = group.values[1:]


def test_members_are_read_and_written_in_place():
    outer = group()
    assert read(outer) == (2.0, 5.0, 2, 3, 9)
    write(outer)
    assert outer.values.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert outer.inner.table[1].tolist() == [2.0, 3.0, 4.0]


def test_groups_in_the_rows_of_arrays_have_the_words_of_groups_made_of_them():
    """Of all members but one, which is shared; an empty one is part of no row."""
    values, tables, shared = np.zeros((3, 4)), np.zeros((3, 2, 3)), np.array([2, 0])
    flags = np.zeros((3, 0), dtype=np.int64)

    def made(k):
        return Outer(values[k, 1:], Inner(shared, tables[k]), flags[k])

    words = made(0).in_rows([values, tables])
    for k in range(3):
        expected = made(k)._words.tolist()
        empty = made(0)._words.tolist()[-2:]
        assert words[k].tolist() == [*expected[:-2], *empty]
    assert words.ndim == 2 and len(np.unique(words[:, 0])) == 3


def test_one_compiled_version_serves_all_sizes():
    read(group())
    other = Outer(np.zeros(9), Inner(np.array([8]), np.zeros((5, 4))), np.arange(30))
    assert read(other)[2:4] == (5, 30)
    assert len(read.signatures) == 1


def test_members_are_never_replaced():
    with pytest.raises(FrozenInstanceError):
        group().values = np.zeros(3)
    with pytest.raises(AssertionError):
        Inner(np.zeros(2), np.zeros((4, 4))[:, ::2])


def test_types_are_those_numba_gives_to_the_arrays():
    """What is looked up for groups alike is true for each of them."""
    found = [group(), group(), Outer(np.arange(4), *list(vars(group()).values())[1:3]),
             Outer(np.zeros((4, 1)), *list(vars(group()).values())[1:3])]
    for one in found:
        own = dict(one._numba_type_.members)
        assert own["values"] == typeof(one.values) and own["counts"] == typeof(one.counts)
        assert own["inner"] == typeof(one.inner)
        assert dict(own["inner"].members) == {"places": typeof(one.inner.places),
                                              "table": typeof(one.inner.table)}
    assert len({one._numba_type_ for one in found}) == 3
    # Numba names compiled functions by these: code of one type must not stand for that of another
    assert len({one._numba_type_.name for one in found}) == 3


def test_arrays_that_cannot_be_written_are_no_members():
    locked = np.zeros(2)
    locked.flags.writeable = False
    with pytest.raises(TypeError, match="not writable"):
        Inner(locked, np.zeros((2, 2)))


def test_changed_sources_are_other_types(monkeypatch):
    """Numba's cache must not serve what was compiled from other sources."""
    before = group()._numba_type_
    assert before == group()._numba_type_
    monkeypatch.setattr(arrays, "SOURCES", "changed")
    assert group()._numba_type_ != before
