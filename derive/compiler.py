"""The compiler of kernels: from the name of a kernel to the text of its file."""

from collections.abc import Callable
from typing import NamedTuple

from sebody.derive.formulas import elements
from sebody.derive.kernels.body_load import BODY_LOADS, body_load_kernel
from sebody.derive.kernels.catalogue import ELEMENTS
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.linearize import linearized
from sebody.derive.kernels.resources import (
    body_load_resources,
    element_resources,
    resources,
)
from sebody.derive.kernels.superelement import superelement
from sebody.derive.printing.body_loads import body_load_text
from sebody.derive.printing.elements import element_text
from sebody.derive.printing.superelements import superelement_text
from sebody.kernels.names import element_name, superelement_name


class Variant(NamedTuple):
    """A superelement kernel by its names."""

    layout: str
    frame: str
    inertia: str


class Stages(NamedTuple):
    """How kernels of a kind are compiled; see `compile_kernel`."""

    derive: Callable
    linearize: Callable
    collect: Callable
    print: Callable


SUPERELEMENT = Stages(lambda v: superelement(Layout.parse(v.layout), v.frame, v.inertia),
                      linearized, resources, superelement_text)
BODY_LOAD = Stages(body_load_kernel, lambda kernel: kernel, body_load_resources, body_load_text)
ELEMENT = Stages(lambda name: ELEMENTS[name](), elements.linearized, element_resources,
                 element_text)


def compile_kernel(kernel: Variant | str) -> str:
    """The file of a kernel.

    1. derive: steps of the forces and energies, from kinematics and energies. Input: the names;
       output: a description, `Superelement` or `Element`, with the residual.
    2. linearize: the differential of every step, or expression. Output: the description with
       the column of the matrix.
    3. collect: scratch rows and functions the steps report. Output: `Resources`.
    4. print: text, a pure function of the description and the resources.

    Parameters
    ----------
    kernel : Variant or str
        A superelement, or the name of a joint, rigid body or load. The matrix of a load on a body
        is derived with its force.

    Raises
    ------
    LayoutError
        A layout that cannot be read, or that cannot carry the frame.
    """
    stages = (SUPERELEMENT if isinstance(kernel, Variant) else
              BODY_LOAD if kernel in BODY_LOADS else ELEMENT)
    derived = stages.derive(kernel)                     # 1
    description = stages.linearize(derived)             # 2
    uses = stages.collect(description)                  # 3
    return stages.print(description, uses)              # 4


def file_name(kernel: Variant | str) -> str:
    """Name of the file of a kernel."""
    if isinstance(kernel, Variant):
        name = superelement_name(Layout.parse(kernel.layout).name, kernel.frame, kernel.inertia)
    else:
        name = element_name(kernel)
    return name + ".py"
