"""High spin and high loads: where linear bodies are too soft, or never buckle."""

from collections.abc import Callable

import numpy as np

from sebody.basics.errors import SimulationError
from sebody.model.model import Model
from sebody.runs.whole_runs import simulate
from sebody.scenes import spin_up
from sebody.small_motion.linearization import modes
from sebody.verify.atlas.beams import FRAMES, arm, grows, onset, pressed, spinning
from sebody.verify.atlas.finding import REFERENCE, Finding, Row
from sebody.verify.atlas.theory import (
    beck_load,
    cantilever,
    deflection_of_spin_up,
    divergence,
    euler_load,
    lag,
)

COUNTS = (1, 2, 4, 8)
MODES = 4               # of one body that stiffens
T_END = 20.0            # of the spin-up
DEEPEST_DRAWN = 2.0     # of its deflections
DEEPEST = {"kane": -0.53366, "simo": -0.57392}  # 12 quadratic geometrically exact elements
SPINS = (0.0, 1.5, 3.0, 4.0, 5.0, 5.5, 6.0, 6.5, 8.0, 10.0, 12.0)
LAG = {3.0: 3.7435, 6.0: 4.2632, 12.0: 5.4270}  # tables of rotating beams, a power series
WITHIN = (1e-3, 1e-3, 5e-3)                     # four modes in the plane; eight: 3e-4 at 6


def spurious_divergence() -> Finding:
    """Spin at which a cantilever in its plane diverges; a beam never does."""
    finding = Finding(
        "loss of stability at high spin, option B",
        "critical spin; with geometric stiffening there is none",
        "A rotating beam stiffens and never diverges in its plane of rotation. A linear body does "
        "not stiffen: it diverges if W^2 times its inertia exceeds its stiffness. This limit grows "
        "with the number of bodies; a single body with stiffening has no limit.",
        "sebody stiffens bodies by default; it warns once if a body without stiffening spins "
        "faster than its limit.",
        "number of bodies", "critical spin, W sqrt(rho A L^4 / EI)", logarithmic="xy")
    _by_bodies(finding, lambda n, frame: divergence(cantilever(n, frame), option_b=True),
               lambda n, frame, theory: onset(lambda eta: grows(
                   lambda: spinning(arm(n, frame), eta), eta), 0.7 * theory, 1.3 * theory, 7),
               2e-3)
    for frame in ("node", "mean"):
        onsets = onset(lambda eta, own=frame: grows(
            lambda: spinning(arm(1, own, MODES, None), eta), eta), 2.0, 20.0, 7)
        finding.rows.append(Row(f"{frame} frame, one body with stiffening, up to 20", np.inf,
                                onsets, 0.0))
        finding.predict(f"{frame} frame, exact inertia, theory", COUNTS, [
            divergence(cantilever(n, frame)) for n in COUNTS])
    finding.predict("chord frame, exact inertia, theory", COUNTS, [
        divergence(cantilever(n, "chord")) for n in COUNTS])
    return finding


def frequencies() -> Finding:
    """The first frequency in the plane of a cantilever that turns, of one body."""
    finding = Finding(
        "one rotating body",
        "first in-plane frequency of a cantilever, four modes",
        "The first in-plane frequency of a rotating beam grows with the spin, from 3.516 at rest "
        "to 5.427 at spin 12. One body with stiffening has this frequency; without stiffening "
        "(exact inertia or option B) a body is unstable from spin 6 on.",
        "sebody stiffens bodies by default.", "spin, W sqrt(rho A L^4 / EI)",
        "frequency / sqrt(EI / rho A L^4)")
    for eta, exact in LAG.items():
        finding.rows.append(Row(f"theory, spin {eta:g}", exact, lag(eta), 1e-4, REFERENCE))
    line = np.linspace(SPINS[0], SPINS[-1], 25)
    finding.predict("beam, theory", line, [lag(eta) for eta in line])
    kinds = {"one body with stiffening": {"inertia": None},
             "exact inertia, no stiffening": {"inertia": None, "stiffening": False},
             "option B": {"inertia": "material"}}
    for name, kind in kinds.items():
        lowest = [_lowest(arm(1, "mean", MODES, **kind), eta) for eta in SPINS]
        stable = SPINS[:lowest.index(0.0) + 1] if 0.0 in lowest else SPINS
        finding.curves[name] = stable, lowest[:len(stable)]
        end = dict(zip(SPINS, lowest, strict=True))
        if kind == {"inertia": None}:
            finding.rows += [Row(f"{name}, spin {eta:g}", exact, end[eta], within)
                             for (eta, exact), within in zip(LAG.items(), WITHIN, strict=True)]
        else:
            finding.rows.append(Row(f"{name}, spin 12: unstable", 0.0, end[12.0], 0.0))
    return finding


def _lowest(model: Model, spin: float) -> float:
    """Zero where it is unstable."""
    if grows(lambda: spinning(model, spin), spin):
        return 0.0
    return float(modes(spinning(model, spin), spin).omega[0])


def spin_up_outcomes() -> Finding:
    """The spin-up of two flexible arms: bounded or not, and how deep the tip bends."""
    finding = Finding(
        "spin-up of a flexible arm, option B",
        "with too few bodies of option B the deflection is too large",
        "One body of option B with its frame at the root diverges when the spin exceeds its first "
        "frequency. With two bodies the deflection of Kane's arm at 4 rad/s is bounded, that of "
        "Simo's arm at 6 rad/s is not; with four and eight bodies the largest deflection converges "
        "to the exact -0.534 and -0.574. One body with stiffening and two modes is sufficient.",
        "sebody stiffens bodies by default; without stiffening the run continues with a warning. "
        "If a node rotates by more than 168 degrees relative to its body, the run stops.",
        "time [s]", "tip deflection of Kane's arm")
    for case in spin_up.CASES:
        length = spin_up.CASES[case][0]
        for frame, n in (("node", 4), ("node", 8), ("mean", 4), ("mean", 8)):
            t, v = _deflection(case, n, frame)
            finding.rows.append(Row(f"{case}, {frame} frame, {n} bodies: lowest",
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
                finding.curves[f"node frame, {n} bod{'y' if n == 1 else 'ies'}"] = t, np.where(
                    np.abs(v) < DEEPEST_DRAWN, v, np.nan)
        t, v = _deflection(case, 1, "mean", inertia=None, modes=2)
        finding.rows.append(Row(f"{case}, one body with stiffening: lowest", DEEPEST[case],
                                v.min(), 2e-3, REFERENCE))
        if case == "kane":
            finding.curves["one body with stiffening"] = t, v
            finding.predict("lowest of nonlinear beams", (t[0], t[-1]), (DEEPEST[case],) * 2)
    return finding


def _predicted(case: str, bodies: int, frame: str) -> np.ndarray:
    """Tip deflection by theory, whose units are the arm's length, mass and bending stiffness."""
    length, speed, _, _, bending, mass = spin_up.CASES[case]
    unit = np.sqrt(mass * length**4 / bending)      # of time
    _, rate, second = spin_up.turning(speed)
    return length * deflection_of_spin_up(
        cantilever(bodies, frame), lambda t: unit * rate(unit * t),
        lambda t: unit**2 * second(unit * t), T_END / unit)


def _deflection(case: str, bodies: int, frame: str, inertia: str | None = "b", modes: int = 0):
    scene = spin_up.build(case, bodies, modes, frame=FRAMES[frame], inertia=inertia)
    try:
        result = simulate(scene.model, 0.01, T_END)
    except SimulationError as error:
        result = error.result
    angle = np.array([spin_up.turning(spin_up.CASES[case][1])[0](t) for t in result.t])
    x, y = result["tip.position"].T
    return result.t, y * np.cos(angle) - x * np.sin(angle)


def buckling() -> Finding:
    """Fixed-direction load along a cantilever."""
    finding = Finding(
        "Euler buckling load, option B",
        "without geometric stiffening the buckling load is too high",
        "Bodies that are linear in their frames buckle only by rotation of the frames: one body "
        "with the frame at its root does not buckle, with a chord frame it buckles at 3 EI/L^2, "
        "and many bodies at pi^2/4 EI/L^2. One body with stiffening buckles at pi^2/4 EI/L^2.",
        "Above the buckling load sebody leaves the straight state for a bent one and says so; on "
        "request it keeps the straight one, with a warning.",
        "number of bodies", "load / (EI/L^2)", logarithmic="x")
    _by_bodies(finding, lambda n, frame: euler_load(cantilever(n, frame)),
               lambda n, frame, _: onset(lambda p: grows(
                   lambda: pressed(arm(n, frame), p, False)), 1.5, 6.0, 19), 2e-3)
    finding.predict("beam, theory", COUNTS, [np.pi**2 / 4] * len(COUNTS))
    _of_one_body(finding, np.pi**2 / 4, False, 1e-3)
    return finding


def flutter() -> Finding:
    """A load that follows the tip of a cantilever."""
    finding = Finding(
        "flutter load of Beck's column, option B",
        "without geometric stiffening the flutter load is too high",
        "A beam flutters at 20.05 EI/L^2. One linear body does not flutter below 80, two linear "
        "bodies flutter at 24 (chord frame) to 39 (node frame); the flutter load converges from "
        "above with the square of the number of bodies. One body with stiffening flutters at "
        "20.05.",
        "Eigenvalues of the linearisation show the flutter load; a simulation shows the flutter "
        "without a warning.",
        "number of bodies", "load / (EI/L^2)", logarithmic="x")
    _by_bodies(finding, lambda n, frame: beck_load(cantilever(n, frame)),
               lambda n, frame, _: onset(lambda p: grows(
                   lambda: pressed(arm(n, frame, 6 // n + 1), p, True)), 15.0, 80.0, 27), 0.01)
    finding.predict("beam, theory", COUNTS, [20.0509536] * len(COUNTS))
    _of_one_body(finding, 20.0509536, True, 1e-3)
    return finding


def _of_one_body(finding: Finding, exact: float, follower: bool, within: float) -> None:
    """Rows of one body that stiffens, in both frames."""
    for frame in ("node", "mean"):
        spin = onset(lambda p, own=frame: grows(lambda: pressed(
            arm(1, own, MODES, None), p, follower)), 0.9 * exact, 1.1 * exact, 3)
        finding.rows.append(Row(f"{frame} frame, one body with stiffening", exact, spin, within))
    finding.curves["one body with stiffening"] = (1,), [spin]


def _by_bodies(finding: Finding, theory: Callable[[int, str], float],
               measured: Callable[[int, str, float], float], within: float) -> None:
    """A row for every frame and number of bodies, a curve for every frame."""
    for frame in ("node", "mean"):
        rows = []
        for n in COUNTS:
            expected = theory(n, frame)
            rows.append(measured(n, frame, expected))
            finding.rows.append(Row(f"{frame} frame, bodies: {n}", expected, rows[-1], within))
        finding.curves[f"{frame} frame, measured"] = COUNTS, rows
