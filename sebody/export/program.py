"""Outputs in the making: what compiled code evaluates, and what that gives in given states."""

from collections.abc import Callable, Iterable, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.channels import Channel
from sebody.assembly.motions import Motions, motions
from sebody.assembly.numbering import Numbering
from sebody.contract.law_row import OUTSIDE
from sebody.contract.layout import MOTION
from sebody.engine.control_data import CHANNEL_NUMBERS, CHANNEL_PLACES
from sebody.engine.state import State
from sebody.export.quantities import (
    BELOW_HALF,
    BODY,
    COSINE,
    FACTORS,
    FORCE,
    NOW,
    OF_ENERGY,
    ONE,
    POSITIVE,
    RESIDUES,
    SINE,
    SUM,
    VALUE,
    Outputs,
)
from sebody.model.mechanism import Mechanism

NONE = ONE, 0
FUNCTIONS: dict[int, Callable[[NDArray], NDArray]] = {
    COSINE: np.cos, SINE: np.sin, POSITIVE: lambda x: (x > 0.0).astype(float),
    BELOW_HALF: lambda x: (x < 0.5).astype(float)}


class Term(NamedTuple):
    """A product of a weight and some numbers."""

    weight: float
    factors: tuple[tuple[int, int], ...] = ()       # what each is of, and its place

    def times(self, *factors: tuple[int, int], weight: float = 1.0) -> "Term":
        """The same with more factors."""
        return Term(weight * self.weight, (*self.factors, *factors))


class Program:
    """Outputs in the order of evaluation.

    Parameters
    ----------
    asked : int
        Outputs that are asked for; others, which they are made of, come behind them.
    """

    def __init__(self, asked: int):
        self.channels: list[Channel | None] = [None] * asked
        self.terms: list[tuple[int, Term]] = []
        self.roots: list[int] = []
        self.choices: list[tuple[int, int, int]] = []
        self.bodies: dict[str, tuple[Motions, int]] = {}
        self.moved = 0

    def add(self, terms: Iterable[Term]) -> int:
        """An output more, by its terms; returns its place."""
        self.channels.append(None)
        self.put(len(self.channels) - 1, terms)
        return len(self.channels) - 1

    def put(self, k: int, terms: Iterable[Term]) -> None:
        """Terms of an output, which contain outputs with terms before these alone."""
        self.terms += [(k, term) for term in terms]

    def put_root(self, k: int, terms: Iterable[Term]) -> None:
        """Let an output be the root of what its terms make."""
        self.put(k, terms)
        self.roots.append(k)

    def motion(self, model: Mechanism, numbering: Numbering, name: str
               ) -> tuple[dict[str, slice], Motions]:
        """Where numbers of the motion of a body are."""
        if name not in self.bodies:
            group, = motions(model, numbering, [model.bodies[name]])
            self.bodies[name] = group, self.moved
            self.moved += group.size
        group, first = self.bodies[name]
        return {part: slice(first + own.start, first + own.stop)
                for part, own in MOTION.slices(group.counts).items()}, group

    def evaluated(self, numbers: dict[int, NDArray], known: dict[int, NDArray]) -> list[NDArray]:
        """All outputs in some states, (n,) each.

        Parameters
        ----------
        numbers : dict
            (n, numbers) of every kind but VALUE and functions.
        known : dict
            What channels read.
        """
        n = len(numbers[NOW])
        values = [known.get(k, np.zeros(n)) for k in range(len(self.channels))]
        for k, term in self.terms:
            values[k] = values[k] + product_of(term, numbers, values)
        for k in self.roots:
            values[k] = np.sqrt(np.maximum(values[k], 0.0))
        for k, rows in groupby(self.choices, key=lambda row: row[0]):
            own = list(rows)
            largest = np.argmax([values[row[1]] for row in own], axis=0)
            values[k] = np.choose(largest, [values[row[2]] for row in own])
        return values

    def outputs(self, state: State | None) -> Outputs:
        """Arrays for compiled code."""
        outside = Channel(np.array([OUTSIDE] + [0] * CHANNEL_PLACES), np.zeros(CHANNEL_NUMBERS))
        channels = [one or outside for one in self.channels]
        rows = [(k, *(n for factor in (*term.factors, *(NONE,) * FACTORS)[:FACTORS]
                      for n in factor)) for k, term in self.terms]
        kinds = {kind for _, term in self.terms for kind, _ in term.factors}
        needs = bool(kinds & {FORCE, SUM}), OF_ENERGY in kinds, RESIDUES in kinds
        sizes = [state.now.size, state.loads.size, state.residual.size, state.frames.size
                 ] if state else [0] * 4
        groups = list(self.bodies.values())
        strides = [group.index.shape[1] for group, _ in groups]
        starts = np.cumsum([0, *strides]), np.cumsum([0, *(g.constants.size for g, _ in groups)])
        bodies = [(group.address, strides[k], group.counts["n"], starts[0][k], starts[1][k], first)
                  for k, (group, first) in enumerate(groups)]
        return Outputs(
            _whole([one.places for one in channels], 1 + CHANNEL_PLACES),
            np.array([one.numbers for one in channels], dtype=float).reshape(-1, CHANNEL_NUMBERS),
            _whole(rows, 1 + 2 * FACTORS),
            np.array([term.weight for _, term in self.terms], dtype=float),
            np.array(self.roots, dtype=np.int64), _whole(self.choices, 3), _whole(bodies, BODY),
            np.concatenate([group.index.ravel() for group, _ in groups] or [_whole([], 1).ravel()]),
            np.concatenate([group.constants for group, _ in groups] or [np.zeros(0)]),
            np.array(needs, dtype=np.int64), np.zeros(len(channels)), np.zeros(self.moved),
            np.zeros(2), np.zeros(sizes[0]), np.zeros(sizes[1]), np.zeros(sizes[2]),
            np.zeros(sizes[3]), np.zeros(max((group.scratch for group, _ in groups), default=0)))


def product_of(term: Term, numbers: dict[int, NDArray], values: Sequence[NDArray] = ()) -> NDArray:
    """A product in some states, (n,)."""
    product = np.full(len(numbers[NOW]), term.weight)
    for kind, place in term.factors:
        product = product * (values[place] if kind == VALUE else
                             FUNCTIONS[kind](numbers[NOW][:, place]) if kind in FUNCTIONS else
                             numbers[kind][:, place])
    return product


def _whole(rows: Sequence, width: int) -> NDArray:
    return np.array(rows, dtype=np.int64).reshape(-1, width)
