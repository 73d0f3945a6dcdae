"""Critical speeds of a rotor, exactly: roots of ``omega_k(W) = n W``."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from sebody.basics import inputs
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.small_motion.crossings import Crossings, orders_of, refuse_turning
from sebody.small_motion.linearization import Modes, modes_in
from sebody.small_motion.rotation.speeds import Rotations
from sebody.small_motion.rotation.whirls import whirls

SAMPLES = 16        # speeds between which crossings are looked for
BEYOND = 1.5        # of the highest frequency at rest over the order: the fastest speed by default
FREE = 1e-7         # of the highest frequency: the rate of a free turn, which is no vibration
EXACT = 1e-10       # of a critical speed


def critical_speeds(model: Model, axis: ArrayLike | None = None, orders: ArrayLike = (1.0,),
                    count: int = 8, fastest: float | None = None, steps: int = 1,
                    frame: str = "auto", hub: Node | str | None = None) -> Crossings:
    """Speeds at which a frequency is a multiple of the speed, with whirl and damping.

    Parameters
    ----------
    model : Model
        Its unbalances are left out.
    axis : (3,), optional
        Axis of rotation in space, by default that of the model's hinges and bearings.
    orders : sequence of float
        The multiples: 1 is what unbalances excite, the number of blades what these feel.
    count : int
        How many of the lowest vibrations at rest are followed.
    fastest : float, optional
        Highest speed; by default half more than the highest of these frequencies at rest, over the
        lowest order, or where tables of bearings end [1/time].
    steps : int
        Load steps of each equilibrium.
    frame, hub
        See `modes`.

    Returns
    -------
    Crossings
        Above the slowest speed that all tables of bearings have. The frequency is the imaginary
        part of the damped eigenvalue. Unbalance excites forward whirls, backward ones where
        supports are not isotropic, and no vibrations along and about the axis.

    Raises
    ------
    InputError
        Orders or a speed that are not positive, no axis or several, or frequencies that only
        turning axes have.
    SimulationError
        A speed without an equilibrium.
    """
    multiples = orders_of(orders)
    count = inputs.integer(count, "count", least=1)
    if fastest is not None:
        fastest = inputs.number(fastest, "fastest", above=0)
    rotations = Rotations(model, axis, 1.0 if fastest is None else fastest, frame, hub, steps,
                          "critical speeds")
    refuse_turning(rotations.view.frame, rotations.view.reason)
    search = _Search(rotations)
    still = search.at(rotations.slowest).omega
    vibrations = np.flatnonzero(still > FREE * still.max())[:count] - len(still)
    if fastest is None:
        fastest = min(BEYOND * still[vibrations].max() / multiples.min(), rotations.fastest)
    speeds = np.linspace(rotations.slowest, fastest, SAMPLES + 1)
    return Crossings.sorted(
        (*search.crossing(k, order, between), int(k - vibrations[0]))
        for k in vibrations for order in multiples
        for between in zip(speeds, speeds[1:], strict=False)
        if search.gap(k, order, between[0]) > 0.0 >= search.gap(k, order, between[1])
        or search.gap(k, order, between[0]) < 0.0 <= search.gap(k, order, between[1]))


class _Search:
    """Modes at speeds, each found once.

    The frequencies in ascending order are continuous functions of the speed, counted from the
    highest: what is damped beyond vibrating joins the zeros below.
    """

    def __init__(self, rotations: Rotations):
        self._rotations = rotations
        self._known: dict[float, Modes] = {}

    def at(self, speed: float) -> Modes:
        """Modes about the rotation at a speed."""
        if speed not in self._known:
            self._known[speed] = modes_in(*self._rotations.at(speed))
        return self._known[speed]

    def gap(self, k: int, order: float, speed: float) -> float:
        """A frequency less a multiple of the speed."""
        return float(self.at(speed).omega[k] - order * speed)

    def crossing(self, k: int, order: float, between: tuple[float, float]) -> tuple:
        """The place where this gap closes: speed, order, eigenvalue, whirl."""
        speed = brentq(lambda at: self.gap(k, order, at), *between, xtol=EXACT * between[1])
        modes = self.at(speed)
        names = whirls(self._rotations.model, modes, self._rotations.unit)
        return speed, order, modes.values[k], names[k]
