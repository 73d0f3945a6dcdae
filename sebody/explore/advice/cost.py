"""Predicted cost of a run: operations of the kernels, scaled by measured runs.

A step takes so many Newton iterations, each an evaluation of every element and a solution. The
operations of an evaluation are those that the generated kernels declare, `EFFORT` how long the
kernels of an inertia option take for one, and the time of one operation is that of the reference's
run. How many evaluations variable steps take is known from runs with them.
"""

import ast
import re
from functools import cache

from sebody.basics.errors import InputError
from sebody.contract.counts import layout_name
from sebody.contract.names import PLANAR, element_name
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.forms import Form, Part
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.loader import find, superelement_kernel_name
from sebody.model.frames import FRAMES
from sebody.model.inertias import needs_damped_kernel
from sebody.model.model import Model

CALL = 300.0        # operations that calling a kernel and gathering its coordinates is worth
STEP = 300.0        # operations of a step itself
SOLUTION = 2.0      # operations of a solution by the square of a body's coordinates
THIRD = 1.0 / 3.0   # order of the length of variable steps by the local tolerance


@cache
def operations(kernel: str) -> tuple[float, ...]:
    """Operations of a residual, as the kernel's file declares them; it is not compiled for this."""
    path = find(kernel)
    text = path.read_text(encoding="utf-8") if path else ""
    match = re.search(r'OPERATIONS = \{"residual": (\([^)]*\))', text)
    return ast.literal_eval(match.group(1)) if match else (0, 0, 0, 0)


@cache
def of_form(part: Part, form: Form, flat: bool) -> float:
    """Operations of one part, in the plane it is symmetric about or as it is."""
    body = part.body
    flat = flat or body.planar
    if form.rigid:
        return CALL + operations(element_name("planar_" * flat + "rigid_body"))[0]
    layout = layout_name(body.keeps, body.planar)
    if flat and not body.planar:
        layout = PLANAR + layout
    try:
        kernel = superelement_kernel_name(layout, FRAMES[form.frame].kernel, form.inertia,
                                          form.modes, needs_damped_kernel(body, form.inertia))
    except InputError:
        return float("inf")
    positions, rotations = len(body.position_nodes), len(body.rotation_nodes)
    bound = positions * (2 if flat else 3) + rotations * (1 if flat else 3)
    # of spatial modes of beams half are in a plane
    n = bound + (form.modes // 2 if flat and not body.planar else form.modes)
    alone, position, rotation, products = operations(kernel)
    full = bound * (2 * n - bound) + n - bound
    return form.bodies * (INERTIA_OPTIONS[form.inertia].cost * (
        CALL + alone + position * positions + rotation * rotations + 2.0 * products * full)
        + SOLUTION * n**2)


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
        loads = (*model.rigid_bodies.values(), *model.loads)
        self._rest = STEP + sum(CALL + operations(element_name(one.kind))[0] for one in loads)
        self._joints = sum(CALL + operations(element_name(one.kind))[0]
                           for one in model.constraints)
        self._parts, self._t_end = parts, t_end
        self._second = 1e-9         # of an operation and the iterations of a step
        self._iterations = 2.5      # of a step
        self._variable: tuple[float, float] | None = None   # local tolerance, iterations

    def operations(self, choice: Choice) -> float:
        """Operations of one evaluation."""
        return self._rest + (0.0 if choice.shared else self._joints) + sum(
            of_form(part, form, choice.planar)
            for part, form in zip(self._parts, choice.forms, strict=True))

    def of(self, choice: Choice) -> float:
        """Seconds of a run."""
        return self._second * self.work(choice, self._evaluations(choice.step))

    def _evaluations(self, step: Step) -> float:
        if step.local is None:
            return self._iterations * self._t_end / step.h
        if self._variable is None:
            return float("inf")
        local, count = self._variable
        return count * (local / step.local)**THIRD

    def work(self, choice: Choice, iterations: float) -> float:
        """Operations of a run with so many Newton iterations."""
        return self.operations(choice) * iterations

    def measured(self, choice: Choice, seconds: float, iterations: float) -> None:
        """Scale by the reference's run."""
        self._iterations = iterations * choice.step.h / self._t_end
        self._second = seconds / self.work(choice, iterations)

    def counted(self, step: Step, iterations: float) -> None:
        """Take the evaluations of a run with variable steps."""
        if step.local is not None:
            self._variable = step.local, iterations
