"""The compiler of kernels: from the name of a kernel to the text of its file."""

from collections.abc import Callable
from typing import Any, NamedTuple

from sebody.contract.names import element_name, products_name, superelement_name
from sebody.derive.form.kernel import Kernel
from sebody.derive.formulas import elements
from sebody.derive.kernels.body_contact import BODY_CONTACTS, body_contact_kernel
from sebody.derive.kernels.body_contact_form import body_contact_form
from sebody.derive.kernels.body_load import BODY_LOADS, body_load_kernel
from sebody.derive.kernels.body_load_form import body_load_form
from sebody.derive.kernels.catalogue import ELEMENTS
from sebody.derive.kernels.element_form import element_form
from sebody.derive.kernels.element_products import products_element
from sebody.derive.kernels.law_products import products_law
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.linearize import linearized
from sebody.derive.kernels.motion import MOTIONS, frame_motion, motion_form
from sebody.derive.kernels.path import (
    PATH_ACROSS,
    PATH_LOADS,
    PATH_TURNS,
    PATHS,
    path_kernel,
    path_load_kernel,
)
from sebody.derive.kernels.path_form import path_form, path_load_form
from sebody.derive.kernels.products import products_body_load, products_superelement
from sebody.derive.kernels.superelement import superelement
from sebody.derive.kernels.superelement_form import superelement_form
from sebody.derive.printing.numba.files import Head, file_text
from sebody.derive.printing.numba.heads import (
    body_contact_head,
    body_load_head,
    element_head,
    motion_head,
    path_head,
    path_load_head,
    products_head,
    superelement_head,
)


class Variant(NamedTuple):
    """A superelement kernel by its names."""

    layout: str
    frame: str
    inertia: str


class Products(NamedTuple):
    """A kernel of products with the derivatives of the forces of another one."""

    of: Variant | str


class Stages(NamedTuple):
    """The compilation of kernels of a kind; see `compile_kernel`."""

    derive: Callable
    linearize: Callable
    assemble: Callable[[Any], Kernel]
    head: Callable[[Any, Kernel], Head]
    name: Callable[[Any], str]          # of the module


def _same(kernel: Any) -> Any:
    return kernel


SUPERELEMENT = Stages(
    lambda v: superelement(Layout.parse(v.layout), v.frame, v.inertia), linearized,
    superelement_form, superelement_head,
    lambda v: superelement_name(Layout.parse(v.layout).name, v.frame, v.inertia))
BODY_CONTACT = Stages(body_contact_kernel, _same, body_contact_form, body_contact_head,
                      element_name)
BODY_PATH = Stages(path_kernel, _same, path_form, path_head, element_name)
PATH_LOAD = Stages(path_load_kernel, _same, path_load_form, path_load_head, element_name)
BODY_LOAD = Stages(body_load_kernel, _same, body_load_form, body_load_head, element_name)
ELEMENT = Stages(lambda name: ELEMENTS[name](), elements.linearized, element_form, element_head,
                 element_name)
MOTION = Stages(frame_motion, _same, motion_form, motion_head, _same)


def compile_kernel(kernel: Variant | Products | str, shipped: bool = True) -> str:
    """The file of a kernel.

    1. derive: steps of the forces and energies, from kinematics and energies. Input: the names;
       output: a description, `Superelement` or `Element`, with the residual.
    2. linearize: the differential of every step, or expression. Output: the description with
       the column of the matrix.
    3. assemble: loads, common subexpressions, loops and tasks. Output: `Kernel`, typed statements
       that know no target.
    4. print: text, a pure function of the statements and of what the file says of itself.

    Parameters
    ----------
    kernel : Variant, Products or str
        A superelement, products, or the name of a joint, rigid body, load or motion. The matrix of
        a load on a body is derived with its force; motions have none.
    shipped : bool
        The file goes with the package; else it carries a hash of the functions that it calls.

    Raises
    ------
    LayoutError
        A layout that cannot be read, or that cannot carry the frame.
    """
    stages = stages_of(kernel)
    derived = stages.derive(kernel)                     # 1
    description = stages.linearize(derived)             # 2
    statements = stages.assemble(description)              # 3
    return file_text(stages.head(description, statements), statements, shipped)     # 4


def statements_of(kernel: Variant | Products | str) -> Kernel:
    """The first three stages: a kernel for any target."""
    stages = stages_of(kernel)
    return stages.assemble(stages.linearize(stages.derive(kernel)))


def stages_of(kernel: Variant | Products | str) -> Stages:
    """The compilation of a kernel."""
    if isinstance(kernel, Products):
        return _of_products(kernel)
    if isinstance(kernel, Variant):
        return SUPERELEMENT
    if kernel in BODY_CONTACTS:
        return BODY_CONTACT
    if kernel in PATHS or kernel in PATH_TURNS or kernel in PATH_ACROSS:
        return BODY_PATH
    if kernel in PATH_LOADS:
        return PATH_LOAD
    return MOTION if kernel in MOTIONS else BODY_LOAD if kernel in BODY_LOADS else ELEMENT


def _of_products(kernel: Products) -> Stages:
    """As the kernel that has the forces, up to the assembly."""
    own = stages_of(kernel.of)
    assemble = {SUPERELEMENT: products_superelement, BODY_LOAD: products_body_load,
                ELEMENT: _products_element}[own]
    return Stages(lambda given: own.derive(given.of), own.linearize, assemble,
                  lambda description, made: products_head(own.head(description, made), made),
                  lambda given: products_name(own.name(given.of)))


def _products_element(element: elements.Element) -> Kernel:
    """The products of a joint, body or load; laws are made of stages."""
    return products_law(element) if element.stages else products_element(element)


def file_name(kernel: Variant | Products | str) -> str:
    """Name of the file of a kernel."""
    return stages_of(kernel).name(kernel) + ".py"
