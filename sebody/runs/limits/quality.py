"""Warnings of a run that has ended: from its energies, its steps and its fastest vibrations."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh, null_space

from sebody.assembly.allocation import allocate
from sebody.assembly.evaluation import matrix
from sebody.basics.errors import InputError
from sebody.contract.layout import ENERGIES, RECORD_T
from sebody.engine import growth
from sebody.engine.evaluate import to_body_axes
from sebody.model.numbering import record_counts
from sebody.model.parts import Element
from sebody.results import energy_balance
from sebody.results.audit import DRIFT
from sebody.results.postprocessing import energies
from sebody.results.recording import Recording
from sebody.runs.limits.thresholds import CUT, EXCITED, GROWN, PERIOD, WAVERS

LOOKED_AT = 200     # recorded states whose constraints are looked at
SMALL = 100         # unknowns up to which vibrations are looked for, by dense algebra
MASSLESS = 1e-12    # of the mean mass, where there is none
IDLE = 1e-9         # of all work: nothing works between two states
NO_MOTION = 1e-9    # of all energies: kinetic energy of a model at rest


def remarks(run: Recording) -> dict[str, str]:
    """Warnings by key; `run` has its rows from the start on.

    Of a run that failed, which has said why, and of one that kept to a tolerance, the step is not
    judged: their cuts and energies count.
    """
    scratch = allocate(run.model, run.system, run.numbering, 1.0, False)    # the run may go on
    try:
        run.energies = energies(run.system, scratch, run.rows)
    except InputError:          # the last state of a run that failed
        return _steps(run) | _guarded(run)
    message = energy_balance.warning(run.energy_balance(),
                                     bool(run.state.control.adaptive))
    by_key = ({"balance": message} if message else {}) | _steps(run) | _guarded(run)
    if run.failure or run.state.control.adaptive:
        return by_key
    columns = ENERGIES.slices(record_counts(run.numbering))
    kinetic, strain, potential = (run.energies[:, columns[name]][:, 0]
                                  for name in ("kinetic", "strain", "potential"))
    part = Recording(run.model, run.numbering, run.system, scratch, run.rows, 0.0)
    work = part.recorded("works").sum(axis=1)
    h = float(run.rows[-1, RECORD_T]) / max(int(run.state.control.steps), 1)
    if "balance" not in by_key:
        by_key |= _grown(part, h, kinetic, strain, potential, work)
    if kinetic.max() > NO_MOTION * (np.abs(potential).max() + strain.max()):
        states = {int(np.argmax(kinetic)), int(np.argmax(strain))}
        by_key |= _vibrations(part, sorted(states), h, kinetic.max())
    if run.numbering.multipliers:
        chosen = np.unique(np.linspace(0, len(run.rows) - 1, LOOKED_AT).astype(int))
        part.rows = run.rows[chosen]
        by_key |= _constraints(part)
    return by_key


def _grown(part: Recording, h: float, kinetic: NDArray, strain: NDArray, potential: NDArray,
           work: NDArray) -> dict[str, str]:
    """Tell whether energy grows that nothing supplies: of all that there is, or of vibrations."""
    inner = kinetic + strain
    energy, largest = inner + potential, inner.max()
    grown = (increase(energy, work) - energy_balance.rounded(inner, potential)) / max(
        largest, 1e-300)
    if grown > GROWN:
        deforms = part.model.bodies and strain.max() > GROWN * largest
        cause = ("vibrations of a strongly bent body; take a smaller step, divide the body, or "
                 "keep the position of a node off the line of the others" if deforms else
                 "the fastest motion of its rigid parts; take a smaller step, or rho below 1")
        return {"growth": f"energy grows by {grown:.2g} of its maximum "
                f"although no work is done on the model (limit {GROWN:g}): the steps do not "
                f"resolve {cause}"}
    most = strain.max()
    rise = increase(energy, work, from_lowest=False)
    allowed = WAVERS * most + growth.TURNED * _turned(part, h)**2 * kinetic.max()
    if rise <= allowed or most <= EXCITED * kinetic.max():
        return {}
    # the gain is of second order in the step
    step = h * np.sqrt(WAVERS * most / rise)
    cause = ("bodies that bend far exchange energy between vibrations" if part.model.bodies else
             "springs exchange energy with what moves")
    predicted = " (sebody.analysis.energy_gain predicts it)" * bool(part.model.bodies)
    return {"growth": f"energy grows by {rise / most:.2g} of the largest strain energy although no "
            f"work is done on the model (limit {WAVERS:g}): {cause}, and the steps follow it to "
            f"second order; below a step of {step:.2g} the gain is within the limit{predicted}"}


def _turned(part: Recording, h: float) -> float:
    """Largest rotation of the frame of a body in a step, from recorded states."""
    frames = part.recorded("frames")[:, :9 * len(part.numbering.modes)]
    if len(frames) < 2 or not frames.size:
        return 0.0
    changes = np.diff(frames, axis=0).reshape(len(frames) - 1, -1, 9)
    between = np.linalg.norm(changes, axis=2).max(axis=1) / np.sqrt(2.0)
    return float(h * (between / np.maximum(np.diff(part.rows[:, RECORD_T]), h)).max())


def increase(energy: NDArray, work: NDArray, from_lowest: bool = True) -> float:
    """Largest increase of an energy over stretches of states between which no work is done.

    Parameters
    ----------
    energy, work : (n,)
    from_lowest : bool
        Above the lowest value in the stretch so far, else above the first one.
    """
    idle = np.abs(np.diff(work)) <= IDLE * max(np.ptp(work), np.ptp(energy))
    least, most = energy[0], 0.0
    for still, now in zip(idle, energy[1:], strict=True):
        if not still or (from_lowest and now < least):
            least = now
        most = max(most, now - least)
    return float(most)


def _guarded(run: Recording) -> dict[str, str]:
    """Interventions of the guard against energy that grows."""
    guard, control = run.state.guard, run.state.control
    count = int(guard.rejections)
    if not count:
        return {}
    parts = 2 ** int(guard.most_halved)
    share = f"{100.0 * growth.SHARE:g} %"
    done = (f"energy grew by {share} of the strain energy although nothing supplied it: "
            f"{count} steps from t = {guard.first:.6g} to {guard.last:.6g} were "
            f"repeated with shorter ones, down to 1/{parts}")
    if guard.in_vain:
        done += f"; it grew in {int(guard.in_vain)} of the shortest steps, too"
    if guard.off:
        done += ", and then the run went on without this check"
    remedy = ("a smaller tolerance" if control.adaptive else
              f"a step of {float(run.state.clock.step) / parts:.2g}")
    return {"guard": f"{done}. Steps do not resolve vibrations of a body that bends far or turns "
            f"fast; take {remedy}, divide the body, or use its default inertia and frame"}


def _steps(run: Recording) -> dict[str, str]:
    """Tell whether many steps were rejected, for other reasons than energy that grows."""
    steps = int(run.state.control.steps)
    cuts = int(run.state.control.cuts - run.state.guard.rejections)
    if cuts <= CUT * steps:
        return {}
    pressing = any("slow" in load.constants for load in run.model.loads)    # see `model.impacts`
    why = ("contacts, stops or gears meet within steps, or Newton's iteration does not "
           "converge" if pressing else "Newton's iteration does not converge")
    return {"cuts": f"{cuts} rejected steps, {steps} accepted (limit of the ratio {CUT:g}): {why}; "
            "take a smaller step, or smoother loads and softer bodies"}


def _constraints(part: Recording) -> dict[str, str]:
    """Tell whether the constraints hold, rotational ones compared with one radian."""
    equations: list[Element] = part.model.constraints
    extent = part.system.magnitude.max()
    turning = all(t.rotational for c in equations for t in c.dof_blocks)
    size = 1.0 if turning or not extent > 0.0 else extent
    off = part.constraint_residuals[:, 0].max() / size
    if off <= DRIFT:
        return {}
    return {"constraints": f"the largest constraint residual is {off:.2g} of the model's "
            f"characteristic length (limit {DRIFT:g}): take a smaller tolerance of the scheme, or "
            "a smaller step"}


def _vibrations(part: Recording, states: list[int], h: float, largest: float) -> dict[str, str]:
    """Tell whether the fastest vibration that has energy takes too few steps a period."""
    if part.numbering.free > SMALL:
        return {}
    omega = max(_fastest(part, part.rows[k], EXCITED * largest) for k in states)
    if omega * h * PERIOD <= 2.0 * np.pi:
        return {}
    return {"period": f"vibrations of {omega:.4g} rad/s are excited and have "
            f"{2.0 * np.pi / (omega * h):.2g} steps per period (limit {PERIOD:g}): take a step of "
            f"{2.0 * np.pi / (omega * 3.0 * PERIOD):.2g}, or apply loads more gradually"}


def _fastest(part: Recording, row: NDArray, energy: float) -> float:
    """Largest angular frequency of the free vibrations of a state that have some energy.

    The energy of a vibration of modal coordinate x is at most ``(x'' / omega)^2 / 2``. Motion that
    is slow against a vibration adds hardly anything to it: accelerations are projected, velocities
    would be those of the body as a whole.
    """
    system, state, n = part.system, part.state, part.numbering.free
    state.T[:] = np.tile(np.eye(3).ravel(), len(state.T) // 9)
    state.now[:] = row
    acceleration = state.a.copy()
    state.v[:], state.a[:] = 0.0, 0.0
    K, M = (matrix(system, state, "a recorded state", mass=mass, damping=0.0, stiffness=stiffness,
                   constraint=stiffness).toarray() for mass, stiffness in ((0.0, 1.0), (1.0, 0.0)))
    if not (np.isfinite(K).all() and np.isfinite(M).all()):     # a user force elsewhere
        return 0.0
    to_body_axes(system, state.frames, acceleration, False)
    fixed = system.is_multiplier[:n] > 0.0
    moving, multipliers = np.flatnonzero(~fixed), np.flatnonzero(fixed)
    basis = (null_space(K[np.ix_(multipliers, moving)]) if multipliers.size else
             np.eye(len(moving)))
    if not basis.shape[1]:
        return 0.0
    K, M = (basis.T @ A[np.ix_(moving, moving)] @ basis for A in (K, M))
    M = (M + M.T) / 2 + MASSLESS * np.trace(M) / len(M) * np.eye(len(M))
    try:
        squares, shapes = eigh((K + K.T) / 2, M)
    except LinAlgError:     # a mass that is not positive: bent far out of the linear range
        return 0.0
    modal = shapes.T @ M @ (basis.T @ acceleration[moving])
    excited = (squares > 0.0) & (modal**2 > 2.0 * energy * np.abs(squares))
    return float(np.sqrt(squares[excited].max(initial=0.0)))
