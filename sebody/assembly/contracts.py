"""Checks of every body and element of a model against its kernel, before anything runs.

Kernels read and write through pointers without bounds checks: a row that is too short, or a wrong
number of unknowns, would go unnoticed.
"""

from collections.abc import Iterable, Mapping
from types import ModuleType

from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.contract.counts import (
    MOST_SLAVED,
    Counts,
    axes_of,
    bound_counts,
    first_mode,
    floating_counts,
    rigid_part_counts,
    superelement_counts,
)
from sebody.contract.layout import INDEX, ContractError, Row
from sebody.contract.names import IN_PLANE, element_name
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.loader import find
from sebody.kernels.packed import move_to_cache_lines
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import Element, Superelement
from sebody.reduction.invariants import InertiaInvariants

REMEDY = "regenerate the kernels with python -m sebody.derive, or reinstall sebody"


def check_joints(model: Mechanism) -> None:
    """Check that the equations of all joints are made for models of this dimension.

    Raises
    ------
    InputError
        An equation exists only in planar models and the model is spatial, or the reverse; the
        message names the joint.
    """
    own, other = ("planar", "spatial") if model.planar else ("spatial", "planar")
    remedy = "Model()" if model.planar else "Model(planar=True)"
    users = {c.kind: joint for joint in model.joints for c in joint.constraints}
    for kind, joint in users.items():
        bare = kind.removeprefix(IN_PLANE)
        fitting, wrong = (model.kind_of(bare), bare if model.planar else IN_PLANE + bare)
        what = f"joint {joint.name!r} has an equation of kind {kind!r}"
        if find(element_name(fitting)):
            if kind != fitting:
                raise InputError(f"{what}, which is for {other} models, and this model is {own}: "
                                 f"use {fitting!r}, the kind that model.kind_of({bare!r}) gives")
        elif find(element_name(wrong)):
            raise InputError(f"{what}: this joint exists only in {other} models, and this model is "
                             f"{own}: build it with {remedy}, or use another joint")


def check_element(element: Element, kernel: ModuleType, unknowns: int,
                  numbering: Numbering) -> None:
    """Check counts, time function and power port of an element.

    Raises
    ------
    InputError
        What it has is not what its kernel reads; the message names both.
    """
    matrices = sum(t in numbering.rotations for t in element.dof_blocks)
    wrong = _different((("unknowns", unknowns, kernel.WIDTH),
                        ("multipliers", element.equations.multipliers, kernel.MULTIPLIERS),
                        ("multipliers of a joint to read",
                         len(numbering.reads.get(element, ())), kernel.READS),
                        ("positions", positions_of(element), kernel.N_POSITIONS),
                        ("rotation matrices", matrices, kernel.N_ROTATIONS)))
    if kernel.DRIVEN and element.time_function is None:
        wrong.append("it has no time function, but the kernel reads one")
    if element.time_function is not None and not kernel.POWER:
        wrong.append("it has a time function, but the kernel reads none")
    if kernel.POWER != (element in numbering.ports):
        wrong.append("it has no power port and the kernel writes power" if kernel.POWER else
                     "it has a power port and the kernel writes no power")
    if wrong:
        raise _misfit(element.name, kernel, wrong)


def check_superelement(body: Superelement, kernel: ModuleType) -> None:
    """Check counts and damping of a superelement.

    Raises
    ------
    InputError
        What it has is not what its kernel reads; the message names both.
    """
    reduced = body.reduced
    positions, rotations = len(reduced.position_nodes), len(reduced.rotation_nodes)
    wrong = _different((("positions", positions, kernel.N_POSITIONS),
                        ("rotations", rotations, kernel.N_ROTATIONS),
                        ("coordinates before its modes", _width(body) - reduced.modes,
                         first_mode(positions, rotations, kernel.PLANAR)),
                        ("modes", reduced.modes, kernel.N_MODES)))
    if kernel.PLANAR != reduced.planar:
        wrong.append(f"it is {'planar' if reduced.planar else 'spatial'} and the kernel is not")
    if kernel.DAMPED not in (None, reduced.damping is not None):
        wrong.append(f"it has {'no' if kernel.DAMPED else 'a'} damping matrix and the kernel reads "
                     f"{'one' if kernel.DAMPED else 'none'}")
    if INERTIA_OPTIONS[kernel.INERTIA].field:
        wrong += _of_second_order(body.invariants, kernel)
    if wrong:
        raise _misfit(body.name, kernel, wrong)


def _of_second_order(invariants: InertiaInvariants, kernel: ModuleType) -> list[str]:
    """Faults in the numbers of slaved coordinates and of stress resultants."""
    slaved, resultants = kernel.SECOND_ORDER or (None, None)
    wrong = _different((("slaved coordinates", invariants.slaved, slaved),
                        ("stress resultants", invariants.resultants, resultants)))
    if invariants.slaved > MOST_SLAVED:
        wrong.append(f"it has {invariants.slaved} slaved coordinates and the kernel memory "
                     f"for {MOST_SLAVED}")
    return wrong


def constants_row(name: str, kernel: ModuleType, counts: Counts,
                  values: Mapping[str, ArrayLike]) -> NDArray:
    """The constants of a body or element in the order of its kernel.

    Raises
    ------
    InputError
        Names or shapes are not those of the kernel.
    """
    try:
        form = Row("constants", kernel.CONSTANTS)
        row = form.pack(counts, values)
    except ContractError as error:
        raise _misfit(name, kernel, [str(error)]) from error
    places = form.slices(counts)
    for part in form.parts:
        if part.packed and part.size(counts):
            place = places[part.name]
            move_to_cache_lines(row[place], place.start)
    return row


def index_row(name: str, kernel: ModuleType, unknowns: list[int], nodes: list[int],
              **values: int) -> list[int]:
    """The index row of an element: where its kernel finds its data.

    Parameters
    ----------
    unknowns, nodes : list of int
        The parts of these names.
    **values : int
        The others, without the number of rotations.

    Raises
    ------
    InputError
        The row is longer or shorter than the kernel reads.
    """
    rotations = len(nodes) if kernel.N_ROTATIONS is None else kernel.N_ROTATIONS
    own = rotations - getattr(kernel, "CARRIERS", 0)
    lists = {"rotations": own, "nodes": nodes, "unknowns": unknowns}
    try:
        return INDEX.pack_integers({"N_ROTATIONS": rotations, "n": len(unknowns)}, values | lists)
    except ContractError as error:
        raise _misfit(name, kernel, [str(error)]) from error


def positions_of(element: Element) -> int:
    """The number of positions an element is on; an internal mode counts as one.

    Of a contact inside a body, or a point on a path, those of the body.
    """
    if places := element.carried[0]:
        return sum(one.kind == "position" for one in element.attachments[:places])
    return sum(not t.rotational for t in element.dof_blocks) + (element.mode is not None)


def frame_counts(body: Superelement) -> Counts:
    """The counts that what places its frame refers to, and what its motion has."""
    reduced = body.reduced
    return axes_of(reduced.planar) | superelement_counts(
        len(reduced.position_nodes), len(reduced.rotation_nodes), reduced.planar, _width(body))


def counts_of(body: Superelement) -> Counts:
    """The counts that sizes of a superelement's rows are products of."""
    reduced = body.reduced
    counts = superelement_counts(len(reduced.position_nodes), len(reduced.rotation_nodes),
                                 reduced.planar, _width(body))
    option, damped = INERTIA_OPTIONS[body.inertia], reduced.damping is not None
    if option.field:
        return counts | bound_counts(len(reduced.position_nodes), len(reduced.rotation_nodes),
                                     reduced.planar) | floating_counts(
            reduced.planar, _width(body), body.invariants.slaved, body.invariants.resultants,
            damped)
    return counts | rigid_part_counts(reduced.planar, _width(body),
                                      damped) if option.rates else counts


def _width(body: Superelement) -> int:
    return len(body.reduced.stiffness)


def _different(facts: Iterable[tuple[str, int, int | None]]) -> list[str]:
    """Descriptions of facts that differ; None is of a kernel that takes any number."""
    return [f"it has {own} {what} and the kernel {read}" for what, own, read in facts
            if read is not None and own != read]


def _misfit(name: str, kernel: ModuleType, wrong: list[str]) -> InputError:
    return InputError(f"{name!r} does not fit its kernel {kernel.__name__}: {'; '.join(wrong)}: "
                      f"{REMEDY}")
