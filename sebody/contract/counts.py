"""Counts that sizes of rows and matrices are products of, and names of layouts."""

from collections.abc import Iterable, Mapping

LANES = 4           # columns of a body's matrices are padded to whole vectors of so many
CACHE_LINE = 8      # numbers: the memory of kernels begins at whole lines
MEMBERS = 8         # of an ensemble that are evaluated at a time, see `sebody.engine.lanes`
MOST_SLAVED = 12        # coordinates that may follow the unknowns: load modes of three
# translations, three rotations and six products of angular velocities
MARGIN = MOST_SLAVED + 6    # what scratch rows of option C have beyond n: these, a force, a moment
LETTERS = {"full": "f", "translation": "t", "rotation": "r"}    # by kept DOF blocks of a node

Counts = Mapping[str, int]
Size = str | int        # a count, or a number


def whole_vectors(n: int) -> int:
    """Length of a column of n numbers in a kernel's matrices: whole vectors."""
    return (n + LANES - 1) // LANES * LANES


def packed_size(count: int, rows: int, columns: int) -> int:
    """Length of the row of some packed matrices, see `sebody.kernels.packed`."""
    height, width = whole_vectors(rows), whole_vectors(columns)
    return count * height * (width + width // 4) + 5 * width + 40


def axes_of(planar: bool) -> dict[str, int]:
    """The counts that follow from the space: of a position, a rotation, a symmetric matrix.

    ``lines`` are a first moment, a rotation and an inertia for each coordinate, ``motions`` those
    of the frame, ``entries`` of its rotation: cosine and sine in a plane. ``coupled`` are
    products of matrices with coordinates, and with their rates.
    """
    D, turns, pairs = (2, 1, 1) if planar else (3, 3, 6)
    return {"D": D, "turns": turns, "pairs": pairs, "lines": D + turns + pairs,
            "motions": D + turns, "entries": 2 if planar else 9,
            "coupled": pairs + 3 * turns}


def superelement_counts(positions: int, rotations: int, planar: bool, unknowns: int
                        ) -> dict[str, int]:
    """The counts that sizes of a superelement's rows are products of."""
    return {"N_POSITIONS": positions, "N_ROTATIONS": rotations, "D": 2 if planar else 3,
            "n": unknowns}


def floating_counts(planar: bool, unknowns: int, slaved: int, resultants: int,
                    damped: bool = False) -> dict[str, int]:
    """The further counts of option C."""
    axes = axes_of(planar)
    free = unknowns - axes["motions"]
    return axes | {"free": free, "N": free + slaved, "slaved": slaved, "resultants": resultants,
                   "stretching": resultants + 1, "damped": int(damped)}


def bound_counts(positions: int, rotations: int, planar: bool) -> dict[str, int]:
    """Coordinates of the boundary, and those that determine the others in the frame."""
    bound = first_mode(positions, rotations, planar)
    return {"bound": bound, "bound_free": bound - axes_of(planar)["motions"]}


def rigid_part_counts(planar: bool, unknowns: int, damped: bool = False) -> dict[str, int]:
    """The further counts of option D."""
    return axes_of(planar) | {"damped": unknowns * damped}


def scratch_size(work_rows: int, work_squares: int, unknowns: int, rotations: int) -> int:
    """Scratch memory of a superelement's kernel: rows, and squares of as many rows."""
    longest = max(unknowns + MARGIN * (work_squares > 0), 9 * rotations)
    return (work_rows + work_squares * (unknowns + MARGIN)) * whole_vectors(longest)


def first_rotation(positions: int, planar: bool) -> int:
    """The first rotation among a superelement's coordinates: positions, rotations, modes."""
    return (2 if planar else 3) * positions


def first_mode(positions: int, rotations: int, planar: bool) -> int:
    """The first of its internal modes."""
    return first_rotation(positions, planar) + (1 if planar else 3) * rotations


def layout_name(keeps: Iterable[str], planar: bool) -> str:
    """Name of a layout, such as ``f2t1``; the order of the nodes does not enter.

    Parameters
    ----------
    keeps : iterable of 'full', 'translation' or 'rotation'
        What each boundary node keeps.
    planar : bool
        Motion in a plane.
    """
    kept = list(keeps)
    counts = (f"{letter}{kept.count(keep)}" for keep, letter in LETTERS.items() if keep in kept)
    return "planar-" * planar + "".join(counts)
