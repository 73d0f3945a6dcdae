"""The grammar of quantities, in one place: the meaning of ``tip.position.y`` everywhere.

=======================  =========================================================================
``tip.position``         a quantity, by the table of `sebody.quantities.table`
``tip.position.y``       a component: x, y, z of vectors, xx, xy, ... of rotation matrices and
                         stresses, 0, 1, ... of everything else
``tip.position.norm``    the length of a vector
``tip.rotation.z``       of a rotation matrix its rotation vector, followed through full turns
``energy``               a group of quantities of the model, see `GROUPS`
=======================  =========================================================================
"""

from collections.abc import Iterable, Sequence
from itertools import product
from typing import NoReturn

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import alike
from sebody.quantities.inside import FENodes
from sebody.quantities.numbers import Parts
from sebody.quantities.table import (
    FE_NODE,
    INSIDE,
    OF_MODEL,
    OPTIONAL,
    OWNERS,
    Owner,
    find,
)

AXES, NORM = "xyz", "norm"
STRESS = "xx", "yy", "zz", "yz", "zx", "xy"
GROUPS = {"energy": ("energy.kinetic", "energy.strain", "energy.potential",
                     "energy.external_work"),
          "constraints": ("constraints.position", "constraints.velocity")}
NUMBERED = {name for owner in OWNERS for name, row in owner.quantities.items() if row.numbered}
ALIKE = 0.75            # ratio of `difflib` from which a name is near another
OF_FIELD = (*INSIDE, "strain", "principal")
ENVELOPED = ("von_mises", "largest_principal", "smallest_principal", "displacement", "velocity",
             "acceleration")     # of them and others: those of a field that have envelopes


def split(of: Parts, name: str) -> tuple[str, list[str]]:
    """The quantity or group that a name begins with, and the components behind it.

    Raises
    ------
    InputError
        A name that nothing has; the message has names that are like it.
    """
    inputs.name(name, "name of a quantity")
    whole = name
    components: list[str] = []
    while whole not in GROUPS and find(of, whole) is None:
        before, _, last = whole.rpartition(".")
        if not before or not (_may_be_component(last) or find(of, before)):
            raise _unknown(of, name, whole, components)
        whole, components = before, [last, *components]
    return whole, components


def labels_of(shape: tuple[int, ...], name: str) -> list[str]:
    """Components of a quantity of a shape in a state: of a matrix its rows, of a rotation all."""
    if shape == (3, 3):
        return [*map("".join, product(AXES, AXES))]
    return _labels(shape[0], name, len(shape) > 1)


def refuse_component(name: str, component: str, labels: Sequence[str] = ()) -> NoReturn:
    """Refuse a component that a quantity does not have."""
    if not labels:
        raise InputError(f"{name}.{component} is unknown: {name} is one number, it has no "
                         "components")
    known = [*(AXES if len(labels) == 9 and labels[0] == "xx" else ()), *labels, NORM]
    raise InputError(f"{name}.{component} is unknown: {name} has the components "
                     f"{', '.join(known)}")


def names(of: Parts) -> list[str]:
    """Names of all quantities there are, but those of FE nodes: of the model, then by owner."""
    return list(OF_MODEL) + list(dict.fromkeys(
        f"{owner}.{quantity}" for one in OWNERS if one.kind != FE_NODE
        for owner in one.names(of)
        for quantity, row in one.quantities.items() if row.has(of, owner)))


def unknown_quantity(of: Parts, name: str) -> InputError:
    """The exception for a name that nothing has: names that are like it, and what there is."""
    owner, _, quantity = name.rpartition(".")
    model = of.model
    if owner in model.bodies and quantity in OF_FIELD:
        return _of_field(of, owner, quantity)
    owners = [one for one in OWNERS if owner in one.names(of)]
    inside = INSIDE if owner in FENodes(of) else ()
    near = alike(name, [*names(of), *(f"{owner}.{q}" for q in inside)], cutoff=ALIKE)
    meant = f"did you mean {' or '.join(map(repr, near))}? " if near else ""
    if owners:
        return InputError(f"{quantity!r} is unknown: {meant}" + "; ".join(
            f"a {one.kind} has {', '.join(one.quantities)}" for one in owners))
    *offers, of_fe_nodes = [one.offer.format(names=_listed(one, of),
                                             quantities=_enumerated(one.quantities))
                            for one in OWNERS
                            if one.kind not in OPTIONAL or list(one.names(of))]
    return InputError(f"{name!r} is unknown: {meant}{'; '.join(offers)}; of the model "
                      f"{', '.join(OF_MODEL)}{of_fe_nodes}")


def _unknown(of: Parts, name: str, whole: str, components: list[str]) -> InputError:
    """The exception for a name that nothing has; `whole` is what there is before components."""
    if components and (near := alike(whole, names(of))):
        meant = " or ".join(repr(".".join([one, *components])) for one in near)
        return InputError(f"{name!r} is unknown: did you mean {meant}?")
    return unknown_quantity(of, name)


def _of_field(of: Parts, body: str, quantity: str) -> InputError:
    """The exception for a quantity of FE nodes that is requested for a whole body."""
    recovery = of.model.bodies[body].reduced.recovery
    if recovery is None:
        return InputError(f"'{body}.{quantity}' is unknown: {body!r} was reduced without the "
                          "shapes of its FE model; reduce it from the FE model, or import it with "
                          "its mesh")
    node = f"{body}.node{recovery.number(0)}"
    return InputError(f"'{body}.{quantity}' is unknown: it is a quantity of FE nodes, such as "
                      f"'{node}.{quantity}'; for all FE nodes at one time use "
                      f"result.field({body!r}).{quantity}(t=...)"
                      + ("; the largest over the run result.field("
                         f"{body!r}).envelope({quantity!r})" if quantity in ENVELOPED else ""))


def _listed(one: Owner, of: Parts) -> str:
    """Names of a kind, where its offer lists them."""
    return ", ".join(one.names(of) if "{names}" in one.offer else ()) or f"any {one.kind}"


def _enumerated(names: Iterable[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def _may_be_component(last: str) -> bool:
    return last in (*AXES, NORM, *STRESS, *map("".join, product(AXES, AXES))) or last.isdecimal()


def _labels(size: int, name: str, has_inner: bool) -> list[str]:
    """Names of the columns of a quantity, of its rows where these have columns."""
    if name in GROUPS:
        return [one.partition(".")[2] for one in GROUPS[name]]
    quantity = name.rpartition(".")[2]
    if quantity == "stress" or (not name and size == len(STRESS)):
        return list(STRESS)
    directions = size in (2, 3) and quantity not in NUMBERED and not has_inner
    return list(AXES[:size]) if directions else [*map(str, range(size))]
