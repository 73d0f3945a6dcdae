"""Numerical damping, step size, and a million steps."""

import numpy as np

from sebody.basics.errors import SimulationError
from sebody.engine.state import Scheme
from sebody.model.model import Model
from sebody.runs.schemes import generalized_alpha, hht
from sebody.runs.simulation import Simulation
from sebody.runs.whole_runs import simulate
from sebody.scenes import planar_hinged_beam, spherical_beam_strong
from sebody.verify.atlas.finding import PROGRAM, Finding, Row

STEPS = 60
DRAWN = 0.0, -0.1       # of HHT's alpha, whose theory is drawn


def damping_of_constraints() -> Finding:
    """A push that a constraint does not allow, for HHT's alpha from 0 to -1/3, and index 2."""
    finding = Finding(
        "disturbed constraints",
        "constraint forces grow if the scheme has no damping",
        "In constrained directions HHT multiplies the state by a matrix with the double eigenvalue "
        "-(1 + alpha)/(1 - alpha). With alpha 0 multipliers grow by 4 per step; in the stabilised "
        "index-2 form they stay at 1/gamma = 2.",
        "sebody warns if constraints of index 3 are integrated without numerical damping.",
        "steps", "acceleration across the constraint, h a / v_0", logarithmic="y")
    for alpha in (0.0, -0.05, -0.1, -0.2, -1 / 3):
        scheme = hht(alpha, tolerance=1e-13)
        pushed = _pushed(scheme)
        theory = _powers(scheme)
        finding.rows.append(Row(f"alpha {alpha:.3g}: after {STEPS} steps", abs(theory[-1]),
                                abs(pushed[-1]), 1e-4))
        finding.curves[f"HHT, alpha {alpha:.3g}"] = np.arange(1, STEPS + 1), np.abs(pushed) + 1e-16
        if alpha in DRAWN:
            finding.predict(f"theory, alpha {alpha:.3g}", np.arange(1, STEPS + 1),
                            np.abs(theory) + 1e-16)
    index_2 = _pushed(hht(0.0, tolerance=1e-13, index=2))
    finding.rows.append(Row(f"index 2, alpha 0: after {STEPS} steps", 2.0, abs(index_2[-1]), 1e-6))
    finding.curves["HHT of index 2, alpha 0"] = np.arange(1, STEPS + 1), np.abs(index_2)
    return finding


def _pushed(scheme: Scheme, push: float = 1e-3, h: float = 0.01) -> np.ndarray:
    model = Model(planar=True)
    node = model.node("ball", (0.0, 0.0), "translation")
    model.point_mass("mass", node, 2.0)
    model.slider(node, (1.0, 0.0))
    run = Simulation(model, h, scheme)
    run.state.v[1] = push
    residuals = []
    for k in range(1, STEPS + 1):
        run.run_to(k * h)
        residuals.append(h * run.state.aux[1] / push)
    return np.array(residuals)


def _powers(scheme: Scheme) -> list[float]:
    """Powers of the matrix of a constrained direction, on a unit push."""
    b, g = scheme.beta, scheme.gamma
    T = np.array([[1 - g / b, 1 - g / (2 * b)], [-1 / b, 1 - 1 / (2 * b)]])
    state, sizes = np.array([1.0, 0.0]), []
    for _ in range(STEPS):
        state = T @ state
        sizes.append(state[1])
    return sizes


def newton() -> Finding:
    """Step size and Newton's iteration, in a strongly struck beam."""
    finding = Finding(
        "step size and Newton's iteration",
        "after a strong impact long steps take more iterations",
        "Newton's iteration converges from the prediction only if the state changes little during "
        "a step: long steps fail after a strong impulse.",
        "sebody rejects the step and reduces its size until Newton's iteration converges; if "
        "1/4096 "
        "of the step still fails, the run stops with a message and keeps its results.",
        "step [s]", "iterations per step; rejected steps", logarithmic="x")
    steps, iterations, cuts = (0.00125, 0.0025, 0.005, 0.01, 0.02, 0.04), [], []
    for h in steps:
        try:
            result = simulate(spherical_beam_strong.build().model, h, 20.0)
        except SimulationError as error:
            result = error.result
        iterations.append(result.iterations_per_step)
        cuts.append(result.cuts)
    finding.rows.append(Row("rejected steps at h = 0.0025", 0.0, cuts[1], 0.0, PROGRAM))
    finding.rows.append(Row("rejected steps at h = 0.04: some", 1.0, float(cuts[-1] > 0), 0.0,
                            PROGRAM))
    finding.curves["iterations per step"] = steps, iterations
    finding.curves["rejected steps / 100"] = steps, np.array(cuts) / 100
    finding.predict("no rejected steps are expected", steps[:2], (0.0, 0.0))
    return finding


def million_steps() -> Finding:
    """Energy and momentum of a beam that turns freely, over a million steps."""
    finding = Finding(
        "a million steps",
        "a free beam: energy and angular momentum change by about 1e-6",
        "Without loads the angular momentum is conserved to the tolerance of Newton's iteration, "
        "here 1e-10 of the motion in a step. Numerical damping dissipates the energy of "
        "vibrations.",
        "No action is needed; `Result.energy_balance` shows the drift of any run.",
        "steps", "relative change", logarithmic="xy")
    scene = planar_hinged_beam.build()
    run = Simulation(scene.model, 0.01, generalized_alpha(tolerance=1e-10), output_every=1000)
    result = run.run_to(10000.0).result()
    free = result.t >= 10.0
    energy = (result["energy.kinetic"] + result["energy.strain"])[free]
    momentum = result["angular_momentum"][free, 2]
    steps = np.arange(1, len(energy)) * 1000.0
    finding.rows += [
        Row("change of the angular momentum", 0.0, np.abs(momentum / momentum[0] - 1).max(),
            1e-5),
        Row("gain of energy", 0.0, max((energy / energy[0] - 1).max(), 0.0), 1e-6),
        Row("loss of energy, of vibrations", 0.0, (1 - energy / energy[0]).max(), 1e-4)]
    finding.curves["energy"] = steps, np.abs(energy[1:] / energy[0] - 1) + 1e-16
    finding.curves["angular momentum"] = steps, np.abs(momentum[1:] / momentum[0] - 1) + 1e-16
    finding.predict("the tolerance in every step", steps, 1e-10 * steps)
    return finding
