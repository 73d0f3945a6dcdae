"""High spin and high loads: where linear bodies are too soft, or never buckle."""

from collections.abc import Callable

import numpy as np

from sebody.analysis.simulation import simulate
from sebody.errors import SimulationError
from sebody.scenes import spin_up
from sebody.studies.atlas.beams import FRAMES, grows, onset, pressed, spinning
from sebody.studies.atlas.finding import Finding, Row
from sebody.studies.atlas.theory import (
    beck_load,
    cantilever,
    deflection_of_spin_up,
    divergence,
    euler_load,
)

COUNTS = (1, 2, 4, 8)
T_END = 20.0            # of the spin-up


def spurious_divergence() -> Finding:
    """Spin at which a cantilever in its plane diverges; a beam never does."""
    finding = Finding(
        "divergence at high spin",
        "A beam stiffens as it turns and never diverges in its plane. A linear body does not: it "
        "diverges where W^2 times its inertia exceeds its stiffness. The limit grows with the "
        "number of bodies.",
        "Warns once when the spin of a body exceeds its own limit, and says to divide it.",
        "bodies", "spin of divergence, W sqrt(rho A L^4 / EI)", logarithmic="xy")
    _by_bodies(finding, lambda n, frame: divergence(cantilever(n, frame), option_b=True),
               lambda n, frame, theory: onset(lambda eta: grows(
                   lambda: spinning(n, frame, eta), eta), 0.7 * theory, 1.3 * theory, 7), 2e-3)
    for frame in ("node", "mean"):
        finding.curves[f"{frame} frame, exact inertia"] = COUNTS, [
            divergence(cantilever(n, frame)) for n in COUNTS]
    finding.curves["chord frame, exact inertia"] = COUNTS, [
        divergence(cantilever(n, "chord")) for n in COUNTS]
    return finding


def spin_up_outcomes() -> Finding:
    """The spin-up of two flexible arms: bounded or not, and how deep the tip bends."""
    finding = Finding(
        "spin-up of a flexible arm",
        "One body with its frame at the root diverges when the speed passes its first frequency. "
        "Kane's arm at 4 rad/s survives with two, Simo's at 6 rad/s does not; with four and eight "
        "the deflection tends to that of the beam, -0.534 and -0.574.",
        "Runs on with a warning; a node that turns by more than 168 degrees stops the run.",
        "time [s]", "tip deflection of Kane's arm")
    for case in spin_up.CASES:
        length = spin_up.CASES[case][0]
        for frame, n in (("node", 4), ("node", 8), ("mean", 4), ("mean", 8)):
            t, v = _deflection(case, n, frame)
            finding.rows.append(Row(f"{case}, {frame} frame, {n} bodies: deepest",
                                    _predicted(case, n, frame).min(), v.min(), 0.01))
            if case == "kane":
                finding.curves[f"{frame} frame, {n} bodies"] = t, v
        for n in (1, 2):
            t, v = _deflection(case, n, "node")
            lost, expected = (np.abs(w).max() > length / 2
                              for w in (v, _predicted(case, n, "node")))
            finding.rows.append(Row(f"{case}, node frame, bodies: {n}, bent by half its length",
                                    float(expected), float(lost), 0.0))
            if case == "kane":
                finding.curves[f"node frame, bodies: {n}"] = t, np.clip(v, -2.0, 2.0)
    return finding


def _predicted(case: str, bodies: int, frame: str) -> np.ndarray:
    """Tip deflection by theory, whose units are the arm's length, mass and bending stiffness."""
    length, speed, _, _, bending, mass = spin_up.CASES[case]
    unit = np.sqrt(mass * length**4 / bending)      # of time
    _, rate, second = spin_up.turning(speed)
    return length * deflection_of_spin_up(
        cantilever(bodies, frame), lambda t: unit * rate(unit * t),
        lambda t: unit**2 * second(unit * t), T_END / unit)


def _deflection(case: str, bodies: int, frame: str):
    scene = spin_up.build(case, bodies, frame=FRAMES[frame])
    try:
        result = simulate(scene.model, 0.01, T_END)
    except SimulationError as error:
        result = error.result
    angle = np.array([spin_up.turning(spin_up.CASES[case][1])[0](t) for t in result.t])
    x, y = result["tip.position"].T
    return result.t, y * np.cos(angle) - x * np.sin(angle)


def buckling() -> Finding:
    """Dead load along a cantilever."""
    finding = Finding(
        "Euler's load",
        "Bodies that are linear in their frames buckle where the frames turn: not at all with one "
        "body and the frame at its root, at 3 EI/L^2 with a chord, and at pi^2/4 in the limit.",
        "Finds no stable equilibrium beyond the load and says so.",
        "bodies", "load / (EI/L^2)", logarithmic="x")
    _by_bodies(finding, lambda n, frame: euler_load(cantilever(n, frame)),
               lambda n, frame, _: onset(lambda p: grows(
                   lambda: pressed(n, frame, p, False, 0)), 1.5, 6.0, 19), 2e-3)
    finding.curves["beam"] = COUNTS, [np.pi**2 / 4] * len(COUNTS)
    return finding


def flutter() -> Finding:
    """A load that follows the tip of a cantilever."""
    finding = Finding(
        "Beck's load",
        "A beam flutters at 20.05 EI/L^2. One linear body does not flutter below 80, two at 24 "
        "(chord) to 39 (node); the load converges from above with the square of their number.",
        "Eigenvalues of the linearisation show it; a simulation flutters, without a warning.",
        "bodies", "load / (EI/L^2)", logarithmic="x")
    _by_bodies(finding, lambda n, frame: beck_load(cantilever(n, frame)),
               lambda n, frame, _: onset(lambda p: grows(
                   lambda: pressed(n, frame, p, True, 6 // n + 1)), 15.0, 80.0, 27), 0.01)
    finding.curves["beam"] = COUNTS, [20.0509536] * len(COUNTS)
    return finding


def _by_bodies(finding: Finding, theory: Callable[[int, str], float],
               measured: Callable[[int, str, float], float], within: float) -> None:
    """A row for every frame and number of bodies, a curve for every frame."""
    for frame in ("node", "mean"):
        found = []
        for n in COUNTS:
            expected = theory(n, frame)
            found.append(measured(n, frame, expected))
            finding.rows.append(Row(f"{frame} frame, bodies: {n}", expected, found[-1], within))
        finding.curves[f"{frame} frame, measured"] = COUNTS, found
