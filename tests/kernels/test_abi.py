"""How kernels are called: by the names of the table, with numbers of its types."""

import re

import numpy as np
import pytest
from numba import njit, typeof
from numba.core.errors import TypingError

from sebody.contract.layout import ARGUMENTS, RESIDUAL
from sebody.kernels.abi import Arguments, call_kernel


@njit
def call(arguments):
    return call_kernel(0, RESIDUAL, 0, 0, 0, arguments)


def given():
    return Arguments(**{name: np.zeros(1, dtype=kind) for name, kind, _ in ARGUMENTS})


def test_arguments_are_those_of_the_table():
    assert Arguments._fields == tuple(name for name, _, _ in ARGUMENTS)
    call.compile((typeof(given()),))        # accepted; there is no kernel to call
    assert call.nopython_signatures[0].args == (typeof(given()),)


def test_a_plain_tuple_is_refused():
    """Its order would be anybody's guess."""
    with pytest.raises(TypingError, match="a kernel is called with Arguments of arrays by name"):
        call(tuple(given()))


@pytest.mark.parametrize("name, kind", [("index", "float64"), ("q", "int64"), ("work", "float32")])
def test_numbers_of_another_type_are_refused(name, kind):
    wanted = dict((n, k) for n, k, _ in ARGUMENTS)[name]
    message = f"a kernel's argument {name} has numbers of type {wanted}, not"
    with pytest.raises(TypingError, match=re.escape(message)):
        call(given()._replace(**{name: np.zeros(1, dtype=kind)}))
