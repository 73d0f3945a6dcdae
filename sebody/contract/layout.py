"""The contracts between kernels and their callers: one table for every row of numbers.

Kernels work on flat arrays. The places of all numbers in these arrays are defined here only: the
printer of the kernels, the assembly of models, the compiled loop, the checks and the results read
these tables. Sizes are products of counts, which are constants in specialised kernels and read
from the index row in general ones:

============  ======================================================================================
N_POSITIONS   nodes of the element that keep their position
N_ROTATIONS   nodes that keep their rotation
D             coordinates of a position: 3, in a plane 2
n             unknowns of the element
free          local coordinates that determine the others in their frame, in option C
N             these, and the coordinates that follow them
============  ======================================================================================
"""

from collections.abc import Iterator, Mapping
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.contract.counts import Counts, Size, packed_size, whole_vectors

# tasks of a kernel; VELOCITY and ACCELERATION are the constraints differentiated in time
RESIDUAL, TANGENT, ENERGY, VELOCITY, ACCELERATION = range(5)
# tasks of kernels of products: see sebody/derive/kernels/products.py
PREPARE, ALONG, TRANSPOSED = range(5, 8)
# numbers that contacts keep beside each other, for the time loop: their rate, the speed of the
# impact under way, and the depth
AT_RATE, AT_IMPACT, AT_DEPTH = range(3)
# status that a kernel returns: HALF_TURN if a node is rotated by nearly half a turn against the
# frame of its body, NO_FRAME if the search for this frame does not converge, OFF_PATH if a point is
# beyond the end of its path
OK, HALF_TURN, NO_FRAME, OFF_PATH = range(4)


class Part(NamedTuple):
    """A named stretch of a row: a number, a vector or a matrix.

    `columns` stores a matrix column after column, each filled with zeros to whole vectors;
    `packed` leaves room for some packed matrices, whose number, rows and columns are the shape.
    """

    name: str
    shape: tuple[Size, ...] = ()
    meaning: str = ""
    columns: bool = False
    packed: bool = False

    def size(self, counts: Counts) -> int:
        """The count of numbers that the part takes."""
        sizes = [counts[s] if isinstance(s, str) else s for s in self.shape]
        if self.columns:
            return sizes[1] * whole_vectors(sizes[0])
        return packed_size(*sizes) if self.packed else prod(sizes)

    def own_shape(self, counts: Counts) -> tuple[int, ...]:
        """The shape of its value: packed matrices are a row of numbers."""
        if self.packed:
            return (self.size(counts),)
        return tuple([counts[s] if isinstance(s, str) else s for s in self.shape])


class Row(NamedTuple):
    """Parts one after the other."""

    title: str
    parts: tuple[Part, ...]

    def slices(self, counts: Counts) -> dict[str, slice]:
        """The slice of every part in the row."""
        return {name: slice(first, first + size) for name, first, size in self._walk(counts)}

    def size(self, counts: Counts) -> int:
        """Numbers of the whole row."""
        return sum(part.size(counts) for part in self.parts)

    def first(self, name: str) -> int:
        """The start of a part, if all parts before it are of fixed size."""
        return self.slices(_Fixed())[name].start

    def pack(self, counts: Counts, values: Mapping[str, ArrayLike]) -> NDArray:
        """The row of some values, given by name.

        Raises
        ------
        ContractError
            A part without a value, a value of another shape, or one that is no part.
        """
        self._check_names(values)
        pieces = [np.zeros(0)]
        for part in self.parts:
            value = np.asarray(values[part.name], dtype=float)
            self._check_shape(part, value.shape, counts)
            pieces.append(padded_columns(value) if part.columns else value.ravel())
        return np.concatenate(pieces)

    def pack_integers(self, counts: Counts, values: Mapping[str, int | list[int]]) -> list[int]:
        """The row of some numbers and lists of numbers, given by name.

        Raises
        ------
        ContractError
            The same as of `pack`.
        """
        self._check_names(values)
        row: list[int] = []
        for part in self.parts:
            value = values[part.name]
            entries = value if isinstance(value, list) else (value,)
            if entries is value or part.shape:      # most are single numbers, of many elements
                self._check_shape(part, (len(entries),) if entries is value else (), counts)
            row += entries
        return row

    def unpack(self, counts: Counts, row: NDArray) -> dict[str, NDArray]:
        """The values of a row by name, in their shapes."""
        values, slices = {}, self.slices(counts)
        for part in self.parts:
            shape = part.own_shape(counts)
            piece = row[slices[part.name]]
            if part.columns:
                values[part.name] = piece.reshape(shape[1], whole_vectors(shape[0]))[:, :shape[0]].T
            else:
                values[part.name] = piece.reshape(shape)
        return values

    def _check_names(self, values: Mapping[str, object]) -> None:
        names = [part.name for part in self.parts]
        if values.keys() != set(names):
            raise ContractError(f"{self.title}: the kernel reads {', '.join(names) or 'nothing'}; "
                                f"given are {', '.join(values) or 'none'}")

    def _check_shape(self, part: Part, own: tuple[int, ...], counts: Counts) -> None:
        shape = part.own_shape(counts)
        if own != shape:
            raise ContractError(f"{self.title}: {part.name} has shape {own}, the kernel reads "
                                f"{shape}")

    def _walk(self, counts: Counts) -> Iterator[tuple[str, int, int]]:
        first = 0
        for part in self.parts:
            try:
                size = part.size(counts)
            except KeyError:        # parts that follow have no fixed place
                yield part.name, first, 0
                return
            yield part.name, first, size
            first += size


class ContractError(ValueError):
    """Data of a model that do not agree with what a kernel reads."""


class _Fixed(dict):
    """No counts: only parts behind parts of fixed size have a place."""


def padded_columns(matrix: NDArray) -> NDArray:
    """Columns of a matrix one after the other, each filled with zeros to whole vectors."""
    height, width = matrix.shape
    columns = np.zeros((width, whole_vectors(height)))
    columns[:, :height] = matrix.T
    return columns.ravel()


# arguments of every kernel after task, count, stride and width: their types and meaning
ARGUMENTS = (
    ("index", "int64", "rows of INDEX, one for each element"),
    ("constants", "float64", "rows of constants: of superelements one for each body type"),
    ("q", "float64", "coordinates: positions, modes, multipliers; rotations' step increments"),
    ("R", "float64", "rotations, nine numbers each, row by row"),
    ("v", "float64", "velocities of the coordinates"),
    ("a", "float64", "their accelerations"),
    ("references", "float64", "frames of the last converged step, nine numbers each, then what "
     "elements keep from step to step"),
    ("frames", "float64", "the same of the current iterate; all write their own"),
    ("T", "float64", "tangent operators of the step increments of rotations, nine numbers each"),
    ("loads", "float64", "of every power port the amplitude now and its first two derivatives"),
    ("coefficients", "float64", "the row COEFFICIENTS"),
    ("forces", "float64", "written: forces of every element, (count, n); of motions rows MOTION"),
    ("matrices", "float64", "written: matrices of every element, (count, n, n)"),
    ("work", "float64", "scratch memory: WORK_ROWS padded rows"),
    ("energies", "float64", "added to: the row ENERGIES"),
)

INDEX = Row("index row of an element", (
    Part("constants", (), "where its row of constants begins"),
    Part("frame", (), "number of its frame; of elements that keep numbers the place of theirs"),
    Part("port", (), "number of its power port, if it does work: a load, damper or drive"),
    Part("positions", (), "N_POSITIONS, the same for all elements of a batch"),
    Part("rotations", (), "N_ROTATIONS, likewise"),
    Part("nodes", ("N_ROTATIONS",), "numbers of its rotation matrices"),
    Part("unknowns", ("n",), "its coordinates, then its multipliers"),
))
AT_CONSTANTS, AT_FRAME, AT_PORT, AT_POSITIONS, AT_ROTATIONS, HEADER = (
    INDEX.first(name) for name in ("constants", "frame", "port", "positions", "rotations", "nodes"))

# J = c_mass dG/da + c_damping dG/dv + c_stiffness dG/dq T: rotations vary multiplicatively, and T
# maps the variation of a rotation's increment in a step to the variation of the rotation
COEFFICIENTS = Row("coefficients of the iteration matrix, and gravity", (
    Part("c_mass", (), "of the derivatives by accelerations"),
    Part("c_damping", (), "of the derivatives by velocities"),
    Part("c_stiffness", (), "of the derivatives by positions and rotations"),
    Part("c_geo", (), "1 for consistent tangents, 0 for the paper's"),
    Part("c_constraint", (), "of constraints and multipliers"),
    Part("field", (3,), "gravity [length/time^2]"),
))
C_MASS, C_DAMPING, C_STIFFNESS, C_GEO, C_CONSTRAINT, FIELD = (
    COEFFICIENTS.first(part.name) for part in COEFFICIENTS.parts)

ENERGIES = Row("sums over the elements, and powers", (
    Part("kinetic", (), "kinetic energy"),
    Part("strain", (), "strain energy, that of springs included"),
    Part("momentum", (3,), "momentum in global axes"),
    Part("moment", (3,), "its moment about the origin"),
    Part("potential", (), "potential of gravity"),
    Part("powers", ("ports",), "power of every power port"),
))
KINETIC, STRAIN, MOMENTUM, MOMENT, POTENTIAL, POWERS = (
    ENERGIES.first(part.name) for part in ENERGIES.parts)

RECORD = Row("what is recorded of a state", (
    Part("t", (), "time"),
    Part("iterations", (), "Newton iterations since the start"),
    Part("works", ("ports",), "work of every power port since the start"),
    Part("q", ("coordinates",), "positions, modes, angles, multipliers; rotations' increments"),
    Part("R", ("rotations", 9), "rotation matrices"),
    Part("v", ("coordinates",), "velocities"),
    Part("a", ("coordinates",), "accelerations"),
    Part("frames", ("stored",), "frames of superelements, nine numbers each, then what elements, "
         "inputs, sensors and controllers store"),
    Part("frames_old", ("stored",), "the same of the last accepted step"),
))
# places that are the same in all models; of other parts their number, see `Record.at`
RECORD_T, RECORD_ITERATIONS, RECORD_WORKS = (
    RECORD.first(name) for name in ("t", "iterations", "works"))
Q_PART, R_PART, V_PART, A_PART = (
    [part.name for part in RECORD.parts].index(name) for name in ("q", "R", "v", "a"))

MOTION = Row("motion of a body in a state, in axes of its frame but for the place of that", (
    Part("origin", ("D",), "place of the frame, in global axes"),
    Part("rotation", (9,), "of the frame, row by row; in a plane its first two axes are there"),
    Part("velocity", ("D",), "of the origin"),
    Part("acceleration", ("D",), "of the origin"),
    Part("spin", ("turns",), "angular velocity of the frame"),
    Part("spin_rate", ("turns",), "its rate"),
    Part("y", ("n",), "local coordinates"),
    Part("y_rate", ("n",), "their rates, seen in the frame"),
    Part("y_second", ("n",), "their second rates"),
))

# what places the frame of a body, and constants of every superelement; a frame or inertia option
# may declare more
FRAME_CONSTANTS = (
    Part("alphas", ("N_POSITIONS",), "frame weights of the positions"),
    Part("fits", ("N_POSITIONS",), "weights in the rotation of best fit"),
    Part("alpha_rs", ("N_ROTATIONS",), "frame weights of the rotations"),
    Part("X", ("N_POSITIONS", "D"), "nodes in the undeformed frame [length]"),
)
SUPERELEMENT_CONSTANTS = (
    *FRAME_CONSTANTS,
    Part("S", ("n", "n"), "reduced stiffness", columns=True),
    Part("M", ("n", "n"), "reduced mass", columns=True),
    Part("mass_columns", ("n", "D"), "Mbar r of the rigid translations r", columns=True),
    Part("mass_rows", ("D", "n"), "its transpose", columns=True),
    Part("mc", ("D",), "first moment of mass about the origin of the frame"),
    Part("full", (1,), "leading rows and columns of S, M and C that are not diagonal"),
    Part("masses", (1,), "mass"),
)
# in place of the address of a function of time: the time itself, or what was last set as an input
CLOCK, INPUT = 1, 2
# of an input, in State.frames: the value that was set, when, and the force or torque at that time
INPUT_NUMBERS = 3
DAMPING_CONSTANTS = (Part("C", ("n", "n"), "reduced damping", columns=True),)


