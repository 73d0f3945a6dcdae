"""One sign of angles and ways: readings, limits, drives, actuators, friction, planar variants."""

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, Simulation, rest_to_rest, simulate
from sebody.analysis import resume, save_state
from sebody.model.variants import planar

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
PLACE = np.array([2.0, -1.0, 0.5])
KINDS = ("prismatic", "cylindrical", "slider")
FORCE, MASS = 1.5, 2.0

pytestmark = pytest.mark.filterwarnings("ignore:.*since version 0.2.0:FutureWarning")


def cart(kind, mounted=False, flat=False):
    """A cart that slides along a rail in general position, on the ground or on a heavy mount."""
    model = Model(planar=flat)
    inertia = 0.3 if flat else TURN @ np.diag((0.3, 0.4, 0.5)) @ TURN.T
    place, axis = (PLACE[:2], TURN[:2, 0]) if flat else (PLACE, TURN[:, 0])
    cart = model.node("cart", place + 0.3 * axis)
    model.rigid_body("car", cart, MASS, inertia)
    to = None
    if mounted:
        to = model.node("mount", place)
        model.rigid_body("mass", to, 1e9, 1e9 if flat else (1e9, 1e9, 1e9))
    getattr(model, kind)(cart, axis, to=to, name="rail")
    return model


def moved(result):
    """The way of the cart along the axis at the start."""
    start = result["cart.position"]
    axis = TURN[:start.shape[1], 0]
    return (start - start[0]) @ axis / (axis @ axis)


@pytest.mark.parametrize("mounted", [False, True])
@pytest.mark.parametrize("kind, flat", [*((kind, False) for kind in KINDS), ("prismatic", True),
                                        ("slider", True)])
def test_limit_drive_actuator_and_reading_agree(kind, flat, mounted):
    """All are of the cart against what carries it: positive along the axis."""
    length = np.linalg.norm(TURN[:2, 0]) if flat else 1.0
    pushed = cart(kind, mounted, flat)
    pushed.actuator("motor", joint="rail", start=FORCE,
                    **({"what": "force"} if kind == "cylindrical" else {}))
    result = simulate(pushed, 0.01, 0.8)
    way = FORCE / MASS * 0.8**2 / 2
    assert result["rail.displacement"][-1] == pytest.approx(way, rel=1e-7)
    assert moved(result)[-1] * length == pytest.approx(way, rel=1e-7)
    assert result["rail.speed"][-1] == pytest.approx(FORCE / MASS * 0.8, rel=1e-7)
    unit = TURN[:2, 0] / length if flat else TURN[:, 0]
    assert result["motor.force"][-1] @ unit == pytest.approx(FORCE)
    for limits in ({"upper": 0.1}, {"lower": -0.1}):
        stopped = cart(kind, mounted, flat)
        sign = 1.0 if "upper" in limits else -1.0
        stopped.actuator("motor", joint="rail", start=sign * FORCE,
                         **({"what": "force"} if kind == "cylindrical" else {}))
        stopped.stop("rail", **limits, stiffness=1e5, name="end")
        result = simulate(stopped, 0.005, 0.8)
        assert 0.1 < np.abs(result["rail.displacement"]).max() < 0.12
        assert result["end.normal_force"].max() > FORCE
        k = np.argmax(result["end.normal_force"])
        assert result["end.force"][k] @ unit == pytest.approx(
            -sign * result["end.normal_force"][k])


@pytest.mark.parametrize("kind, flat", [*((kind, False) for kind in KINDS), ("prismatic", True)])
def test_drives_of_joints_and_of_nodes(kind, flat):
    """The drive of a joint by its name is that of its node; thrust times rate is the power."""
    axis = TURN[:2, 0] if flat else TURN[:, 0]
    ways = [lambda m: m.drive_slide("rail", rest_to_rest(0.5, 1.0), name="winch")]
    if kind != "slider":
        ways.append(lambda m: m.drive_slide("cart", rest_to_rest(0.5, 1.0), axis, name="winch"))
    for drive in ways:
        model = cart(kind, flat=flat)
        drive(model)
        result = simulate(model, 0.01, 0.7)
        s = 0.7
        done = 0.5 * (10 * s**3 - 15 * s**4 + 6 * s**5)
        assert result["rail.displacement"][-1] == pytest.approx(done)
        unit = axis / np.linalg.norm(axis)
        assert result["winch.thrust"][20] == pytest.approx(
            MASS * result["cart.acceleration"][20] @ unit, rel=1e-6)
        assert result["winch.power"] == pytest.approx(
            result["winch.thrust"] * result["rail.speed"], abs=1e-9)


@pytest.mark.parametrize("kind", ["prismatic", "slider"])
def test_friction_brakes_the_node(kind):
    """Its force is that on the node of the joint, against the motion."""
    model = cart(kind)
    model.friction("rail", 0.2, preload=5.0, reaction=False, name="dry")
    model.initial_velocity("cart", linear=0.8 * TURN[:, 0])
    result = simulate(model, 0.01, 0.3)
    assert result["rail.speed"][-1] == pytest.approx(0.8 - 0.3 / MASS, rel=1e-6)
    assert result["dry.force"][-1] @ TURN[:, 0] == pytest.approx(-1.0)


def test_a_planar_variant_has_the_same_sign():
    def in_a_plane(kind):
        model = cart(kind)
        model.attach("tip", PLACE + TURN @ (0.7, 0.2, 0.0), "cart")
        model.gravity(-9.81 * TURN[:, 1])
        return model
    spatial = in_a_plane("prismatic")
    spatial.stop("rail", lower=-0.4, upper=0.1, stiffness=1e5, name="end")
    spatial.actuator("motor", joint="rail", start=FORCE)
    flat = planar(spatial).model
    one, other = (simulate(model, 0.005, 0.6)["rail.displacement"] for model in (spatial, flat))
    assert one.max() > 0.1
    assert other == pytest.approx(one, abs=1e-7)
    driven = in_a_plane("cylindrical")
    driven.drive_slide("rail", rest_to_rest(0.3, 1.0), name="winch")
    one, other = (simulate(model, 0.01, 0.6) for model in (driven, planar(driven).model))
    assert other["rail.displacement"] == pytest.approx(one["rail.displacement"], abs=1e-9)
    assert other["winch.thrust"] == pytest.approx(one["winch.thrust"], abs=1e-6)


def test_files_have_the_same_sign(tmp_path):
    """A saved result, and a run that goes on."""
    model = cart("prismatic")
    model.drive_slide("rail", rest_to_rest(0.5, 1.0), name="winch")
    run = Simulation(model, 0.01).run_to(0.3)
    save_state(run, tmp_path / "run.npz")
    whole = run.run_to(0.6).result()
    again = resume(model, tmp_path / "run.npz").run_to(0.6).result()
    loaded = Result.load(whole.save(tmp_path / "result.npz"))
    for name in ("rail.displacement", "winch.thrust"):
        assert whole[name][30] > 0
        assert np.array_equal(again[name], whole[name])
        assert np.array_equal(loaded[name], whole[name])


def test_the_new_sign_is_said_once_a_model():
    """Where a limit or drive was of the other node before, and nowhere else."""
    def said(build):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            build()
        return [one for one in caught if one.category is FutureWarning]

    def limited(kind):
        model = cart(kind)
        model.stop("rail", upper=1.0, stiffness=1e4)
        model.drive_slide("cart", rest_to_rest(0.1, 1.0), TURN[:, 0])
    for kind, count in (("prismatic", 1), ("cylindrical", 1)):
        found = said(lambda kind=kind: limited(kind))
        assert len(found) == count and found[0].filename == __file__
        assert "since version 0.2.0 positive is where 'cart' has moved along" in str(
            found[0].message)
    assert not said(lambda: cart("slider").stop("rail", upper=1.0, stiffness=1e4))
    assert not said(lambda: cart("prismatic").actuator("motor", joint="rail"))
    hinge = Model()
    hinge.rigid_body("wheel", hinge.node("a", PLACE), 1.0, (1, 1, 1))
    hinge.revolute("a", TURN[:, 0], name="hinge")
    assert not said(lambda: hinge.stop("hinge", upper=1.0, stiffness=1e4))


def test_drives_along_what_slides_the_other_way_are_refused():
    for build, message in (
            (lambda m: m.drive_slide("cart", rest_to_rest(1.0, 1.0), TURN[:, 1], name="winch"),
             "'winch' is along .* which prismatic 'rail' forbids, since it slides along"),
            (lambda m: m.drive_slide("cart", rest_to_rest(1.0, 1.0)),
             "drive at 'cart' has no axis: give axis=, or a joint in place of the node"),
            (lambda m: m.drive_slide("rail", rest_to_rest(1.0, 1.0), TURN[:, 0]),
             "given joint 'rail', which has an axis and two nodes: leave axis and to out"),
            (lambda m: m.drive_angle("rail", rest_to_rest(1.0, 1.0)),
             "'rail' is a prismatic, which does not turn about one axis: give a revolute")):
        with pytest.raises(InputError, match=message):
            build(cart("prismatic"))
