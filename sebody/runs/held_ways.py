"""Ways of points on paths in an equilibrium: held while loads are applied, then let go.

A point that slides freely has no stiffness along its path until loads bend the path, and Newton's
iteration may lead it to where it could rest but would not stay, such as a support. So its way is
held at its start until all loads are applied. Then the force that holds it is taken away, and the
point moves to where the potential is least.

Where one body hands over to the next at once, a path has a kink: that of a hinge, or what the
shapes of welded bodies are off each other. A point may rest in a kink, pushed into it from both
sides. The kink is rounded while the point moves, and put back where the point rests near it.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags_array

from sebody.assembly.batches import carrier_constants
from sebody.contract.layout import Row
from sebody.kernels.loader import element_kernel
from sebody.model.parts import Joint, OnPath
from sebody.model.path_joints import PATH, way_of
from sebody.model.path_tables import edges
from sebody.runs.kkt_solver import Scaled
from sebody.runs.rotating_frame import Spin
from sebody.runs.settling import linear, pace
from sebody.runs.simulation import Standstill

ROUND = 1e-3        # of the shortest piece of a path: length over which a kink is rounded
BESIDE = 1e-9       # of the length of a path: how far beside a kink forces are looked at
ARRIVED = 1e-2      # of the length of a path: a point so near to its end is on the way off it
PULLED = 100.0      # stiffness, by inertias times the square of the pace, that loads may overcome
EDGES = 3           # where the edges of the weight stand in the numbers of a path


class Ways:
    """Ways of a run along which nothing resists at the start.

    Parameters
    ----------
    run : Standstill
        At its start, with all of its loads.
    spin : Spin
        With the whole load.
    """

    def __init__(self, run: Standstill, spin: Spin):
        self.run = run
        joints = [joint for joint in run.model.joints
                  if joint.kind == PATH and way_of(joint, "equilibrium").solved]
        places = [_place(run, joint) for joint in joints]
        kept = _soft(run, spin, places) if places else []
        self._joints = [joints[k] for k in kept]
        self._at = np.array([places[k] for k in kept], dtype=np.int64)
        self._start = run.state.q[self._at].copy()
        self.kinks: list[str] = []      # in which points rest, in words
        self.hold()

    def __len__(self) -> int:
        return len(self._joints)

    def hold(self) -> None:
        """Hold them where they are."""
        self.run.held_unknowns = self._at

    def let_go(self, spin: Spin) -> None:
        """Hold them no longer; the forces that held them are kept for `reason`."""
        self.run.held_unknowns = self._at[:0]
        self._pushed = self._forces(spin)

    def _forces(self, spin: Spin) -> NDArray:
        """Forces along the paths, out of balance."""
        forces: NDArray = -linear(self.run, spin, None)[1][self._at]
        return forces

    @contextmanager
    def rounded(self) -> Iterator[None]:
        """Kinks of the paths are rounded within this, and hold no point."""
        self.run.held_unknowns = self._at[:0]
        constants = self.run.system.constants
        kept = constants.copy()
        for joint in self._joints:
            for element in joint.constraints:
                assert element.path is not None
                if element.path.path.blend == 0.0:
                    counts, _ = carrier_constants(element.path.here)
                    row = Row(joint.name, element_kernel(element.kind).CONSTANTS)
                    first = (self.run.numbering.constants_at[element] + EDGES
                             + row.slices({**counts, "path": 0})["path"].start)
                    found = edges(element.path.path, element.path.piece, _rounding(element.path))
                    constants[first:first + len(found)] = found
        try:
            yield
        finally:
            constants[:] = kept

    def place(self, spin: Spin, balanced: Callable[[], bool]) -> bool:
        """Bring what has settled with rounded kinks to rest without.

        Parameters
        ----------
        balanced : callable
            Newton's iteration from the state of the run; tells whether it has found one.
        """
        run, kinks = self.run, self._near_kinks()
        self.kinks = []
        if not kinks:
            return balanced()
        ways = np.array(list(kinks))
        run.state.q[self._at[ways]] = list(kinks.values())
        run.held_unknowns = self._at[ways]
        found = balanced()
        run.held_unknowns = self._at[:0]
        if not found:
            return False
        now, sides = run.state.now.copy(), []
        for side in (-1.0, 1.0):
            for k in ways:
                run.state.now[:] = now
                run.state.q[self._at[k]] += side * BESIDE * _path(self._joints[k]).path.length
                sides.append(self._forces(spin)[k])
        run.state.now[:] = now
        before, behind = np.reshape(sides, (2, -1))
        stay = (before >= 0.0) & (behind <= 0.0)
        run.held_unknowns = self._at[ways[stay]]
        self.kinks = [f"{self._joints[k].name} rests in a kink of path "
                       f"{_path(self._joints[k]).path.name!r}, at {kinks[k]:.6g}"
                       for k in ways[stay]]
        for k, forth in zip(ways[~stay], before[~stay] > 0.0, strict=True):
            run.state.q[self._at[k]] += (1.0 if forth else -1.0) * BESIDE * _path(
                self._joints[k]).path.length
        return bool(stay.all()) or balanced()

    def _near_kinks(self) -> dict[int, float]:
        """Ways that are where one piece hands over to the next at once, and the place there."""
        found = {}
        for k, (joint, s) in enumerate(zip(self._joints, self.run.state.q[self._at], strict=True)):
            on = _path(joint)
            if on.path.blend == 0.0:
                for piece in on.path.pieces[1:]:
                    if abs(s - piece.offset) < _rounding(on):
                        found[k] = piece.offset
        return found

    def reason(self) -> str:
        """The reason why they come to rest nowhere, by the last state that was reached."""
        k = int(np.argmax(np.abs(self._pushed)))
        joint, on, s = self._joints[k], _path(self._joints[k]), self.run.state.q[self._at[k]]
        end, length = (on.path.length if self._pushed[k] > 0.0 else 0.0), on.path.length
        gone = "beyond" if not 0.0 <= s <= length else "to" if abs(
            s - end) < ARRIVED * length else ""
        to = f"moves {gone} the {'end' if end else 'beginning'} of" if gone else "rests nowhere on"
        return (f"held at {self._start[k]:.6g} of path {on.path.name!r}, where {joint.name}.way "
                f"starts, the model is in equilibrium with a force of {-self._pushed[k]:.3g} along "
                f"the path; let go, the point {to} it: hold it by drive_way, or by a spring, a "
                "stop or friction that bears this force")


def _path(joint: Joint) -> OnPath:
    path = joint.constraints[0].path
    assert path is not None         # of joints of this kind
    return path


def _place(run: Standstill, joint: Joint) -> int:
    return run.numbering.dof_blocks[way_of(joint, "equilibrium")]


def _rounding(on: OnPath) -> float:
    """Length over which kinks of a path are rounded."""
    return ROUND * min(float(piece.ways[-1]) for piece in on.path.pieces)


def _soft(run: Standstill, spin: Spin, places: list[int]) -> list[int]:
    """Those of some unknowns along which nothing resists, also once those before are held.

    The wheels of a carriage cannot be held apart from each other: it moves with one of them. What
    resists is told by the motion under a unit force against springs that loads of this pace
    overcome, with the stiffness of the structure and without. Springs and friction along the path
    do not count: they hold a way together with what holds it here.
    """
    unit = pace(run, spin)
    if not 0.0 < unit < np.inf:
        return []
    tangent, _ = linear(run, Spin.of(run.model, None), None)
    n = tangent.shape[0]
    moving = run.system.is_multiplier[:n] == 0.0
    springs = diags_array(np.where(moving, PULLED * unit * run.system.inertias[:n], 0.0))
    counts = moving.copy()
    counts[places] = False
    K, whole = (diags_array(one.astype(float)) @ tangent @ diags_array(one.astype(float))
                for one in (counts, moving))
    without = csc_matrix(tangent - whole + springs)
    kept: list[int] = []
    for k, place in enumerate(places):
        force = np.zeros(n)
        force[place] = 1.0
        held = np.ones(n)
        held[[places[one] for one in kept]] = 0.0
        free = diags_array(held)
        moved, most = (Scaled(csc_matrix(free @ one @ free + diags_array(1.0 - held))).least(
            force)[0][place] for one in (without + K, without))
        if moved > most / 2.0 > 0.0:
            kept.append(k)
    return kept
