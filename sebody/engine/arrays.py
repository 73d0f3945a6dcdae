"""Groups of arrays that compiled code gets as one pointer and reads by name.

A named tuple would be passed array by array, seven words each: with a hundred arrays compiling that
takes a minute. Members are read without reference counts, which cost as much as a small element.
"""

from collections.abc import Iterable
from copy import copy
from ctypes import addressof, c_char
from dataclasses import fields
from functools import cache
from hashlib import sha256
from typing import Self

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import NativeValue, models, register_model, unbox
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.compiler.sources import CODE, folder_hash

# part of every compiled type: what is compiled for other sources is never used
SOURCES = folder_hash(*CODE)
_PLACE = c_char * 0     # has the address of an array, even of an empty one
_WORD = ir.IntType(64)


class Arrays:
    """Base of frozen dataclasses of C-contiguous arrays, records of scalars, or such groups again.

    Arrays may be written to, never replaced. Whoever calls compiled code keeps the group alive.
    """

    def __post_init__(self) -> None:
        words, facts = [], []
        for value in tuple(self.__dict__.values()):     # in the order of the fields
            if isinstance(value, Arrays):
                words += value._words.tolist()
                facts.append((type(value), value._facts))
                continue
            if isinstance(value, np.record):
                words.append(value.__array_interface__["data"][0])
                facts.append((value.dtype, None))
                continue
            assert value.flags.c_contiguous
            # a third of the time of the array's own `ctypes`: a run has a hundred arrays
            words.append(addressof(_PLACE.from_buffer(value)))
            words += value.shape
            facts.append((value.dtype, value.ndim))
        words, facts = np.array(words, dtype=np.int64), tuple(facts)
        # compiled functions read the type of an argument from this attribute
        self.__dict__.update(_words=words, _facts=facts, _address=words.ctypes.data,
                             _numba_type_=_view(type(self), facts, SOURCES))

    def in_rows(self, arrays: Iterable[NDArray]) -> NDArray:
        """Words of groups whose arrays lie in the rows of some arrays as those of this one do.

        Compiled code takes the address of such a row in place of a group: to make eight groups
        takes longer than many runs.

        Parameters
        ----------
        arrays : iterable of (rows, ...)
            C-contiguous; arrays of this group are parts of their first rows. All others are shared.

        Returns
        -------
        (rows, words)
        """
        arrays = list(arrays)
        words = np.tile(self._words, (len(arrays[0]), 1))
        for one in arrays:
            place, size = self._words - one.ctypes.data, one.strides[0]
            own = (place >= 0) & (place < size)
            words[:, own] += size * np.arange(len(one))[:, np.newaxis]
        return words

    def at_row(self, words: NDArray) -> Self:
        """The group as compiled code reads it at such a row: Python sees the arrays of this one."""
        group = copy(self)
        group.__dict__.update(_words=words, _address=words.ctypes.data)
        return group


@cache
def _view(group: type[Arrays], facts: tuple, sources: str) -> "View":
    """The type of a group, looked up: typing a hundred arrays takes a millisecond."""
    type_of = way().type_of
    members = [_view(kind, own, sources) if isinstance(own, tuple) else
               type_of(kind) if own is None else types.Array(type_of(kind), own, "C")
               for kind, own in facts]
    names = [field.name for field in fields(group)]
    way().show_members(View, names, _kind_of_member, _member)
    return View(group.__name__, tuple(zip(names, members, strict=True)), sources)


class View(types.Type):
    """The compiled type of a group."""

    def __init__(self, name: str, members: tuple, sources: str):
        self.members = members
        # one text: Numba hashes the key of a type thousands of times, and texts only once
        self._key = " ".join([name, sources, *(f"{own}: {kind.key}" for own, kind in members)])
        # groups of numbers and of lanes have one name, and code of both is in one program: Numba
        # tells the compiled functions apart by the names of the types of their arguments
        super().__init__(f"View({name}{sha256(self._key.encode()).hexdigest()[:8]})")

    @property
    def key(self) -> str:
        return self._key

    def place(self, name: str) -> tuple[int, types.Type] | None:
        """Word and type of a member."""
        first = 0
        for own, kind in self.members:
            if own == name:
                return first, kind
            first += _size(kind)
        return None


def _size(kind: types.Type) -> int:
    """Words of a group, of a record of scalars or of an array."""
    if isinstance(kind, View):
        return sum(_size(member) for _, member in kind.members)
    return 1 if isinstance(kind, types.Record) else 1 + kind.ndim


@register_model(View)
class _Pointer(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _WORD.as_pointer())


@unbox(View)
def _unbox(kind, group, c):
    boxed = c.pyapi.object_getattr_string(group, "_address")
    address = c.pyapi.long_as_longlong(boxed)
    c.pyapi.decref(boxed)
    return NativeValue(c.builder.inttoptr(address, _WORD.as_pointer()))


def _kind_of_member(view: View, name: str) -> types.Type | None:
    place = view.place(name)
    return place and place[1]


def _member(context, builder, view, pointer, name):
    """Instructions that read a member; of an array its place, and the fields Numba has for it."""
    first, kind = view.place(name)
    if isinstance(kind, View):
        return builder.gep(pointer, [_WORD(first)], inbounds=True)

    def word(k):
        loaded = builder.load(builder.gep(pointer, [_WORD(first + k)], inbounds=True))
        # groups never change: without this every store would make LLVM read the places again
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded
    if isinstance(kind, types.Record):
        return builder.inttoptr(word(0), context.get_value_type(kind))
    array = context.make_array(kind)(context, builder)
    item = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    shape = [word(1 + k) for k in range(kind.ndim)]
    strides, items = [], _WORD(1)
    for length in reversed(shape):
        strides.insert(0, builder.mul(items, _WORD(item)))
        items = builder.mul(items, length)
    array.meminfo, array.parent = array.meminfo.type(None), array.parent.type(None)
    array.nitems, array.itemsize = items, _WORD(item)
    array.data = builder.inttoptr(word(0), array.data.type)
    array.shape, array.strides = _packed(builder, shape), _packed(builder, strides)
    return array._getvalue()


def _packed(builder, words):
    """An array of words as one value."""
    packed = ir.ArrayType(_WORD, len(words))(ir.Undefined)
    for k, word in enumerate(words):
        packed = builder.insert_value(packed, word, k)
    return packed
