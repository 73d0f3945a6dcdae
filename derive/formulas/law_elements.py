"""Elements of laws: geometry gives measures and their rates, laws the forces along them.

The force on the coordinates follows from the power ``sum F w``, and its derivative from slopes:
derivatives of the laws with respect to measures, computed once for all columns of the matrix.
"""

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.elements import (
    Block,
    Constant,
    Element,
    Stage,
    in_time,
    varied,
)
from sebody.derive.symbolic.variation import Rules, along, differential


class Forces(NamedTuple):
    """Forces against rates: those that do work ``-F w`` on the system."""

    rates: tuple[sp.Expr, ...]          # linear in the velocities
    forces: tuple[sp.Expr, ...]
    lost: tuple[sp.Expr, ...]           # the part that is no derivative of the stored energy


class Measures:
    """Symbols of the geometry, each with the expression of the state it stands for."""

    def __init__(self, blocks: Sequence[Block]) -> None:
        self.blocks = blocks
        self.stage: list[tuple[sp.Symbol, sp.Expr]] = []

    def add(self, name: str, value: sp.Expr) -> sp.Symbol:
        """Name an expression of the state; names that it has of other ones are written out."""
        value = sp.sympify(value).xreplace(dict(self.stage))
        if not value.free_symbols:
            return value
        self.stage.append((sp.Symbol(name), value))
        return self.stage[-1][0]

    def add_all(self, name: str, values: Sequence[sp.Expr]) -> list[sp.Symbol]:
        """Name several expressions."""
        return [self.add(f"{name}_{k + 1}", value) for k, value in enumerate(values)]

    def rate(self, value: sp.Expr) -> sp.Expr:
        """An expression of the state differentiated in time."""
        return differential(value, in_time(self.blocks))


def law_element(name: str, summary: str, space: Space, measures: Measures,
                constants: Sequence[Constant], stages: Sequence[Stage], forces: Forces,
                memory: Sequence[tuple[str, sp.Expr]], stored: sp.Expr = sp.S.Zero,
                reads: Sequence[sp.Symbol] = (), sees: Sequence[sp.Symbol] = ()) -> Element:
    """Derive an element from its measures, laws and forces.

    Parameters
    ----------
    stages : sequence of Stage
        Laws: of symbols of the measures, constants, kept numbers and earlier stages.
    forces : Forces
    memory : sequence of (str, expression)
        Numbers kept from step to step.
    stored : expression
        Strain energy.
    reads : sequence of Symbol
        Multipliers of other equations.
    sees : sequence of Symbol
        Numbers that another element keeps, as it has just found them; the matrix takes them as
        constants.
    """
    blocks = measures.blocks
    residual, lost = (_conjugate(space, blocks, forces.rates, values)
                      for values in (forces.forces, forces.lost))
    power = -sum(f * w for f, w in zip(forces.lost, forces.rates, strict=True))
    none = (sp.S.Zero,) * len(reads)
    element = Element(
        name, ("planar " if space.planar else "") + summary, space, tuple(constants),
        tuple(blocks), (), (*residual, *none), (), (),
        {} if stored == 0 else {"strain": stored}, power, (*lost, *none),
        memory=tuple(memory), reads=tuple(reads), sees=tuple(sees),
        stages=(tuple(measures.stage), *stages))
    return _with_column(element, stages)


def _conjugate(space: Space, blocks: Sequence[Block], rates: Sequence[sp.Expr],
               forces: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Forces on the coordinates of forces against rates."""
    return [entry for block in blocks for entry in space.components(block.rate.kind, sum(
        (f * conjugate_to(w, block.rate.symbols)
         for f, w in zip(forces, rates, strict=True)), sp.zeros(3, 1)
        if block.rate.kind != "scalar" else sp.zeros(1, 1)))]


def _with_column(found: Element, stages: Sequence[Stage]) -> Element:
    """The element with slopes and with columns of its matrix."""
    blocks, reads = found.blocks, found.reads
    rates: Rules = {}
    for block in blocks:
        rates |= along(block.rate.symbols, block.unit.symbols)
    measured = found.stages[0]
    force = found.residual[:found.coordinates]
    used = set().union(*(sp.sympify(f).free_symbols for f in force))
    inputs = [s for s, _ in measured] + list(reads)
    slopes, of = _slopes(stages, inputs, used)
    vary = varied(blocks)
    moves, moved, turned = [], {}, {}
    for symbol, value in measured:
        for letter, rules, found_moves in (("d", vary, moved), ("u", rates, turned)):
            if (move := differential(value, rules)) != 0:
                found_moves[symbol] = sp.Symbol(f"{letter}{symbol}")
                moves.append((found_moves[symbol], move))
    by_state, by_rates = _through(of, moved) | vary, _through(of, turned)
    c_damping, c_stiffness = sp.symbols("c_damping c_stiffness")
    linear = [c_stiffness * differential(f, by_state) + c_damping * differential(f, by_rates)
              for f in force]
    columns = sp.Matrix(len(force), len(reads), lambda i, k: differential(
        force[i], _through(of, {reads[k]: sp.S.One})))
    return found._replace(slopes=slopes, moves=(tuple(moves),), on_multipliers=columns,
                          linear=(*linear, *(sp.S.Zero,) * len(reads)))


def _through(of: dict, moved: Rules) -> Rules:
    """Differentials of the symbols of stages where measures move."""
    differentials = dict(moved)
    for symbol, slopes in of.items():
        differentials[symbol] = sum(slope * moved.get(by, 0) for by, slope in slopes.items())
    return differentials


def _slopes(stages: Sequence[Stage], inputs: Sequence[sp.Symbol], used: set[sp.Symbol]
            ) -> tuple[tuple[Stage, ...], dict[sp.Symbol, dict[sp.Symbol, sp.Symbol]]]:
    """Derivatives of stage symbols by measures, as stages; those that the force uses, by both."""
    of: dict[sp.Symbol, dict[sp.Symbol, sp.Expr]] = {s: {s: sp.S.One} for s in inputs}
    found: list[Stage] = []
    for stage in stages:
        lines = []
        for symbol, value in stage:
            of[symbol] = {}
            for by in inputs:
                slope = sum(value.diff(one) * of[one][by] for one in sorted(
                    value.free_symbols, key=str) if one in of and by in of[one])
                if slope != 0:
                    of[symbol][by] = sp.Symbol(f"d{symbol}_by_{by}")
                    lines.append((of[symbol][by], slope))
        found.append(tuple(lines))
    needed = {slope for symbol in used & of.keys() for slope in of[symbol].values()}
    kept: list[Stage] = []
    for lines in reversed(found):
        own = tuple(line for line in lines if line[0] in needed)
        needed |= set().union(*(value.free_symbols for _, value in own)) if own else set()
        kept.append(own)
    stage_symbols = {symbol for stage in stages for symbol, _ in stage}
    return (tuple(stage for stage in reversed(kept) if stage),
            {symbol: slopes for symbol, slopes in of.items() if symbol in stage_symbols & used})
