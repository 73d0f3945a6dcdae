"""What a scene is: a model with the step and the time it is meant to be run with."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sebody import InputError, Model, simulate
from sebody.fem import Section, planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.triplets import Node


@dataclass(frozen=True, eq=False)
class Scene:
    """A model ready to run."""

    name: str
    summary: str
    model: Model
    h: float
    t_end: float
    base: str = "base"      # nodes that the standard picture shows
    tip: str = "tip"


def divided_beam(model: Model, end: ArrayLike, section: Section, bodies: int, modes: int,
                 elements: int, **options) -> list[Node]:
    """A beam from the origin to `end` as equal superelements, from node "base" to node "tip".

    With one finite element a body and no modes these are nonlinear beams, see `Model.beam`.

    Raises
    ------
    InputError
        Elements that cannot be divided among the bodies.
    """
    if bodies < 1 or elements % bodies:
        raise InputError(f"{elements} elements cannot be divided among {bodies} bodies: give a "
                         "multiple")
    each, end = elements // bodies, np.asarray(end, dtype=float)
    nodes = [model.node("base" if k == 0 else "tip" if k == bodies else f"beam {k}",
                        k / bodies * end) for k in range(bodies + 1)]
    line = planar_beam if model.planar else straight_beam
    body = craig_bampton(line(nodes[0].point, nodes[1].point, section, each),
                         [(0, "full"), (each, "full")], modes)
    for k, pair in enumerate(zip(nodes, nodes[1:], strict=False)):
        model.superelement("beam" if bodies == 1 else f"beam {k + 1}", body, pair, **options)
    return nodes


def main(build: Callable[[], Scene]) -> None:
    """Run a scene as a script, with its summary and picture."""
    from sebody.plot import save_picture

    scene = build()
    result = simulate(scene.model, scene.h, scene.t_end)
    print(result.summary())
    print("picture:", save_picture(result, f"{scene.name}.png", scene.base, scene.tip))
