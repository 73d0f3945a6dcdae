"""Bushings and bearings of a model: springs and dampers along and about all axes."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name
from sebody.model.bearing_tables import BearingTable
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import check_together, pair
from sebody.model.parts import Element, Node, positions, rotations
from sebody.model.shafts import shaft_axes
from sebody.model.special_laws import Special
from sebody.model.spring_laws import Law

AXES = "x", "y", "z"
_PLAIN = Special(None, 0.0, 0.0, False, 0.0, None)      # a spring without any of it
Laws = Mapping[str, Mapping[str, Any]]      # of axes "x" to "rz": arguments of `spring`


def bushing(model: Mechanism, node: Node | str, to: Node | str | None = None,
            stiffness: ArrayLike = 0.0, damping: ArrayLike = 0.0,
            turning_stiffness: ArrayLike = 0.0, turning_damping: ArrayLike = 0.0,
            rotation: ArrayLike | None = None, name: str | None = None,
            axis: ArrayLike | None = None,
            table: Mapping[str, ArrayLike] | str | Path | None = None,
            speed: float | None = None, laws: Laws | None = None,
            **acting: Unpack[Acting]) -> Element:
    """Springs and dampers along and about axes that turn with `node`, between nodes at one point.

    Each coefficient is a number, or one for each axis. Moments follow the sine of the angles:
    stay well below half a right angle. About an axis without coefficients, where others have some,
    `to` may turn freely, as a shaft in a bearing: moments follow the tilt of this axis.

    A bearing may also be given by matrices, with the shaft along the third axis: (2, 2) of the ways
    across it, or (4, 4) of the ways and of the turns about the same two axes. They need not be
    symmetric: cross-coupled stiffness drives whirls.

    Parameters
    ----------
    stiffness, damping : number, (3,), (2, 2) or (4, 4) array_like
        Planar: number, (2,) or (2, 2) [force/length, force time/length; of turns times length].
    turning_stiffness, turning_damping : number or (3,) array_like
        Not with (4, 4) [force length, force length time].
    rotation : (3, 3), planar (2, 2), optional
        Rotates the axes of space to those of the bushing at the start, its columns; by default
        they are the same.
    axis : (3,), optional
        Direction of a shaft, instead of `rotation`: the third axis. The first two are across it in
        the order of space: y and z of a shaft along x.
    table : mapping of str to (m,) array_like, or path of a CSV file
        Instead of stiffness and damping those across the shaft by its speed, columns ``frequency``
        (rad/time; or ``rpm``), ``kxx``, ``kxy``, ``kyx``, ``kyy``, ``cxx``, ``cxy``, ``cyx``,
        ``cyy``; ``kyy`` and ``cyy`` are those of x where they are left out, others none. Equilibria
        with a spin and analyses over the speed read the table at the speed of the shaft.
    speed : float, optional
        At which the table is read once for all, as runs over time need [rad/time].
    laws : mapping of str to mapping, optional
        In place of the coefficients of an axis, ``x``, ``y``, ``z``, or about it, ``rx``, ``ry``,
        ``rz`` (of the bushing's axes; in a plane ``x``, ``y``, ``rz``): what `spring` takes, of
        ``force``, ``damping``, ``stiffness``, ``gap``, ``tension_only``, ``preload``, ``between``.
        Elongations are ways and turns of `to` against `node`; a positive force takes them back.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Coefficients that are negative, matrices whose symmetric part is not positive, no rotation,
        nodes that do not coincide, or a table that is wrong, or has not this speed; laws of an
        unknown axis, beside matrices, or of anything a spring does not take.
    """
    a, b = pair(model, node, to, "bushing")
    _refuse_laws(a, {"stiffness": stiffness, "damping": damping, "turning_stiffness":
                     turning_stiffness, "turning_damping": turning_damping}, acting)
    check_together(model, a, b, "bushing")
    turn = _bushing_axes(model, a, rotation, axis)
    rows = None
    if table is not None:
        rows, stiffness, damping = _of_table(a, table, speed, stiffness, damping)
    elif speed is not None:
        raise InputError(f"bushing at {a.name!r}: speed= is that at which a table is read: give "
                         "table=, or leave it out")
    numbers = {"k": _Coefficients.of(model, a, "stiffness", stiffness, turning_stiffness),
               "c": _Coefficients.of(model, a, "damping", damping, turning_damping)}
    coupled = rows is not None or any(np.any(one.across) for one in numbers.values())
    constants: dict[str, float | NDArray] = {}
    if laws is not None:
        if coupled:
            raise InputError(f"bushing at {a.name!r} has laws and coupled axes: give coefficients "
                             "for each axis, or no laws")
        constants, numbers = _by_laws(model, a, laws, numbers)
    for key, one in numbers.items() if laws is None else ():
        constants |= {key: one.along, f"{key}t": one.about}
        if coupled:
            constants |= one.couplings(model.planar, key)
    constants |= {f"e{k}": column for k, column in enumerate(turn.T, 1)}
    if not model.planar:
        constants["n"] = _free_axis(turn, *numbers.values())
    kind = "bearing" if coupled else "bushing" if laws is None else "table_bushing"
    made = Element(chosen_name(model, name, f"bushing at {a.name}"), model.kind_of(kind),
                   positions(a, b) + rotations(a, b), constants)
    model.loads.append(made)
    made.table = rows
    return made


def table_constants(table: BearingTable, speed: float, bearing: Element
                    ) -> dict[str, float | NDArray]:
    """Constants of a bearing by its table at a speed.

    Raises
    ------
    InputError
        A speed outside the table.
    """
    found: dict[str, float | NDArray] = {}
    for key, matrix in zip("kc", table.at(speed, bearing.name), strict=True):
        along = np.array(bearing.vector(key))
        along[:2] = np.diag(matrix)
        found |= {key: along, f"{key}12": matrix[0, 1], f"{key}21": matrix[1, 0]}
    return found


def by_tables(model: Mechanism) -> list[Element]:
    """Bearings whose coefficients are tables."""
    return [load for load in model.loads if load.table is not None]


def refuse_tables(model: Mechanism) -> None:
    """Refuse bearings by tables that have not been read at a speed.

    Raises
    ------
    InputError
        The message names the first.
    """
    for bearing in by_tables(model):
        if bearing.read_at is None:
            raise InputError(f"{bearing.name!r} has a table of the speed, which a run over time "
                             "does not follow: give bushing(..., speed=), at which it is read")


def _by_laws(model: Mechanism, a: Node, laws: Laws, numbers: dict[str, _Coefficients]
             ) -> tuple[dict[str, float | NDArray], dict[str, _Coefficients]]:
    """Tables of all axes, straight where there is no law; coefficients, 1 about axes with a law."""
    where = f"bushing at {a.name!r}"
    remedy = 'give a dict of axes, such as {"x": {"force": table, "damping": 20.0}}'
    given = dict(inputs.mapping(laws, f"{where}: laws", remedy))
    d = model.dimension
    axes = {axis: (str(k + 1), "along", k) for k, axis in enumerate(AXES[:d])}
    axes |= {"r" + axis: (f"t{k + 1}", "about", 0 if model.planar else k)
             for k, axis in enumerate(AXES) if not model.planar or k == 2}
    if odd := [one for one in given if one not in axes]:
        raise unknown(f"axis of laws of {where}", odd[0], axes)
    about = {key: np.array(one.about) for key, one in numbers.items()}
    tables: dict[str, float | NDArray] = {}
    for axis, (key, part, k) in axes.items():
        if axis not in given:
            stiff, damped = (float(np.atleast_1d(getattr(numbers[of], part))[k]) for of in "kc")
            made = {"force": Law.straight(stiff).packed(), "damper": Law.straight(damped).packed()}
        else:
            made = _tables(f"{where}: law of {axis}", given[axis], remedy)
            if part == "about":
                about["k"][k] = 1.0
        tables |= {name + key: table for name, table in made.items()}
    return tables, {key: one._replace(about=about[key]) for key, one in numbers.items()}


def _tables(what: str, law: Any, remedy: str) -> dict[str, NDArray]:
    """The tables of one law, of the arguments of a spring."""
    own = dict(inputs.mapping(law, what, remedy))
    if odd := [one for one in own if one not in (*Special._fields, "stiffness")]:
        raise unknown(f"argument of {what}", odd[0], (*Special._fields, "stiffness"))
    stiffness = inputs.number(own.pop("stiffness", 0.0), f"{what}: stiffness", least=0)
    return _PLAIN._replace(**own).tables(what, stiffness, 0.0)


def _refuse_laws(a: Node, coefficients: Mapping[str, Any], acting: Mapping[str, Any]) -> None:
    """Refuse tables and functions of the elongation in place of coefficients: these are laws."""
    given = [name for name, one in coefficients.items() if _is_law(one)]
    given += sorted(acting.keys() & set(Special._fields))
    if given:
        raise InputError(f"bushing at {a.name!r} has a law by {given[0]}=: give it to an axis, "
                         'laws={"x": {"force": table, "damping": table}}, about one "rx"')


def _is_law(given: Any) -> bool:
    """Tell whether a coefficient is a table or function, or one of its axes is."""
    if isinstance(given, list | tuple) and any(map(_is_law, given)):
        return True
    try:
        rows, *columns = np.shape(given) or (0,)
    except ValueError:      # a table for one axis, numbers for others
        return True
    return (callable(given) or isinstance(given, PathLike) or columns == [2] and rows != 2
            or isinstance(given, str) and given.endswith(".csv"))


def _of_table(a: Node, table: Mapping[str, ArrayLike] | str | Path, speed: float | None,
              stiffness: ArrayLike, damping: ArrayLike
              ) -> tuple[BearingTable | None, NDArray, NDArray]:
    """The table, none if a speed is given; stiffness and damping at it, else at the lowest."""
    what = f"bushing at {a.name!r}: table"
    if np.any(stiffness) or np.any(damping):
        raise InputError(f"{what} has stiffness and damping: leave out these arguments")
    rows = BearingTable.of(table, what)
    if speed is None:
        return rows, *rows.at(rows.speeds[0], f"bushing at {a.name}")
    speed = inputs.number(speed, f"bushing at {a.name!r}: speed", least=0)
    return None, *rows.at(speed, f"bushing at {a.name}")


class _Coefficients(NamedTuple):
    """Stiffness or damping of a bushing."""

    along: NDArray      # one for each axis
    about: NDArray
    across: NDArray     # (4, 4) couplings of ways and turns along axes 1 and 2, zeros on diagonals

    @classmethod
    def of(cls, model: Mechanism, a: Node, what: str, ways: ArrayLike, turns: ArrayLike
           ) -> _Coefficients:
        """Coefficients as a user gives them: numbers, or matrices."""
        where = f"bushing at {a.name!r} has a coefficient that is negative or no number: "
        d, size = model.dimension, model.rotation_size
        if np.ndim(ways) != 2:
            return cls(_spread(ways, where + what, d),
                       _spread(turns, where + f"turning_{what}", size), np.zeros((4, 4)))
        shapes = ((2, 2),) if model.planar else ((2, 2), (4, 4))
        remedy = "give a matrix of finite numbers, " + " or ".join(
            f"{rows} x {rows}" for rows, _ in shapes) + ", whose symmetric part is not negative"
        title = f"bushing at {a.name!r}: {what}"
        given = inputs.reals(ways, title, remedy)
        if given.shape not in shapes or not np.isfinite(given).all():
            raise inputs.refusal(title, ways, remedy)
        whole = np.zeros((4, 4))
        whole[:len(given), :len(given)] = given
        least = np.linalg.eigvalsh((whole + whole.T) / 2)
        if what == "damping" and least[0] < -1e-12 * np.abs(least).max():
            raise inputs.refusal(title, ways, remedy)
        about = _spread(turns, where + f"turning_{what}", size)
        if len(given) == 4:
            if np.any(about):
                raise InputError(f"{title} is 4 x 4 and has the turns in it: leave out "
                                 f"turning_{what}")
            about = np.array([*np.diag(given)[2:], 0.0])
        along = np.zeros(d)
        along[:2] = np.diag(given)[:2]
        return cls(along, about, whole - np.diag(np.diag(whole)))

    def couplings(self, planar: bool, key: str) -> dict[str, float]:
        """By the names that the kernel has for them."""
        found: dict[str, float] = {}
        blocks = {"": (0, 0)} if planar else {"": (0, 0), "t": (2, 2), "ut": (0, 2), "tu": (2, 0)}
        for name, (row, column) in blocks.items():
            found |= {f"{key}{name}{i + 1}{j + 1}": float(self.across[row + i, column + j])
                      for i in range(2) for j in range(2) if i != j or len(name) == 2}
        return found


def _free_axis(turn: NDArray, *coefficients: _Coefficients) -> NDArray:
    """Direction about which a bushing lets turn freely while it resists tilts; zero if none."""
    resisted = np.any([one.about != 0.0 for one in coefficients], axis=0)
    coupled = np.array([np.any(one.across[2:]) or np.any(one.across[:, 2:])
                        for one in coefficients]).any()
    resisted[:2] |= coupled
    free = np.flatnonzero(~resisted)
    return turn[:, free[0]] if len(free) == 1 else np.zeros(3)


def _bushing_axes(model: Mechanism, a: Node, rotation: ArrayLike | None, axis: ArrayLike | None
                  ) -> NDArray:
    """Axes of a bushing at the start, as columns."""
    if axis is None:
        return np.eye(model.dimension) if rotation is None else inputs.rotation(
            rotation, f"bushing at {a.name!r}: rotation", model.dimension)
    if rotation is not None or model.planar:
        raise InputError(f"bushing at {a.name!r}: " + (
            "a model in a plane has no axis=, leave it out" if model.planar else
            "give axis= or rotation=, not both"))
    third = inputs.vector(axis, f"bushing at {a.name!r}: axis", 3)
    length = np.linalg.norm(third)
    if not length > 0.0:
        raise InputError(f"bushing at {a.name!r}: axis has no length: give the shaft's direction")
    return shaft_axes(third / length)


def _spread(value: ArrayLike, what: str, size: int) -> NDArray:
    """A coefficient for each axis."""
    remedy = f"give one finite number >= 0, or {size}"
    given = inputs.reals(value, what, remedy)
    if given.shape not in ((), (1,), (size,)) or not (np.isfinite(given) & (given >= 0)).all():
        raise inputs.refusal(what, value, remedy)
    return np.broadcast_to(given, (size,))
