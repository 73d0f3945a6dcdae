"""Contributions to quantities, ranked: the table, histories and picture that users get."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.basics.tabular import text

LARGE = 0.3         # of a quantity's largest change: beyond, estimates say that a change is large


@dataclass(frozen=True, eq=False)
class Contribution:
    """The change of some quantities if a body is simplified.

    Attributes
    ----------
    body, change : str
    sizes : (quantities,)
        Largest change of each at any time, relative to its largest change from the start.
    times : (quantities,)
        When [time].
    """

    body: str
    change: str
    sizes: NDArray
    times: NDArray

    @property
    def large(self) -> bool:
        """True where the change is so large that first order tells its size alone."""
        return bool(self.sizes.max() > LARGE)


@dataclass(frozen=True, eq=False)
class Contributions:
    """Contributions of the parts of a model to some quantities.

    Attributes
    ----------
    quantities : tuple of str
    t : (n,)
        Times [time].
    values : dict of str to (n, ...)
        Histories of the quantities in the full model.
    rows : tuple of Contribution
        All simplifications, those of the largest effect first.
    changes : dict of str to (n, ..., rows)
        How each quantity changes over time, in the order of the rows; see `history`.
    by_step : (quantities,)
        What half the step changes of the full model, relative as the changes are. Errors by the
        step of a simplified model differ from those of the full one by about as much, which
        estimates do not have: they are good where they are larger.
    seconds, run_seconds : float
        Time that all of it took, and the run of the full model in it.
    """

    quantities: tuple[str, ...]
    t: NDArray
    values: dict[str, NDArray]
    rows: tuple[Contribution, ...]
    changes: dict[str, NDArray]
    by_step: NDArray
    seconds: float = 0.0
    run_seconds: float = 0.0

    def __repr__(self) -> str:
        return (f"<Contributions of {len(self.rows)} simplifications to "
                f"{', '.join(self.quantities)}>")

    def history(self, quantity: str, body: str, change: str) -> NDArray:
        """Change of a quantity over time by a simplification: of the simplified model less the full
        one, (n, ...).

        Raises
        ------
        InputError
            Names that it does not have.
        """
        if quantity not in self.changes:
            raise unknown("quantity", quantity, self.quantities, "there are", "there is none")
        k = next((k for k, one in enumerate(self.rows) if (one.body, one.change) == (body, change)),
                 None)
        if k is None:
            raise unknown("simplification", f"{body}: {change}",
                          [f"{one.body}: {one.change}" for one in self.rows], "there are",
                          "there is none")
        return self.changes[quantity][..., k]

    def table(self) -> str:
        """A line for each simplification, those of the largest effect first."""
        heads = ["body", "change", *(head for name in self.quantities for head in (name, "at t"))]
        lines = [[one.body, one.change, *(cell for size, t, step in zip(
            one.sizes, one.times, self.by_step, strict=True) for cell in (
                f"{size:.2g}{_remark(size, step)}", f"{t:.4g}"))]
            for one in self.rows]
        lines.append(["", "half the step", *(cell for step in self.by_step for cell in (
            f"{step:.2g}", ""))])
        return text("largest change of each quantity, relative to its largest change from the "
                    "start", heads, lines)

    def __str__(self) -> str:
        return self.table()

    def save_picture(self, path: str | Path) -> Path:
        """Bars of the largest contributions, and histories of four; PNG.

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        from sebody.gradients.picture import draw

        return draw(self, path)


def _remark(size: float, step: float) -> str:
    """Remark on a change that first order tells but roughly."""
    return " (large)" if size > LARGE else " (below the step)" if size < step else ""


def ranked(names: Sequence[str], each: Sequence[tuple[str, str]], t: NDArray,
           values: dict[str, NDArray], changes: dict[str, NDArray]
           ) -> tuple[tuple[Contribution, ...], list[int]]:
    """Simplifications (body, change) by their largest effect on any quantity, and their places."""
    sizes, times = np.zeros((2, len(names), len(each)))
    for k, name in enumerate(names):
        whole = np.abs(values[name] - values[name][0]).max()
        if whole == 0:
            raise InputError(f"quantity {name!r} does not change: give one that the motion changes")
        own = np.abs(changes[name]).reshape(len(t), -1, len(each)).max(axis=1) / whole
        sizes[k], times[k] = own.max(axis=0), t[own.argmax(axis=0)]
    order = [int(j) for j in np.argsort(-sizes.max(axis=0), kind="stable")]
    return tuple(Contribution(*each[j], sizes[:, j], times[:, j])
                 for j in order), order
