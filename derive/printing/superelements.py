"""Files of superelement kernels: the steps of a derivation set into the frame of a file."""

from collections import Counter

import sympy

from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.resources import TALL, Resources
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.printing import parts, templates
from sebody.derive.printing.expressions import indented
from sebody.derive.printing.imports import import_lines
from sebody.derive.printing.step_printer import StepPrinter, product_name
from sebody.kernels.layout import DAMPING_CONSTANTS, MARGIN, SUPERELEMENT_CONSTANTS
from sebody.kernels.sources import room_hash


def superelement_text(kernel: Superelement, uses: Resources) -> str:
    """The file of a superelement kernel."""
    layout, planar = kernel.layout, kernel.layout.planar
    printer = StepPrinter(kernel.space, layout, kernel.names)
    residual = printer.lines(kernel.residual)
    in_residual = counted(printer)
    energy = [*printer.lines(kernel.energy), *templates.ENERGY_OUTPUTS[planar]]
    energy += templates.FRICTION_FIELD * kernel.options[1].traits.rates
    prepared = printer.lines(kernel.prepared)
    printer.operations, printer.products = Counter(), 0
    tangent = printer.lines(kernel.tangent)
    return templates.SUPERELEMENT.format(
        **_head(kernel), **_constants(kernel), imports=import_lines(_names(kernel, uses)),
        filled=templates.FILLED * any(", filled)" in line for line in [*residual, *tangent]),
        matrix_rows=indented([*["row = hidden(row)"] * (layout.modes is None),
                              *scratch_rows(uses, of_matrix=True)], 3),
        reference=templates.REFERENCE * ("reference" in uses.pointers),
        work_rows=len(uses.rows) + sum(TALL[name] for name in uses.tall),
        work_squares=len(uses.squares),
        reads=indented(reads(layout), 1) + "\n" * (layout.nodes is None),
        rows=indented([*sizes(layout, uses), *scratch_rows(uses)], 2),
        residual_operations=in_residual, column_operations=counted(printer),
        residual=indented(residual, 2), sums=_sums(kernel), prepared=_prepared(prepared),
        energy=indented(energy, 3), seeds=indented(templates.SEEDS[planar], 4),
        tangent=indented(tangent, 4))


def _head(kernel: Superelement) -> dict[str, object]:
    """What the file says of itself."""
    layout, (frame, inertia) = kernel.layout, kernel.options
    return {"layout": layout.name, "frame": kernel.frame, "inertia": kernel.inertia,
            "frame_summary": frame.traits.summary, "inertia_summary": inertia.traits.summary,
            "planar": layout.planar, "positions": layout.positions,
            "rotations": layout.rotations, "nodes": _nodes(layout),
            "first_rotation": layout.first_rotation,
            "first_mode": layout.first_mode, "n_modes": layout.modes,
            "damped": None if inertia.traits.rates else layout.damped,
            "space": "motion in a plane" if layout.planar else "motion in space",
            "modes": "any number of" if layout.modes is None else layout.modes,
            "version": templates.VERSION, "sympy": sympy.__version__,
            "signature": templates.SIGNATURE, "room": room_hash("kernels")}


def _constants(kernel: Superelement) -> dict[str, str]:
    """The table of the constants, and the pointers to them."""
    damped = kernel.layout.damped
    row = SUPERELEMENT_CONSTANTS + DAMPING_CONSTANTS * damped + kernel.declared
    table = "SUPERELEMENT_CONSTANTS" + " + DAMPING_CONSTANTS" * damped
    table += f" + {parts.table(kernel.declared)}" if kernel.declared else ""
    return {"constants": table, "chain": indented(parts.chain(row, kernel.layout.planar), 2)}


def _names(kernel: Superelement, uses: Resources) -> set[str]:
    """Names of the runtime in the file."""
    names = {*templates.SUPERELEMENT_NAMES, *(product_name(name, kernel.layout)
                                              for name in uses.calls)}
    names |= set(templates.DAMPING_NAMES) if kernel.layout.damped else set()
    names |= {"AT_PORT", "POWERS"} if kernel.options[1].traits.rates else set()
    names |= set(templates.GENERAL_NAMES) if kernel.layout.nodes is None else set()
    names |= {"hidden"} if kernel.layout.modes is None else set()
    names |= {"packed_room"} if any(part.packed for part in kernel.declared) else set()
    return names | ({"Part"} if kernel.declared else set())


def _nodes(layout: Layout) -> str:
    """Its counts in words."""
    if layout.nodes is None:
        return "Any number of positions and rotations"
    return f"{layout.positions} position(s) and {layout.rotations} rotation(s)"


def reads(layout: Layout) -> list[str]:
    """Counts that are not known beforehand: those of the first element, as all of a batch have."""
    known = {"N_POSITIONS": layout.positions, "N_ROTATIONS": layout.rotations,
             "ROTATIONS": layout.first_rotation, "MODES": layout.first_mode}
    values = {"N_POSITIONS": "index[AT_POSITIONS]", "N_ROTATIONS": "index[AT_ROTATIONS]",
              "ROTATIONS": f"{layout.position_size}*N_POSITIONS",
              "MODES": f"ROTATIONS + {layout.rotation_size}*N_ROTATIONS"}
    return [f"{name} = {values[name]}" for name, count in known.items() if count is None]


def counted(printer: StepPrinter) -> str:
    """Arithmetic of the element, of each position and rotation, and products, as a tuple."""
    found = [printer.operations[home] for home in ("element", "position", "rotation")]
    return f"({', '.join(map(str, [*found, printer.products]))})"


def _sums(kernel: Superelement) -> str:
    """Energies that are sums over the coordinates, where they are."""
    factors, damped = kernel.formulas.inertia.kinetic, kernel.layout.damped
    lines = [line.format(*factors) for line in templates.SUMS] if factors else []
    friction = templates.FRICTION * damped if factors else ()
    return indented([*lines, *friction], 3) + "\n" * bool(lines)


def _prepared(lines: list[str]) -> str:
    return indented(lines, 3) + "\n" * bool(lines)


def sizes(layout: Layout, uses: Resources) -> list[str]:
    """The number of unknowns and the length of a row of scratch memory, in the loop over elements.

    The compiler does not know that they are the same for all elements, or in a matrix as in forces:
    otherwise it computes a hundred places in scratch memory before every loop.
    """
    n = "hidden(width)" if layout.modes is None else str(layout.first_mode + layout.modes)
    return [f"n = {n}", f"row = padded(max(n{_margin(uses)}, 9*N_ROTATIONS))"]


def scratch_rows(uses: Resources, of_matrix: bool = False) -> list[str]:
    """Scratch memory: a row of local coordinates each, or of rotations of the nodes."""
    places, first, margin = {}, 0, _margin(uses)
    for name in (*uses.rows, *uses.tall):
        places[name] = f"{first}*row"
        first += TALL.get(name, 1)
    for k, name in enumerate(uses.squares):
        places[name] = f"({first} + {k}*(n{margin}))*row"
    return [f"{name} = at(work, {place})" for name, place in places.items()
            if (name in uses.of_matrix) == of_matrix]


def _margin(uses: Resources) -> str:
    return f" + {MARGIN}" if uses.squares else ""
