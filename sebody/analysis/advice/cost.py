"""What a run costs, predicted: operations of the kernels, scaled by measured runs.

A step takes so many Newton iterations, each an evaluation of every element and a solution. The
operations of an evaluation are those that the generated kernels declare; the time of one operation
is that of the runs that were made, first of the reference.
"""

import ast
import re
from functools import cache

from sebody.analysis.advice.changes import Choice
from sebody.analysis.advice.forms import Form, Part
from sebody.errors import InputError
from sebody.kernels.layout import layout_name
from sebody.kernels.loader import find, superelement_kernel_name
from sebody.kernels.names import element_name
from sebody.model.frames import FRAMES
from sebody.model.inertias import needs_damped_kernel
from sebody.model.model import Model

CALL = 60.0         # operations that calling a kernel and gathering its coordinates is worth
STEP = 300.0        # operations of a step itself
SOLUTION = 4.0      # operations of a solution by the square of a body's coordinates
BODY = ((2, 1), (3, 3))     # coordinates of a position and of a rotation, planar or not


@cache
def operations(kernel: str) -> tuple[float, ...]:
    """Operations of a residual, as the kernel's file declares them; it is not compiled for this."""
    path = find(kernel)
    text = path.read_text(encoding="utf-8") if path else ""
    found = re.search(r'OPERATIONS = \{"residual": (\([^)]*\))', text)
    return ast.literal_eval(found.group(1)) if found else (0, 0, 0, 0)


@cache
def _of_form(part: Part, form: Form) -> float:
    body = part.body
    planar = body.planar
    if form.rigid:
        return CALL + operations(element_name("planar_" * planar + "rigid_body"))[0]
    try:
        kernel = superelement_kernel_name(
            layout_name(body.keeps, planar), FRAMES[form.frame].kernel, form.inertia, form.modes,
            needs_damped_kernel(body, form.inertia))
    except InputError:
        return float("inf")
    n = len(body.stiffness) - body.modes + form.modes
    positions, rotations = len(body.position_nodes), len(body.rotation_nodes)
    alone, position, rotation, products = operations(kernel)
    return form.bodies * (CALL + alone + position * positions + rotation * rotations
                          + (2.0 * products + SOLUTION) * n**2)


class Cost:
    """Predicted seconds of runs.

    Parameters
    ----------
    model : Model
    parts : list of Part
    t_end : float
        End of the runs.
    """

    def __init__(self, model: Model, parts: list[Part], t_end: float):
        others = (*model.rigid_bodies.values(), *model.constraints, *model.loads)
        self._rest = STEP + sum(CALL + operations(element_name(one.kind))[0] for one in others)
        self._parts, self._t_end = parts, t_end
        self._second = 1e-9         # of an operation and the iterations of a step

    def operations(self, choice: Choice) -> float:
        """Of one evaluation."""
        return self._rest + sum(map(_of_form, self._parts, choice.forms))

    def of_form(self, part: Part, form: Form) -> float:
        """Operations of one part alone."""
        return _of_form(part, form)

    def of(self, choice: Choice) -> float:
        """Seconds of a run."""
        return self._second * self.operations(choice) * self._t_end / choice.step.h

    def work(self, choice: Choice, iterations: float) -> float:
        """Operations of a run that was made, by its Newton iterations."""
        return self.operations(choice) * iterations

    def measured(self, choice: Choice, seconds: float) -> None:
        """Scale by a run that was made."""
        self._second *= seconds / self.of(choice)
