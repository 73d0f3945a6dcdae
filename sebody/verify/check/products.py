"""Criteria of products with derivatives: against the matrices of the kernel that has the forces."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.counts import whole_vectors
from sebody.contract.layout import ALONG, PREPARE, RESIDUAL, TANGENT, TRANSPOSED
from sebody.contract.names import PRODUCTS, SUPERELEMENT
from sebody.kernels.abi import Arguments
from sebody.kernels.loader import load
from sebody.verify.check.body_loads import body_load_case
from sebody.verify.check.elements import element_case
from sebody.verify.check.states import STATES, Case, CheckRow, arguments, called, scratch
from sebody.verify.check.superelement_cases import nodes_of, superelement_case

LIMIT = 1e-12       # of the largest entry: both sum some hundred terms, in other orders
PARTS = (0, 0, 1, 1, 1), (0, 1, 0, 1, 0), (1, 0, 0, 1, 0)      # coefficients that leave K, C, M
GRAVITY, DAMPING = 3.0, 0.3


def cases(name: str) -> list[tuple[Case, tuple[int, ...]]]:
    """Generic states of the kernel with the forces, and nodes and modes of a general one."""
    of = load(name.removeprefix(PRODUCTS))
    if of.__name__.rpartition(".")[2].startswith(SUPERELEMENT):
        damping = DAMPING if of.DAMPED is not False else 0.0
        return [(superelement_case(of, seed, gravity=GRAVITY, damping=damping, nodes=nodes),
                 tuple(nodes)) for nodes in nodes_of(of) for seed in range(STATES)]
    if hasattr(of, "FRAME"):
        return [(body_load_case(of, seed, nodes), tuple(nodes)) for nodes in nodes_of(of)
                for seed in range(STATES)]
    return [(element_case(of, seed), ()) for seed in range(STATES)]


def _call(case: Case, task: int, given: Arguments) -> Arguments:
    if status := called(case, task, given):
        raise InputError(f"kernel {case.module.__name__} refuses the check's state (status "
                         f"{status})")
    return given


def _matrices(case: Case) -> list[NDArray]:
    """K, C and M, positions in axes of the frame."""
    return [_call(case, TANGENT, arguments(case, part)).matrices.reshape(case.n, case.n)
            for part in PARTS]


def _prepared(case: Case, module: ModuleType) -> tuple[Case, Arguments]:
    """Products in a state, ready for the others."""
    own = case._replace(module=module)
    room = scratch(own) + whole_vectors(module.KEPT)
    given = arguments(own)._replace(matrices=np.zeros(4 * case.n), work=np.zeros(room))
    return own, _call(own, PREPARE, given)


def _error(found: NDArray, exact: NDArray, size: float) -> float:
    return float(np.abs(found - exact).max() / max(size, 1e-300))


def forces(case: Case, module: ModuleType, random: np.random.Generator) -> float:
    """Forces against those of the other kernel."""
    exact = _call(case, RESIDUAL, arguments(case)).forces
    return _error(_prepared(case, module)[1].forces, exact, np.abs(exact).max())


def transposed(case: Case, module: ModuleType, random: np.random.Generator) -> float:
    """``K^T w``, ``C^T w`` and ``M^T w``, twice in one state."""
    own, given = _prepared(case, module)
    worst, found = 0.0, given.matrices.reshape(4, case.n)
    for _ in range(2):
        found[0] = w = random.normal(size=case.n)
        _call(own, TRANSPOSED, given)
        worst = max(worst, *(_error(product, A.T @ w, np.abs(A).max()) for A, product in zip(
            _matrices(case), found[1:], strict=True)))
    return worst


def along(case: Case, module: ModuleType, random: np.random.Generator) -> float:
    """``K dq + C dv + M da``, after a product with weights."""
    own, given = _prepared(case, module)
    found = given.matrices.reshape(4, case.n)
    found[:] = random.normal(size=found.shape)
    _call(own, TRANSPOSED, given)
    found[1:] = directions = random.normal(size=(3, case.n))
    _call(own, ALONG, given)
    parts = _matrices(case)
    exact = sum(A @ d for A, d in zip(parts, directions, strict=True))
    return _error(found[0], exact, max(np.abs(A).max() for A in parts))


CRITERIA = {"forces": forces, "products with weights": transposed, "products with motions": along}


def check_products(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of products with the derivatives of a kernel."""
    return [CheckRow(name, criterion, k % STATES, measure(case, module, np.random.default_rng(k)),
                     None, LIMIT, nodes)
            for k, (case, nodes) in enumerate(cases(name))
            for criterion, measure in CRITERIA.items()]
