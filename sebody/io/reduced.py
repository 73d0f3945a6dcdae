"""Bodies that an FE program has reduced: rows by node and direction, and rows of modes."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.io.body_file import BodyFile
from sebody.reduction.checks import dead_rows

_SHOWN = 6      # nodes that a note names
NAMES = ("x", "y", "z", "rx", "ry", "rz")


def reduced_parts(matrices: Mapping[str, NDArray], rows: Sequence[tuple[int, int] | None],
                  points: Mapping[int, NDArray], source: str,
                  outputs: Mapping[str, NDArray] = MappingProxyType({})
                  ) -> tuple[dict, tuple[str, ...], dict[str, str]]:
    """Arguments of a `ReducedBody`, its nodes' labels as names, and a note of what is left out.

    Triplets of rows that are zero in stiffness and mass are left out: programs write the rotations
    of nodes of solids so.

    Parameters
    ----------
    matrices : mapping of (n, n) by name
        'stiffness', 'mass' and, if there is one, 'damping'.
    rows : sequence of (label, direction) or None
        Of every row: node and direction, 0 to 2 translations, 3 to 5 rotations; None for a mode.
    points : dict of (3,) by label
        Nodes [length].
    source : str
        Where the rows come from, for messages.
    outputs : mapping of (m, n) by name
        Output matrices of these rows.

    Raises
    ------
    InputError
        Nodes without a place, or with some of three directions.
    """
    labels = list(dict.fromkeys(row[0] for row in rows if row is not None))
    place = {(label, k): i for i, row in enumerate(rows) if row is not None for label, k in [row]}
    left = _left_out(matrices, place)
    keeps, order = [], []
    for label in labels:
        if label not in points:
            raise InputError(f"{source} has rows of node {label}, whose place is not given: give "
                             "a file with the coordinates of all boundary nodes")
        keeps.append(_keep(label, [k for k in range(6) if (label, k) in place], source))
    for first, other in ((0, "rotation"), (3, "translation")):
        order += [place[label, first + k] for label, keep in zip(labels, keeps, strict=True)
                  if keep != other for k in range(3)]
    modes = [i for i, row in enumerate(rows) if row is None]
    order += modes
    chosen = np.ix_(order, order)
    return {**{name: matrix[chosen] for name, matrix in matrices.items()},
            **({"outputs": {name: matrix[:, order] for name, matrix in outputs.items()}}
               if outputs else {}),
            "coordinates": np.array([points[label] for label in labels], dtype=float),
            "keeps": tuple(keeps), "modes": len(modes)}, tuple(map(str, labels)), _note(left)


def _left_out(matrices: Mapping[str, NDArray], place: dict[tuple[int, int], int]
              ) -> list[tuple[int, int]]:
    """Triplets with neither stiffness nor mass, by label and first direction; they leave `place`.
    """
    names = [""] * len(matrices["stiffness"])
    for (_, k), row in place.items():
        names[row] = "position" if k < 3 else "rotation"
    dead = dead_rows([matrices["stiffness"], matrices["mass"]],
                     [name or f"mode {row}" for row, name in enumerate(names)])
    left = []
    for label, first in dict.fromkeys((label, 3 * (k // 3)) for label, k in place):
        own = [(label, first + k) for k in range(3) if (label, first + k) in place]
        other = any((label, k) in place for k in range(3 - first, 6 - first))
        if other and all(dead[place[one]] for one in own):
            left.append((label, first))
            for one in own:
                del place[one]
    return left


def _note(left: Sequence[tuple[int, int]]) -> dict[str, str]:
    """Omissions, in words."""
    if not left:
        return {}
    shown = [f"{'rotations' if first else 'translations'} of node {label}" for label, first in left]
    more = ", ..." * (len(shown) > _SHOWN)
    return {"rows left out": f"{', '.join(shown[:_SHOWN])}{more}: neither stiffness nor mass"}


def _keep(label: int, directions: list[int], source: str) -> str:
    keeps = {(0, 1, 2): "translation", (3, 4, 5): "rotation", (0, 1, 2, 3, 4, 5): "full"}.get(
        tuple(directions))
    if keeps is None:
        have = ", ".join(NAMES[k] for k in directions) or "nothing that has stiffness or mass"
        lacking = ", ".join(NAMES[k] for first in (0, 3) for k in range(first, first + 3)
                            if k not in directions and any(first <= j < first + 3
                                                           for j in directions))
        raise InputError(f"{source} keeps {have} of node {label}: retain all three translations, "
                         "all three rotations, or both, when reducing"
                         + f" (also {lacking})" * bool(lacking))
    return keeps


def chosen_interfaces(file: BodyFile, labels: Sequence[str], names: Sequence[str]) -> BodyFile:
    """The body with its boundary nodes named and in another order.

    Raises
    ------
    InputError
        Nodes that the body does not have, or nodes of it that are left out.
    """
    for label in labels:
        if label not in file.names:
            raise InputError(f"node {label} is not a boundary node of the reduced body: there are "
                             f"{', '.join(file.names)}")
    left = [label for label in file.names if label not in labels]
    if left:
        raise InputError(f"the reduced body has boundary nodes that are not interfaces: "
                         f"{', '.join(left)}; name all of them, or reduce with fewer")
    parts = file.parts
    keeps = parts["keeps"]
    order = [file.names.index(label) for label in labels]
    rows, start = [], 0
    for other in ("rotation", "translation"):
        own = [k for k, keep in enumerate(keeps) if keep != other]
        first = {k: start + 3 * i for i, k in enumerate(own)}
        rows += [first[k] + axis for k in order if k in first for axis in range(3)]
        start += 3 * len(own)
    rows += range(start, len(parts["stiffness"]))
    chosen = np.ix_(rows, rows)
    changed = {name: parts[name][chosen] for name in ("stiffness", "mass", "damping")
               if parts.get(name) is not None}
    if parts.get("outputs"):
        changed["outputs"] = {name: matrix[:, rows] for name, matrix in parts["outputs"].items()}
    return BodyFile({**parts, **changed, "coordinates": parts["coordinates"][order],
                     "keeps": tuple(keeps[k] for k in order)}, tuple(names), file.units,
                    file.provenance)
