"""Choices of the prediction in lanes."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some, where
from sebody.engine import prediction


@in_lanes_of(prediction.either)
def either(condition, a, b):
    """See `prediction.either`."""
    return where(condition, a, b)


@in_lanes_of(prediction.any_positive)
def any_positive(x):
    """See `prediction.any_positive`."""
    return some(x > 0.0)
