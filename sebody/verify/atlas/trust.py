"""Cases that `advise` may confirm: loads between steps, damping, rotation, instability."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import trapezoid

from sebody.basics.errors import InputError
from sebody.explore.advice import Advice, advise
from sebody.explore.advice.loads import SEEN, missed
from sebody.explore.advice.steady import steady_frequencies
from sebody.fem import Section
from sebody.model.histories import time_function
from sebody.model.model import Model
from sebody.runs.simulation import Simulation
from sebody.runs.statics import equilibrium
from sebody.runs.whole_runs import simulate
from sebody.small_motion.linearization import modes, vibrations
from sebody.verify.atlas.finding import PROGRAM, REFERENCE, Finding, Row
from sebody.verify.atlas.spin import LAG
from sebody.verify.atlas.theory import lag

# a steel strip of 1 m, in the plane
MODULUS, SIDE, DENSITY, LENGTH = 2.1e11, 0.01, 7800.0, 1.0
SECTION = Section(area=SIDE**2, inertia_y=SIDE**4 / 12, inertia_z=SIDE**4 / 12,
                  torsion=0.14 * SIDE**4, youngs_modulus=MODULUS, poisson_ratio=0.3,
                  density=DENSITY)
BENDING, MASS = MODULUS * SIDE**4 / 12, DENSITY * SIDE**2
PULSE, WIDTH = 0.1034, 4e-4         # middle of a triangle, and half its duration [s]
RATIO = 0.02                        # of the first mode of a clamped beam
CLAMPED = 1.8751040687, 4.6940911330        # roots of cos x cosh x = -1
SPINS = (0.0, 2.0, 4.0, 6.0, 9.0, 12.0)
LOADS = (0.0, 0.3, 0.6, 0.9, 1.1, 1.3, 1.6)     # of Euler's load
GROWING, ADVISED = 0.06, 0.25       # times in which a disturbance of the column grows [s]


def missed_loads() -> Finding:
    """A pulse that falls between steps: what of it a mass gets, and what advice does."""
    finding = Finding(
        "a load between the steps",
        "steps longer than a pulse miss it, or get too much of it, unless it is a table",
        "A run knows functions at the ends of its steps alone: a mass gets the trapezoidal sum of "
        "a pulse, h times the forces at these times, which is nothing where none falls into it. "
        "Of a table whose rows are closer than steps it gets the whole impulse.",
        "advise compares the spectrum of what lies between steps with that of the load, shortens "
        "the steps of the reference until they miss 1 % at most, and says so; without that it is "
        "refused.", "step / duration of the pulse", "impulse that the mass gets / true one",
        logarithmic="x")
    table = [(0.0, 0.0), (PULSE - WIDTH, 0.0), (PULSE, 1.0), (PULSE + WIDTH, 0.0)]
    loads = time_function(_pulse)
    expected, shares, of_table = [], [], []
    parts = (1, 2, 4, 8, 16, 32, 64, 128)
    steps = 0.02 / np.array(parts)
    for h in steps:
        t = h * np.arange(round(0.12 / h) + 1)
        expected.append(float(trapezoid(loads.values(t), t)) / WIDTH)
        for load, found in ((_pulse, shares), (table, of_table)):
            model = Model(planar=True)
            model.point_mass("mass", model.node("a", (1.0, 2.0), "translation"), 2.0)
            model.force("a", (0.6, 0.8), load)
            velocity = simulate(model, h, 0.12)["a.velocity"][-1]
            found.append(2.0 * float(velocity @ (0.6, 0.8)) / WIDTH)
    over = steps / (2.0 * WIDTH)
    finding.predict("sum at the steps", over, expected)
    finding.curves["function"] = over, shares
    finding.curves["table"] = over, of_table
    finding.rows += [Row(f"step {h:g}: impulse", a, b, 1e-3)
                     for h, a, b in zip(steps, expected, shares, strict=True)]
    finding.rows += [Row(f"step {h:g}: impulse of the table", 1.0, one, 1e-9)
                     for h, one in zip(steps, of_table, strict=True) if h > WIDTH]
    whole = missed(["pulse"], [loads], 0.01, 0.12)
    finding.rows.append(Row("steps of 0.01 miss all of it", 1.0, whole.share, 0.05))
    advice = advise(_struck(lambda t: 400.0 * _pulse(t)), 0.01, 0.16, "tip.position", 1e-2)
    finest = min(one.step for one in advice.table if one.kind == "reference")
    finding.rows += [
        Row("advise: share that its reference misses, at most 1 %", 1.0,
            float(missed(["pulse"], [loads], finest, 0.12).share <= SEEN), 0.0, PROGRAM),
        Row("advise: confirmed", 1.0, float(advice.confirmed), 0.0, PROGRAM),
        Row("advise: says that the load needs shorter steps", 1.0,
            float(any("needs shorter steps" in one for one in advice.remarks)), 0.0, PROGRAM)]
    return finding


def _pulse(t: float) -> float:
    """A triangle, of whose course between steps nothing is known."""
    return max(0.0, 1.0 - abs(t - PULSE) / WIDTH)


def _struck(load: Callable[[float], float]) -> Model:
    """A hinged strip with a weight, struck."""
    model = Model(planar=True)
    tip, root = model.node("tip", (LENGTH, 0.3)), model.node("root", (0.0, 0.3))
    model.beam("strip", (root, tip), SECTION, 16, 1, 2)
    model.point_mass("weight", tip, 0.5)
    model.fix(root, "position")
    model.force(tip, (0.0, 1.0), load)
    return model


def damping_by_division() -> Finding:
    """Damping ratios of a clamped beam of one to eight bodies."""
    finding = Finding(
        "damping and the division of a beam",
        "a beam has the same damping in any number of bodies",
        "Damping proportional to the rate of strain gives the modes of a beam ratios that grow "
        "with their frequencies: of 2 % in the first mode of a cantilever, 12.5 % in the second. "
        "If each body were damped by its own modes, ratios would fall with the number of bodies.",
        "sebody damps beams by material: `damping` names the ratio of a mode of the whole beam. "
        "advise therefore finds the same decay in a given model and in its reference.",
        "bodies", "damping ratio", logarithmic="xy")
    counts = (1, 2, 4, 8)
    expected = [RATIO * (root / CLAMPED[0])**2 for root in CLAMPED]
    ratios = np.array([_ratios(_damped(n)) for n in counts])
    for k, name in enumerate(("first", "second")):
        finding.predict(f"beam, {name} mode", counts, [expected[k]] * len(counts))
        finding.curves[f"{name} mode"] = counts, ratios[:, k]
        finding.rows += [Row(f"{name} mode, bodies: {n}", expected[k], ratios[i, k], 0.01)
                         for i, n in enumerate(counts)]
    advice = advise(_damped(1, struck=True), 1e-3, 0.15, "tip.position", 2e-2)
    given = next(one for one in advice.table if one.kind == "given")
    finding.rows += [
        Row("advise: the given body decays as its reference", 0.0, given.error, 0.05, PROGRAM),
        Row("advise: confirmed", 1.0, float(advice.confirmed), 0.0, PROGRAM)]
    return finding


def _ratios(model: Model) -> list[float]:
    """Ratios of the two slowest vibrations."""
    vibrations = modes(equilibrium(model))
    return list(vibrations.damping[vibrations.omega > 0.0][:2])


def _damped(bodies: int, struck: bool = False) -> Model:
    """A clamped strip, damped as a whole."""
    model = Model(planar=True)
    root, tip = model.node("root", (0.2, 0.1)), model.node("tip", (0.2, 0.1 + LENGTH))
    model.beam("strip", (root, tip), SECTION, 16, bodies, 2, damping=(RATIO, "clamped 1"))
    model.fix(root)
    if struck:
        model.force(tip, (1.0, 0.0), [(0.0, 0.0), (0.004, 40.0), (0.01, 0.0)])
    return model


def frequencies_that_rotate() -> Finding:
    """The frequency that advice keeps, of a blade in steady rotation."""
    finding = Finding(
        "frequencies of what rotates",
        "kept about the steady rotation, with its stresses",
        "The first in-plane frequency of a rotating cantilever grows with the spin. About an "
        "unstretched start at this spin stresses are missing, and the motion is unstable.",
        "advise linearises about the steady rotation or the equilibrium, and refuses frequencies "
        "if the initial velocities are no steady rotation.",
        "spin, W sqrt(rho A L^4 / EI)", "frequency / sqrt(EI / rho A L^4)")
    unit = float(np.sqrt(BENDING / (MASS * LENGTH**4)))
    line = np.linspace(SPINS[0], SPINS[-1], 25)
    finding.predict("beam, theory", line, [lag(eta) for eta in line])
    frequencies = [_first(_blade(eta * unit)) / unit for eta in SPINS]
    finding.curves["as advise keeps it"] = SPINS, frequencies
    finding.curves["frequency at rest"] = SPINS, [float(
        vibrations(Simulation(_blade(0.0), 1e-3)).omega[0]) / unit] * len(SPINS)
    finding.rows += [Row(f"spin {eta:g}", lag(eta), one, 3e-3)
                     for eta, one in zip(SPINS, frequencies, strict=True)]
    finding.rows += [Row(f"theory, spin {eta:g}", exact, lag(eta), 1e-4, REFERENCE)
                     for eta, exact in LAG.items()]
    try:
        advise(_blade(12.0 * unit, thrown=1.0), 1e-3, 4e-3, "frequency 1", 1e-2)
        refused = 0.0
    except InputError as reason:
        refused = float("no steady rotation" in str(reason))
    finding.rows.append(Row("advise: a start that is no rotation is refused", 1.0, refused, 0.0,
                            PROGRAM))
    return finding


def _blade(spin: float, thrown: float = 0.0) -> Model:
    """A blade on a driven hub, which may move besides."""
    model = Model(planar=True)
    hub, tip = model.node("hub", (0.0, 0.0)), model.node("tip", (0.6 * LENGTH, 0.8 * LENGTH))
    model.beam("blade", (hub, tip), SECTION, 16, 2, 4)
    model.fix(hub, "position")
    model.move(hub, 1.0, [(0.0, 0.0), (1.0, spin)], "rotation")
    model.rigid_velocity((0.0, 0.0), spin)
    if thrown:
        model.initial_velocity(tip, (thrown, -0.6 * thrown))
    return model


def _first(model: Model) -> float:
    omega = steady_frequencies(Simulation(model, 1e-3).result())
    return float(omega[omega > 1e-5 * omega.max()][0])


def instability() -> Finding:
    """A hinged column under more than Euler's load, which stays straight by symmetry."""
    finding = Finding(
        "instability that symmetry hides",
        "a disturbance grows above Euler's load",
        "A hinged column under the load P has the squared frequency w_1^2 (1 - P / P_E), which is "
        "negative above Euler's load: after the time T a velocity v aside has moved it by "
        "v sin(w T) / w, or v sinh(g T) / g. Without it the column stays straight.",
        "advise runs the reference model once with small random velocities and forces. If they "
        "grow, nothing is confirmed, the factor is said, and no symmetry is assumed.",
        "load / Euler's load", "displacement / that of a drift", logarithmic="y")
    first = float(np.sqrt(BENDING * np.pi**4 / (MASS * LENGTH**4)))

    def theory(load: float) -> float:
        phase = first * GROWING * np.sqrt(complex(1.0 - load))
        return float(abs(np.sin(phase) / phase)) if phase else 1.0
    growths = [_grown(load) for load in LOADS]
    line = np.linspace(LOADS[0], LOADS[-1], 60)
    finding.predict("column, theory", line, [max(theory(load), 1e-3) for load in line])
    finding.curves["measured"] = LOADS, growths
    # steps resolve the growth, shear and shortening are left out: exponents to some per mille
    finding.rows += [Row(f"load {load:g}: growth", theory(load), one, 0.05)
                     for load, one in zip(LOADS, growths, strict=True) if load > 1.0]
    for load, stable in ((0.6, 1.0), (1.6, 0.0)):
        advice = _advised_column(load)
        finding.rows.append(Row(f"advise, load {load:g}: confirmed", stable,
                                float(advice.confirmed), 0.0, PROGRAM))
    finding.rows.append(Row("advise, load 1.6: says that it is unstable", 1.0, float(
        "unstable" in advice.summary()), 0.0, PROGRAM))
    return finding


def _column(load: float, aside: float = 0.0,
            press: list[tuple[float, float]] | None = None) -> Model:
    """A hinged column of four bodies under a load, with a small velocity aside."""
    euler = BENDING * np.pi**2 / LENGTH**2
    model = Model(planar=True)
    foot, top = model.node("foot", (0.0, 0.0)), model.node("top", (0.0, LENGTH))
    nodes = model.beam("column", (foot, top), SECTION, 16, 4, 2)
    model.fix(foot, "position")
    rail = model.node("rail", (0.0, LENGTH))
    model.fix(rail)
    model.slider(top, (0.0, 1.0), to=rail)
    model.force(top, (0.0, -load * euler), press, name="press")
    for node in nodes[1:-1]:
        share = np.sin(np.pi * node.point[1] / LENGTH)
        model.initial_velocity(node, (aside * share, 0.0))
    return model


def _grown(load: float) -> float:
    """The shift of the middle after a small velocity aside, relative to a drift."""
    aside = 1e-6
    result = simulate(_column(load, aside), 5e-5, GROWING)
    return float(abs(result["column 2.position"][-1, 0])) / (aside * GROWING)


def _advised_column(load: float) -> Advice:
    press = [(0.0, 0.0), (0.1, 1.0), (0.3, 1.0)]
    return advise(_column(load, press=press), 2e-3, ADVISED, "top.position rms", 5e-2)
