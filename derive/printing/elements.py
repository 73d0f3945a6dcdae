"""Files of joints, rigid bodies and forces: everything written out in components."""

import sympy as sp

from sebody.derive.formulas.elements import AMPLITUDE, Block, Constant, Element
from sebody.derive.kernels.resources import Resources
from sebody.derive.printing import parts, templates
from sebody.derive.printing.expressions import code, indented, offset
from sebody.derive.printing.imports import import_lines
from sebody.kernels.layout import Part
from sebody.kernels.sources import room_hash

SUMS = {"kinetic": ("KINETIC", 0), "strain": ("STRAIN", 0), "potential": ("POTENTIAL", 0),
        "P_x": ("MOMENTUM", 0), "P_y": ("MOMENTUM", 1), "P_z": ("MOMENTUM", 2),
        "H_x": ("MOMENT", 0), "H_y": ("MOMENT", 1), "H_z": ("MOMENT", 2)}     # among the energies
COEFFICIENTS = {"c_mass": "C_MASS", "c_damping": "C_DAMPING", "c_stiffness": "C_STIFFNESS",
                "c_constraint": "C_CONSTRAINT"}


def element_text(element: Element, uses: Resources) -> str:
    """The file of an element's kernel."""
    width = len(element.residual)
    residual, count = _assign(element.residual, [f"g[{i}] = " for i in range(width)])
    column, _ = _assign(element.linear, [f"J[{i * width} + column] = " for i in range(width)],
                        count)
    names = _names(element)
    imports = import_lines(names)
    if uses.calls:
        imports = f"from math import {', '.join(uses.calls)}\n\n{imports}"
    return templates.ELEMENT.format(
        **_head(element), imports=imports, work_rows=2,
        constant=templates.CONSTANT * bool(element.constants),
        residual_operations=_operations(element.residual),
        column_operations=_operations(element.linear),
        loads=indented(_loads(element), 2), residual=indented(residual, 2),
        tasks=indented(_tasks(element), 2), coefficients=indented(_coefficients(element), 3),
        seeds=indented(_seeds(element, uses), 3),
        tangent=indented([*_directions(element), *column], 4),
        multiplier_columns=indented(_multiplier_columns(element), 3))


def _head(element: Element) -> dict[str, object]:
    """What the file says of itself."""
    return {"summary": element.summary, "coordinates": element.coordinates,
            "multipliers": len(element.multipliers), "width": len(element.residual),
            "version": templates.VERSION, "sympy": sp.__version__, "room": room_hash("kernels"),
            "signature": templates.SIGNATURE,
            "planar": element.space.planar,
            "positions": sum(not b.rotational for b in element.blocks),
            "rotations": _matrices(element), "first_rotation": _first_rotation(element),
            "constants": parts.table(map(_part, element.constants)),
            "inertial": "kinetic" in element.sums, "power": element.power is not None,
            "driven": bool(element.multipliers) and element.power is not None}


def _names(element: Element) -> set[str]:
    """Names of the runtime in the file."""
    names = {*templates.ELEMENT_NAMES, *(SUMS[name][0] for name in element.sums)}
    names |= {COEFFICIENTS[name] for name in _used_coefficients(element)}
    names |= {"VELOCITY", "ACCELERATION"} if element.multipliers else set()
    names |= {"ENERGY"} if element.sums or element.power is not None else set()
    names |= {"AT_PORT", "POWERS"} if element.power is not None else set()
    names |= {"AT_CONSTANTS", "Part"} if element.constants else set()
    names |= {"AT_PORT"} if set(AMPLITUDE) & _used(element.printed) else set()
    return names | ({"FIELD"} if set(_field(element)) & _used(element.printed) else set())


def _tasks(element: Element) -> list[str]:
    """Constraints differentiated in time; energies, power, and the forces that have this power."""
    constraints = [f"g[{element.coordinates + k}] = " for k in range(len(element.multipliers))]
    sums = [f"energies[{offset(*SUMS[name])}] += " for name in element.sums]
    power = [] if element.power is None else [element.power]
    return [*_task("VELOCITY", element.velocity, constraints),
            *_task("ACCELERATION", element.second, constraints),
            *_task("ENERGY", list(element.sums.values()), sums),
            *_task("ENERGY", power, ["energies[POWERS + index[first + AT_PORT]] = "]),
            *_task("ENERGY", element.losses, [f"g[{i}] = " for i in range(len(element.losses))])]


def _part(constant: Constant) -> Part:
    """A constant as a part of the row: a number, or the components that are stored."""
    quantity, meaning = constant
    shape = () if quantity.kind == "scalar" else (len(quantity.kept),)
    return Part(quantity.name, shape, meaning)


def _matrices(element: Element) -> int:
    """Rotation matrices it reads; in a plane there are angles instead."""
    return 0 if element.space.planar else sum(b.rotational for b in element.blocks)


def _first_rotation(element: Element) -> int:
    return sum(len(b.direction.kept) for b in element.blocks if not b.rotational)


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


def _used(expressions) -> set[sp.Symbol]:
    return set().union(*(sp.sympify(e).free_symbols for e in expressions))


def _field(element: Element) -> list[sp.Symbol]:
    """Gravity, where it acts."""
    return element.space.known["field"].kept if "field" in element.space.known else []


def _loads(element: Element) -> list[str]:
    """Local variables of the constants, the state and the multipliers."""
    used = _used(element.printed)
    row = [s for quantity, _ in element.constants for s in quantity.kept]
    lines = [f"{s} = constant[{k}]" for k, s in enumerate(row) if s in used]
    lines += [f"{s} = coefficients[{offset('FIELD', k)}]"
              for k, s in enumerate(_field(element)) if s in used]
    at, matrix = 0, 0
    for block in element.blocks:
        lines += _state(block, at, matrix, used)
        for array, quantity in (("v", block.rate), ("a", block.acceleration)):
            lines += [f"{s} = {array}[unknowns[{at + k}]]" for k, s in enumerate(quantity.kept)
                      if s in used]
        at += len(block.direction.kept)
        matrix += block.rotational
    lines += [f"{s} = q[unknowns[{element.coordinates + k}]]"
              for k, s in enumerate(element.multipliers)]
    return lines + [f"{s} = loads[{offset('3*index[first + AT_PORT]', k)}]"
                    for k, s in enumerate(AMPLITUDE) if s in used]


def _state(block: Block, at: int, matrix: int, used: set) -> list[str]:
    kept = block.state.kept
    if not block.rotational:
        return [f"{s} = q[unknowns[{at + k}]]" for k, s in enumerate(kept) if s in used]
    if block.angle is None:
        return [f"{s} = R[9*nodes[{matrix}] + {k}]" for k, s in enumerate(kept) if s in used]
    lines = [f"{s} = {f}(q[unknowns[{at}]])" for s, f in zip(kept, ("cos", "sin"), strict=True)
             if s in used]
    return lines + ([f"{block.angle} = q[unknowns[{at}]]"] if block.angle in used else [])


def _used_coefficients(element: Element) -> list[str]:
    used = {str(s) for s in _used([*element.linear, *element.on_multipliers])}
    used |= {"c_constraint"} if element.multipliers else set()
    return [name for name in COEFFICIENTS if name in used]


def _coefficients(element: Element) -> list[str]:
    return [f"{name} = coefficients[{COEFFICIENTS[name]}]" for name in _used_coefficients(element)]


def _seeds(element: Element, uses: Resources) -> list[str]:
    """Directions of a column: of a rotation its variation goes through T."""
    first, further = _first_rotation(element), uses.rows[1:]
    lines = [f"{row} = at(work, WIDTH)" for row in further]
    lines += [f"for column in range({element.coordinates}):",
              f"    for i in range({element.coordinates}):",
              *(f"        {row}[i] = 0.0" for row in uses.rows),
              *(f"    {row}[column] = 1.0" for row in further)]
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


def _multiplier_columns(element: Element) -> list[str]:
    """Columns of the multipliers: the constraint gradient, and zero below it."""
    count, coordinates, width = (len(element.multipliers), element.coordinates,
                                 len(element.residual))
    entries = [(i * width + coordinates + k, sp.Symbol("c_constraint")
                * element.on_multipliers[i, k])
               for k in range(count) for i in range(coordinates)]
    lines, _ = _assign([e for _, e in entries], [f"J[{at}] = " for at, _ in entries], 700)
    return lines + [f"J[{(coordinates + i) * width + coordinates + k}] = 0.0"
                    for i in range(count) for k in range(count)]
