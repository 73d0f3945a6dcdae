"""Frames and inertia options by name: a kernel combines one of each."""

from sebody.contract.traits import FrameTraits, InertiaTraits
from sebody.derive.form.spaces import Space
from sebody.derive.formulas.frames import converged_mean, mean, mean_axes, mean_small, positions
from sebody.derive.formulas.frames.frame import Condition
from sebody.derive.formulas.inertia import option_a, option_b, option_c, option_d
from sebody.derive.formulas.quantities import Quantities

FRAMES = {
    "converged_mean": converged_mean.FRAME,     # the first that a layout can carry is its default
    "mean": mean.FRAME,
    "mean_small": mean_small.FRAME,
    "positions": positions.FRAME,
    "mean_axes": mean_axes.FRAME,
}
INERTIA_OPTIONS = {
    "frame_axes": option_a.INERTIA,
    "material": option_b.INERTIA,
    "floating_field": option_c.INERTIA,
    "rigid_part": option_d.INERTIA,
}


def frame_traits() -> dict[str, FrameTraits]:
    """The declared traits of each frame."""
    return {name: option.traits for name, option in FRAMES.items()}


def frame_conditions() -> dict[tuple[str, bool], Condition]:
    """The conditions on local coordinates in each frame that says them, in space and in a plane."""
    return {(name, planar): option.condition(Quantities(Space(planar)))
            for name, option in FRAMES.items() if option.condition
            for planar in (False, True) if option.traits.planar or not planar}


def inertia_traits() -> dict[str, InertiaTraits]:
    """The declared traits of each inertia option."""
    return {name: option.traits for name, option in INERTIA_OPTIONS.items()}
