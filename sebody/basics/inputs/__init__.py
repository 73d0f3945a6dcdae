"""Checks of what users give: types, shapes, finiteness, ranges and names, the same everywhere.

Every function returns the value in the form the program works with, or raises `InputError` with a
message that names the argument (`what`), shows the value and says what to give instead.
"""

from sebody.basics.inputs.kinds import choice, flag, function, instance, items, mapping
from sebody.basics.inputs.numbers import array, integer, number, reals, rotation, vector
from sebody.basics.inputs.refusals import refusal, shown
from sebody.basics.inputs.texts import name, path, text

__all__ = ["array", "choice", "flag", "function", "instance", "integer", "items", "mapping", "name",
           "number", "path", "reals", "refusal", "rotation", "shown", "text", "vector"]
