"""Damping of beams against the continuous beam of Kelvin and Voigt, for any division."""

import numpy as np
import pytest
from scipy.optimize import brentq

from sebody import InputError, Model, simulate
from sebody.analysis import frequency_response, modes
from sebody.fem import Section, rectangle
from sebody.model.beam_damping import retardation_times
from sebody.model.beam_pieces import Course
from sebody.model.variants import divide, keep_modes, planar
from sebody.runs.simulation import Simulation

WIDE = Section(area=6e-4, inertia_y=2e-8, inertia_z=4.5e-8, torsion=3e-8, youngs_modulus=7e10,
               poisson_ratio=0.3, density=2700.0)
LENGTH = 1.3
BENDING, TORSION = 7e10 * 4.5e-8, 7e10 / 2.6 * 3e-8
MASS = 2700.0 * 6e-4
RATIO = 0.02
DIVISIONS = [(1, 8), (2, 6), (4, 4), (8, 2)]      # bodies and modes of each
CLAMPED, FREE = 1.875104068711961, 4.730040744862704    # roots of cos cosh = -1 and 1


def turn() -> np.ndarray:
    return np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]


def cantilever(bodies: int, n: int, damping=RATIO, flat: bool = False, angle: float = 0.4) -> Model:
    """A beam in general position, held at its first end."""
    model = Model(planar=flat)
    if flat:
        direction = np.array([np.cos(angle), np.sin(angle)])
        across, start, up = np.array([-direction[1], direction[0]]), np.array([3.0, -1.0]), None
    else:
        direction, across, _ = turn()
        start, up = np.array([3.0, -1.0, 2.0]), across
    model.node("tip", start + LENGTH * direction), model.node("root", start)
    model.beam("blade", ("root", "tip"), WIDE, 16, bodies, modes=n, damping=damping,
               **({} if flat else {"up": up}))
    model.fix("root")
    model.force("tip", across, name="push")
    return model


def ratios(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and parts of critical damping of small motion."""
    found = modes(Simulation(model, 1e-3))
    return found.omega, found.damping


def bending(frequency: np.ndarray, beta: float) -> np.ndarray:
    """Answer of the tip of a continuous cantilever to a force there.

    Blevins (1979), Formulas for Natural Frequency and Mode Shape, 8.1, with the stiffness
    ``EI (1 + i w beta)``.
    """
    stiffness = BENDING * (1 + 1j * frequency * beta)
    k = (MASS * frequency**2 / stiffness)**0.25
    c, s, ch, sh = (f(k * LENGTH) for f in (np.cos, np.sin, np.cosh, np.sinh))
    return (s * ch - c * sh) / (stiffness * k**3 * (1 + c * ch))


@pytest.mark.parametrize(("bodies", "n"), DIVISIONS)
@pytest.mark.parametrize("flat", [False, True])
def test_ratios_are_those_of_the_continuous_beam_for_any_division(bodies, n, flat):
    omega, found = ratios(cantilever(bodies, n, flat=flat))
    # bending in the plane of y: k L = 1.875, 4.694 clamped, 4.730 free
    first = (CLAMPED / LENGTH)**2 * np.sqrt(BENDING / MASS)
    for root in (CLAMPED, 4.694091132974174):
        frequency = first * (root / CLAMPED)**2
        k = int(np.argmin(np.abs(omega - frequency)))
        assert omega[k] == pytest.approx(frequency, rel=1e-2)   # Euler and Bernoulli's, no rotary
        assert found[k] == pytest.approx(RATIO * (root / FREE)**2, rel=1e-2)
    if not flat:        # torsion: a quarter of the wave length clamped, half of it free
        frequency = np.pi / 2 / LENGTH * np.sqrt(TORSION / (2700.0 * 6.5e-8))
        k = int(np.argmin(np.abs(omega - frequency)))
        # one body without modes of torsion has a tenth more of both
        assert found[k] == pytest.approx(RATIO / 2 * omega[k] / frequency, rel=1e-2)


@pytest.mark.parametrize(("bodies", "n"), DIVISIONS)
def test_half_power_width_and_height_are_those_of_the_continuous_beam(bodies, n):
    model = cantilever(bodies, n, (0.03, "clamped 1"), flat=True)
    first = (CLAMPED / LENGTH)**2 * np.sqrt(BENDING / MASS)
    frequency = first * np.linspace(0.9, 1.1, 401)
    answer = frequency_response(Simulation(model, 1e-3), "push", "tip.position", frequency)
    across = np.array([-np.sin(0.4), np.cos(0.4)])
    found = np.abs(answer["tip.position"] @ across)
    exact = np.abs(bending(frequency, 2 * 0.03 / first))
    assert found.max() == pytest.approx(exact.max(), rel=1e-2)
    widths = [np.ptp(frequency[one > one.max() / np.sqrt(2)]) for one in (found, exact)]
    assert widths[0] == pytest.approx(widths[1], rel=2e-2)      # 30 steps of a frequency each
    assert widths[1] == pytest.approx(2 * 0.03 * first, rel=2e-2)


@pytest.mark.parametrize(("bodies", "n"), [(1, 4), (5, 0)])
def test_vibrations_of_a_plucked_beam_decay_as_those_of_the_continuous_beam(bodies, n):
    model = Model(planar=True)
    model.node("root", (0.0, 0.0)), model.node("tip", (0.0, LENGTH))
    model.beam("blade", ("root", "tip"), WIDE, 15, bodies, modes=n, damping=(0.03, "clamped 1"))
    model.fix("root")
    first = (CLAMPED / LENGTH)**2 * np.sqrt(BENDING / MASS)
    period = 2 * np.pi / first
    model.force("tip", (1.0, 0.0), [(0, 0), (2 * period, 50.0), (2 * period + 1e-9, 0.0)])
    result = simulate(model, period / 80, 10 * period)
    x, t = result["tip.position.x"], result.t
    peaks = [k for k in range(1, len(x) - 1) if t[k] > 3 * period and x[k] > x[k - 1] >= 0
             and x[k] >= x[k + 1]]
    decrement = np.log(x[peaks[0]] / x[peaks[-1]]) / (len(peaks) - 1)
    assert decrement == pytest.approx(2 * np.pi * 0.03 / np.sqrt(1 - 0.03**2), rel=2e-2)


@pytest.mark.parametrize("mode", ["free 2", "clamped 2", "hinged 1"])
def test_the_named_mode_has_the_ratio(mode):
    model = cantilever(4, 4, (RATIO, mode), flat=True)
    if not mode.startswith("clamped"):
        model = Model(planar=True)
        model.node("a", (0, 0)), model.node("b", (LENGTH, 0))
        model.beam("blade", ("a", "b"), WIDE, 16, 4, modes=4, damping=(RATIO, mode))
        if mode == "hinged 1":
            model.fix("a", "position"), model.fix("b", "position")
    omega, found = ratios(model)
    flexible = np.flatnonzero(omega > 1e-4 * omega.max())
    assert found[flexible[int(mode[-1]) - 1]] == pytest.approx(RATIO, rel=1e-3)


def test_a_frequency_in_place_of_a_mode_is_a_time_of_all():
    model = cantilever(4, 0, (RATIO, 50.0))
    found = modes(Simulation(model, 1e-3))
    slow = found.damping < 0.9
    assert found.damping[slow] == pytest.approx(RATIO * np.abs(found.values[slow]) / 50.0, rel=1e-6)
    for part in model.bodies.values():
        assert part.reduced.damping == pytest.approx(
            2 * RATIO / 50.0 * part.reduced.stiffness, rel=1e-9)


def test_no_rigid_motion_is_damped():
    for flat in (False, True):
        for part in cantilever(2, 4, flat=flat).bodies.values():
            body = part.reduced
            force = body.damping @ body.rigid_modes
            assert np.abs(force).max() <= 1e-9 * np.abs(body.damping).max()


def test_variants_keep_the_damping():
    model = cantilever(1, 4)
    expected = RATIO * (CLAMPED / FREE)**2
    first = (CLAMPED / LENGTH)**2 * np.sqrt(BENDING / MASS)
    for made in (divide(model, "blade", 8).model, divide(model, "blade", 2, 32, modes=0).model,
                 keep_modes(model, "blade", 2).model, planar(model).model,
                 divide(planar(model).model, "blade", 4).model):
        omega, found = ratios(made)
        assert found[np.argmin(np.abs(omega - first))] == pytest.approx(expected, rel=2e-2)


@pytest.mark.parametrize(("damping", "message"), [
    (-0.1, " is -0.1: give a ratio of critical damping >= 0, or"),
    ((0.1, "held 1"), "mode is 'held 1': give 'free 1', 'clamped 1'"),
    ((0.1, 0.0), "frequency is 0.0: give a ratio"),
    (("free 1", 0.1), "give a ratio of critical damping"),
    ((0.1, "free 1", 2), "give a ratio of critical damping")])
def test_wrong_damping_is_refused(damping, message):
    with pytest.raises(InputError, match=f"beam 'blade': damping.*?{message}"):
        cantilever(2, 0, damping)


@pytest.mark.parametrize("thickness", [0.1, 0.01, 1e-3])
def test_the_first_clamped_mode_is_that_of_slender_beams_too(thickness):
    """Frequencies of short waves are up to 1e6 times that of a thin strip's first mode."""
    section = rectangle(thickness, 0.02, 2.1e11, 0.3, 7800.0)
    model = Model(planar=True)
    ends = model.node("a", (0.0, 0.0)), model.node("b", (2.0, 0.0))
    times = retardation_times((0.02, "clamped 1"), "strip", Course(model, ends, section))
    first = (CLAMPED / 2.0)**2 * np.sqrt(2.1e11 / 7800.0 / 12.0) * thickness
    assert times[-1] == pytest.approx(2 * 0.02 / first, rel=5e-3)     # shear of the thickest


def test_roots():
    assert brentq(lambda x: np.cos(x) * np.cosh(x) + 1, 1, 3) == pytest.approx(CLAMPED, abs=1e-12)
    assert brentq(lambda x: np.cos(x) * np.cosh(x) - 1, 4, 5) == pytest.approx(FREE, abs=1e-12)
