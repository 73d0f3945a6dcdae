"""Paths along bodies as text: ``RAIL``, ``RAIL:z``, ``RAIL:5``, ``RAIL:z:5``."""

import re
from collections.abc import Iterable, Mapping

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel
from sebody.io.interfaces import set_called
from sebody.reduction.path_loads import COUNT, PathLoads

REMEDY = ("write the name of a node set, SET:x, SET:y or SET:z for loads in one direction of the "
          f"FE axes, with :N behind it for N loads instead of {COUNT}")


def parsed_paths(paths: Mapping[str, str | PathLoads] | Iterable[str]) -> dict[str, PathLoads]:
    """Paths in words by their names, which are those of their sets unless others are given.

    Raises
    ------
    InputError
        A text that cannot be read, or a name given twice.
    """
    if isinstance(paths, Mapping):
        return {inputs.name(name, "name of a path"): one if isinstance(one, PathLoads) else
                _one(one) for name, one in paths.items()}
    checked: dict[str, PathLoads] = {}
    for text in inputs.items(paths, "paths", REMEDY):
        one = _one(text)
        if one.nodes in checked:
            raise InputError(f"path {one.nodes!r} is given twice: give it once")
        checked[str(one.nodes)] = one
    return checked


def named_sets(model: FEModel, paths: Mapping[str, PathLoads]) -> dict[str, PathLoads]:
    """The same with the names of sets as the model writes them."""
    return {name: one._replace(nodes=set_called(model, one.nodes))
            if isinstance(one.nodes, str) else one for name, one in paths.items()}


def _one(text: object) -> PathLoads:
    match = re.fullmatch(r"([^:]+?)(?::([xyz]))?(?::(\d{1,9}))?", text.strip()
                         ) if isinstance(text, str) else None
    if not match:
        raise inputs.refusal("path", text, REMEDY)
    return PathLoads(match[1].strip(), int(match[3] or COUNT), match[2] or "")
