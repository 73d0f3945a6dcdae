"""The table of axes along which a model may be simplified, and what predicts each error."""

from collections.abc import Callable
from typing import NamedTuple

from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.linearity import linearity
from sebody.explore.advice.indicators.omission import omission
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.rigidity import rigidity
from sebody.explore.advice.indicators.stiffening import spin, stiffening


class Axis(NamedTuple):
    """An axis.

    Parameters
    ----------
    name : str
    of : str
        What has it: part, model or run.
    values : str
        From the least to the most detailed.
    variants : tuple of str
        Functions of `sebody.model.variants` that make them, and lines of the code.
    indicator : callable, optional
        Predicted error of a form of a part; none where a change is exact, or where runs with
        several steps tell.
    depends : tuple of str
        Fields of the form that the indicator looks at.
    """

    name: str
    of: str
    values: str
    variants: tuple[str, ...]
    indicator: Callable[[Recorded, Part, Form], float] | None = None
    depends: tuple[str, ...] = ()


AXES = (
    Axis("planar", "model", "in a plane where it is symmetric about it, in space", ("planar",)),
    Axis("shared", "model", "joints of shared positions and rotations, of equations", ("shared",)),
    Axis("dropped", "model", "without positions and rotations that only one body has, with them",
         ("drop_triplet",)),
    Axis("rigid", "part", "rigid, flexible", ("rigid",), rigidity),
    Axis("division", "part", "1, 2, 4, 8 bodies of a beam", ("divide",), linearity,
         ("bodies",)),
    Axis("modes", "part", "0, 1, 2, 4, ... all internal modes of each body",
         ("keep_modes", "divide"), omission, ("bodies", "modes")),
    Axis("inertia", "part", "b, d, c", ("with_options", "divide"), spin,
         ("bodies", "inertia")),
    Axis("stiffening", "part", "without, with", ("with_options", "divide"), stiffening,
         ("bodies", "stiffening")),
    Axis("step", "run", "4, 2, 1, 1/2, 1/4 of the given step and finer where a tolerance needs it, "
         "or variable ones", ()),
)


def indicated(recorded: Recorded, part: Part, form: Form) -> dict[str, float]:
    """Relative errors of the quantities that a form makes, by axis; zeros are left out."""
    axes = [axis for axis in AXES
            if axis.indicator is not None and (axis.name == "rigid") == form.rigid]
    errors = {axis.name: _of_axis(axis, recorded, part, form) for axis in axes}
    return {name: error for name, error in errors.items() if error > 0.0}


def _of_axis(axis: Axis, recorded: Recorded, part: Part, form: Form) -> float:
    """The error of an indicator, the same for all forms that agree in what it depends on."""
    key = (axis.name, part.name, *(getattr(form, name) for name in axis.depends))
    if key not in recorded.indicated:
        recorded.indicated[key] = axis.indicator(recorded, part, form)
    return recorded.indicated[key]
