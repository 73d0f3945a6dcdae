"""In which axes an analysis about a rotation is written: one decision for all of them.

An analysis finds what turns and what stands (`turning_parts`), and takes the first axes in which
its matrices are constant, tested by turning the model to other azimuths: *standing* ones for an
axisymmetric rotor on any supports, *turning* ones for any rotor on isotropic supports. Three or
more equal blades on a hub have *multiblade* coordinates, with a ripple that is averaged. All else
is periodic (*floquet*).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm, null_space

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import known
from sebody.model.model import Model
from sebody.model.parts import DofBlock, Node
from sebody.results.result import Result
from sebody.runs.bearing_speeds import check_read
from sebody.runs.rotating_frame import Spin, Turning, motion
from sebody.runs.simulation import Simulation
from sebody.runs.turning_parts import parts_of, unloaded
from sebody.small_motion.coordinate_names import coordinate_names
from sebody.small_motion.rotation.azimuths import (
    Base,
    Matrices,
    base_matrices,
    steady,
    substituted,
)
from sebody.small_motion.rotation.blades import found_blades
from sebody.small_motion.rotation.periodic import Coordinates, Revolution

FRAMES = "auto", "standing", "turning", "multiblade", "floquet"
AZIMUTHS = 0.7, -1.6, 2.9   # of what turns fastest, where matrices are compared with those at
                            # azimuth zero; less than half a turn, which elements count [rad]
RIPPLE = 1e-6               # in multi-blade coordinates of blades that are alike
CONSTANT = 1e-8             # change of matrices that are constant, of the stiffness of coordinates
NOTHING_TURNS = "nothing turns by itself, so all supports turn, too"
NOTHING_STANDS = "nothing stands"
AXISYMMETRIC = "what turns is axisymmetric"
ISOTROPIC = "what stands is isotropic about the axis"
MISSING = {"standing": "what turns is not axisymmetric",
           "turning": "what stands is not isotropic about the axis"}


@dataclass(frozen=True)
class View:
    """Axes of an analysis.

    Attributes
    ----------
    frame : str
        ``standing``, ``turning`` and so on; empty at rest.
    reason : str
        Why.
    spin : Spin
        Of the parts that turn, or of everything.
    """

    frame: str
    reason: str
    spin: Spin
    hub: Node | None = None

    @property
    def speed(self) -> float:
        """Rate of the azimuth."""
        return float(np.sqrt(self.spin.squared))

    def matrices(self, run: Simulation | Result) -> Matrices:
        """Mass, damping and stiffness, constant ones; of what rotates.

        Raises
        ------
        InputError
            Motion is periodic: it has no such matrices.
        """
        if self.frame == "floquet" and self.speed:
            raise InputError("the motion is periodic: no axes make its matrices constant, so it "
                             "has modes and a Campbell diagram alone; " + self.reason)
        if self.frame == "multiblade":
            return self.revolution(run).averaged()
        own = base_matrices(run, self.spin)
        if self.spin.parts is None:
            return own
        G = self._generator(run)
        return substituted(own, self.speed, np.eye(len(G)), G, G @ G)

    def revolution(self, run: Simulation | Result) -> Revolution:
        """Matrices over a revolution, in multi-blade coordinates if there are blades."""
        return Revolution.of(run, self.spin, self._coordinates(run))

    def base(self, run: Simulation | Result, unknowns: NDArray, rates: NDArray, seconds: NDArray
             ) -> tuple[NDArray, NDArray, NDArray]:
        """Motions in base coordinates, (k, n) and their rates, by those in these axes."""
        if self.spin.parts is None:
            return unknowns, rates, seconds
        P, P1, P2 = (one.T for one in self._substitution(run))
        W = self.speed
        return (unknowns @ P, rates @ P + W * unknowns @ P1,
                seconds @ P + 2.0 * W * rates @ P1 + W**2 * unknowns @ P2)

    def pushed(self, run: Simulation | Result, push: NDArray) -> NDArray:
        """Forces on the coordinates of these axes by those on the unknowns."""
        if self.frame == "multiblade":
            return self._substitution(run)[0].T @ push
        return push

    def shapes(self, run: Simulation | Result, shapes: NDArray) -> NDArray:
        """Shapes of the unknowns at azimuth zero, in their own axes."""
        if self.frame in ("multiblade", "floquet"):
            return self._substitution(run)[0] @ shapes
        return shapes

    def _substitution(self, run: Simulation | Result) -> tuple[NDArray, NDArray, NDArray]:
        """P of the unknowns in their own axes, and its derivatives, at azimuth zero."""
        if self.frame in ("multiblade", "floquet"):
            own = self._coordinates(run)
            parts = own.at(0.0)
            # these coordinates are told in global axes
            return tuple(own.base.axes.T @ one for one in parts)
        G = self._generator(run)
        return np.eye(len(G)), G, G @ G

    def _coordinates(self, run: Simulation | Result) -> Coordinates:
        blades = None if self.hub is None else found_blades(run, self.spin, self.hub)
        return Coordinates.of(run, self.spin, blades)

    def _generator(self, run: Simulation | Result) -> NDArray:
        """Matrix of base coordinates by those of these axes, of the unknowns in their own axes."""
        base = Base.of(run, self.spin)
        return base.axes.T @ (base.still if self.frame == "standing" else base.turned) @ base.axes


def view(run: Simulation | Result, spin: ArrayLike | None, frame: str = "auto",
         hub: Node | str | None = None) -> View:
    """The axes of an analysis about the state of a run.

    Raises
    ------
    InputError
        A wrong spin, or a frame in which the matrices are not constant.
    """
    frame = inputs.choice(frame, "frame", FRAMES)
    given = Spin.of(run.model, spin)
    if not given.rotates:
        check_read(run.model, given)
        if spin is None and frame != "auto":
            raise InputError(f"frame={frame!r} is of a steady rotation: give spin=, its angular "
                             "velocity")
        return View("", "", given)
    own = None if hub is None else known(run.model, hub)
    whole = parts_of(run.model, given, own)
    check_read(run.model, whole)
    return decided(run.model, whole, frame, own)


def decided(model: Model, spin: Spin, frame: str, hub: Node | None = None) -> View:
    """The axes for what turns and what stands, tested where the model is built."""
    if spin.parts is None:
        if frame not in ("auto", "turning"):
            raise InputError(f"frame={frame!r}: {NOTHING_TURNS}: leave frame= out, or hold the "
                             "rotor by joints or bearings that let it turn")
        return View("turning", NOTHING_TURNS, spin)
    if frame in ("auto", "turning") and not _stands(model, spin.parts):
        return View("turning", NOTHING_STANDS, spin)
    run = unloaded(model)
    if frame in ("multiblade", "floquet"):
        return _periodic(run, spin, frame, hub, "it was asked for")
    base = Base.of(run, spin)
    candidates = {"standing": AXISYMMETRIC, "turning": ISOTROPIC}
    wanted = candidates if frame == "auto" else {frame: candidates[frame]}
    worst = {}
    for one, reason in wanted.items():
        worst[one] = _change(run, spin, base, one)
        if worst[one].size <= CONSTANT:
            return View(one, reason, spin)
    said = _not_constant(run, worst)
    if frame != "auto":
        raise InputError(f"the matrices about the rotation are not constant: {said}: leave frame= "
                         "out")
    return _periodic(run, spin, frame, hub, " and ".join(MISSING.values()))


def _periodic(run: Simulation, spin: Spin, frame: str, hub: Node | None, why: str) -> View:
    """Multi-blade coordinates of equal blades, or multipliers of a revolution."""
    if frame == "multiblade" and hub is None:
        raise InputError("frame='multiblade' needs hub=, the node where the blades join")
    try:
        own = View("multiblade", "", spin, hub)
        ripple = own.revolution(run).ripple(own.speed) if hub is not None else np.inf
    except InputError:
        if frame == "multiblade":
            raise
        own, ripple = View("floquet", why, spin), np.inf
    if frame == "multiblade" or frame == "auto" and ripple < RIPPLE:
        return replace(own, reason=f"blades are alike; ripple {ripple:.2g}, averaged")
    return replace(own, frame="floquet", reason=why)


def _not_constant(run: Simulation | Result, worst: dict[str, _Change]) -> str:
    names = coordinate_names(run)
    return "; ".join(f"in {one} axes they change by {change.size:.2g} of the stiffness of "
                     f"{names[change.place]!r}, since {MISSING[one]}"
                     for one, change in worst.items())


def _stands(model: Model, parts: dict[DofBlock, Turning]) -> bool:
    """Tell whether anything stands: fixed or free blocks that do not turn."""
    blocks = [t for n in (*model.nodes.values(), *model.grounds) for t in (n.position, n.rotation)
              if t is not None]
    return any(t not in parts or t.fixed for t in blocks)


class _Change(NamedTuple):
    """The largest change of matrices as the azimuth changes."""

    size: float     # of the sizes of the coordinates
    place: int      # of one of these


def _change(run: Simulation | Result, spin: Spin, base: Base, frame: str) -> _Change:
    """Changes of matrices in some axes with the azimuth."""
    speed = float(np.sqrt(spin.squared))
    multipliers = np.flatnonzero(run.arrays_of_loop[0].is_multiplier[:run.numbering.free] > 0)
    moving = np.setdiff1d(np.arange(run.numbering.free), multipliers)
    first, N, size = None, np.eye(len(moving)), np.ones(len(moving))
    worst = _Change(0.0, int(moving[0]))
    assert spin.parts is not None
    fastest = max(1.0, *(abs(one.factor) for one in spin.parts.values()))
    for azimuth in (0.0, *(one / fastest for one in AZIMUTHS)):
        M, C, K = at_azimuth(run, spin, base, frame, azimuth)
        G = K[np.ix_(multipliers, moving)]
        inner = [X[np.ix_(moving, moving)] for X in (speed**2 * M, speed * C, K)]
        if first is None:
            N = null_space(G) if multipliers.size else N
            first = [N.T @ X @ N for X in inner]
            size = np.sqrt(sum(np.abs(np.diag(X)) for X in first))
            size = np.maximum(size, 1e-9 * size.max(initial=1e-300))
            lengths = np.maximum(np.linalg.norm(G, axis=1), 1e-300)[:, None]
            continue
        changes = [np.abs(N.T @ X @ N - old) / np.outer(size, size)
                   for X, old in zip(inner, first, strict=True)]
        change = max(changes, key=lambda one: one.max(initial=0.0))
        left = np.abs(G @ N / lengths).max(initial=0.0) if multipliers.size else 0.0
        if (found := max(change.max(initial=0.0), left)) > worst.size:
            own = int(np.argmax(change.max(axis=1))) if change.size else 0
            worst = _Change(float(found), int(moving[np.argmax(np.abs(N[:, own]))]))
    return worst


def at_azimuth(run: Simulation | Result, spin: Spin, base: Base, frame: str, azimuth: float
               ) -> Matrices:
    """Matrices at an azimuth in standing or turning axes, positions in global axes."""
    own = base_matrices(run, spin, azimuth)
    with steady(run, spin, azimuth):
        axes = motion(run)[:run.numbering.free].toarray()
    matrices = tuple(axes @ X @ axes.T for X in own)
    if frame == "standing":
        G, turns = base.still, np.where(np.outer(base.places, base.places), 0.0, base.still)
    else:
        G, turns = base.turned, base.turned + base.spatial
    P = expm(azimuth * turns)
    return substituted(matrices, float(np.sqrt(spin.squared)), P, G @ P, G @ G @ P)
