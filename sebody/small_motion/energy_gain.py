"""The energy that a run with fixed steps will gain: known before it, from small vibrations.

Generalized-alpha with little numerical damping is nearly the trapezoidal rule. In a conservative
system this keeps, up to the fourth order of the step h,

    H + h^2 / 12 Q,      Q = v . K v + a . M a,

the second derivative of the energy H along the motion, with velocities v, accelerations a, mass M
and stiffness K (`tests/benchmarks/README.md`, "Why energy oscillates"). A vibration of angular
frequency omega and energy E adds ``2 omega^2 E`` to Q. As long as vibrations are linear, Q is
constant and so is H. Bodies that bend far exchange energy between vibrations, at most all of it,
and H gains up to

    h^2 / 12 * sum 2 omega^2 E = (h omega_e)^2 / 6 * sum E

with ``omega_e^2 = sum omega^2 E / sum E`` over all vibrations.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.evaluation import evaluate
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import set_loads, to_body_axes
from sebody.model.model import Model
from sebody.runs.simulation import Simulation, Standstill
from sebody.small_motion.eigenvalues import EPS
from sebody.small_motion.linearization import vibrations

UNITS = 100.0           # in the last place of places: below it a motion is rounding
SAMPLES = 400           # of the loads, besides their corners
RIGID = 1e-6            # of the highest frequency, or of 1 / until: below it motions are rigid


class EnergyGain(NamedTuple):
    """Gain that a run may have, relative to the energy of its vibrations; see `energy_gain`."""

    energy: float       # of the vibrations, once the loads have acted
    omega: float        # root mean square of their angular frequencies, weighted by energy [1/time]

    def at(self, h: float) -> float:
        """Gain of a run with a step, over the energy of vibrations."""
        return (inputs.number(h, "the time step", above=0) * self.omega)**2 / 6.0

    def step(self, gain: float = 1e-3) -> float:
        """Step up to which a run gains no more than that, over the energy of vibrations."""
        return float(np.sqrt(6.0 * inputs.number(gain, "gain", above=0)) / self.omega)


def energy_gain(model: Model, until: float) -> EnergyGain:
    """The energy that fixed steps may add to the vibrations that a blow and a spin leave behind.

    Loads from t = 0 to `until` act on the model where it stands and, with the forces of its
    initial velocities, excite small vibrations about it. The gain is an estimate from above of how
    far the energy oscillates in later motion without work, with the default scheme: bodies that
    bend within the linear range, 0.3 rad, gain up to twice as much, most of them less than half.

    Parameters
    ----------
    model : Model
    until : float
        Time after which loads do no more work [time].

    Returns
    -------
    EnergyGain

    Raises
    ------
    InputError
        A time that is not positive, a model that is not stable where it stands or has motions
        without mass, or one in which nothing vibrates.

    Examples
    --------
    >>> forecast = energy_gain(model, 0.01)     # a blow of 10 ms         # doctest: +SKIP
    >>> forecast.at(1e-3), forecast.step(1e-3)                            # doctest: +SKIP
    (0.0082, 0.00035)
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    until = inputs.number(until, "until", above=0)
    run = Standstill(model, until)
    state, n = run.state, run.numbering.free
    velocity = state.v.copy()
    state.v[:] = state.a[:] = 0.0
    found = vibrations(run)
    elastic = found.omega > RIGID * found.omega.max(initial=1.0 / until)
    omega, shapes = found.omega[elastic], found.shapes[:, elastic]
    times = np.union1d(np.linspace(0.0, until, SAMPLES + 1),
                       run.system.corners[run.system.corners < until])
    rates = shapes.T @ _momenta(run, velocity)[:n]
    state.v[:], state.a[:] = velocity, 0.0
    forces = np.array([_forces(run, t)[:n] @ shapes for t in times])
    energies = _energies(omega, rates, times, forces)
    energy = float(energies.sum())
    if not energy > _rounding(run, omega, shapes):
        raise InputError(f"nothing vibrates at t = {until:.6g}: give the model loads that act "
                         "before, or initial velocities, on something elastic")
    return EnergyGain(energy, float(np.sqrt(omega**2 @ energies / energy)))


def _rounding(run: Simulation, omega: NDArray, shapes: NDArray) -> float:
    """Energy of vibrations whose amplitudes are rounding of the places that nodes have."""
    sized = np.flatnonzero(run.system.magnitude[:len(shapes)])      # positions and rotations
    size, q = run.system.magnitude[sized], run.state.q[sized]
    places = UNITS * EPS * max(1.0, np.abs(q / size).max(initial=0.0))
    moved = np.abs(shapes[sized] / size[:, None]).max(axis=0, initial=1e-300)
    return float(np.sum((omega * places / moved)**2 / 2.0))


def _forces(run: Simulation, t: float) -> NDArray:
    """Forces on the unknowns where the model stands, with the loads of a time."""
    set_loads(run.system, run.state.frames, run.state.loads, t)
    return -_residual(run)


def _momenta(run: Simulation, velocity: NDArray) -> NDArray:
    """Mass times a velocity."""
    rest = _residual(run)
    run.state.a[:] = velocity
    return _residual(run) - rest


def _residual(run: Simulation) -> NDArray:
    evaluate(run.system, run.state, RESIDUAL, RESIDUAL, "the initial state")
    residual = run.state.residual.copy()
    to_body_axes(run.system, run.state.frames, residual, False)
    return residual


def _energies(omega: NDArray, rates: NDArray, times: NDArray, forces: NDArray) -> NDArray:
    """Energies of vibrations about where the last forces hold them; forces are linear in between.

    Parameters
    ----------
    omega, rates : (m,)
        Angular frequencies, and initial rates of the modal coordinates, which start from zero.
    times : (k,)
    forces : (k, m)
    """
    x, rate = np.zeros(len(omega)), rates
    for t, end, force, last in zip(times[:-1], times[1:], forces[:-1], forces[1:], strict=True):
        slope = (last - force) / (end - t)
        cosine, sine = np.cos(omega * (end - t)), np.sin(omega * (end - t))
        from_static = x - force / omega**2
        lag = (rate - slope / omega**2) / omega
        x = from_static * cosine + lag * sine + last / omega**2
        rate = omega * (lag * cosine - from_static * sine) + slope / omega**2
    return (rate**2 + (omega * x - forces[-1] / omega)**2) / 2.0
