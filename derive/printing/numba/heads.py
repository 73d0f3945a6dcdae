"""Docstrings of files of kernels, by what the kernels are of."""

from collections.abc import Iterable

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.counts import FIRST_ROTATION, POSITIONS, ROTATIONS, WIDTH
from sebody.derive.form.kernel import Kernel
from sebody.derive.formulas.elements import AMPLITUDE, Constant, Element
from sebody.derive.kernels.body_contact import BodyContact
from sebody.derive.kernels.body_load import BodyLoad
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.motion import FrameMotion
from sebody.derive.kernels.path import BodyPath
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.printing.lines import INDENT, filled
from sebody.derive.printing.numba.files import Head, counts, operations
from sebody.derive.printing.numba.parts import table

SPACES = {False: "motion in space", True: "motion in a plane"}
PART = "Part"
# what kernels of loads on bodies, of any layout, declare alike
OF_LOADS = (
    "WIDTH = None            # any number",
    "INERTIAL = False        # has kinetic energy",
    "POWER = True        # does work on the system: a load, damper or drive",
    "DRIVEN = False        # a constraint that depends on time",
)


def superelement_head(given: Superelement, kernel: Kernel) -> Head:
    """The head of a superelement: the frame and the inertia option are in the names."""
    layout, (frame, inertia) = given.layout, given.options
    damped = None if inertia.traits.rates else layout.damped
    rows = ("SUPERELEMENT_CONSTANTS", *["DAMPING_CONSTANTS"] * layout.damped)
    own = [table(given.declared)] if given.declared else []
    modes = "any number of" if layout.modes is None else layout.modes
    return Head(
        f"Superelement kernel: layout {layout.name}, frame {given.frame}, inertia option "
        f"{given.inertia}",
        (f"{_nodes(layout)} of {SPACES[layout.planar]}; {modes} internal modes.",
         f"Frame: {frame.traits.summary}.", f"Inertia: {inertia.traits.summary}.",
         "Equations of Cardona (2000): coordinates (11), (17), elastic forces (24)-(30);",
         f"frame {frame.equations};", f"inertia {inertia.equations}."),
        (f'LAYOUT = "{layout.name}"', f'FRAME = "{given.frame}"', f'INERTIA = "{given.inertia}"',
         *counts(layout.planar, (layout.positions, layout.rotations)),
         f"ROTATIONS = {layout.first_rotation}      # first rotation among the local coordinates",
         f"MODES = {layout.first_mode}          # first internal mode",
         f"DAMPED = {damped}        # has structural damping, None where a body tells",
         f"N_MODES = {layout.modes}        # their number, None where it is read at run time",
         *[f"SECOND_ORDER = {layout.second_order}       # slaved coordinates, stress resultants"
           ] * inertia.traits.field,
         f"WORK_ROWS = {kernel.rows}", f"WORK_SQUARES = {kernel.squares}",
         "# arithmetic of one evaluation: of the element, of each position and of each rotation; "
         "then the", "# number of products with n x n matrices", *operations(kernel),
         f"CONSTANTS = {' + '.join([*rows, *own])}"),
        rows, (PART,) if own else ())


def body_load_head(given: BodyLoad, kernel: Kernel) -> Head:
    """The head of a load on a body: any layout, one frame."""
    planar = given.layout.planar
    return Head(
        "Element kernel: load on a body that turns with its frame",
        (f"Any number of positions and rotations of {SPACES[planar]}; any number of internal "
         "modes.", f"Frame: {given.option.traits.summary}."),
        (f'FRAME = "{given.frame}"', *counts(planar, (None, None)),
         f"CONSTANTS = FRAME_CONSTANTS + {table(given.declared)}", "MULTIPLIERS = 0", "READS = 0",
         "MEMORY = ()",
         *OF_LOADS,
         f"WORK_ROWS = {kernel.rows}", *operations(kernel)),
        ("FRAME_CONSTANTS",), (PART,))


def body_contact_head(given: BodyContact, kernel: Kernel) -> Head:
    """The head of a contact of a point inside a body: any layout and surface, one frame."""
    planar, law = given.layout.planar, given.steps.law
    parts = (*given.declared, *(_part(constant) for constant in law.constants))
    return Head(
        "Element kernel: contact of a point inside a body with a plane, sphere or cylinder",
        (f"Any number of positions and rotations of {SPACES[planar]}; any number of internal "
         "modes.", f"Frame: {given.option.traits.summary}."),
        (f'FRAME = "{given.frame}"', *counts(planar, (None, None)),
         "CARRIERS = 1         # nodes behind those of the body: that of the surface",
         f"CONSTANTS = FRAME_CONSTANTS + {table(parts)}", "MULTIPLIERS = 0", "READS = 0",
         *memory(name for name, _ in law.memory),
         *OF_LOADS,
         f"WORK_ROWS = {kernel.rows}", *operations(kernel)),
        ("FRAME_CONSTANTS",), (PART,))


def path_head(given: BodyPath, kernel: Kernel) -> Head:
    """The head of a point on a path of a body, or of a node that turns with it."""
    planar, turns = given.layout.planar, given.turns
    alone = turns or given.across
    size = 1 if alone else 2 if planar else 3
    node = "a position" if not turns else "an angle" if planar else "a rotation"
    carriers = ("CARRIERS = 1         # nodes behind those of the body: that which turns",)
    return Head(
        "Element kernel: a node turns with a path of a body, at a way that is an unknown" if turns
        else "Element kernel: a point stays on a path of a body, at a way that is an unknown",
        (f"Any number of positions and rotations of {SPACES[planar]}; any number of internal "
         "modes.", f"Frame: {given.option.traits.summary}."),
        (f'FRAME = "{given.frame}"', *counts(planar, (None, None)),
         *(carriers if turns and not planar else ()),
         f"WAY = True         # behind those of the body: {node}, a way, "
         + ("a multiplier" if alone else "multipliers"),
         f"CONSTANTS = FRAME_CONSTANTS + {table(given.declared)}",
         f"MULTIPLIERS = {size}",
         f"VECTOR = {not alone}        # the equations are components of one vector", "READS = 0",
         *memory(() if turns else [f"tangent_{axis}" for axis in "xyz"[:2 if planar else 3]]),
         "WIDTH = None            # any number",
         "INERTIAL = False        # has kinetic energy",
         "POWER = False        # does work on the system: a load, damper or drive",
         "DRIVEN = False        # a constraint that depends on time",
         f"WORK_ROWS = {kernel.rows}", *operations(kernel)),
        ("FRAME_CONSTANTS",), (PART,))


def path_load_head(given: BodyPath, kernel: Kernel) -> Head:
    """The head of forces that move along a path: any layout, one frame."""
    return Head(
        "Element kernel: forces that move along a path of a body",
        (f"Any number of positions and rotations of {SPACES[given.layout.planar]}; any number of "
         "internal modes.", f"Frame: {given.option.traits.summary}."),
        (f'FRAME = "{given.frame}"', *counts(given.layout.planar, (None, None)),
         "MOVING = True        # along a path",
         f"CONSTANTS = FRAME_CONSTANTS + {table(given.declared)}", "MULTIPLIERS = 0", "READS = 0",
         "MEMORY = ()",
         *OF_LOADS,
         f"WORK_ROWS = {kernel.rows}", *operations(kernel)),
        ("FRAME_CONSTANTS",), (PART,))


def _nodes(layout: Layout) -> str:
    """Its counts in words."""
    if layout.nodes is None:
        return "Any number of positions and rotations"
    return f"{layout.positions} position(s) and {layout.rotations} rotation(s)"


def motion_head(given: FrameMotion, kernel: Kernel) -> Head:
    """The head of the motion of bodies: any layout, one frame."""
    planar, own = given.layout.planar, given.option.traits.constants
    table_of_own = f" + {table(own)}" if own else ""
    return Head(
        "Motion of bodies: their frame and local coordinates, twice derived in time",
        (f"Any number of positions and rotations of {SPACES[planar]}; any number of internal "
         "modes.", f"Frame: {given.option.traits.summary}.",
         "Writes rows MOTION of sebody/contract/layout.py."),
        (f'FRAME = "{given.frame}"', *counts(planar, (None, None)), "N_MODES = None",
         f"CONSTANTS = FRAME_CONSTANTS{table_of_own}", f"WORK_ROWS = {kernel.rows}"),
        ("FRAME_CONSTANTS",), (PART,) if own else ())


def element_head(given: Element, kernel: Kernel) -> Head:
    """The head of a joint, rigid body or force."""
    multipliers, power = len(given.multipliers), given.power is not None
    known, planar = kernel.known, given.space.planar
    driven = multipliers > 0 and power and _reads_amplitude(given)
    constants = [_part(constant) for constant in given.constants]
    return Head(
        f"Element kernel: {given.summary}",
        (f"{given.coordinates} coordinates, {multipliers} multipliers.",),
        (*counts(planar, (known[POSITIONS], known[ROTATIONS])),
         f"ROTATIONS = {known[FIRST_ROTATION]}      # first rotation among the local coordinates",
         f"CONSTANTS = {table(constants)}", f"MULTIPLIERS = {multipliers}",
         *[f"VECTOR = {given.equates_positions}        # the equations are components of one vector"
           ] * (multipliers > 0),
         f"WIDTH = {known[WIDTH]}",
         f"READS = {len(given.reads)}      # multipliers of other equations that it reads",
         *([f"SEES = {len(given.sees)}       # numbers that another element keeps, of this iterate"]
           if given.sees else []),
         *memory(name for name, _ in given.memory),
         f"INERTIAL = {bool(given.sums.get('kinetic'))}        # has kinetic energy",
         f"POWER = {power}        # does work on the system: a load, damper or drive",
         f"DRIVEN = {driven}        # a constraint that depends on time",
         f"WORK_ROWS = {kernel.rows}", *operations(kernel)),
        (), (PART,) if constants else ())


def _reads_amplitude(given: Element) -> bool:
    return any(AMPLITUDE[0] in sp.sympify(one).free_symbols for one in given.residual)


def products_head(own: Head, kernel: Kernel) -> Head:
    """The head of products with derivatives of the forces of a kernel that has its own head."""
    return own._replace(
        title="Products with derivatives of forces", summary=(f"{own.title}.", *own.summary),
        facts=(*own.facts, f"KEPT = {kernel.kept}      # numbers kept between two calls"))


def memory(names: Iterable[str]) -> list[str]:
    """The line that names the numbers which a kernel keeps from step to step."""
    return ["# numbers it keeps from step to step",
            *filled("MEMORY = (", [f'"{name}", ' for name in names], ")", INDENT * 2)]


def _part(constant: Constant) -> Part:
    """A constant as a part of the row: a number, or the components that are stored."""
    quantity, meaning = constant
    shape = () if quantity.kind == "scalar" else (len(quantity.kept),)
    return Part(quantity.name, shape, meaning)
