"""Products with the derivatives of the forces of joints, rigid bodies and loads.

Tasks, and the vectors of each element, are those of `products`. Everything is in components, and
nothing is kept between PREPARE, which leaves the forces, and the others. Elements of laws: see
`law_products`.
"""

from collections.abc import Sequence

import sympy as sp

from sebody.contract.names import element_name, products_name
from sebody.derive.form import counts
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.statements import For, If, Point, Return, Statement, compared
from sebody.derive.form.whole import Number
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elements import Element
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.element_form import (
    COEFFICIENTS,
    counted,
    known_counts,
    loads,
    places,
    stored,
)
from sebody.derive.kernels.products import ROWS, VECTORS
from sebody.derive.passes.reverse import transposed_forms
from sebody.derive.passes.unused import without_unused

DERIVATIVES = "c_stiffness", "c_damping", "c_mass"      # in the order of the vectors


def products_element(element: Element) -> Kernel:
    """Products of a linearized joint, body or load."""
    width = len(element.residual)
    residual, _ = stored(element.residual, [arrays.g[k] for k in range(width)], 0)
    along, back = _along(element), _transposed(element)
    of_element = without_unused((
        *places(element), Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.WIDTH)),
        Point(VECTORS, ARGUMENTS["matrices"].at(ROWS * (counts.element * counts.WIDTH))),
        *loads(element),
        If(compared(counts.task, "==", agreed("PREPARE")), tuple(residual)),
        If(compared(counts.task, "==", agreed("ALONG")), _stored(along, 0)),
        If(compared(counts.task, "==", agreed("TRANSPOSED")), _stored(back, width))))
    body = (For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(products_name(element_name(element.name)), body, known_counts(element), 0, 0,
                  counted(element.residual), counted(back))


def _stored(values: Sequence[sp.Expr], first: int) -> tuple[Statement, ...]:
    """Values stored from a place on."""
    return tuple(stored(values, [VECTORS[first + k] for k in range(len(values))], 0)[0])


def _columns(element: Element) -> list[tuple[list[sp.Expr], list[tuple[sp.Symbol, ...]]]]:
    """Products of K, C and M with a motion, as linear forms, and the symbols of each unknown."""
    names = [[s for block in element.blocks for s in getattr(block, of).kept]
             for of in ("direction", "unit")]
    multipliers = sp.symbols(f"dlam_1:{len(element.multipliers) + 1}")
    columns = []
    for name in DERIVATIVES:
        factors = {c: sp.Integer(str(c) in (name, "c_constraint" if name == "c_stiffness" else ""))
                   for c in COEFFICIENTS}
        forms = [sp.sympify(value).xreplace(factors) for value in element.linear]
        symbols = [tuple(dict.fromkeys(pair)) for pair in zip(*names, strict=True)]
        if name == "c_stiffness":
            for i in range(element.coordinates):
                forms[i] += sum(element.on_multipliers[i, k] * m
                                for k, m in enumerate(multipliers))
        symbols += [(m,) for m in multipliers]
        columns.append((forms, symbols))
    return columns


def _along(element: Element) -> list[sp.Expr]:
    """``K dq + C dv + M da``."""
    width = len(element.residual)
    total = [sp.S.Zero] * width
    for k, (forms, symbols) in enumerate(_columns(element), 1):
        given = {s: VECTORS[k * width + i] for i, own in enumerate(symbols) for s in own}
        total = [one + form.xreplace(given) for one, form in zip(total, forms, strict=True)]
    return total


def _transposed(element: Element) -> list[sp.Expr]:
    """``K^T w``, ``C^T w`` and ``M^T w``, one after the other."""
    weights = [VECTORS[i] for i in range(len(element.residual))]
    rows: list[sp.Expr] = []
    for forms, symbols in _columns(element):
        bars = transposed_forms(forms, weights, [s for own in symbols for s in own])
        rows += [sp.Add(*(bars.get(s, sp.S.Zero) for s in own)) for own in symbols]
    return rows
