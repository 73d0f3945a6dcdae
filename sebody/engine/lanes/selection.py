"""Choices in lanes, member by member."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some, where
from sebody.engine import selection


@in_lanes_of(selection.either)
def either(condition, a, b):
    """See `selection.either`."""
    return where(condition, a, b)


@in_lanes_of(selection.any_true)
def any_true(truth):
    """See `selection.any_true`."""
    return some(truth)
