"""Kernel files of joints, rigid bodies and forces."""

import re

import sympy as sp

from sebody.derive.formulas.elements import AMPLITUDE, Block, Constant, Element
from sebody.derive.printing import templates
from sebody.derive.printing.emit import VERSION, constants_text, names_used
from sebody.derive.printing.imports import import_lines
from sebody.derive.printing.printer import code, indented
from sebody.kernels.layout import Part
from sebody.kernels.sources import room_hash

SUMS = {"kinetic": "KINETIC", "strain": "STRAIN", "potential": "POTENTIAL", "P_x": "MOMENTUM",
        "P_y": "MOMENTUM + 1", "P_z": "MOMENTUM + 2", "H_x": "MOMENT", "H_y": "MOMENT + 1",
        "H_z": "MOMENT + 2"}     # places among the energies
COEFFICIENTS = {"c_mass": "C_MASS", "c_rate": "C_RATE", "c_place": "C_PLACE",
                "c_constraint": "C_CONSTRAINT"}
FUNCTIONS = ("atan2", "cos", "sin", "sqrt")


def element_text(element: Element) -> str:
    """The file of an element's kernel."""
    coordinates = len(element.residual) - len(element.multipliers)
    width = len(element.residual)
    residual, count = _assign(element.residual, [f"g[{i}] = " for i in range(width)])
    column, _ = _assign(element.linear, [f"J[{i * width} + column] = " for i in range(width)],
                        count)
    tasks = [*_task("VELOCITY", element.velocity, [f"g[{coordinates + k}] = " for k in
                                                   range(len(element.velocity))]),
             *_task("ACCELERATION", element.second, [f"g[{coordinates + k}] = " for k in
                                                     range(len(element.second))]),
             *_task("ENERGY", list(element.sums.values()),
                    [f"energies[{SUMS[name]}] += " for name in element.sums]),
             *_task("ENERGY", [] if element.power is None else [element.power],
                    ["energies[POWERS + index[first + AT_ITEM]] = "])]
    parts = {"loads": indented(_loads(element, coordinates), 2), "residual": indented(residual, 2),
             "tasks": indented(tasks, 2),
             "coefficients": indented(_coefficients(element), 3),
             "seeds": indented(_seeds(element, coordinates), 3),
             "tangent": indented([*_directions(element), *column], 4),
             "multiplier_columns": indented(_multiplier_columns(element, coordinates, width), 3)}
    text = "\n".join(parts.values())
    functions = [f for f in FUNCTIONS if re.search(rf"\b{f}\(", text)]
    text = templates.ELEMENT.format(
        summary=element.summary, coordinates=coordinates, multipliers=len(element.multipliers),
        version=VERSION, sympy=sp.__version__, imports="{imports}", room=room_hash("kernels"),
        functions=f"from math import {', '.join(functions)}\n\n" if functions else "",
        positions=sum(not b.turns for b in element.blocks),
        rotations=_matrices(element), width=width, first_rotation=_first_rotation(element),
        constants=constants_text(tuple(map(_part, element.constants))),
        planar=element.space.planar, inertial="kinetic" in element.sums,
        power=element.power is not None, driven=bool(element.multipliers) and
        element.power is not None,
        residual_operations=_operations(element.residual),
        column_operations=_operations(element.linear), **parts)
    return text.replace("{imports}", import_lines(names_used(text.replace("{imports}", ""))))


def _part(constant: Constant) -> Part:
    """A constant as a part of the row: a number, or the components that are stored."""
    quantity, meaning = constant
    shape = () if quantity.kind == "scalar" else (len(quantity.kept),)
    return Part(quantity.name, shape, meaning)


def _matrices(element: Element) -> int:
    """Rotation matrices it reads; in a plane there are angles instead."""
    return 0 if element.space.planar else sum(b.turns for b in element.blocks)


def _first_rotation(element: Element) -> int:
    return sum(len(b.direction.kept) for b in element.blocks if not b.turns)


def _operations(expressions) -> int:
    temporaries, reduced = sp.cse(list(expressions), order="canonical")
    return sum(int(sp.count_ops(e)) for e in [v for _, v in temporaries] + list(reduced))


def _assign(expressions, targets, start=0):
    temporaries, reduced = sp.cse(list(expressions), sp.numbered_symbols("t", start=start),
                                  order="canonical")
    lines = [f"{name} = {code(value)}" for name, value in temporaries]
    lines += [f"{target}{code(value) if value != 0 else '0.0'}"
              for target, value in zip(targets, reduced, strict=True)]
    return lines, start + len(temporaries)


def _task(name: str, expressions, targets) -> list[str]:
    """Lines under an ``if`` of their own, with temporaries of their own."""
    if not expressions:
        return []
    lines, _ = _assign(expressions, targets, start=900)
    return [f"if task == {name}:", *("    " + line for line in lines)]


def _used(*groups) -> set[sp.Symbol]:
    return set().union(*(sp.sympify(e).free_symbols for group in groups for e in group))


def _loads(element: Element, coordinates: int) -> list[str]:
    """Local variables of the constants, the state and the multipliers."""
    used = _used(element.residual, element.linear, element.velocity, element.second,
                 element.sums.values(), [] if element.power is None else [element.power])
    lines, at = [], 0
    for quantity, _ in element.constants:
        lines += [f"{s} = constant[{at + k}]" for k, s in enumerate(quantity.kept) if s in used]
        at += len(quantity.kept)
    field = element.space.known.get("field")
    if field:
        places = ("FIELD", "FIELD + 1", "FIELD + 2")
        lines += [f"{s} = coefficients[{place}]" for place, s in zip(places, field.kept,
                                                                     strict=False) if s in used]
    at, matrix = 0, 0
    for block in element.blocks:
        lines += _state(block, at, matrix, used)
        for array, quantity in (("v", block.rate), ("a", block.acceleration)):
            lines += [f"{s} = {array}[unknowns[{at + k}]]" for k, s in enumerate(quantity.kept)
                      if s in used]
        at += len(block.direction.kept)
        matrix += block.turns
    lines += [f"{s} = q[unknowns[{coordinates + k}]]" for k, s in enumerate(element.multipliers)]
    return lines + [f"{s} = loads[3*index[first + AT_ITEM] + {k}]" for k, s in enumerate(AMPLITUDE)
                    if s in used]


def _state(block: Block, at: int, matrix: int, used: set) -> list[str]:
    kept = block.state.kept
    if not block.turns:
        return [f"{s} = q[unknowns[{at + k}]]" for k, s in enumerate(kept) if s in used]
    if block.angle is None:
        return [f"{s} = R[9*nodes[{matrix}] + {k}]" for k, s in enumerate(kept) if s in used]
    lines = [f"{s} = {f}(q[unknowns[{at}]])" for s, f in zip(kept, ("cos", "sin"), strict=True)
             if s in used]
    return lines + ([f"{block.angle} = q[unknowns[{at}]]"] if block.angle in used else [])


def _units(element: Element) -> set[sp.Symbol]:
    return {s for b in element.blocks for s in b.unit.kept} & _used(element.linear)


def _coefficients(element: Element) -> list[str]:
    used = {str(s) for s in _used(element.linear, element.on_multipliers)}
    used |= {"c_constraint"} if element.multipliers else set()
    return [f"{name} = coefficients[{place}]" for name, place in COEFFICIENTS.items()
            if name in used]


def _seeds(element: Element, coordinates: int) -> list[str]:
    """Directions of a column: of a rotation its variation goes through T."""
    unit, first = bool(_units(element)), _first_rotation(element)
    lines = ["du = at(work, WIDTH)"] if unit else []
    lines += [f"for column in range({coordinates}):",
              f"    for i in range({coordinates}):", "        dq[i] = 0.0",
              *(["        du[i] = 0.0"] if unit else [])]
    lines += ["    du[column] = 1.0"] if unit else []
    if not _matrices(element):
        return [*lines, "    dq[column] = 1.0"]
    turn = [f"j = (column - {first})//3" if first else "j = column//3", "for r in range(3):",
            f"    dq[{first} + 3*j + r] = T[9*nodes[j] + 3*r + column - {first} - 3*j]"]
    if not first:
        return [*lines, *("    " + line for line in turn)]
    return [*lines, f"    if column >= {first}:", *("        " + line for line in turn),
            "    else:", "        dq[column] = 1.0"]


def _directions(element: Element) -> list[str]:
    used, lines = _used(element.linear), []
    for array, kind in (("dq", "direction"), ("du", "unit")):
        kept = [s for block in element.blocks for s in getattr(block, kind).kept]
        lines += [f"{s} = {array}[{k}]" for k, s in enumerate(kept) if s in used]
    return lines


def _multiplier_columns(element: Element, coordinates: int, width: int) -> list[str]:
    """Columns of the multipliers: the constraint gradient, and zero below it."""
    if not element.multipliers:
        return []
    count = len(element.multipliers)
    entries = [(i * width + coordinates + k, sp.Symbol("c_constraint")
                * element.on_multipliers[i, k])
               for k in range(count) for i in range(coordinates)]
    lines, _ = _assign([e for _, e in entries], [f"J[{at}] = " for at, _ in entries], 700)
    return lines + [f"J[{(coordinates + i) * width + coordinates + k}] = 0.0"
                    for i in range(count) for k in range(count)]
