"""Checks of the shapes of an FE model against the body that they belong to."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.beam_stress import BeamStress
from sebody.fem.isoparametric import SOLID_KINDS, element_kind
from sebody.fem.stress import SolidStress, StressModes
from sebody.reduction.recovery import Recovery

_REMEDY = "take the shapes and the body from one reduction"
_DOFS = {2: ("x", "y", "rz"), 3: ("x", "y", "z", "rx", "ry", "rz")}


def check_recovery(recovery: Recovery, planar: bool, n: int, held: int,
                   slaved: int | None) -> None:
    """Raise InputError unless the shapes are of this body and fit their nodes and elements.

    Parameters
    ----------
    n, held, slaved : int
        Numbers of reduced coordinates, of those on the boundary, and of those that follow in second
        order; None if this is unknown, although shapes may be given.
    """
    D, r = (2, 1) if planar else (3, 3)
    names = inputs.items(recovery.node_dofs, "recovery.node_dofs", "give names of DOFs")
    if tuple(names) not in (_DOFS[D], _DOFS[D][:D]):
        raise inputs.refusal("recovery.node_dofs", recovery.node_dofs,
                             f"give {_DOFS[D][:D]} or {_DOFS[D]}")
    _check("coordinates", recovery.coordinates, (None, D))
    count = len(recovery.coordinates)
    rows = count * len(names)
    _check("shapes", recovery.shapes, (rows, None if slaved is None else n + slaved))
    if recovery.shapes.shape[1] < n:
        raise InputError(f"recovery.shapes has {recovery.shapes.shape[1]} columns, the body {n} "
                         f"coordinates: {_REMEDY}")
    if recovery.static is not None:
        _check("static", recovery.static, (rows, None))
        least = held + r * (r + 1) // 2
        if recovery.static.shape[1] < least:
            raise InputError(f"recovery.static has {recovery.static.shape[1]} columns, of {held} "
                             f"coordinates of the boundary and spin there are {least}: {_REMEDY}")
    if (recovery.axes is None) != (recovery.by is None):
        raise InputError(f"recovery.axes and recovery.by belong together: {_REMEDY}")
    if recovery.axes is not None:
        inputs.rotation(recovery.axes, "recovery.axes", D)
        _check("by", recovery.by, (n, n))
    _check_nodes(recovery, count)
    for k, one in enumerate(inputs.items(recovery.stress, "recovery.stress", "give a tuple")):
        _check_stress(f"stress[{k}]", one, count, len(names), n)


def _check_nodes(recovery: Recovery, count: int) -> None:
    """Numbers of nodes and elements."""
    for name in ("labels", "nodes"):
        array = getattr(recovery, name)
        if array is not None:
            _check(name, array, (count,), "iu")
    if recovery.nodes is not None and not (np.diff(recovery.nodes) > 0).all():
        raise InputError(f"recovery.nodes do not ascend: {_REMEDY}")
    lines = 0
    for k, (kind, nodes) in enumerate(recovery.cells):
        inputs.name(kind, f"recovery.cells[{k}]: kind")
        _check(f"cells[{k}]", nodes, (None, None), "iu", below=count)
        lines += len(nodes) * (kind == "line")
    if recovery.outlines is not None:
        _check("outlines", recovery.outlines, (lines, None, 3))


def checked_paths(paths: Mapping[str, ArrayLike], recovery: Recovery | None
                  ) -> dict[str, NDArray]:
    """Paths by name, as new arrays of FE nodes.

    Raises
    ------
    InputError
        Names that are no texts, fewer than two nodes, or nodes that the recovery does not have.
    """
    remedy = "give a dict of FE nodes in order by name"
    checked = {}
    for name, nodes in inputs.mapping(paths, "paths", remedy).items():
        what = f"path {inputs.name(name, 'name of a path')!r}"
        numbers = [inputs.integer(node, f"{what}: a node", least=0)
                   for node in inputs.items(nodes, f"{what}: nodes", remedy)]
        if len(numbers) < 2:
            raise InputError(f"{what} has {len(numbers)} FE nodes: give two at least")
        unknown = [node for node in numbers if recovery is None or not recovery.has(node)]
        if unknown:
            raise InputError(f"{what} has the FE node {unknown[0]}, whose shapes the body does not "
                             "have: keep the recovery of its nodes")
        checked[name] = np.array(numbers)
    return checked


def _check_stress(name: str, one: object, count: int, dofs: int, n: int) -> None:
    if isinstance(one, StressModes):
        _check(f"{name}.modes", one.modes, (len(one.points), 6, n))
        _check(f"{name}.nodes", one.nodes, (len(one.points),), "iu", least=-1, below=count)
    elif isinstance(one, BeamStress):
        _check(f"{name}.nodes", one.nodes, (None, 2), "iu", below=count)
        elements = len(one.nodes)
        _check(f"{name}.forces", one.forces, (elements, 2, 6, 2 * dofs))
        _check(f"{name}.fibres", one.fibres, (elements, 2, None, 3, 6))
        _check(f"{name}.offsets", one.offsets, (elements, 2, one.fibres.shape[2], 2))
        if one.flexibility is not None:
            _check(f"{name}.flexibility", one.flexibility, (elements, 2, 6, 6))
    elif isinstance(one, SolidStress):
        kind = element_kind(inputs.choice(one.kind, f"recovery.{name}.kind", SOLID_KINDS))
        points, corners = kind.values.shape
        _check(f"{name}.nodes", one.nodes, (None, corners), "iu", below=count)
        _check(f"{name}.coordinates", one.coordinates, (count, 3))
        law = (6, 6) if np.ndim(one.elasticity) == 2 else (len(one.nodes), 6, 6)
        _check(f"{name}.elasticity", one.elasticity, law)
        if one.strains is not None:
            _check(f"{name}.strains", one.strains, (points, 6, 3 * corners))
    else:
        raise inputs.refusal(f"recovery.{name}", one, "give a SolidStress, BeamStress or "
                             "StressModes")


def _check(name: str, array: NDArray, shape: Sequence[int | None], kinds: str = "fiu",
           least: int = 0, below: int | None = None) -> None:
    """Refuse an array of another type or shape, numbers that are not finite, or out of range."""
    what = f"recovery.{name}"
    if not isinstance(array, np.ndarray) or array.dtype.kind not in kinds:
        raise inputs.refusal(what, array, "give an array of " + (
            "numbers" if "f" in kinds else "whole numbers"))
    if len(shape) != array.ndim or any(
            wanted not in (None, length) for length, wanted in zip(array.shape, shape,
                                                                   strict=True)):
        wanted = ", ".join("any" if one is None else str(one) for one in shape)
        raise InputError(f"{what} has shape {array.shape}, in place of ({wanted}): {_REMEDY}")
    if not np.isfinite(array).all():
        at = [int(i) for i in np.argwhere(~np.isfinite(array))[0]]
        raise InputError(f"{what} has the entry {array[tuple(at)]} at {at}: give finite numbers")
    if below is not None and array.size and not (
            array.min() >= least and array.max() < below):
        wrong = array.min() if array.min() < least else array.max()
        raise InputError(f"{what} has the node {wrong}: give numbers from {least} to {below - 1}")
