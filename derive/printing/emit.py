"""Kernel files: the steps of a derivation set into the frame of a file."""

import ast
import re

import sympy

from sebody.derive.formulas.frames import frame_axes
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.printing import templates
from sebody.derive.printing.imports import homes, import_lines
from sebody.derive.printing.printer import StepPrinter, indented
from sebody.kernels.layout import DAMPING_CONSTANTS, SUPERELEMENT_CONSTANTS, Part
from sebody.kernels.sources import room_hash

VERSION = "1.0"
ROWS = ("qe", "ve", "ae", "y", "yd", "ydd", "acc", "s", "p", "pd", "h", "beta", "Q", "e0s", "e1s",
        "b0s", "b1s", "gamma", "d", "weight", "dqe", "dve", "dae", "dy", "dyd", "dydd", "dacc",
        "ds", "dp", "dpd", "dh", "dbeta", "dgamma", "dd", "dweight", "eta", "friction", "deta",
        "dfriction", "dg")


def names_used(text: str) -> set[str]:
    """Names of the runtime that a file uses."""
    return {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)} & set(
        homes())


def constants_text(parts: tuple[Part, ...], levels: int = 0) -> str:
    """A tuple of parts, written out over lines."""
    if not parts:
        return "()"
    return "\n".join(["(", *(indented([part_text(part) + ","], levels + 1) for part in parts),
                      indented([")"], levels)])


def part_text(part: Part) -> str:
    """A part as the call that makes it, what is default left out."""
    given = [repr(part.name), repr(part.shape)] if part.shape or part.meaning else [repr(part.name)]
    given += [repr(part.meaning)] if part.meaning else []
    given += ["columns=True"] if part.columns else []
    return f"Part({', '.join(given)})".replace("'", '"')


def constants_chain(parts: tuple[Part, ...], planar: bool) -> list[str]:
    """Pointers to the constants of a superelement, one after the other."""
    known = {"D": 2 if planar else 3}
    starts = ["constants, index[first + AT_CONSTANTS]"]
    starts += [f"{part.name}, {part.expression(known)}" for part in parts[:-1]]
    return [f"{part.name} = at({start})" for part, start in zip(parts, starts, strict=True)]


def superelement_text(kernel: Superelement) -> str:
    """The file of a superelement kernel."""
    layout, planar = kernel.layout, kernel.layout.planar
    printer = StepPrinter(kernel.space, layout, kernel.names)
    located = next(k for k, step in enumerate(kernel.residual)
                   if step.title.startswith("rotation of the frame")) + 1
    before = printer.lines(kernel.residual[:located])
    residual = printer.lines(kernel.residual[located:])
    counted = printer.operations, printer.products
    energy = [*printer.lines(kernel.energy), *templates.ENERGY_OUTPUTS[planar]]
    printer.operations = printer.products = 0
    tangent = printer.lines(kernel.tangent)
    seeds = (templates.SEEDS_PLANAR if planar else templates.SEEDS_SPATIAL).strip("\n").split("\n")
    friction = templates.FRICTION.strip("\n").split("\n") if layout.damped else []
    extra = kernel.frame.traits.constants + kernel.inertia.traits.constants
    parts = SUPERELEMENT_CONSTANTS + DAMPING_CONSTANTS * layout.damped + extra
    constants = ("SUPERELEMENT_CONSTANTS" + " + DAMPING_CONSTANTS" * layout.damped
                 + (f" + {constants_text(extra)}" if extra else ""))
    text = "\n".join([*before, *residual, *energy, *tangent, *seeds])
    rows = [row for row in ROWS if re.search(rf"\b{row}\b", text) or row in ("qe", "ve", "ae")]
    calls = {name for name in ("columns_times", "inverse_3") if name in text}
    for step in (*kernel.residual, *kernel.tangent):
        calls |= set(getattr(step, "calls", ()))
    calls = {name for name in calls if re.search(rf"\b{name}\(", text)}
    height = "padded(max(n, 9*N_ROTATIONS))"
    row_lines = [f"row = {height}"] + [f"{name} = at(work, {k}*row)"
                                       for k, name in enumerate(rows)]
    text = templates.SUPERELEMENT.format(
        layout=layout.name, frame=kernel.frame.name, inertia=kernel.inertia.name,
        positions=layout.positions, rotations=layout.rotations,
        space="motion in a plane" if planar else "motion in space",
        frame_summary=kernel.frame.traits.summary,
        inertia_summary=kernel.inertia.traits.summary,
        version=VERSION, sympy=sympy.__version__, imports="{imports}",
        modes="any number of" if layout.modes is None else layout.modes, n_modes=layout.modes,
        width="width" if layout.modes is None else layout.first_mode + layout.modes,
        first_rotation=layout.first_rotation,
        first_mode=layout.first_mode, work_rows=len(rows),
        residual_operations=counted[0], residual_products=counted[1],
        column_operations=printer.operations, column_products=printer.products, constants=constants,
        room=room_hash("kernels"), planar=planar,
        rows=indented(row_lines, 1), residual_before=indented(before, 2),
        axes=indented(frame_axes(planar), 2), residual=indented(residual, 2),
        rows_of_constants=indented(constants_chain(parts, planar), 2),
        friction="\n" * layout.damped + indented(friction, 3), damped=layout.damped,
        energy=indented(energy, 3), seeds=indented(seeds, 4), tangent=indented(tangent, 4))
    return text.replace("{imports}", import_lines(names_used(text.replace("{imports}", ""))))
