"""Criteria of products with the derivatives of laws, which keep numbers from step to step.

Motions are compared with the matrices of the kernel that has the forces, kept numbers and constants
with differences of what this kernel gives; products with weights with those of motions.
"""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import ALONG, AT_FRAME, PREPARE, RESIDUAL, TANGENT, TRANSPOSED
from sebody.contract.names import PRODUCTS
from sebody.kernels.loader import load
from sebody.verify.check import laws
from sebody.verify.check.elements import element_case
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    arguments,
    called,
    derivative,
    moved,
)

EXACT = 1e-12       # of the largest entry: both sum some hundred terms, in other orders
PARTS = (0, 0, 1, 1, 1), (0, 1, 0, 1, 0)        # coefficients that leave K and C


class _Held:
    """Products in a state."""

    def __init__(self, case: Case, module: ModuleType):
        self.case = case._replace(module=module)
        self.n, self.kept, self.turns = case.n, len(module.MEMORY), 3 * len(case.rotations)
        self.given = arguments(self.case)._replace(matrices=np.zeros(4 * case.n),
                                                   work=np.zeros(module.KEPT))
        self.vectors = self.given.matrices.reshape(4, case.n)
        work, k = self.given.work, self.kept
        self.old, self.new, self.increments, self.constants = (
            work[:k], work[k:2 * k], work[2 * k:2 * k + self.turns], work[2 * k + self.turns:])
        called(self.case, PREPARE, self.given)

    @property
    def values(self) -> NDArray:
        """Forces and kept numbers."""
        first = self.case.index[AT_FRAME]
        return np.r_[self.given.forces, self.given.frames[first:first + self.kept]]

    def along(self, motion: NDArray, rates: NDArray, old: NDArray, increments: NDArray,
              constants: NDArray) -> NDArray:
        """Changes of forces and kept numbers."""
        self.vectors[1:] = motion, rates, 0.0 * rates
        self.old[:], self.increments[:], self.constants[:] = old, increments, constants
        called(self.case, ALONG, self.given)
        self.constants[:] = 0.0
        return np.r_[self.vectors[0], self.new]

    def transposed(self, weights: NDArray) -> tuple[NDArray, ...]:
        """Bars of motion, rates, kept numbers and increments; second rates get none."""
        self.vectors[0], self.new[:] = weights[:self.n], weights[self.n:]
        called(self.case, TRANSPOSED, self.given)
        assert not self.vectors[3].any()
        return tuple(x.copy() for x in (self.vectors[1], self.vectors[2], self.old,
                                        self.increments))


def _values(case: Case) -> NDArray:
    """Forces and kept numbers of the other kernel."""
    given = arguments(case)
    called(case, RESIDUAL, given)
    first = case.index[AT_FRAME]
    return np.r_[given.forces, given.frames[first:first + len(case.module.MEMORY)]]


def _matrix(case: Case, part: tuple[int, ...]) -> NDArray:
    given = arguments(case, part)
    called(case, TANGENT, given)
    return given.matrices.reshape(case.n, case.n)


def _turned(case: Case, motion: NDArray) -> NDArray:
    """Increments of rotations in space that go with a motion."""
    return np.concatenate([np.zeros(0), *(motion[at:at + 3] for at in case.rotations)])


def _relative(found: NDArray, exact: NDArray, size: float) -> float:
    return float(np.abs(found - exact).max() / max(size, np.abs(exact).max(), 1e-9))


def values(case: Case, held: _Held, random: np.random.Generator) -> float:
    """Forces and kept numbers against those of the other kernel."""
    exact = _values(case)
    return _relative(held.values, exact, 0.0)


def along(case: Case, held: _Held, random: np.random.Generator) -> float:
    """Products with a motion against the matrices."""
    motion, rates = random.normal(size=(2, case.n))
    K, C = (_matrix(case, part) for part in PARTS)
    found = held.along(motion, rates, 0.0 * held.old, _turned(case, motion), 0.0 * held.constants)
    # sliding forces may not depend on the motion, so what they do is rounding of theirs
    size = max(np.abs(A).max() for A in (K, C, held.given.forces))
    return _relative(found[:case.n], K @ motion + C @ rates, size)


def transposed(case: Case, held: _Held, random: np.random.Generator) -> float:
    """Products with weights against products with motions, everything kept included."""
    weights = random.normal(size=case.n + held.kept)
    changes = [random.normal(size=size) for size in (case.n, case.n, held.kept, held.turns)]
    exact = weights * held.along(*changes, 0.0 * held.constants)
    found = np.concatenate([b * c for b, c in zip(held.transposed(weights), changes, strict=True)])
    return float(abs(found.sum() - exact.sum()) / max(
        np.abs(found).max(), np.abs(exact).max(), 1e-9))


def differences(case: Case, held: _Held, random: np.random.Generator) -> float:
    """Changes with kept numbers, motion and constants against differences."""
    motion, rates = random.normal(size=(2, case.n))
    old, first = random.normal(size=held.kept), case.index[AT_FRAME]
    flags = [k for k, name in enumerate(case.module.MEMORY) if name in ("slid", "impact")]
    old[flags] = 0.0
    constants = random.normal(size=len(held.constants)) * case.constants[:len(held.constants)]
    reference = np.zeros(len(case.reference))
    reference[first:first + held.kept] = old

    def changed(s: float) -> NDArray:
        own = np.r_[case.constants[:len(constants)] + s * constants,
                    case.constants[len(constants):]]
        return _values(moved(case, motion, s)._replace(
            v=case.v + s * rates, reference=case.reference + s * reference, constants=own))
    exact = derivative(changed, laws.SMALL)
    found = held.along(motion, rates, old, _turned(case, motion), constants)
    return _relative(found, exact, 0.0)


CRITERIA = {"forces and kept numbers": (values, EXACT), "products with motions": (along, EXACT),
            "products with weights": (transposed, EXACT),
            "changes of kept numbers and constants": (differences, LIMIT)}


def check_law_products(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria in all branches of the law."""
    of, rows = load(name.removeprefix(PRODUCTS)), []
    for seed in range(STATES):
        for branch, case in laws.cases(of, element_case(of, seed)).items():
            held = _Held(case, module)
            for criterion, (measure, limit) in CRITERIA.items():
                error = measure(case, held, np.random.default_rng(seed))
                rows.append(CheckRow(name, f"{criterion}, {branch}".rstrip(", "), seed, error,
                                     None, limit))
    return rows
