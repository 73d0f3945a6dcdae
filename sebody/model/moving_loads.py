"""Forces that move along paths, without mass."""

from __future__ import annotations

from collections.abc import Callable
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.names import path_load_kind
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, vector
from sebody.model.frames import FRAMES
from sebody.model.histories import time_function
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, OnPath, Path, Superelement
from sebody.model.paths import known_path
from sebody.model.time_functions import TimeFunction


def moving_force(model: Mechanism, path: Path | str, force: ArrayLike,
                 way: ArrayLike | Callable[[float], float] | TimeFunction,
                 spacing: ArrayLike = (0.0,), factors: ArrayLike | None = None,
                 name: str | None = None,
                 **acting: Unpack[Acting]) -> list[Element]:
    """A force that moves along a path of superelements, or a series of them: axles without mass.

    A mass that moves has inertia, which counts where it is heavy or fast: that is a node with
    `path_joint`.

    Parameters
    ----------
    path : Path or str
        Along superelements. What is on the ground before and behind them bears nothing, and a
        force that is not on the path at all does not act.
    force : (3,), planar (2,)
        Global axes [force].
    way : table, function or ready profile
        Of the first force along the path over time [length].
    spacing : (k,) array_like
        How far behind the first one each force of a series is, its own 0 included [length].
    factors : (k,) array_like, optional
        Of the force, one for each of the series; 1 by default.
    name : str, optional
        Of its results, ``<name>.work`` and ``<name>.power``: on the structure. By default
        ``force along <path>``; on each of several superelements it is followed by their names.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Returns
    -------
    list of Element
        One for each superelement.

    Raises
    ------
    InputError
        A path of another model or along a curve, or numbers that make no sense.

    Examples
    --------
    >>> model.moving_force("deck", (0, 0, -1e5), way=ramp(25.0), spacing=(0, 4.0))
    """
    on = known_path(model, path, "moving force")
    what = f"moving force along {on.name!r}"
    pieces = [(k, piece.carrier) for k, piece in enumerate(on.pieces)
              if isinstance(piece.carrier, Superelement)]
    if not pieces:
        carrier = on.pieces[0].carrier
        assert isinstance(carrier, Node)
        raise InputError(f"{what}: the path is a curve on {carrier.name!r}, and only superelements "
                         "bear moving forces: let a force act on a node, model.force")
    given = vector(model, force, f"{what}: force")
    remedy = "give finite numbers, of one or more forces"
    behind = _row(spacing, f"{what}: spacing", remedy)
    times = np.ones(len(behind)) if factors is None else _row(factors, f"{what}: factors", remedy)
    if len(times) != len(behind):
        raise InputError(f"{what}: spacing has {len(behind)} forces and factors {len(times)}: give "
                         "one number for each")
    course = time_function(way)
    name = chosen_name(model, name, f"force along {on.name}")
    axles = np.column_stack([behind, times])
    made = [Element(name if len(pieces) == 1 else f"{name} on {body.name}",
                    path_load_kind(FRAMES[body.frame].kernel, model.planar), body.attachments,
                    {"load": given, "axles": axles}, time_function=course,
                    path=OnPath(on, k, None)) for k, body in pieces]
    model.loads += made
    return made


def _row(values: ArrayLike, what: str, remedy: str) -> np.ndarray:
    row = np.array(inputs.reals(values, what, remedy), dtype=float)
    if row.ndim != 1 or not row.size or not np.isfinite(row).all():
        raise inputs.refusal(what, values, remedy)
    return row
