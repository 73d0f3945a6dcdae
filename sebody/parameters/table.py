"""The table of parameters: ``<owner>.<quantity>``, as quantities of results are.

Ensembles, sweeps, gradients, calibration and exports vary or set what is listed here. Of a
parameter of several numbers ``<parameter>.x`` or ``<parameter>.2`` is one, as ``gravity.y``.

==========================  ========================================================================
``<node>.position``         initial position, (3,), planar (2,) [length]
``<node>.velocity``         initial velocity; it counts as given, others are fitted to it
``<node>.rotation``         initial rotation against the model as built, a vector, planar an angle
``<node>.angular_velocity``
``<joint>.position``        of a joint with the ground: where it holds its node [length]; a node
                            whose position is unknown begins there by its own parameter
``<coupling>.ratio``        of its first coordinate to the second [rad, length]
``<body>.stiffness``        factor, of a superelement's stiffness and of its geometric stiffness
``<body>.mass``             factor, of a superelement or rigid body with its inertia
``<body>.damping``          factor, of a superelement that has damping
``<body>.reduced``          a whole `ReducedBody` of the same boundary nodes, in the same axes
``<load>.amplitude``        factor of a force or torque
``<load>.table``            values at the times of its table, (rows,)
``<drive>.amplitude``       factor of a motion given by a table or profile
``<spring>.stiffness``      and damping, cubic, length, rest, turning_stiffness, turning_damping:
                            the value itself
``<contact>.stiffness``     and other constants of contacts, stops, gears and friction, as they have
                            them: `load_changes.OF_CONTACTS`, restitution, backlash
``<controller>.parameters`` numbers of its law, in their order, but for infinite limits
``gravity``                 acceleration of free fall, (3,), planar (2,) [length/time^2]
==========================  ========================================================================
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.control_parts import Controller
from sebody.model.element_numbers import refuse_numbers
from sebody.model.model import Model
from sebody.model.parts import Element
from sebody.parameters import changes, load_changes
from sebody.parameters.changes import Handle
from sebody.quantities.names import AXES

GRAVITY = "gravity"
PLACES = ".position", ".rotation"   # what moves the starts of runs, of contacts and stops


class Kind(NamedTuple):
    """A kind of named parts of a model, and what can be varied of them."""

    title: str
    parts: Callable[[Model], Mapping[str, Any]]
    quantities: Mapping[str, Callable[[Model, Any, str], Handle]]


def handle(model: Model, name: str) -> Handle:
    """Object that a name refers to.

    Raises
    ------
    InputError
        A name that nothing has, or a quantity its owner does not have.
    """
    inputs.name(name, "name of a parameter")
    if name == GRAVITY:
        return changes.gravity(model)
    owner, _, quantity = name.rpartition(".")
    for kind in KINDS:
        parts = kind.parts(model)
        if owner in parts and quantity in kind.quantities:
            return kind.quantities[quantity](model, parts[owner], name)
    raise unknown("parameter", name, handles(model), "the model has")


class Found(NamedTuple):
    """A parameter that a name is of, and which of its numbers, counted from 0; None of all."""

    name: str
    handle: Handle
    component: int | None


def parameter(model: Model, name: str) -> Found:
    """Parameter, or one of its numbers, by name.

    Raises
    ------
    InputError
        As `handle`, or a number that the parameter does not have.
    """
    owner, _, last = inputs.name(name, "name of a parameter").rpartition(".")
    if not owner or not (last in AXES or last.isdigit()):
        return Found(name, handle(model, name), None)
    found, component = handle(model, owner), AXES.index(last) if last in AXES else int(last)
    if found.whole or found.base.ndim == 0 or component >= found.base.size:
        has = ("whole bodies for values" if found.whole else "one number"
               if found.base.ndim == 0 else f"{found.base.size} numbers")
        raise InputError(f"parameter {name!r}: {owner} has {has}, so none is called {last!r}: give "
                         f"{owner!r}")
    return Found(owner, found, component)


def handles(model: Model) -> Iterable[str]:
    """Names of all that can be varied."""
    yield GRAVITY
    for kind in KINDS:
        for owner, part in kind.parts(model).items():
            for quantity, make in kind.quantities.items():
                try:
                    make(model, part, f"{owner}.{quantity}")
                except InputError:      # a part that does not have it
                    continue
                yield f"{owner}.{quantity}"


def _springs(model: Model) -> dict[str, Any]:
    constants = set(load_changes.OF_SPRINGS.values())
    return {e.name: e for e in model.loads if e.constants.keys() & constants}


def _contacts(model: Model) -> dict[str, Any]:
    return {e.name: e for e in model.loads if e.constants.keys() & {"coefficient", "exponent"}}


def _drives(model: Model) -> dict[str, Any]:
    moved = {m.name: (t, m) for t in model.dof_blocks() for m in t.motions}
    return moved | {j.name: j for j in model.joints if j.time_function is not None}


KINDS = (
    Kind("node", lambda model: model.nodes, {
        "position": changes.position, "velocity": changes.velocity,
        "rotation": changes.rotation, "angular_velocity": changes.angular_velocity}),
    Kind("superelement", lambda model: model.bodies, {
        "stiffness": changes.body_factor("stiffness"), "mass": changes.body_factor("mass"),
        "damping": changes.body_factor("damping"), "reduced": changes.whole_body}),
    Kind("rigid body", lambda model: model.rigid_bodies, {"mass": changes.rigid_mass}),
    Kind("drive", _drives, {"amplitude": load_changes.drive_amplitude}),
    Kind("joint", lambda model: {j.name: j for j in model.joints}, {
        "position": changes.joint_position, "ratio": load_changes.coupling_ratio}),
    Kind("spring", _springs, {quantity: load_changes.spring_constant(quantity)
                              for quantity in load_changes.OF_SPRINGS}),
    Kind("contact, stop or friction", _contacts, {
        **{constant: load_changes.contact_constant(constant)
           for constant in load_changes.OF_CONTACTS},
        "restitution": load_changes.restitution, "backlash": load_changes.backlash}),
    Kind("controller", lambda model: model.controllers, {
        "parameters": load_changes.law_parameters}),
    Kind("load", lambda model: {e.name: e for e in model.loads if e.law is None}, {
        "amplitude": load_changes.load_amplitude, "table": load_changes.load_table}),
)


def refuse_values(model: Model, names: Iterable[str]) -> None:
    """Refuse values that parameters of some names have now, where a builder refuses them.

    Raises
    ------
    InputError
        As the builders of contacts, stops, gears and friction: of their own numbers, and where
        what they touch begins; and as those of ready laws.
    """
    names = list(names)
    for one in checked_parts(model, names):
        refuse_numbers(model, one)
    for controller in _checked_laws(model, names):
        controller.check_parameters()


def checked_parts(model: Model, names: Iterable[str]) -> list[Element]:
    """Parts whose builders have checks of what parameters of these names change."""
    parts = _contacts(model)
    names = list(names)
    if any(name.endswith(PLACES) for name in names):
        return list(parts.values())
    return [parts[owner] for owner in dict.fromkeys(name.rpartition(".")[0] for name in names)
            if owner in parts]


def _checked_laws(model: Model, names: Iterable[str]) -> list[Controller]:
    """Controllers whose parameters names change."""
    owners = [name.rpartition(".") for name in names]
    return [model.controllers[owner] for owner, _, quantity in owners
            if quantity == "parameters" and owner in model.controllers]


def refused(model: Model, found: Mapping[str, Handle], values: Mapping[str, Any], runs: int
            ) -> dict[int, str]:
    """Runs whose values a builder refuses, and why; the model is changed for moments."""
    reasons: dict[int, str] = {}
    if not (checked_parts(model, found) or _checked_laws(model, found)):
        return reasons
    for run in range(runs):
        try:
            for name, one in found.items():
                one.set(values[name][run])
            refuse_values(model, found)
        except InputError as error:
            reasons[run] = str(error)
        finally:
            for one in reversed(found.values()):
                one.reset()
    return reasons


def checked_values(model: Model, parameters: Mapping[str, Any]
                   ) -> tuple[dict[str, Found], dict[str, Any], int]:
    """Owners of some names, checked values of each, and the number of runs.

    Raises
    ------
    InputError
        Unknown names, values of another shape or outside their bounds, arrays of different
        lengths, a number that is given twice, or none at all.
    """
    if not isinstance(parameters, Mapping) or not parameters:
        raise inputs.refusal("parameters", parameters, "give a dict of names and arrays of values")
    found = {name: parameter(model, name) for name in parameters}
    _refuse_twice(found)
    checked = {name: (one.handle if one.component is None else one.handle.part(one.component)
                      ).checked(name, parameters[name]) for name, one in found.items()}
    lengths = {name: len(values) for name, values in checked.items()}
    if len(set(lengths.values())) > 1:
        raise InputError("parameters have different numbers of values: " + ", ".join(
            f"{name} {count}" for name, count in lengths.items()) + "; give one for each run")
    runs = next(iter(lengths.values()))
    if not runs:
        raise InputError(f"{next(iter(lengths))!r} has no values: give one for each run")
    return found, checked, runs


def given(model: Model, parameters: Mapping[str, Any]
          ) -> tuple[dict[str, Handle], dict[str, Any], int]:
    """Handles and values of some parameters, and the number of runs.

    Of ``gravity.x`` and ``gravity.y`` the values are those of one parameter, (runs, 2).

    Raises
    ------
    InputError
        As `checked_values`.
    """
    found, checked, runs = checked_values(model, parameters)
    values = {owner: checked[names[0]] if found[names[0]].component is None
              else np.stack([checked[name] for name in names], axis=1)
              for owner, names in by_parameter(found).items()}
    return varied(found), values, runs


def by_parameter(found: Mapping[str, Found]) -> dict[str, list[str]]:
    """Names by the parameter that each is of."""
    owners: dict[str, list[str]] = {}
    for name, one in found.items():
        owners.setdefault(one.name, []).append(name)
    return owners


def varied(found: Mapping[str, Found]) -> dict[str, Handle]:
    """Handles of parameters, or of those numbers of each that are named.

    Whole bodies come first: factors are those of the body that is there.
    """
    handles: dict[str, Handle] = {}
    for owner, names in by_parameter(found).items():
        one = found[names[0]]
        handles[owner] = one.handle if one.component is None else one.handle.part(
            [found[name].component for name in names])
    return dict(sorted(handles.items(), key=lambda item: not item[1].whole))


def _refuse_twice(found: Mapping[str, Found]) -> None:
    """Refuse a number that two names are of.

    Raises
    ------
    InputError
    """
    taken: dict[tuple[str, int | None], str] = {}
    for name, (owner, one, component) in found.items():
        for number in (component,) if component is not None else (None, *range(one.base.size)) if (
                not one.whole) else (None,):
            if (owner, number) in taken:
                raise InputError(f"parameters {taken[owner, number]!r} and {name!r} give the same "
                                 "number: leave one out")
            taken[owner, number] = name

