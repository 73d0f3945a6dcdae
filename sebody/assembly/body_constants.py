"""Constants that the kernels of superelements read, and how far matrices of bodies are full."""

from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from sebody.assembly.body_axes import ROUNDING
from sebody.assembly.contracts import counts_of
from sebody.assembly.floating import floating_constants, frame_conditions
from sebody.assembly.rigid_part_constants import rigid_part_constants
from sebody.contract.counts import whole_vectors
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.frames import FRAMES
from sebody.model.parts import Superelement
from sebody.reduction.mean_rotation import mean_rotation


def superelement_constants(body: Superelement) -> dict[str, ArrayLike]:
    """Values of the constants that the kernel of a superelement reads, by name."""
    reduced = body.reduced
    origin = body.alpha @ reduced.coordinates[list(reduced.position_nodes)]
    of_translations = reduced.mass @ reduced.rigid_modes[:, :len(origin)]
    option = INERTIA_OPTIONS[body.inertia]
    damping = {} if option.rates or reduced.damping is None else {"C": reduced.damping}
    values = frame_constants(body) | {
        "S": reduced.stiffness, "M": reduced.mass, "mass_columns": of_translations,
        "mass_rows": of_translations.T,
        "mc": reduced.total_mass * (reduced.centre_of_mass - origin),
        "full": [_filled(body)], "masses": [reduced.total_mass], **damping}
    if not option.rates:
        return values
    if not option.field:
        return values | rigid_part_constants(reduced)
    counts = counts_of(body)
    frame = FRAMES[body.frame]
    invariants = body.invariants.about(origin)
    if not frame.traits.needs_rotations:
        invariants = invariants.rigidly_followed
    return values | floating_constants(invariants, reduced.stiffness,
                                       frame_conditions(frame.kernel, counts, values), counts,
                                       reduced.damping, ROUNDING)


def frame_constants(body: Superelement) -> dict[str, ArrayLike]:
    """Values of what places the frame of a superelement, by name."""
    points = body.reduced.coordinates[list(body.reduced.position_nodes)]
    of_modes = {"Gam": mean_rotation(body.reduced).T} if FRAMES[body.frame].traits.modes else {}
    return {"alphas": body.alpha, "fits": np.full(len(points), 1.0 / len(points)),
            "alpha_rs": body.alpha_r, "X": points - body.alpha @ points} | of_modes


def _filled(body: Superelement) -> int:
    """Leading rows and columns, in whole vectors, beyond which S, M and C are diagonal.

    All rows if there is a single entry off the diagonal between internal modes.
    """
    reduced = body.reduced
    matrices = [A for A in (reduced.stiffness, reduced.mass, reduced.damping) if A is not None]
    n, filled = len(reduced.mass), whole_vectors(len(reduced.mass) - reduced.modes)
    inner = [matrix[filled:, filled:] for matrix in matrices]
    diagonal = all(np.count_nonzero(A) == np.count_nonzero(np.diag(A)) for A in inner)
    return filled if filled < n and diagonal else n


def full_rows(body: Superelement, kernel: ModuleType) -> int:
    """Leading rows and columns beyond which the element matrix is diagonal."""
    # modes that move the frame act on each other through it
    apart = INERTIA_OPTIONS[kernel.INERTIA].modes_apart and not FRAMES[body.frame].traits.modes
    return _filled(body) if apart else len(body.reduced.mass)
