"""Choices by numbers in functions that are also compiled for lanes: see `engine.lanes.selection`.

A comparison of lanes is a mask, which `if` does not take. So one text serves a number and eight of
them if it chooses by `either` and joins truths by ``&`` and ``|``.
"""

from sebody.compiler.decorators import compiled


@compiled
def either(condition, a, b):
    """One of two numbers."""
    return a if condition else b


@compiled
def any_true(truth):
    """Return a truth as it is; in lanes, whether it is true of any member."""
    return truth
