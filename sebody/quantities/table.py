"""The table of all quantities: names, formulas, units, and what has them.

``<owner>.<quantity>`` are in `OWNERS`, those of the whole model in `OF_MODEL`. A quantity that is
added here has a history in results, and is measured, controlled, exported, followed in ensembles
and differentiated by its formula.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

from sebody.contract.layout import ENERGIES
from sebody.model.numbering import record_counts
from sebody.model.parts import SLIDES, TURNS
from sebody.quantities import contacts, forces, inside, motion, paths, ropes
from sebody.quantities.algebra import total
from sebody.quantities.numbers import Numbers, Parts

FE_NODE = "node inside a body"
OPTIONAL = PRESSING, SLIDING, COUPLED, ROPE, SHEAVE, SIGNAL, CONTROLLER, OUTPUT = (  # told if any
    "contact, stop or friction", "joint on a path", "coupling", "rope", "sheave with inertia",
    "sensor, signal or actuator",
    "controller", "output of a body")


def _always(of: Parts, owner: str) -> bool:
    return True


class Quantity(NamedTuple):
    """A row of the table.

    `formula` gives a number, a vector or a matrix of numbers; `has` says whether an owner has the
    quantity.
    """

    formula: Callable[[Numbers, str], Any]
    unit: str = ""              # in words
    has: Callable[[Parts, str], bool] = _always
    numbered: bool = False      # whose columns are no directions
    saved: bool = False         # part of the output file


class Owner(NamedTuple):
    """A kind of named parts of a model, and their quantities."""

    kind: str
    offer: str              # text for the message about an unknown name
    names: Callable[[Parts], Iterable[str]]
    quantities: Mapping[str, Quantity]


# what has a quantity


def _of_block(kind: str, of: Parts, name: str) -> bool:
    block = getattr(of.model.nodes[name], kind)
    return block is not None and block in of.numbering.dof_blocks


def _supported(kind: str, of: Parts, name: str) -> bool:
    return _of_block(kind, of, name) and getattr(of.model.nodes[name], kind).fixed


def _has_modes(of: Parts, name: str) -> bool:
    return name in of.model.bodies and of.model.bodies[name].reduced.modes > 0


def _held_at(kind: str, of: Parts, name: str) -> bool:
    body, node = forces.nodes_of_bodies(of)[name]
    return (node, kind) in forces.bodies(of)[body].attachments


def _is_a(kinds: tuple[str, ...], of: Parts, name: str) -> bool:
    return motion.joints(of)[name].kind in kinds


def _has_equations(of: Parts, name: str) -> bool:
    return bool(motion.joints(of)[name].constraints)


def _drives(kind: str, of: Parts, name: str) -> bool:
    return forces.driven(forces.drives(of)[name]) == kind


def _couples(kind: str, of: Parts, name: str) -> bool:
    return forces.coupled(forces.couplings(of)[name]) == kind


def _acts_on(kind: str, of: Parts, name: str) -> bool:
    return any(place.kind == kind for place in forces.loads(of)[name].attachments)


def _presses(quantity: str, of: Parts, name: str) -> bool:
    return contacts.has(contacts.pressing(of)[name], quantity)


# rows


def _energy(name: str, of: Numbers, owner: str) -> Any:
    part = ENERGIES.slices(record_counts(of.numbering))[name]
    values = [of.energy(k) for k in range(part.start, part.stop)]
    return values if len(values) > 1 else values[0]


def _works(of: Numbers, owner: str) -> Any:
    return total(of.recorded("works", k) for k in range(len(of.numbering.port_names)))


OF_MODEL = {
    "t": Quantity(lambda of, owner: of.recorded("t", 0), "time", saved=True),
    "energy.external_work": Quantity(_works, "force length", saved=True),
    "constraints.position": Quantity(lambda of, owner: of.residue(0), "length"),
    "constraints.velocity": Quantity(lambda of, owner: of.residue(1), "length/time"),
    "energy.kinetic": Quantity(partial(_energy, "kinetic"), "force length", saved=True),
    "energy.strain": Quantity(partial(_energy, "strain"), "force length", saved=True),
    "momentum": Quantity(partial(_energy, "momentum"), "mass length/time", saved=True),
    "angular_momentum": Quantity(partial(_energy, "moment"), "mass length^2/time", saved=True),
    "energy.potential": Quantity(partial(_energy, "potential"), "force length", saved=True),
}


def _translation(name: str, part: str, unit: str, saved: bool = True) -> Quantity:
    return Quantity(lambda of, owner: motion.position(of, owner, part, name), unit,
                    partial(_of_block, "position"), saved=saved)


def _turning(name: str, part: str, unit: str, saved: bool = True) -> Quantity:
    return Quantity(lambda of, owner: motion.angular(of, owner, part, name), unit,
                    partial(_of_block, "rotation"), saved=saved)


def _pair(formula: Callable[..., Any], has: Callable[..., bool] | None = None, prefix: str = ""
          ) -> dict[str, Quantity]:
    """A force and a moment."""
    return {prefix + name: Quantity(
        partial(_with, formula, kind), unit, _always if has is None else partial(has, kind))
        for name, kind, unit in (("force", "position", "force"),
                                 ("moment", "rotation", "force length"))}


def _with(formula: Callable[..., Any], kind: str, of: Numbers, owner: str) -> Any:
    return formula(of, owner, kind)


def _inside(quantity: str, of: Numbers, owner: str) -> Any:
    return of.inside(owner, quantity)


NODE = {
    "position": _translation("position", "q", "length"),
    "rotation": Quantity(motion.rotation, "rotation matrix, in a plane rad",
                         partial(_of_block, "rotation"), saved=True),
    "velocity": _translation("velocity", "v", "length/time"),
    "angular_velocity": _turning("angular_velocity", "v", "rad/time"),
    "acceleration": _translation("acceleration", "a", "length/time^2", saved=False),
    "angular_acceleration": _turning("angular_acceleration", "a", "rad/time^2", saved=False),
    "reaction": Quantity(
        lambda of, owner: motion.reaction(of, owner, "position", "reaction"), "force",
        partial(_supported, "position")),
    "reaction_moment": Quantity(
        lambda of, owner: motion.reaction(of, owner, "rotation", "reaction_moment"),
        "force length", partial(_supported, "rotation")),
}
BODY = {
    "modes": Quantity(partial(_with, motion.modes, "q"), has=_has_modes,
                      numbered=True),
    "mode_rates": Quantity(partial(_with, motion.modes, "v"), has=_has_modes,
                           numbered=True),
    "forces": Quantity(forces.of_body, numbered=True),
}
NODE_OF_BODY = {
    **_pair(forces.at_node, _held_at),
}
JOINT = {
    "multipliers": Quantity(forces.multipliers, has=_has_equations, numbered=True),
    **_pair(forces.of_joint), **_pair(forces.in_joint_axes, prefix="local_"),
    "angle": Quantity(motion.turned, has=partial(_is_a, TURNS)),
    "rate": Quantity(motion.turning, has=partial(_is_a, TURNS)),
    "displacement": Quantity(motion.displacement, "length", partial(_is_a, SLIDES)),
    "speed": Quantity(motion.speed, has=partial(_is_a, SLIDES)),
}
PATH_JOINT = {
    "way": Quantity(lambda of, owner: paths.way(of, owner, "q"), "length"),
    "rate": Quantity(lambda of, owner: paths.way(of, owner, "v")),
    "thrust": Quantity(paths.thrust, "force"),
    "normal_force": Quantity(paths.normal_force),
    "power": Quantity(paths.power, "force length/time"),
}
ROPES = {
    "tension": Quantity(ropes.tension, "force", numbered=True),
    "length": Quantity(ropes.length, "length"),
    "elongation": Quantity(ropes.elongation, "length"),
    "wraps": Quantity(ropes.wraps, numbered=True, has=ropes.passes),
    "slip": Quantity(ropes.slip, "length", numbered=True, has=ropes.rubs),
}
SHEAVES = {
    "angle": Quantity(lambda of, owner: ropes.turned(of, owner, "q")),
    "rate": Quantity(lambda of, owner: ropes.turned(of, owner, "v")),
}


def _effort(formula: Callable[..., Any], has: Callable[..., bool]) -> dict[str, Quantity]:
    """A torque about, or a thrust along an axis."""
    return {name: Quantity(partial(_with, formula, name), unit, partial(has, kind))
            for name, kind, unit in (("torque", "rotation", "force length"),
                                     ("thrust", "position", "force"))}


DRIVE = _effort(forces.effort, _drives)
COUPLING = _effort(forces.on_first, _couples)
CONTACT = {
    "normal_force": Quantity(contacts.normal_force, has=partial(_presses, "normal_force")),
    "gap": Quantity(contacts.gap, has=partial(_presses, "gap")),
    "sticks": Quantity(contacts.sticks, has=partial(_presses, "sticks")),
    "dissipation": Quantity(contacts.dissipation),
}
PORT = {"work": Quantity(forces.work, "force length"),
        "power": Quantity(forces.power, "force length/time")}
INSIDE = {name: Quantity(partial(_inside, name), unit)
          for name, unit in inside.UNITS.items()}

OWNERS = (
    Owner("node", "nodes are {names}", lambda of: of.model.nodes, NODE),
    Owner("body", "of bodies ({names}) there are {quantities}", forces.bodies, BODY),
    Owner("node of a body", "of <body>.<node> {quantities}", forces.nodes_of_bodies, NODE_OF_BODY),
    Owner(SLIDING, "of joints on paths {quantities}", paths.sliding, PATH_JOINT),
    Owner(ROPE, "of ropes {quantities}", ropes.ropes, ROPES),
    Owner(SHEAVE, "of sheaves with inertia {quantities}", ropes.sheaves, SHEAVES),
    Owner("joint", "of joints {quantities}", motion.joints, JOINT),
    Owner("drive", "of drives {quantities}", forces.drives, DRIVE),
    Owner(COUPLED, "of couplings {quantities}", forces.couplings, COUPLING),
    Owner("spring or load", "of springs and loads {quantities}", forces.loads,
          _pair(forces.of_load, _acts_on)),
    Owner(PRESSING, "of contacts, stops and friction {quantities}", contacts.pressing, CONTACT),
    Owner("source of work", "of {names} {quantities}", lambda of: of.numbering.port_names, PORT),
    Owner(SIGNAL, "of sensors, signals and actuators {quantities}",
          lambda of: of.numbering.memory.values, {"value": Quantity(motion.kept)}),
    Owner(CONTROLLER, "of controllers {quantities}", lambda of: of.model.controllers,
          {"states": Quantity(motion.states, numbered=True,
                              has=lambda of, owner: of.model.controllers[owner].states.size > 0)}),
    Owner(OUTPUT, "of outputs of bodies {quantities}", inside.outputs,
          {"values": Quantity(inside.output, numbered=True)}),
    # the last one: its names are too many to be searched for names like another
    Owner(FE_NODE, "; of FE nodes, <body>.node<k>, {quantities}", inside.FENodes, INSIDE),
)


def find(of: Parts, name: str) -> tuple[Quantity, str] | None:
    """The row of a quantity by its full name, and its owner; None if there is none."""
    if name in OF_MODEL:
        return OF_MODEL[name], ""
    owner, _, quantity = name.rpartition(".")
    for one in OWNERS:      # names of nodes come first: those of others are long to list
        if quantity in one.quantities and owner in one.names(of):
            return one.quantities[quantity], owner
    return None
