"""Springs and dampers of a model: between two points, about an axis, along and about all axes."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, known, warn_of_degrees
from sebody.model.bearing_tables import BearingTable
from sebody.model.hinges import about, check_axes
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import check_together, pair
from sebody.model.parts import Attachment, Element, Joint, Node, positions, rotations
from sebody.model.shafts import shaft_axes
from sebody.model.spring_laws import Given, Law

_NO_CUBIC = "force, gap, tension_only, preload or a table"


def spring(model: Mechanism, node: Joint | Node | str, to: Node | str | None = None,
           stiffness: float = 0.0, damping: float | Given = 0.0, length: float | None = None,
           cubic: float = 0.0, name: str | None = None, force: Given | None = None,
           gap: float = 0.0, tension_only: bool = False, preload: float = 0.0,
           between: ArrayLike | None = None, **acting: Unpack[Acting]) -> Element:
    """Spring and damper between two points: ``F = k u + k3 u^3 + c u'``, u the stretch.

    In place of the stiffness a `force` may be given by a table of the stretch, and a `damping` by
    one of its rate: monotone cubics between the rows, of which the energy is the exact integral.

    Parameters
    ----------
    node : Node, str or Joint
        Also a joint on a path, without `to`: the spring then acts along the path, on its way.
    to : Node or str
    stiffness, damping, cubic : float
        k, c and k3 [force/length, force time/length, force/length^3].
    length : float, optional
        Length without force [length], along a path the way; that of the start by default.
    force, damping : table, path of a CSV file, or function
        Rows (stretch, force) or (rate, force), 2 to 65; beyond the ends with the slope there. A
        function is read at 63 places.
    gap : float
        Stretch, of either sign, that takes no force [length].
    tension_only : bool
        Whether it never pushes, as a rope does.
    preload : float
        Force that is added: that without stretch [force].
    between : (2,)
        Of a function `force`: stretches between which it is read.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Numbers that are negative, or nodes that coincide.
    """
    joint = _joint_on_path(model, node)
    if joint is not None and to is None:
        if Special(force, damping, gap, tension_only, preload, between).given:
            raise InputError(f"spring of {joint.name!r} acts along its path: give it stiffness, "
                             "cubic and damping, tables are of springs between nodes")
        return _way_spring(model, joint, stiffness, cast(float, damping), length, cubic, name)
    if joint is not None:
        raise InputError(f"spring of {joint.name!r} acts along its path and has the node "
                         f"{getattr(to, 'name', to)!r}: leave to= out, or give two nodes")
    if to is None or isinstance(node, Joint):
        raise InputError(f"spring at {getattr(node, 'name', node)!r} has one end: give to=, the "
                         "node at the other one, or a joint on a path, along which it acts")
    a, b = pair(model, node, known(model, to), "spring", ("position",))
    start = float(np.linalg.norm(b.point - a.point))
    if not start > 0:
        raise InputError(f"spring: nodes {a.name!r} and {b.name!r} coincide, so it has "
                         "no direction: use a bushing")
    length = start if length is None else length
    law = Special(force, damping, gap, tension_only, preload, between)
    if law.given:
        _check("spring", length=length)
        tables = law.tables(f"spring at {a.name!r}", stiffness, cubic)
        return _add(model, name, "spring", a, positions(a, b), {"length": length} | tables,
                    "table_spring")
    damping = cast(float, damping)
    _check("spring", stiffness=stiffness, cubic=cubic, damping=damping, length=length)
    return _add(model, name, "spring", a, positions(a, b),
                {"k": stiffness, "k3": cubic, "c": damping, "length": length})


def _joint_on_path(model: Mechanism, given: Joint | Node | str) -> Joint | None:
    """A joint of the model that is on a path; none of anything else."""
    return next((one for one in model.joints if one.kind == "path" and (
        one is given or isinstance(given, str) and one.name == given
        and given not in model.nodes)), None)


def _way_spring(model: Mechanism, joint: Joint, stiffness: float, damping: float,
                length: float | None, cubic: float, name: str | None) -> Element:
    """Spring along a path."""
    what, place = f"spring of {joint.name!r}", joint.constraints[0].attachments[-1]
    at = place.dof_block.start[0] if length is None else inputs.number(length, f"{what}: length")
    _check(what, stiffness=stiffness, cubic=cubic, damping=damping)
    name = chosen_name(model, name, f"spring of {joint.name}")
    model.loads.append(Element(name, "way_spring", (place,), {
        "k": stiffness, "k3": cubic, "c": damping, "length": float(at)}))
    return model.loads[-1]


def torsion_spring(model: Mechanism, node: Joint | Node | str, stiffness: float = 0.0,
                   damping: float | Given = 0.0, axis: ArrayLike | None = None,
                   to: Node | str | None = None, rest: float = 0.0, cubic: float = 0.0,
                   name: str | None = None, force: Given | None = None, gap: float = 0.0,
                   tension_only: bool = False, preload: float = 0.0,
                   between: ArrayLike | None = None, **acting: Unpack[Acting]) -> Element:
    """Spring and damper about the axis of a revolute joint: ``M = k u + k3 u^3 + c u'``.

    Turns are counted: in space from step to step, so in one step less than half a turn.

    Parameters
    ----------
    node : Joint, Node or str
        A revolute or cylindrical joint, which has both nodes and the axis; or the node that turns
        against `to` (the ground).
    stiffness, damping, cubic : float
        k, c and k3 [force length, force length time].
    axis : (3,), optional
        With a node: by default that of the one hinge between the nodes, or of the node; z where
        there is none.
    rest : float
        Angle of `node` against `to` without moment, zero at the start [rad].
    force, damping, gap, tension_only, preload, between
        As of `spring`, of the angle less `rest` and the moment that takes it back: a positive
        moment is against a positive angle.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Numbers that are negative, a joint that does not turn about one axis, hinges about several
        axes, an axis that the joint between the nodes forbids.
    """
    what = "torsion spring"
    a, b, vectors = about(model, node, axis, to, what)
    rest = inputs.number(rest, f"torsion spring at {a.name!r}: rest", remedy="give a number")
    warn_of_degrees(f"torsion spring at {a.name!r}", rest=rest)
    law = Special(force, damping, gap, tension_only, preload, between)
    constants: dict[str, float | NDArray]
    if law.given:
        constants = {**law.tables(f"{what} at {a.name!r}", stiffness, cubic)}
    else:
        damping = cast(float, damping)
        _check(what, stiffness=stiffness, cubic=cubic, damping=damping)
        constants = {"k": stiffness, "k3": cubic, "c": damping}
    constants["rest"] = rest
    if vectors:
        constants |= zip(("n", "m"), vectors[1:], strict=True)
    spring = _add(model, name, what, a, rotations(a, b), constants,
                  "table_torsion_spring" if law.given else None)
    check_axes(model, [spring])
    return spring


def bushing(model: Mechanism, node: Node | str, to: Node | str | None = None,
            stiffness: ArrayLike = 0.0, damping: ArrayLike = 0.0,
            turning_stiffness: ArrayLike = 0.0, turning_damping: ArrayLike = 0.0,
            rotation: ArrayLike | None = None, name: str | None = None,
            axis: ArrayLike | None = None,
            table: Mapping[str, ArrayLike] | str | Path | None = None,
            speed: float | None = None,
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
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Coefficients that are negative, matrices whose symmetric part is not positive, no rotation,
        nodes that do not coincide, or a table that is wrong, or has not this speed; tables and
        functions of the elongation, `force=` or in place of a coefficient.
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
    for key, one in numbers.items():
        constants |= {key: one.along, f"{key}t": one.about}
        if coupled:
            constants |= one.couplings(model.planar, key)
    constants |= {f"e{k}": column for k, column in enumerate(turn.T, 1)}
    if not model.planar:
        constants["n"] = _free_axis(turn, *numbers.values())
    made = _add(model, name, "bushing", a, positions(a, b) + rotations(a, b), constants,
                "bearing" if coupled else "bushing")
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


def _refuse_laws(a: Node, coefficients: Mapping[str, Any], acting: Mapping[str, Any]) -> None:
    """Refuse tables and functions of the elongation, which springs and torsion springs have."""
    laws = [name for name, given in coefficients.items() if _is_law(given)]
    laws += sorted(acting.keys() & set(Special._fields))
    if laws:
        raise InputError(f"bushing at {a.name!r} has a law by {laws[0]}=: its axes have "
                         "coefficients alone; give spring(force=..., damping=...) between nodes "
                         "along an axis, or torsion_spring(force=...) about it")


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


class Special(NamedTuple):
    """What makes a spring one of tables."""

    force: Given | None
    damping: float | Given
    gap: float
    tension_only: bool
    preload: float
    between: ArrayLike | None

    @property
    def given(self) -> bool:
        """Tell whether any of it is given: else a spring has coefficients alone."""
        left_out = all(np.isscalar(one) and one == 0
                       for one in (self.gap, self.tension_only, self.preload))
        return (not left_out or self.force is not None or _is_table(self.damping)
                or self.between is not None)

    def tables(self, what: str, stiffness: float, cubic: float) -> dict[str, NDArray]:
        """The numbers of both tables, by the names of the kernel's constants."""
        if self.force is None:
            _check(what, stiffness=stiffness)
            law = Law.straight(stiffness)
            if self.between is not None:
                raise InputError(f"{what}: between= is of a function: give force=, or leave it out")
        else:
            if stiffness:
                raise InputError(f"{what} has a stiffness and a force: give one of them")
            law = Law.of(self.force, self.between, f"{what}: force")
        if cubic:
            raise InputError(f"{what} has cubic= and {_NO_CUBIC}: put the cubic in force=")
        if gap := inputs.number(self.gap, f"{what}: gap", least=0):
            law = law.with_gap(gap, what)
        if preload := inputs.number(self.preload, f"{what}: preload"):
            law = law._replace(forces=law.forces + preload)
        if inputs.flag(self.tension_only, f"{what}: tension_only"):
            law = law.pulling(what)
        if not _is_table(self.damping):
            damper = Law.straight(inputs.number(self.damping, f"{what}: damping", least=0))
        elif callable(self.damping):
            raise InputError(f"{what}: damping is a function: give a table of rows (rate, force)")
        else:
            damper = Law.of(self.damping, None, f"{what}: damping")
            if (damper.forces * damper.places < 0.0).any():
                raise InputError(f"{what}: damping has rows whose force drives the rate: give "
                                 "forces of the sign of the rate")
        return {"force": law.packed(), "damper": damper.packed()}


def _is_table(damping: float | Given) -> bool:
    """Tell a table, a file or a function from what is to be a number."""
    if isinstance(damping, str):
        return bool(Path(damping).suffix)
    rows = isinstance(damping, list | tuple | np.ndarray) and len(damping) > 0
    return callable(damping) or isinstance(damping, PathLike) or (
        rows and np.iterable(damping[0]))   # type: ignore[index]


def _add(model: Mechanism, name: str | None, what: str, a: Node,
         attachments: tuple[Attachment, ...],
         constants: dict[str, float | NDArray], kind: str | None = None) -> Element:
    name = chosen_name(model, name, f"{what} at {a.name}")
    kind = model.kind_of(kind or what.replace(" ", "_"))
    model.loads.append(Element(name, kind, attachments, constants))
    return model.loads[-1]


def _spread(value: ArrayLike, what: str, size: int) -> NDArray:
    """A coefficient for each axis."""
    remedy = f"give one finite number >= 0, or {size}"
    given = inputs.reals(value, what, remedy)
    if given.shape not in ((), (1,), (size,)) or not (np.isfinite(given) & (given >= 0)).all():
        raise inputs.refusal(what, value, remedy)
    return np.broadcast_to(given, (size,))


def _check(what: str, **values: float) -> None:
    for name, value in values.items():
        inputs.number(value, f"{what}: {name}", least=0)
