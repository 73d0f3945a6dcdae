"""Bodies that are held to the ground, of files that do not say where the interface is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.io.load_series import LoadSeries
from sebody.io.text import fault
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import SYMMETRY_LIMIT, asymmetry, coordinate_names
from sebody.reduction.grounded import grounded_body

AXES = ("x", "y", "z", "rx", "ry", "rz")


def columns(modes: int) -> tuple[str, ...]:
    """Names of the coordinates of an interface and so many modes, as columns of a series."""
    return (*AXES, *(f"mode {k}" for k in range(modes)))


class Block(NamedTuple):
    """A matrix of a file, and the line of its first row."""

    matrix: NDArray
    line: int


@dataclass(frozen=True, eq=False)
class HeldBody:
    """Contents of a file, without the place of its interface.

    Parameters
    ----------
    path : Path
    blocks : dict of Block
        mass, stiffness and damping.
    series : LoadSeries or None
        Columns x to rz and the modes; the wave elevation is among its others.
    notes : tuple of str
        What of the input file is not part of a body.
    units : str
        Of the numbers.
    """

    path: Path
    blocks: Mapping[str, Block]
    series: LoadSeries | None
    notes: tuple[str, ...] = ()
    units: str = ""

    __repr__ = brief

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.blocks["mass"].matrix) - len(AXES)

    def body(self, interface: ArrayLike, base: ArrayLike | None = None) -> ReducedBody:
        """The body with its interface at a place.

        Raises
        ------
        InputError
            Matrices that no body has; the message names file, block and line.
        """
        point = inputs.vector(interface, "interface", 3)
        names = coordinate_names(("full",), 3, self.modes, ["the interface"])
        for name, block in self.blocks.items():
            self._check_symmetric(name, block, names, point)
        matrices = {name: block.matrix for name, block in self.blocks.items()}
        try:
            return grounded_body(matrices["stiffness"], matrices["mass"], [point], ("full",),
                                 self.modes, matrices["damping"], base, units=self.units)
        except InputError as error:
            lines = ", ".join(f"{name} from line {block.line}" for name, block in
                              self.blocks.items() if name in str(error).split(" ")[:1])
            raise InputError(f"{self.path}{f' ({lines})' * bool(lines)}: {error}") from error

    def _check_symmetric(self, name: str, block: Block, names: list[str], point: NDArray) -> None:
        A = block.matrix
        defect = asymmetry(A, names, point[None])
        i, j = np.unravel_index(np.argmax(defect), defect.shape)
        if defect[i, j] > SYMMETRY_LIMIT:
            raise fault(self.path, block.line + int(i), f"the {name} matrix is not symmetric: row "
                        f"{i + 1}, column {j + 1} is {A[i, j]:.9g} and row {j + 1}, column {i + 1} "
                        f"is {A[j, i]:.9g}", "write both triangles alike")

    def keeping(self, modes: Sequence[int]) -> HeldBody:
        """The same with some of its modes, counted from 0."""
        rows = [*range(len(AXES)), *(len(AXES) + k for k in modes)]
        blocks = {name: Block(block.matrix[np.ix_(rows, rows)], block.line)
                  for name, block in self.blocks.items()}
        series = self.series
        if series is not None:
            series = LoadSeries(series.t, series.values[:, rows], columns(len(modes)),
                                series.interpolation, series.others)
        return replace(self, blocks=blocks, series=series)
