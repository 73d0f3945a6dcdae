"""Kernel files of joints and loads."""

import sympy as sp

from . import templates
from .elements import Element
from .emit import VERSION
from .printer import code, indented


def element_text(element: Element) -> str:
    """The file of a joint or load kernel."""
    coordinates = len(element.residual) - len(element.multipliers)
    width = len(element.residual)
    residual, count = _assign(element.residual, [f"g[{i}]" for i in range(width)])
    tangent, column_count = _assign(element.linear, [
        f"J[{i * width} + column]" for i in range(width)],
        ["c_place*"] * coordinates + ["c_constraint*"] * len(element.multipliers), count)
    extra, tasks = [], {"HEADER", "SIGNATURE", "TANGENT", "at"}
    if element.second:
        lines, _ = _assign(element.second, [f"g[{coordinates + i}]" for i in
                                            range(len(element.second))], start=900)
        extra += ["if task == ACCELERATION:", *("    " + line for line in lines)]
        tasks.add("ACCELERATION")
    if element.power is not None:
        lines, _ = _assign([element.power], ["power"], start=950)
        extra += ["if task == ENERGY:", *("    " + line for line in lines),
                  "    energies[8] += power"]
        tasks.add("ENERGY")
    return templates.ELEMENT.format(
        summary=element.summary, coordinates=coordinates, multipliers=len(element.multipliers),
        version=VERSION, sympy=sp.__version__, tasks=", ".join(sorted(tasks)),
        rotations=len(element.rotations), width=width,
        constants=sum(len(c.kept) for c in element.constants),
        residual_operations=_operations(element.residual),
        column_operations=_operations(element.linear),
        loads=indented(_loads(element, coordinates), 2), residual=indented(residual, 2),
        extra=indented(extra, 2), seeds=indented(_seeds(element), 4),
        tangent=indented([*_directions(element), *tangent], 4),
        multiplier_columns=indented(_multiplier_columns(element, coordinates, width), 3))


def _operations(expressions) -> int:
    temporaries, reduced = sp.cse(list(expressions), order="canonical")
    return sum(int(sp.count_ops(e)) for e in [v for _, v in temporaries] + list(reduced))


def _assign(expressions, targets, factors=None, start=0):
    temporaries, reduced = sp.cse(list(expressions), sp.numbered_symbols("t", start=start),
                                  order="canonical")
    lines = [f"{name} = {code(value)}" for name, value in temporaries]
    for k, (target, value) in enumerate(zip(targets, reduced, strict=True)):
        text = code(value)
        if factors and value != 0:
            text = f"{factors[k]}({text})"
        lines.append(f"{target} = {text if value != 0 else '0.0'}")
    return lines, start + len(temporaries)


def _loads(element: Element, coordinates: int) -> list[str]:
    """Local variables of the constants, the state and the multipliers."""
    lines, at = [], 0
    for quantity in element.constants:
        lines += [f"{s} = constant[{at + k}]" for k, s in enumerate(quantity.kept)]
        at += len(quantity.kept)
    for j, rotation in enumerate(element.rotations):
        lines += [f"{s} = R[9*nodes[{j}] + {k}]" for k, s in enumerate(rotation.symbols)]
    used = set().union(*(sp.sympify(e).free_symbols for e in (
        *element.residual, *element.second, element.power or sp.S.Zero)))
    for array, group in (("q", element.places), ("v", element.rates), ("a", element.accelerations)):
        at = 0
        for quantity in group:
            lines += [f"{s} = {array}[unknowns[{at + k}]]" for k, s in enumerate(quantity.kept)
                      if s in used]
            at += len(quantity.kept)
    lines += [f"{s} = q[unknowns[{coordinates + k}]]" for k, s in enumerate(element.multipliers)]
    if sp.Symbol("amplitude") in used:
        lines.append("amplitude = loads[index[first + 1]]")
    return lines


def _seeds(element: Element) -> list[str]:
    if not element.rotations:
        return ["dq[column] = 1.0"]
    return ["j = column//3", "for r in range(3):",
            "    dq[3*j + r] = T[9*nodes[j] + 3*r + column - 3*j]"]


def _directions(element: Element) -> list[str]:
    used = set().union(*(sp.sympify(e).free_symbols for e in element.linear))
    kept = [s for quantity in element.directions for s in quantity.kept]
    return [f"{s} = dq[{k}]" for k, s in enumerate(kept) if s in used]


def _multiplier_columns(element: Element, coordinates: int, width: int) -> list[str]:
    """Columns of the multipliers: the constraint gradient, and zero below it."""
    if not element.multipliers:
        return []
    entries = [(i * width + coordinates + k, element.on_multipliers[i, k])
               for k in range(len(element.multipliers)) for i in range(coordinates)]
    lines, _ = _assign([e for _, e in entries], [f"J[{at}]" for at, _ in entries],
                       ["c_constraint*"] * len(entries), 700)
    return lines + [f"J[{(coordinates + i) * width + coordinates + k}] = 0.0"
                    for i in range(len(element.multipliers))
                    for k in range(len(element.multipliers))]
