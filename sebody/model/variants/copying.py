"""A model's copy, which shares nothing with it that can change, and a superelement's exchange."""

from copy import deepcopy
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.contract.names import body_load_kind
from sebody.model.bodies import placed_superelement
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement
from sebody.model.series import coordinate_vectors
from sebody.model.summary import unknowns
from sebody.model.variants.moved_paths import put_on
from sebody.model.variants.moved_points import on_body
from sebody.reduction.body import ReducedBody


class Variant(NamedTuple):
    """A changed copy of a model, and what was changed in a sentence."""

    model: Mechanism
    change: str


def copied(model: Mechanism) -> Mechanism:
    """A copy of a model.

    Reduced bodies, sections, time functions and users' functions never change: both models
    have them.

    Raises
    ------
    InputError
        No model.
    """
    checked(model)
    elements = (*model.constraints, *model.loads)
    constant: list[object] = [body.reduced for body in model.bodies.values()]
    constant += [one for beam in model.beams for one in (
        beam.section, beam.options["axis"], *beam.bodies)]
    constant += [one for element in elements for one in (
        element.time_function, element.function, element.series) if one is not None]
    constant += [one.law.derivatives for one in model.loads
                 if one.law is not None and one.law.derivatives is not None]
    constant += [*model.controllers.values(), *model.sensors.values()]
    constant += [motion.time_function for dof_block in model.dof_blocks()
                 for motion in dof_block.motions]
    constant += [one.time_function for one in model.gravity_courses]
    return deepcopy(model, {id(one): one for one in constant})


def checked(model: Mechanism) -> Mechanism:
    """A model.

    Raises
    ------
    InputError
        Anything else.
    """
    return inputs.instance(model, "model", Mechanism, "give a sebody.Model")


def fewer(model: Mechanism, made: Mechanism) -> str:
    """The number of unknowns that a changed model saves, in words."""
    saved = sum(unknowns(model)) - sum(unknowns(made))
    return f"{saved} unknown{'s' * (saved != 1)} fewer"


def placed(model: Mechanism, name: str) -> Superelement:
    """A superelement by its name.

    Raises
    ------
    InputError
        There is none of this name.
    """
    if not isinstance(name, str) or name not in checked(model).bodies:
        raise unknown("superelement", name, model.bodies, "the model has", "the model has none")
    return model.bodies[name]


def loads_on(model: Mechanism, body: Superelement) -> list[Element]:
    """Loads on a superelement itself, on its modes or on points inside it."""
    return [one for one in model.loads
            if one.body is body or (one.mode is not None and one.mode[0] == body.name)
            or (one.point is not None and one.point.body is body)]


def load_name(load: Element) -> str:
    """Name that the load of a body has there."""
    assert load.body is not None
    if load.series is not None:
        raise InputError(f"{load.name!r} is a series of loads on superelement "
                         f"{load.body.name!r}: it is known for this body alone, leave it out")
    return next(name for name, vector in load.body.reduced.loads.items()
                if np.array_equal(vector, load.constants["P"]))


def _load_constants(load: Element, made: Superelement) -> dict[str, NDArray]:
    """Those of a load on a body that another one takes the place of.

    Columns of a series act on the coordinates of the same names; what the body lacks, such as
    modes, they act on no more.
    """
    if load.series is None:
        return {"P": made.reduced.loads[load_name(load)]}
    assert load.body is not None
    before = load.body.reduced
    own = coordinate_vectors(made.reduced, [node.name for node in made.nodes])
    rows = [own.get(name, np.zeros(len(made.reduced.mass))) for name in coordinate_vectors(
        before, [node.name for node in load.body.nodes])]
    return {"P": np.zeros(len(made.reduced.mass)),
            "columns": np.transpose(rows) @ load.constants["columns"]}


def exchange(model: Mechanism, old: Superelement, body: ReducedBody, frame: str,
             inertia: str | None, stiffening: bool | None,
             nodes: tuple[Node, ...] | None = None) -> Superelement:
    """Put a reduced body, or other options, in the place of a superelement of the model.

    Loads on the body follow. The body may have fewer modes than the one before, and fewer nodes,
    which are then given.
    """
    nodes = old.nodes if nodes is None else nodes
    carrier = old.nodes[old.reduced.position_nodes[int(np.argmax(old.alpha))]]
    on_node = FRAMES[old.frame].on_one_node and any(node is carrier for node in nodes)
    order = list(model.bodies)
    del model.bodies[old.name]
    model.own_names.discard(old.name)
    made = placed_superelement(model, old.name, body, nodes, frame=frame, inertia=inertia,
                        frame_node=nodes.index(carrier) if on_node else 0,
                        stiffening=stiffening)
    made.mode_rates = old.mode_rates[:body.modes].copy()
    model.bodies = {name: model.bodies[name] for name in order}
    kind = body_load_kind(FRAMES[frame].kernel, model.planar)
    model.loads = [
        replace(one, kind=kind, attachments=made.attachments, body=made,
                constants=_load_constants(one, made)) if one.body is old else
        on_body(one, made, model.planar) if one.point is not None and one.point.body is old else one
        for one in model.loads]
    put_on(model, old, made)
    return made
