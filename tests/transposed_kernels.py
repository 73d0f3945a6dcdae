"""Transposed products of kernels against their matrices, both executed as plain Python."""

import numpy as np
from plain_kernels import evaluated, executed

from sebody.contract.layout import RESIDUAL, TANGENT
from sebody.derive.compiler import Variant, compile_kernel, stages_of
from sebody.derive.kernels.transposed import transposed_element, transposed_superelement
from sebody.derive.printing.numba.files import file_text
from sebody.verify.check.elements import element_case
from sebody.verify.check.superelement_cases import superelement_case

ROUNDING = 1e-12        # of the largest entry: both sum some hundred terms, in other orders
FACTORS = (0, 0, 1, 1, 1), (0, 1, 0, 1, 1), (1, 0, 0, 1, 1)     # of K, C and M


def both(kernel):
    """The kernel, its transposed products, and their operations."""
    stages = stages_of(kernel)
    linear = stages.linearize(stages.derive(kernel))
    make = transposed_superelement if isinstance(kernel, Variant) else transposed_element
    backwards = make(linear)
    text = file_text(stages.head(linear, backwards), backwards)
    return executed(compile_kernel(kernel)), executed(text), backwards.column


def superelement_error(variant: Variant, seeds=(0, 1), **options) -> float:
    """Largest difference of ``K^T w``, ``C^T w`` and ``M^T w``, relative to the largest entries.

    The first state has followers and stress resultants in option C, the second one has none.
    """
    plain, backwards, _ = both(variant)
    random, worst = np.random.default_rng(7), 0.0
    for seed in seeds:
        case = superelement_case(plain, seed, gravity=3.0, **options)
        n, w = case.n, random.normal(size=case.n)
        done = evaluated(case._replace(module=backwards), RESIDUAL,
                         matrices=np.r_[w, np.zeros(3 * n)])
        products = done.matrices[n:].reshape(3, n)
        for factors, product in zip(FACTORS, products, strict=True):
            J = evaluated(case, TANGENT, factors).matrices.reshape(n, n)
            worst = max(worst, error(product, J, w))
        assert np.array_equal(done.forces, evaluated(case, RESIDUAL).forces)
    return worst


def element_error(kind: str) -> float:
    """The same of ``J^T w`` of a joint, body or load, with any operators T."""
    plain, backwards, _ = both(kind)
    case, random = element_case(plain, 3), np.random.default_rng(1)
    count = max(case.n_rotations, 1)
    T = np.tile(np.eye(3).ravel(), count) + 0.2 * random.normal(size=9 * count)
    factors = (0.7, 0.4, 1.3, 1, 0.9)
    J = evaluated(case, TANGENT, factors, T=T).matrices.reshape(case.n, case.n)
    w = random.normal(size=case.n)
    done = evaluated(case._replace(module=backwards), RESIDUAL, factors, T=T,
                     matrices=np.r_[w, np.zeros(case.n)])
    return error(done.matrices[case.n:], J, w)


def error(product, J, w) -> float:
    """Of a transposed product."""
    return float(np.abs(product - J.T @ w).max() / max(np.abs(J).max() * np.abs(w).max(), 1e-300))
