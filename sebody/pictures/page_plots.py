"""Histories that the page of an animation can plot: all of a result, as far as there is room."""

from collections.abc import Iterator, Sequence

import numpy as np

from sebody.pictures.blocks import Blocks
from sebody.pictures.curves import panels
from sebody.pictures.scene import Scenery, thinned
from sebody.quantities.names import GROUPS, names
from sebody.results.naming import Values, values
from sebody.results.result import Result
from sebody.results.units import unit_of_curves

NUMBERS = 400_000       # of all histories together, beyond which they have fewer samples
FEWEST = 201            # samples
BITS = 14               # of a number: a plot is a few hundred pixels high
# quantities that are kept before others where there is not room for all
FIRST = ("position", "rotation", "velocity", "angular_velocity", "force", "moment", "torque",
         "thrust", "modes", "reaction", "reaction_moment", "power", "acceleration",
         "angular_acceleration")
OVERVIEW, MODEL = "overview", "model"


def plots(blocks: Blocks, result: Result, drawn: Scenery, chosen: Sequence[str]) -> dict:
    """Histories by what they are of, those that were chosen first.

    Raises
    ------
    InputError
        A chosen quantity there is not.
    """
    shown = [(OVERVIEW, one) for one in _chosen(result, chosen)]
    columns, most = sum(one.numbers.shape[1] for _, one in shown), NUMBERS // FEWEST
    known, left = _names(result), 0
    for at, name in enumerate(known):
        one = values(result, name)
        if columns + one.numbers.shape[1] > most:
            left = len(known) - at
            break
        if np.isfinite(one.numbers).all():
            columns += one.numbers.shape[1]
            shown.append((_owner(name), one))
    frames = thinned(len(drawn.t), max(FEWEST, NUMBERS // max(columns, 1)))
    return {"frames": blocks.indices(frames), "left": left,
            "all": [_plot(blocks, owner, one, drawn, drawn.states[frames]) for owner, one in shown]}


def _chosen(result: Result, words: Sequence[str]) -> Iterator[Values]:
    for panel in panels({"the result": result}, words):
        if panel.kind == "history":
            yield Values(panel.title, tuple(curve.label for curve in panel.curves),
                         np.column_stack([curve.y for curve in panel.curves]))


def _names(result: Result) -> list[str]:
    """Quantities of the model, then of its parts: positions before others, see `FIRST`."""
    rank = {quantity: k for k, quantity in enumerate(FIRST)}
    named = [*GROUPS, *(name for name in names(result) if name != "t")]
    return sorted(named, key=lambda name: -1 if _owner(name) == MODEL else
                  rank.get(name.rpartition(".")[2], len(FIRST)))


def _owner(name: str) -> str:
    owner = name.rpartition(".")[0]
    return MODEL if owner in ("", *GROUPS) or name in GROUPS else owner


def _plot(blocks: Blocks, owner: str, one: Values, drawn: Scenery, states: np.ndarray) -> dict:
    return {"owner": owner, "name": one.name, "labels": one.labels,
            "unit": unit_of_curves(one.name, drawn.units),
            "range": [float(one.numbers.min()), float(one.numbers.max())],
            "values": blocks.values(one.numbers[states], bits=BITS)}
