"""The most stressed FE nodes of a superelement over a run."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.units import Units
from sebody.model.summary import table
from sebody.results.field import Field
from sebody.results.units import with_unit

if TYPE_CHECKING:
    from pandas import DataFrame

COMPONENTS = "xx", "yy", "zz", "yz", "zx", "xy"


class HotSpot(NamedTuple):
    """A node and the instant at which von Mises's stress is largest there.

    Parameters
    ----------
    node : int
        Its label in the FE program, or its number in the FE model, from 0, if it has no label.
    von_mises : float
        [force/length^2]
    t : float
        [time]
    place : (D,)
        Of the undeformed node in axes of the FE model [length].
    stress : (6,)
        Components xx, yy, zz, yz, zx, xy then.
    """

    node: int
    von_mises: float
    t: float
    place: NDArray
    stress: NDArray


class HotSpots(tuple):
    """Hot spots, the most stressed one first; printed and shown as a table."""

    units: Units | None = None

    def __repr__(self) -> str:
        heads, rows = self._table()
        widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
        return "\n".join("  ".join(word.rjust(width) for word, width in zip(
            row, widths, strict=True)) for row in (heads, *rows))

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return table(*self._table())

    def to_pandas(self) -> "DataFrame":
        """A row for each node (extra ``tables``).

        Raises
        ------
        InputError
            pandas is missing.
        """
        from sebody.results.dataframes import check_installed
        check_installed("pandas")
        from pandas import DataFrame

        return DataFrame([{"node": one.node, "von_mises": one.von_mises, "t": one.t,
                           **dict(zip("xyz", one.place, strict=False)),
                           **dict(zip(COMPONENTS, one.stress, strict=True))} for one in self])

    def _table(self) -> tuple[list[str], list[list[str]]]:
        dimension = len(self[0].place) if self else 3
        heads = ["node", *(with_unit(label, name, self.units) for label, name in (
            ("von Mises", ".von_mises"), ("time", "t"))),
            *(with_unit(axis, ".position", self.units) for axis in "xyz"[:dimension]),
            *(with_unit(name, ".stress", self.units) for name in COMPONENTS)]
        rows = [[str(one.node), *(f"{value:.6g}" for value in (one.von_mises, one.t)),
                 *(f"{value:.6g}" for value in one.place),
                 *(f"{value:.4g}" for value in one.stress)] for one in self]
        return heads, rows


def hot_spots(field: Field, count: int, apart: float, units: Units | None) -> HotSpots:
    """The nodes with the largest von Mises's stress over time.

    Parameters
    ----------
    count : int
        How many of them.
    apart : float
        Least distance between two of them [length].

    Raises
    ------
    InputError
        An invalid count or distance, or a body without stresses.
    """
    count = inputs.integer(count, "number of hot spots", least=1)
    apart = inputs.number(apart, "apart", least=0)
    over_time = field.envelope("von_mises")
    places = field.fe_places
    nodes: list[int] = []
    for node in np.argsort(-over_time.value, kind="stable"):
        if len(nodes) == count or not np.isfinite(over_time.value[node]):
            break
        if apart == 0 or all(np.linalg.norm(places[node] - places[other]) >= apart
                             for other in nodes):
            nodes.append(int(node))
    spots = HotSpots(HotSpot(
        field.called(node), float(over_time.value[node]), float(over_time.t[node]), places[node],
        field.at(field.number(node)).stress[field.state(t=float(over_time.t[node]))])
        for node in nodes)
    spots.units = units
    return spots
