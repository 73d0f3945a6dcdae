"""Finite element models, sections and reduction refuse wrong arguments in words."""

import pytest
from malformed import body_cases
from malformed.cases import listed

from sebody import InputError

TABLES = body_cases.SECTIONS | body_cases.BEAMS | body_cases.FE_MODELS


@pytest.mark.parametrize("right, argument, value, said", listed(TABLES))
def test_refused(right, argument, value, said):
    with pytest.raises(InputError) as caught:
        right.function(**{**right.arguments, argument: value})
    assert said in str(caught.value)


@pytest.mark.parametrize("name", TABLES)
def test_the_right_call_is_accepted(name):
    TABLES[name].function(**TABLES[name].arguments)
