"""Items of a model: what has a history or does work."""

from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.kernels.loader import element_kernel
from sebody.model.histories import History
from sebody.model.mechanism import Mechanism


class Items(NamedTuple):
    """Loads, springs and drives, then damped bodies, then prescribed motions."""

    of: dict[int, int]              # id(constraint, load, spring or body) -> item
    names: list[str]
    histories: list[History]
    prescribed: list[tuple[int, int, int, float]]   # coordinate, item, 1 if it turns R, factor


def number_items(model: Mechanism, at: dict[int, int]) -> Items:
    """Items of a model; `at` is the first coordinate of each triplet, by id."""
    found = Items({}, [], [], [])

    def add(name: str, history: History | None) -> int:
        found.names.append(name)
        found.histories.append(history or History())
        return len(found.names) - 1

    for element in (*model.constraints, *model.loads):
        if element_kernel(element.kind).POWER:
            found.of[id(element)] = add(element.name, element.history)
    for body in model.bodies.values():
        if body.body.damping is not None:
            found.of[id(body)] = add(f"damping of {body.name}", None)
    for triplet in model.triplets():
        turning = int(triplet.turns and not model.planar)
        for motion in triplet.motions:
            item = add(motion.name, motion.history)
            found.prescribed.extend((at[id(triplet)] + k, item, turning, d)
                                    for k, d in enumerate(motion.direction) if d != 0.0)
    return found


def item_arrays(histories: list[History],
                prescribed: list[tuple[int, int, int, float]]) -> dict[str, NDArray]:
    """The members of `System` that tell histories, and the coordinates that some of them move."""
    return {"table_at": np.array([0, *accumulate(len(h.times) for h in histories)], dtype=np.int64),
            "table_times": np.array([t for h in histories for t in h.times], dtype=float),
            "table_cubics": np.array([c for h in histories for c in h.cubics],
                                     dtype=float).reshape(-1, 4),
            "corners": np.array(sorted({t for h in histories for t in h.corners}), dtype=float),
            "functions": np.array([h.addresses for h in histories],
                                  dtype=np.int64).reshape(-1, 3),
            "prescribed": np.array([row[:3] for row in prescribed], dtype=np.int64).reshape(-1, 3),
            "prescribed_factor": np.array([row[3] for row in prescribed], dtype=float)}
