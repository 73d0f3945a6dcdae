"""Small elements written out in components: what joints, bodies and forces are derived with.

An element acts on blocks, positions and rotations, and is given by a few scalars: kinetic energy,
strain energy, potential, dissipation, constraints, virtual work of a load. Forces, tangents and
balances follow, once for all of them:

    force = d/dt dT/dv - dT/dq + dV/dq + dD/dv + lambda . dphi/dq - load

with Hamel's term ``Omega x dT/dOmega`` on rotations, whose variations do not commute.
"""

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import View, pointed
from sebody.derive.form.functions import TABLE_LAW
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import Rules, along, check_same, differential, rotating

AMPLITUDE = sp.symbols("amplitude amplitude_rate amplitude_acceleration")
Stage = tuple[tuple[sp.Symbol, sp.Expr], ...]      # none reads a symbol of the same stage


def kept(name: str) -> sp.Symbol:
    """A number that an element keeps from step to step, as it was in the last accepted step."""
    return sp.Symbol("kept_" + name)


class choose(sp.Function):  # noqa: N801  (as functions of SymPy)
    """``choose(x, yes, no)``: yes where x is positive, else no; derivatives are of these two."""

    nargs = 3
    written_out = True      # no function of a target's library

    def _eval_derivative(self, by: sp.Symbol) -> sp.Expr:
        yes, no = (one.diff(by) for one in self.args[1:])
        return choose(self.args[0], yes, no) if (yes, no) != (0, 0) else sp.S.Zero


class near_angle(sp.Function):  # noqa: N801  (as functions of SymPy)
    """An angle plus as many whole turns as bring it nearest to another one."""

    nargs = 2

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Whole turns do not change."""
        return sp.Integer(argindex == 1)


class tabled(sp.Function):  # noqa: N801  (as functions of SymPy)
    """``tabled(u, order, first)``: a law by a table whose numbers begin there among the constants.

    Of order 0 the integral of the force, whose derivatives are the force (1) and its slope (2).
    """

    nargs = 3
    written_out = True
    calls = TABLE_LAW

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The next order."""
        u, order, first = self.args
        return tabled(u, order + 1, first)

    @property
    def table(self) -> View:
        """The array of the numbers."""
        return pointed("constant").at(int(self.args[2]))


def whole_turns(expr: sp.Expr) -> sp.Expr:
    """An expression that is not differentiated any more, with all `near_angle` written out."""
    expr, turn = sp.sympify(expr), sp.Float(2.0 * pi)
    return expr.xreplace({
        near: near.args[0] + turn * sp.floor((near.args[1] - near.args[0]) / turn + 0.5)
        for near in expr.atoms(near_angle)})


class Block(NamedTuple):
    """A position or a rotation: its value, its motion, and how a column of the tangent moves it."""

    state: Quantity
    rate: Quantity
    acceleration: Quantity
    direction: Quantity     # variation of the state; of a rotation through T
    unit: Quantity          # the column itself, along which rates and accelerations vary
    angle: sp.Symbol | None # of a rotation in a plane
    increment: Quantity | None = None   # of a rotation in space: its rotation vector of the step

    @property
    def rotational(self) -> bool:
        """A rotation."""
        return self.state.kind == "rotation"


class Constant(NamedTuple):
    """A constant of an element: what the model gives, by name."""

    quantity: Quantity
    meaning: str

    @property
    def symbols(self) -> sp.Matrix:
        """Its components."""
        return self.quantity.symbols


class Element(NamedTuple):
    """Description of a joint, body or force: what the printer turns into text."""

    name: str
    summary: str
    space: Space
    constants: tuple[Constant, ...]     # in the order of the constants row
    blocks: tuple[Block, ...]           # positions first
    multipliers: tuple[sp.Symbol, ...]
    residual: tuple[sp.Expr, ...]       # force on the coordinates, then phi
    velocity: tuple[sp.Expr, ...]       # phi differentiated in time, once
    second: tuple[sp.Expr, ...]         # and twice
    sums: dict[str, sp.Expr]            # what it adds to the energies, by name
    power: sp.Expr | None               # of loads, dampers and drives on the system
    losses: tuple[sp.Expr, ...]         # force of the dampers, where that is not the whole force
    memory: tuple[tuple[str, sp.Expr], ...] = ()    # numbers kept, which the next step reads
    reads: tuple[sp.Symbol, ...] = ()   # multipliers of other equations
    sees: tuple[sp.Symbol, ...] = ()    # numbers that another element keeps, of this iterate
    stages: tuple[Stage, ...] = ()      # what the force and the memory are made of, in this order
    slopes: tuple[Stage, ...] = ()      # derivatives of these, for the matrix
    moves: tuple[Stage, ...] = ()       # of a column: what these move with its unknown
    linear: tuple[sp.Expr, ...] = ()    # a column of the matrix
    on_multipliers: sp.Matrix = sp.zeros(0, 0)  # derivative of the force by the multipliers

    @property
    def coordinates(self) -> int:
        """Number of unknowns that are no multipliers."""
        return len(self.residual) - len(self.multipliers) - len(self.reads)

    @property
    def equates_positions(self) -> bool:
        """Its equations are the components of one vector: a sum of positions and constants.

        Then its multipliers are a force, which may be solved for in any axes.
        """
        count, first = len(self.multipliers), self.coordinates
        equations = sp.Matrix(self.residual[first:first + count])
        return count > 0 and all(
            not block.rotational
            and equations.jacobian([x for x in block.state.symbols if x.free_symbols])
            in (sp.eye(count), -sp.eye(count)) for block in self.blocks)

    @property
    def printed(self) -> list[sp.Expr]:
        """Every expression the kernel evaluates, the multipliers' columns apart."""
        staged = [value for stage in (*self.stages, *self.slopes, *self.moves)
                  for _, value in stage]
        power = [] if self.power is None else [self.power]
        return [*staged, *(value for _, value in self.memory), *self.residual, *self.linear,
                *self.velocity, *self.second, *self.sums.values(), *power, *self.losses]


def constant(space: Space, name: str, kind: str, meaning: str) -> Constant:
    """Declare a constant: a scalar, a vector or an axial vector."""
    return Constant(space.quantity(name, kind, "element"), meaning)


def position(space: Space, name: str) -> Block:
    """A position, ``x<name>`` with velocity ``v<name>``."""
    return Block(*(space.quantity(kind + name, "vector", "element")
                   for kind in ("x", "v", "a", "dx", "ux")), None)


def amplitude(space: Space, name: str) -> Block:
    """The amplitude of an internal mode, ``y<name>``."""
    return Block(*(space.quantity(kind + name, "scalar", "element")
                   for kind in ("y", "yd", "ydd", "dy", "uy")), None)


def rotation(space: Space, name: str) -> Block:
    """A rotation, ``R<name>`` with material angular velocity ``Om<name>``."""
    state = space.quantity("R" + name, "rotation", "element")
    return Block(state, *(space.quantity(kind + name, "axial", "element")
                          for kind in ("Om", "A", "dth", "uth")),
                 sp.Symbol("th" + name) if space.planar else None,
                 space.quantity("psi" + name, "axial", "element"))


def varied(blocks: Sequence[Block]) -> Rules:
    """Rules of a variation of the configuration."""
    rules = configuration(blocks, "direction")
    for block in blocks:
        if block.increment is not None:
            rules |= along(block.increment.symbols, block.unit.symbols)
    return rules


def in_time(blocks: Sequence[Block]) -> Rules:
    """Rules of time derivatives: of states, rates and the amplitude of a load."""
    rules = configuration(blocks, "rate")
    for block in blocks:
        rules |= along(block.rate.symbols, block.acceleration.symbols)
    return rules | dict(zip(AMPLITUDE[:2], AMPLITUDE[1:], strict=True))


def configuration(blocks: Sequence[Block], along_what: str) -> Rules:
    """Rules of states alone, along one of the quantities of their blocks."""
    rules: Rules = {}
    for block in blocks:
        by = getattr(block, along_what).symbols
        if not block.rotational:
            rules |= along(block.state.symbols, by)
            continue
        rules |= rotating(block.state.symbols, by)
        if block.angle is not None:
            rules[block.angle] = by[2]
    return rules


def element(name: str, summary: str, space: Space, blocks: Sequence[Block],
            constants: Sequence[Constant] = (), *, constraints: Sequence[sp.Expr] = (),
            kinetic: sp.Expr = sp.S.Zero, strain: sp.Expr = sp.S.Zero,
            potential: sp.Expr = sp.S.Zero, dissipation: sp.Expr = sp.S.Zero,
            load: sp.Expr = sp.S.Zero,
            memory: Sequence[tuple[str, sp.Expr]] = ()) -> Element:
    """Derive an element from its scalars; `load` is virtual work, linear in the directions.

    An element may keep numbers from step to step, to count its turns: see `near_angle`.
    """
    lam = sp.symbols(f"lam_1:{len(constraints) + 1}")
    vary, time = varied(blocks), in_time(blocks)
    work = sum(f * differential(phi, vary) for f, phi in zip(lam, constraints, strict=True))
    work += differential(strain + potential, vary) - load
    force = [entry for block in blocks for entry in space.components(
        block.direction.kind, conjugate_to(work, block.direction.symbols)
        + conjugate_to(dissipation, block.rate.symbols) + _inertia(kinetic, block, vary, time))]
    velocity = [differential(phi, time) for phi in constraints]
    return Element(
        name, ("planar " if space.planar else "") + summary, space, tuple(constants),
        tuple(blocks), lam, (*force, *constraints), tuple(velocity),
        tuple(differential(v, time) for v in velocity),
        _sums(blocks, kinetic, strain, potential),
        _power(blocks, lam, constraints, dissipation, load),
        _losses(blocks, space, dissipation, load) if kinetic + strain + potential != 0 else (),
        tuple(memory))


def linearized(given: Element) -> Element:
    """The element with the columns of its matrix; one of laws has them, see `law_elements`."""
    if given.linear:
        return given
    force, constraints = given.residual[:given.coordinates], given.residual[given.coordinates:]
    lam, vary = given.multipliers, varied(given.blocks)
    gradient = sp.Matrix(force).jacobian(sp.Matrix(lam)) if lam else sp.zeros(len(force), 0)
    _check_gradient(given.blocks, lam, constraints, gradient, vary)
    return given._replace(linear=_column(given.blocks, force, constraints, vary),
                          on_multipliers=gradient)


def _inertia(kinetic: sp.Expr, block: Block, vary: Rules, time: Rules) -> sp.Matrix:
    momentum = conjugate_to(kinetic, block.rate.symbols)
    force = differential(momentum, time) - conjugate_to(differential(kinetic, vary),
                                               block.direction.symbols)
    return force + cross(block.rate.symbols, momentum) if block.rotational else force


def _column(blocks, force, constraints, vary) -> tuple[sp.Expr, ...]:
    c_mass, c_damping, c_stiffness, c_constraint = sp.symbols(
        "c_mass c_damping c_stiffness c_constraint")
    rates, accelerations = {}, {}
    for block in blocks:
        rates |= along(block.rate.symbols, block.unit.symbols)
        accelerations |= along(block.acceleration.symbols, block.unit.symbols)
    on_force = [c_stiffness * differential(f, vary) + c_damping * differential(f, rates)
                + c_mass * differential(f, accelerations) for f in force]
    return (*on_force, *(c_constraint * differential(phi, vary) for phi in constraints))


def _check_gradient(blocks, lam, constraints, gradient, vary) -> None:
    """Columns of the multipliers and rows of the constraints are transposes of each other."""
    directions = sp.Matrix([s for block in blocks for s in block.direction.kept])
    for k in range(len(lam)):
        check_same("constraint force is the gradient", sp.Matrix([gradient[:, k].dot(directions)]),
                   sp.Matrix([differential(constraints[k], vary)]))


def _sums(blocks, kinetic, strain, potential) -> dict[str, sp.Expr]:
    """Energies; momentum and its moment, conjugate to rigid motions of the element."""
    sums = {"kinetic": kinetic, "strain": strain, "potential": potential}
    if kinetic != 0:
        linear, moment = sp.zeros(3, 1), sp.zeros(3, 1)
        for block in blocks:
            p = conjugate_to(kinetic, block.rate.symbols)
            if block.state.kind == "scalar":    # no rigid motion of the element changes it
                continue
            if block.rotational:
                moment += block.state.symbols * p
            else:
                linear, moment = linear + p, moment + cross(block.state.symbols, p)
        sums |= {f"P_{a}": linear[k] for k, a in enumerate("xyz")}
        sums |= {f"H_{a}": moment[k] for k, a in enumerate("xyz")}
    return {name: value for name, value in sums.items() if value != 0}


def _losses(blocks, space, dissipation, load) -> tuple[sp.Expr, ...]:
    """Forces of the dampers, and of what else does work that no energy holds."""
    if dissipation == 0 and load == 0:
        return ()
    return tuple(entry for block in blocks for entry in space.components(
        block.direction.kind, conjugate_to(dissipation, block.rate.symbols)
        - conjugate_to(load, block.direction.symbols)))


def _power(blocks, lam, constraints, dissipation, load) -> sp.Expr | None:
    """Rate of work on the system of what is not in the energies."""
    rules = {d: r for block in blocks for d, r in zip(block.direction.symbols, block.rate.symbols,
                                                      strict=True) if isinstance(d, sp.Symbol)}
    power = sp.sympify(load).xreplace(rules)
    for block in blocks:
        power -= block.rate.symbols.dot(conjugate_to(dissipation, block.rate.symbols))
    if any(phi.has(AMPLITUDE[0]) for phi in constraints):   # a drive: what moves is not at rest
        moved = configuration(blocks, "rate")
        power -= sum(f * differential(phi, moved) for f, phi in zip(lam, constraints, strict=True))
    return power if power != 0 else None
