"""Load steps to an equilibrium: what follows the path, and what leaves it where it ends.

A step from one equilibrium to the next is halved where Newton's iteration finds nothing, or a state
that is not stable: this follows the path and refuses jumps to other branches. Where steps of
`FOLLOWED` of the load do not help, the path ends or becomes unstable. Then the structure may leave
it: an unstable state is moved to either side along its softest motion and settles; where there is
no state, it settles from the last one (it snaps). Only a stable state counts.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from sebody.basics.errors import InputError, SimulationError
from sebody.contract.layout import FIELD, RECORD_T
from sebody.runs import user_faults
from sebody.runs.held_ways import Ways
from sebody.runs.kkt_solver import Scaled
from sebody.runs.rotating_frame import Spin
from sebody.runs.settling import (
    FAR,
    NUDGE,
    Found,
    Work,
    balance,
    linear,
    moved_by,
    nudge,
    pace,
    settle,
    size,
    solution,
)
from sebody.runs.simulation import Standstill
from sebody.runs.stability import Stiffness
from sebody.runs.sticking import RUN, in_turns, remedy
from sebody.runs.tensions import Tensions

SMALLEST = 1.0 / 1024       # smallest load step, as a share of the load
FOLLOWED = 1.0 / 64         # load step below which a path that ends or becomes unstable is left
JUMP, NEAR = 4.0, 0.05      # how far a state is on the path: of the first correction, or at all
LOST = 0.1                  # part of the stiffness at the start that is left where a path ends
CHOICES = "leave", "keep"


class Loading:
    """A structure under a share of its loads that grows from 0 to 1.

    Parameters
    ----------
    run : Standstill
        At rest, with all of its loads.
    steady : Spin
        With the whole load.
    steps : int
        Equal ones, divided where necessary.
    keep : bool
        Whether unstable states are kept.

    Attributes
    ----------
    share : float
        Of the load whose equilibrium the run is in.
    notes : list of str
        Where the path became unstable or ended.
    """

    def __init__(self, run: Standstill, steady: Spin, steps: int, tolerance: float, keep: bool):
        self.run, self.steady, self.steps, self.tolerance = run, steady, steps, tolerance
        self.keep = keep
        self.loads, self.field = run.state.loads.copy(), run.state.coefficients[FIELD:].copy()
        self.tensions = Tensions.of(run)
        self.share, self.step = 0.0, 1.0 / steps
        self.notes: list[str] = []
        self.judged = not steady.rotates
        self._work = Work()
        self._slack = False         # what has settled has motions without stiffness of its own
        # whether all motions have a stiffness without the loads
        self._unstable = False      # what is kept
        self._tried = -1.0          # share of the load at which leaving the path was tried
        still = Spin.of(run.model, None)
        self._unit = pace(run, still) if self.judged else 0.0
        if not np.isfinite(self._unit):
            self._unit = 0.0
        self.ways = Ways(run, steady)
        self.load(0.0)
        self._stiff = self.judged and Stiffness(run, linear(run, still, None)[0],
                                                self._unit).stiff()
        run.rows.stretches = [run.state.now[None].copy()]

    def follow(self) -> None:
        """Load the structure fully.

        Raises
        ------
        SimulationError
            No equilibrium is found, or one that only the model has.
        """
        while self.share < 1.0 - 1e-12:
            self._start = self.run.state.now.copy()
            target = min(self.share + self.step, 1.0)
            self.load(target)
            # residuals of fixed coordinates tell of a function that raised there
            if self._reach(target) and np.isfinite(self.run.state.residual).all():
                self.share = target
                self.run.state.now[RECORD_T] = target
                if target >= 1.0 - 1e-12 and len(self.ways):
                    self._let_go()
                self.run.rows.stretches.append(self.run.state.now[None].copy())
                continue
            self._back()
            self.step /= 2
            if self.step < SMALLEST:
                raise SimulationError(f"no equilibrium was found above {self.share:.4g} of the "
                                      f"load: {self._reason(target)}", None)

    def _let_go(self) -> None:
        """Let go the ways that were held while the loads were applied.

        Raises
        ------
        SimulationError
            They come to rest nowhere.
        """
        run, spin = self.run, self.steady
        self._start = run.state.now.copy()
        self.ways.let_go(spin)
        with self.ways.rounded():
            found = balance(run, self.tolerance, spin)
            near = size(run, moved_by(run, self._start)) < NEAR
            stable = found is not None and near and self._accepts(found.tangent)
        if found is None or not near:
            self._back()
            rests = self._rolls(spin, 1.0)
        else:
            if not stable:      # on top of a support
                self._leave(spin, 1.0, found.tangent, self._rolls)
            rests = self._placed(spin)
        if not rests:
            why = self.ways.reason()
            self._back()
            self.ways.hold()
            run.rows.stretches.append(run.state.now[None].copy())
            raise SimulationError(f"no equilibrium was found: {why}", None)
        self.notes += self.ways.kinks

    def _rolls(self, spin: Spin, target: float) -> bool:
        """Tell whether points on paths move to where they rest."""
        try:
            with self.ways.rounded():
                settles = settle(self.run, self.tolerance, spin, False, self._work)
            return settles and self._placed(spin) and self._accepts(
                linear(self.run, spin, None)[0])
        except InputError:      # a point is beyond the end of its path
            return False

    def _placed(self, spin: Spin) -> bool:
        return self.ways.place(spin, lambda: balance(self.run, self.tolerance, spin) is not None)

    def _accepts(self, tangent: csc_matrix) -> bool:
        return not self.judged or self._is_stable(1.0, tangent)

    def load(self, share: float) -> None:
        """Set the loads of the run to a share of them."""
        state = self.run.state
        state.loads[:], state.coefficients[FIELD:] = share * self.loads, share * self.field

    def _back(self) -> None:
        self.run.state.now[:] = self._start

    def _reach(self, target: float) -> bool:
        """Tell whether the structure gets to an equilibrium under a share of the load."""
        run, tolerance, spin = self.run, self.tolerance, self.steady.times(np.sqrt(target))
        found = balance(run, tolerance, spin, stiff=self._slack)
        if not self.judged:
            if found is None:       # motions of what spins may have no stiffness
                self._back()
                return settle(run, tolerance, spin, False, self._work)
            return True
        if found is not None and self._is_stable(target, found.tangent):
            return self._follows(target, found.first)
        if self._settles(spin, target, found):
            return True
        if found is not None and self._unstable:
            return True
        if self.step > FOLLOWED:
            return False
        return (self._snap(spin, target) if found is None else
                self._leave(spin, target, found.tangent, self._rests))

    def _follows(self, target: float, first: float) -> bool:
        """Tell if a stable state is where the path leads, or the path ends and it may be another.

        The first correction says how far that is.
        """
        distance = size(self.run, moved_by(self.run, self._start))
        if self._slack or distance < max(JUMP * first, NEAR):
            return True
        if self.step > FOLLOWED:
            return False
        self._note_snap(target)
        return True

    def _settles(self, spin: Spin, target: float, found: Found | None) -> bool:
        """Let what nothing may hold at the start settle; False where this is not to be tried."""
        first = self.share == 0.0 and self.step == 1.0 / self.steps
        if not (self._slack or first) or (found is not None and (self.keep or self._stiff)):
            return False
        now = self.run.state.now.copy()
        self._back()
        if settle(self.run, self.tolerance, spin, self._slack, self._work):
            self._refuse_folded(target)
            self._slack = True
            return True
        self.run.state.now[:] = now
        return False

    def _is_stable(self, target: float, tangent: csc_matrix) -> bool:
        """Tell if an equilibrium is stable; nothing can be said where loads follow the structure.

        Raises
        ------
        SimulationError
            Only the model has it, not the structure.
        """
        self._refuse_folded(target)
        stiffness = Stiffness(self.run, tangent, self._unit)
        return stiffness.follows or stiffness.stable()

    def _refuse_folded(self, target: float) -> None:
        if folded := self.tensions.spurious(self.run):
            self._back()
            raise SimulationError(f"the equilibrium at {target:.4g} of the load {folded}", None)

    def _rests(self, spin: Spin, target: float) -> bool:
        """Tell whether the structure settles, from where it is, in a stable state."""
        try:
            return (settle(self.run, self.tolerance, spin, False, self._work)
                    and self._is_stable(target, linear(self.run, spin, None)[0]))
        except InputError:      # cannot be evaluated: a point is beyond the end of its path
            return False

    def _leave(self, spin: Spin, target: float, tangent: csc_matrix,
               rests: Callable[[Spin, float], bool]) -> bool:
        """Leave an unstable state to one of its sides; True, as it is kept where neither rests."""
        found = self.run.state.now.copy()
        self.step = 1.0 / self.steps
        if not self.keep:
            motion = Stiffness(self.run, tangent, self._unit).softest().motion
            for side in (1.0, -1.0):
                self.run.state.now[:] = found
                nudge(self.run, motion, side)
                if rests(spin, target):
                    self.notes.append(f"left an unstable state at {target:.4g} of the load")
                    return True
            self.run.state.now[:] = found
        self._unstable = True
        self.notes.append(f"unstable from {target:.4g} of the load on" + self._searched())
        return True

    def _snap(self, spin: Spin, target: float) -> bool:
        """Settle somewhere else from a state beyond which the path does not go on."""
        if self.keep or self._tried == self.share:
            return False
        self._tried = self.share
        self._back()
        if not self._rests(spin, target):
            return False
        self._note_snap(target)
        return True

    def _note_snap(self, target: float) -> None:
        distance = size(self.run, moved_by(self.run, self._start))
        if distance > NUDGE:        # else the path goes on, where Newton's iteration fails
            self.notes.append(f"moved far, by {distance:.3g} sizes of the model or radians, "
                              f"between {self.share:.4g} and {target:.4g} of the load")
        self.step = 1.0 / self.steps

    def _reason(self, target: float) -> str:
        """The reason why nothing is found from the last state on."""
        run, spin = self.run, self.steady.times(np.sqrt(target))
        said = user_faults.fault(run.model, -np.inf) or self.tensions.reason(run)
        if said:
            return said
        if said := in_turns(run, spin):
            return said
        try:
            tangent, residual = linear(run, spin, None)
        except InputError as error:
            return str(error)
        solver = Scaled(tangent)
        correction = solution(run, solver, residual)
        if not np.isfinite(correction).all():
            free = self._name(solver.least(residual)[1])
            return (f"a load moves {free}, which is free to move: hold it, or let something "
                    f"resist this load{remedy(run)}")
        if lost := self._softest_now(tangent):
            return (f"the structure buckles or snaps, mostly at {lost}, and settles in no stable "
                    f"state nearby{self._searched()}"
                    + ("; unstable='leave' lets it move on" if self.keep else "") + remedy(run))
        if size(run, correction) > FAR:
            return (f"a small part of the load moves {self._name(correction)} far: use more "
                    "steps, or supports for what is free to move")
        return (f"forces on {self._name(solver.scale * residual)} do not come to balance"
                + (remedy(run) or f": {RUN}"))

    def _searched(self) -> str:
        """Length of searches for stable states that were in vain."""
        return f", where {self._work.vain} iterations found none" * bool(self._work.vain)

    def _softest_now(self, tangent: csc_matrix) -> str:
        """The place of the softest motion, if it has lost its stiffness since the loads began."""
        state, now = self.run.state, self.run.state.now.copy()
        soft = Stiffness(self.run, tangent, self._unit).softest()
        state.now[:] = self.run.rows.stretches[0][0]
        self.load(0.0)
        still = Spin.of(self.run.model, None)
        first = Stiffness(self.run, linear(self.run, still, None)[0], self._unit).softest()
        state.now[:] = now
        return self._name(soft.motion) if soft.stiffness < LOST * first.stiffness else ""

    def _name(self, change: NDArray) -> str:
        """The position or rotation, or else the unknown, with the largest part of a change."""
        n = len(change)
        magnitude = self.run.system.magnitude[:n]
        if not (change * magnitude).any():      # of a body that is held at all its nodes
            magnitude = np.ones(n)
        parts = np.where(magnitude > 0.0, np.abs(change) / np.maximum(magnitude, 1e-300), 0.0)
        return self.run.numbering.names[int(np.argmax(parts))].partition("[")[0]

    def verdict(self) -> str:
        """Tell whether the state is stable, and where the path was not, in words."""
        if not self.judged:
            return "not judged, as the frame rotates"
        stiffness = Stiffness(self.run, linear(self.run, self.steady, None)[0], self._unit)
        now = ("not judged, as loads follow the structure or friction holds it"
               if stiffness.follows else "stable" if stiffness.stable() else "unstable")
        return "; ".join([now, *self.notes])
