"""Where points come to rest on paths: their ways are held at first, then let go."""

import numpy as np
import pytest
from model.test_paths import SHIFT, TURN, G, bead, slide
from scipy.optimize import brentq

from sebody import Model, SimulationError, simulate
from sebody.analysis import equilibrium, vibrations
from sebody.fem import rectangle

MASS = 0.3
EI = 7e10 * 0.04 * 0.01**3 / 12
STARTS = [0.0, 1e-3, 0.5, 0.98, 1.6, 2.0]


def trolley(start, flat=True, bodies=1, hang=0.0, scale=1.0):
    """A trolley, perhaps with a load on a rope, on a beam with weight that two supports bear."""
    model, turned = Model(planar=flat), np.eye(3) if flat else TURN

    def at(x, y=0.0):
        place = scale * np.array([x, y, 0.0])
        return place[:2] if flat else turned @ place + SHIFT
    ends = model.node("a", at(0.0)), model.node("b", at(2.0))
    up = {} if flat else {"up": turned[:, 1]}
    model.beam("beam", ends, rectangle(
        0.01 * scale, 0.04 * scale, youngs_modulus=7e10 / scale, poisson_ratio=0.0,
        density=270.0 / scale**3), elements=60, bodies=bodies, modes=8 if bodies == 1 else 4, **up)
    model.revolute("a", (0, 0, 1) if flat else turned[:, 2])
    model.slider("b", axis=at(1.0) - at(0.0))
    car = model.node("car", at(start), "translation")
    model.point_mass("car", car, MASS)
    if hang:
        bob = model.node("bob", at(start, -0.4), "translation")
        model.point_mass("bob", bob, hang)
        model.distance(car, bob)
    field = scale * np.array([0.0, -G, 0.0])
    model.gravity(field[:2] if flat else turned @ field)
    model.path("rail", on="beam")
    model.path_joint(car, "rail", name="runs")
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("options", [
    {}, {"bodies": 4}, {"flat": False, "hang": 0.5}, {"flat": False, "bodies": 2, "scale": 1e3}])
def test_a_trolley_rolls_into_the_middle(options):
    """Of a beam with weight: of one body, and of several, which meet in the middle."""
    model = trolley(0.5, **options)
    size, several = options.get("scale", 1.0), options.get("bodies", 1) > 1
    force = G * (MASS + options.get("hang", 0.0))
    sag = force * 8 / 48 / EI + 5 / 384 * 270 * 4e-4 * G * 16 / EI
    for start in STARTS:
        rest = equilibrium(trolley(start, **options))
        assert rest.stability.startswith("stable")
        assert ("rests in a kink of path 'rail', at 1" in rest.stability) == several
        way, place = rest["runs.way"] / size, rest["car.position"]
        assert way[:-1] == pytest.approx(start, abs=1e-15)      # held
        assert way[-1] == pytest.approx(1.0, abs=1e-8)
        down = TURN[:, 1] @ (place[-1] - SHIFT) if model.dimension == 3 else place[-1, 1]
        assert -down / size == pytest.approx(sag, rel=2e-3)
    result = simulate(model, 1e-2, 0.5, start=rest)
    assert result["runs.way"] / size == pytest.approx(1.0, abs=1e-6)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("start", [0.5, 0.98, 1.6])
def test_a_bead_rests_off_the_middle_of_a_slope(start):
    """Where F C'(s) / 2 = -1e-3, from V = -F^2 C(s) / 2 and C = s^2 (L - s)^2 / (3 EI L).

    With 12 modes this stiffness is off by 2e-3, as the square of the frequency of the bead is.
    """
    def slope(s):
        return MASS * G * s * (2 - s) * (2 - 2 * s) / (6 * EI)
    model = bead(start)
    model.force("car", (1.0, 0.0), 1e-3 * MASS * G)
    place = brentq(lambda s: slope(s) + 1e-3, 1.0, 1.4)     # the stable one; a second is at 1.8
    rest = equilibrium(model)
    assert rest.stability == "stable"
    assert rest["runs.way"][-1] - 1.0 == pytest.approx(place - 1.0, rel=2e-3)


def spans(start, blend=0.0):
    """Three spans, over whose supports the path has kinks that point up."""
    model = Model(planar=True)
    for k in range(3):
        ends = [model.node(f"{name} {k}", (2 * (k + x), 0.0)) for name, x in (("a", 0), ("b", 1))]
        model.beam(f"span {k}", ends, rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                                density=270.0), elements=20, bodies=1, modes=6,
                   stiffening=False)
        for end in ends:
            model.fix(end, "position")
    car = model.node("car", (start, 0.0), "translation")
    model.point_mass("car", car, MASS)
    model.gravity((0.0, -G))
    model.path("deck", on=[f"span {k}" for k in range(3)], blend=blend)
    model.path_joint(car, "deck", name="runs")
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("blend", [0.0, 0.1])
def test_a_point_stays_on_its_span(blend):
    for start, place in ((0.3, 1.0), (2.3, 3.0), (5.5, 5.0)):
        rest = equilibrium(spans(start, blend))
        assert rest["runs.way"][-1] == pytest.approx(place, abs=1e-5)
        assert rest.stability == "stable"
    for start in (2.0, 4.0):        # on a support: to one of its sides
        rest = equilibrium(spans(start, blend))
        assert abs(rest["runs.way"][-1] - start) == pytest.approx(1.0, abs=1e-5)
        assert rest.stability == "stable; left an unstable state at 1 of the load"


@pytest.mark.filterwarnings("ignore")
def test_a_carriage_is_held_by_one_of_its_wheels():
    """Both would hold the beam, too, from bending."""
    model = trolley(0.6)
    body = model.node("body", (0.7, 0.1))
    model.rigid_body("carriage", body, 0.5, 0.01)
    for name, x in (("rear", 0.6), ("front", 0.8)):
        model.path_joint(model.attach(name, (x, 0.0), body), "rail", name=f"{name} runs")
    rest = equilibrium(model)
    ways = np.array([rest[f"{name} runs.way"] for name in ("rear", "front")])
    assert ways[:, -1].mean() == pytest.approx(1.0, abs=1e-6)
    assert rest["runs.way"][-1] == pytest.approx(1.0, abs=1e-6)
    assert ways[0, -2] == pytest.approx(0.6) and 1e-9 < abs(ways[1, -2] - 0.8) < 1e-3
    assert np.isfinite(vibrations(rest).omega).all()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("ends", "goes"), [("refuse", "to the end of|beyond the end of"),
                                            ("straight", "beyond the end of")])
def test_a_slope_without_friction_has_no_equilibrium(ends, goes):
    """It says with which force the point would stay, and has the states in which it was held."""
    with pytest.raises(SimulationError) as caught:
        equilibrium(slide(ends=ends))
    said = str(caught.value)
    for words in ("no equilibrium was found: held at 0 of path 'line'", "runs.way starts",
                  f"a force of {-2 * 0.8 * G:.3g} along the path", "hold it by drive_way"):
        assert words in said
    assert any(f"the point moves {one} it" in said for one in goes.split("|"))
    held = caught.value.result
    assert held.t[-1] == pytest.approx(1.0) and held["runs.way"] == pytest.approx(0.0, abs=1e-15)
    assert held["runs.normal_force"][-1] == pytest.approx(2 * 0.6 * G)


@pytest.mark.parametrize(("coefficient", "rests"), [(1.5, True), (1.2, False)])
def test_friction_holds_a_bead_on_a_slope(coefficient, rests):
    """Of an angle whose tangent is 4 / 3."""
    model = slide()
    model.friction("runs", coefficient, name="rub")
    if rests:
        assert equilibrium(model)["runs.way"][-1] == pytest.approx(0.0, abs=1e-6)
    else:
        with pytest.raises(SimulationError, match="stop or friction that bears this force"):
            equilibrium(model)
