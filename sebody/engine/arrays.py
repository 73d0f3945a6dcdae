"""Groups of arrays that compiled code gets as one pointer and reads by name.

A named tuple would be passed array by array, seven words each: with a hundred arrays compiling that
takes a minute. Members are read without reference counts, which cost as much as a small element.
"""

from ctypes import addressof, c_char
from dataclasses import fields
from functools import cache

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    unbox,
)
from numba.np.numpy_support import from_dtype

from sebody.kernels.sources import room_hash

# part of every compiled type: what is compiled for other sources is never used
SOURCES = room_hash("kernels", "engine")
_PLACE = c_char * 0     # has the address of an array, even of an empty one


class Arrays:
    """Base of frozen dataclasses of C-contiguous arrays, or of such groups again.

    Arrays may be written to, never replaced. Whoever calls compiled code keeps the group alive.
    """

    def __post_init__(self) -> None:
        words, facts = [], []
        for value in tuple(self.__dict__.values()):     # in the order of the fields
            if isinstance(value, Arrays):
                words += value._words.tolist()
                facts.append((type(value), value._facts))
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


@cache
def _view(group: type[Arrays], facts: tuple, sources: str) -> "View":
    """The type of a group, looked up: typing a hundred arrays takes a millisecond."""
    members = [_view(kind, own, sources) if isinstance(own, tuple) else
               types.Array(from_dtype(kind), own, "C") for kind, own in facts]
    return View(group.__name__, tuple(zip((f.name for f in fields(group)), members, strict=True)),
                sources)


class View(types.Type):
    """The compiled type of a group."""

    def __init__(self, name: str, members: tuple, sources: str):
        self.members = members
        # one text: Numba hashes the key of a type thousands of times, and texts only once
        self._key = " ".join([name, sources, *(f"{own}: {kind.key}" for own, kind in members)])
        super().__init__(f"View({name})")

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
    """Words of a group or of an array."""
    if isinstance(kind, View):
        return sum(_size(member) for _, member in kind.members)
    return 1 + kind.ndim


@register_model(View)
class _Pointer(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, cgutils.intp_t.as_pointer())


@unbox(View)
def _unbox(kind, group, c):
    boxed = c.pyapi.object_getattr_string(group, "_address")
    address = c.pyapi.long_as_longlong(boxed)
    c.pyapi.decref(boxed)
    return NativeValue(c.builder.inttoptr(address, cgutils.intp_t.as_pointer()))


@infer_getattr
class _Members(AttributeTemplate):
    key = View

    def generic_resolve(self, view, name):
        found = view.place(name)
        return found and found[1]


@lower_getattr_generic(View)
def _member(context, builder, view, pointer, name):
    first, kind = view.place(name)
    if isinstance(kind, View):
        return cgutils.gep_inbounds(builder, pointer, first)

    def word(k):
        loaded = builder.load(cgutils.gep_inbounds(builder, pointer, first + k))
        # groups never change: without this every store would make LLVM read the places again
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded
    array = context.make_array(kind)(context, builder)
    item = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    shape = [word(1 + k) for k in range(kind.ndim)]
    strides, items = [], cgutils.intp_t(1)
    for length in reversed(shape):
        strides.insert(0, builder.mul(items, cgutils.intp_t(item)))
        items = builder.mul(items, length)
    null = cgutils.get_null_value
    array.meminfo, array.parent = null(array.meminfo.type), null(array.parent.type)
    array.nitems, array.itemsize = items, cgutils.intp_t(item)
    array.data = builder.inttoptr(word(0), array.data.type)
    array.shape = cgutils.pack_array(builder, shape)
    array.strides = cgutils.pack_array(builder, strides)
    return array._getvalue()
