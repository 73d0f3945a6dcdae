"""Products with derivatives of kernels against their matrices, both executed as plain Python."""

import numpy as np
from plain_kernels import evaluated, executed

from sebody.contract.counts import whole_vectors
from sebody.contract.layout import ALONG, OK, PREPARE, RESIDUAL, TANGENT, TRANSPOSED
from sebody.derive.compiler import Products, Variant, compile_kernel, statements_of
from sebody.verify.check.elements import element_case
from sebody.verify.check.states import arguments, scratch
from sebody.verify.check.superelement_cases import superelement_case

ROUNDING = 1e-12        # of the largest entry: both sum some hundred terms, in other orders
FACTORS = (0, 0, 1, 1, 1), (0, 1, 0, 1, 0), (1, 0, 0, 1, 0)     # of K, C and M


def both(kernel):
    """The kernel, its products, and the operations of these."""
    return (executed(compile_kernel(kernel)), executed(compile_kernel(Products(kernel))),
            statements_of(Products(kernel)).column)


def superelement_error(variant: Variant, seeds=(0, 1), **options) -> float:
    """Largest difference of products, relative to the largest entries.

    The first state has followers and stress resultants in option C, the second one has none.
    """
    plain, products, _ = both(variant)
    return max(error(superelement_case(plain, seed, gravity=3.0, **options), products, seed)
               for seed in seeds)


def element_error(kind: str) -> float:
    """The same of a joint, body or load."""
    plain, products, _ = both(kind)
    return error(element_case(plain, 3), products, 1)


def error(case, products, seed) -> float:
    """Of ``K^T w``, ``C^T w`` and ``M^T w``, and of ``K dq + C dv + M da``."""
    n, random, own = case.n, np.random.default_rng(seed), case._replace(module=products)
    K, C, M = (evaluated(case, TANGENT, factors).matrices.reshape(n, n) for factors in FACTORS)
    given = arguments(own)._replace(
        matrices=np.zeros(4 * n), work=np.zeros(whole_vectors(products.KEPT) + scratch(own)))

    def call(task):
        assert products.kernel(task, 1, len(case.index), n, *given) == OK
    call(PREPARE)
    assert np.allclose(given.forces, evaluated(case, RESIDUAL).forces, rtol=1e-13, atol=1e-13)
    vectors, worst = given.matrices.reshape(4, n), 0.0
    vectors[0] = w = random.normal(size=n)
    call(TRANSPOSED)
    for A, product in zip((K, C, M), vectors[1:], strict=True):
        worst = max(worst, relative(product - A.T @ w, A))
    vectors[1:] = directions = random.normal(size=(3, n))
    call(ALONG)
    exact = sum(A @ d for A, d in zip((K, C, M), directions, strict=True))
    return max(worst, relative(vectors[0] - exact, K, C, M))


def relative(difference, *matrices) -> float:
    """Of the largest entry of some matrices."""
    return float(np.abs(difference).max() / max(max(np.abs(A).max() for A in matrices), 1e-300))
