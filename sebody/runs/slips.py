"""Slips of ropes on sheaves at the start, which no mass and no constraint gives."""

import numpy as np

from sebody.engine.state import State
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import DofBlock
from sebody.model.rope_parts import Rope


def begin_slips(model: Mechanism, numbering: Numbering, state: State) -> None:
    """Let ropes begin to slip on sheaves with friction so that their strains change least.

    Rates at which stretches are strained, times the roots of their lengths, are as small in the
    mean square as slips can make them. So a drum may spin in a band at rest, and a rope run over a
    sheave at rest, without strain.
    """
    for rope in model.ropes.values():
        if rope.frictions:
            _begin(rope, numbering, state)


def _begin(rope: Rope, numbering: Numbering, state: State) -> None:
    def place(dof_block: DofBlock) -> int:
        return numbering.dof_blocks[dof_block]

    lengths = {stretch.length: k for k, stretch in enumerate(rope.stretches)}
    weights = np.array([stretch.law.number("material") for stretch in rope.stretches])**-0.5
    by_slips = np.zeros((len(rope.stretches), len(rope.frictions)))
    for k, one in enumerate(rope.frictions):
        for side, sign in ((2, 1.0), (5, -1.0)):
            by_slips[lengths[one.dof_blocks[side]], k] = sign * one.number("along")
    rates = np.array([
        state.v[place(s)] - law.number("given_a") * state.v[place(a)]
        - law.number("given_b") * state.v[place(b)]
        for law in (stretch.law for stretch in rope.stretches) for s, a, b in [law.dof_blocks]])
    turned = np.linalg.lstsq(weights[:, None] * by_slips, -weights * rates, rcond=None)[0]
    for one, change in zip(rope.frictions, turned, strict=True):
        state.v[place(one.dof_blocks[0])] += change
        for wound, sign in ((3, 1.0), (6, -1.0)):       # what the sheave has taken up on each side
            state.v[place(one.dof_blocks[wound])] += sign * one.number("along") * change
