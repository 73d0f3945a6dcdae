"""Damping matrices of bodies that an FE program has reduced: taken over, or left out in words."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.reduction.body import ReducedBody


def with_damping(parts: dict[str, Any], name: str, structural: Sequence[str]
                 ) -> tuple[dict[str, Any], dict[str, str]]:
    """The parts of a body with the damping that it can have, and a note for its provenance.

    Parameters
    ----------
    parts : dict
        Arguments of a `ReducedBody`, with the viscous ``damping`` of the file or without.
    name : str
        What the file calls the viscous damping.
    structural : sequence of str
        What it calls matrices of structural damping that it has: forces in phase with the velocity
        that are proportional to the displacement, which only vibrations of one frequency have.
    """
    parts = dict(parts)
    missing, notes = {}, {}
    viscous = parts.pop("damping", None)
    if viscous is not None and np.any(viscous):
        try:
            _check(parts, viscous)
            parts["damping"] = viscous
            notes["damping"] = name
        except InputError as error:
            missing["damping"] = f"{name} is not that of a free body: {error}"
    if structural:
        missing["structural damping"] = (
            f"{' and '.join(structural)} {'has' if len(structural) == 1 else 'have'} no equation "
            "of motion in time; give the body damping ratios of its modes, half the loss factor g")
    if missing:
        parts["missing"] = {**parts.get("missing", {}), **missing}
    return parts, notes


def _check(parts: dict[str, Any], damping: NDArray) -> None:
    """Raise InputError if the body is right and its damping is not."""
    try:
        ReducedBody(**parts)
    except InputError:      # of which the body is told by itself
        return
    ReducedBody(**parts, damping=damping)
