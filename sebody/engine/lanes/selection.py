"""Choices in lanes, member by member."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some, where
from sebody.engine import selection


@in_lanes_of(selection.either)
def either(condition, a, b):
    """See `selection.either`."""
    return where(condition, a, b)


@in_lanes_of(selection.any_positive)
def any_positive(x):
    """See `selection.any_positive`."""
    return some(x > 0.0)
