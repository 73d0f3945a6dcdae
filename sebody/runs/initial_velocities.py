"""Initial velocities that users gave against those a run starts with: both values are named."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.engine.state import State
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates
from sebody.model.parts import DofBlock, Superelement
from sebody.reduction.body import ReducedBody

SMALL = 1e-6        # difference of velocities, of the largest one
STRAINED = 1e-4     # share of the kinetic energy in deformation: speeds off by a hundredth
MOST = 4            # DOF blocks that a message lists


def refuse_contradicted(model: Mechanism, numbering: Numbering, state: State) -> None:
    """Refuse a velocity that was given to what is fixed, prescribed or follows another node.

    Raises
    ------
    InputError
        It has another velocity; the message names both.
    """
    for dof_block, actual in _dof_blocks(model, numbering, state):
        if dof_block.given and not dof_block.solved and _differ(state, dof_block.rate, actual):
            raise InputError(
                f"{dof_block.name} is given the initial velocity {_shown(dof_block.rate)}, but "
                f"{_holds(dof_block)}, so it has {_shown(actual)}: leave one of them out, or give "
                "both the same velocity")


def changed(model: Mechanism, numbering: Numbering, state: State) -> str:
    """Remark where joints and drives demand other velocities than `rigid_velocity` gave.

    Nothing where they do not.
    """
    blocks = [f"{dof_block.name} {_shown(_round(state, actual))} in place of "
              f"{_shown(dof_block.rate)}"
              for dof_block, actual in _dof_blocks(model, numbering, state)
              if dof_block.solved and not dof_block.given and dof_block.rate.any()
              and _differ(state, dof_block.rate, actual)]
    if not blocks:
        return ""
    return ("rigid_velocity contradicts the initial velocities that joints and drives demand: "
            f"{_listed(blocks)}; give a motion that the joints allow, or give body= and name only "
            "bodies that are free to move like this")


def strained(model: Mechanism, numbering: Numbering, state: State) -> str:
    """Remark on bodies of which some nodes were given velocities and others rest or not.

    Their velocities are not those of a rigid motion, nor were all of them given on purpose.
    """
    bodies = [body for body in model.bodies.values()
              if _is_partly_given(body) and _share(body, numbering, state) > STRAINED]
    if not bodies:
        return ""
    first, others = bodies[0], [repr(body.name) for body in bodies[1:]]
    own = dict.fromkeys((*first.positions, *first.rotations))
    values = [(t, _round(state, state.v[coordinates(numbering, t)])) for t in own]
    given = [f"{t.name} {_shown(v)}" for t, v in values if _is_given(t)]
    rest = [f"{t.name} {_shown(v) if v.any() else 'at rest'}" for t, v in values
            if not _is_given(t)]
    return (f"body {first.name!r} is strained from the start: initial velocities are given to "
            f"{_listed(given)}"
            + (f", not to {_listed(rest)}" if rest else ", which is no rigid motion")
            + (f"; likewise {_listed(others)}" if others else "")
            + f": start it by rigid_velocity(..., body={first.name!r}), or give every node of it a "
            "velocity, zero where it rests")


def _dof_blocks(model: Mechanism, numbering: Numbering,
                state: State) -> Iterator[tuple[DofBlock, NDArray]]:
    """DOF blocks of a model with the velocities a run starts with."""
    for dof_block in model.dof_blocks():
        if dof_block in numbering.dof_blocks:
            yield dof_block, state.v[coordinates(numbering, dof_block)]


def _differ(state: State, one: NDArray, other: NDArray) -> bool:
    return bool(np.abs(one - other).max() > SMALL * max(np.abs(state.v).max(), np.abs(one).max()))


def _holds(dof_block: DofBlock) -> str:
    """Source of a DOF block that is not solved for its velocity."""
    if dof_block.root is not None:
        return f"it follows {dof_block.root.name} by a rigid link"
    if dof_block.motions:
        return f"{', '.join(repr(motion.name) for motion in dof_block.motions)} moves it"
    return "it is fixed"


def _is_partly_given(body: Superelement) -> bool:
    """Tell whether some of the nodes of a body have velocities from the user, and some have not."""
    free = [t for t in (*body.positions, *body.rotations) if t.solved]
    return any(t.rate.any() for t in free) and not all(t.given for t in free)


def _share(body: Superelement, numbering: Numbering, state: State) -> float:
    """Share of the kinetic energy of the nodes of a body that is in its deformation."""
    own = [c for t in (*body.positions, *body.rotations) for c in coordinates(numbering, t)]
    v = np.concatenate([state.v[own], np.zeros(body.reduced.modes)])
    return float(v @ _deformation(body.reduced) @ v / max(v @ body.reduced.mass @ v, 1e-300))


def _deformation(reduced: ReducedBody) -> NDArray:
    """Matrix D of a body, ``v^T D v / 2`` being the kinetic energy of its deformation.

    That of the velocities v less that of the rigid motion with the same momenta.
    """
    r = reduced.rigid_modes_about(reduced.centre_of_mass)
    momentum = reduced.mass @ r
    return reduced.mass - momentum @ np.linalg.pinv(r.T @ momentum) @ momentum.T


def _is_given(dof_block: DofBlock) -> bool:
    """Tell if `initial_velocity` or `rigid_velocity` has set the velocity, the latter not to 0."""
    return dof_block.given or bool(dof_block.rate.any())


def _round(state: State, values: NDArray) -> NDArray:
    """Velocities without what is rounding against the largest one."""
    return np.where(np.abs(values) > SMALL * np.abs(state.v).max(), values, 0.0)


def _shown(value: NDArray) -> str:
    texts = [f"{number:.6g}" for number in value]
    return texts[0] if len(texts) == 1 else f"({', '.join(texts)})"


def _listed(texts: list[str]) -> str:
    more = len(texts) - MOST
    return ", ".join(texts[:MOST]) + (f" and {more} more" if more > 0 else "")
