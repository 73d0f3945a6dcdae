"""Estimated changes by simplified bodies against runs of the simplified models."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import contributions
from sebody.gradients.ranking import ranked
from sebody.gradients.simplifications import Deformation
from sebody.model.numbering import coordinates
from sebody.model.variants import keep_modes, rigid, with_options
from sebody.runs.schemes import generalized_alpha
from tests import differentiated as scenes

pytestmark = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
SCHEME = generalized_alpha(tolerance=1e-10)


def simplified(model, body, change):
    """The model that a contribution is of; None of single modes that are not the last."""
    modes = model.bodies[body].reduced.modes
    if change == "rigid":
        return rigid(model, body).model
    if change == "without modes":
        return keep_modes(model, body, 0).model
    if change == f"without mode {modes - 1}":
        return keep_modes(model, body, modes - 1).model
    return None


# scene, h, end, quantities, and how far estimates are from runs, in parts of the change: products
# of changes, which are of second order, make it, of forces more than of motions
@pytest.mark.parametrize("make, h, t_end, quantities, close", [
    (scenes.hinged, 0.005, 0.5, ["tip.position", "hinge.force"], [0.02, 0.25]),
    (scenes.spinning, 0.005, 0.5, ["tip.acceleration"], [0.08]),
    (scenes.driven, 0.005, 0.5, ["tip.position", "slide.position"], [0.05, 0.08]),
    (scenes.flat, 0.002, 0.2, ["d.position", "b.velocity"], [0.06, 0.08])],
    ids=["hinged", "spinning", "driven", "planar"])
def test_estimates_are_what_runs_show(make, h, t_end, quantities, close):
    model = make()
    found = contributions(model, h, t_end, quantities)
    seen = set()
    for one in found.rows:
        made = simplified(model, one.body, one.change)
        if made is None:
            continue
        run = simulate(made, h, t_end, scheme=SCHEME)
        for name, most in zip(quantities, close, strict=True):
            true = run[name] - found.values[name]
            own = found.history(name, one.body, one.change)
            apart = np.sqrt(((own - true)**2).sum() / (true**2).sum())
            if one.large:       # of first order no more: the crank bends from a start that strains
                most = 0.3
            assert apart < most, (one.body, one.change, name, apart)
        seen.add(one.change)
    assert {"rigid", "without modes"} <= seen


def test_options_are_measured():
    model = scenes.hinged()
    found = contributions(model, 0.005, 0.2, "tip.position")
    for change, options in (("without stiffening", {"stiffening": False}),
                            ("inertia 'material'", {"inertia": "material", "stiffening": False})):
        run = simulate(with_options(model, "beam", **options).model, 0.005, 0.2, scheme=SCHEME)
        assert np.array_equal(found.history("tip.position", "beam", change),
                              run["tip.position"] - found.values["tip.position"])


def test_order_and_table():
    found = contributions(scenes.flat(), 0.002, 0.1, ["d.position", "b.velocity"], ["rod", "crank"])
    largest = [one.sizes.max() for one in found.rows]
    assert largest == sorted(largest, reverse=True)
    one = found.rows[0]
    own = np.abs(found.history("d.position", one.body, one.change)).max(axis=1)
    whole = np.abs(found.values["d.position"] - found.values["d.position"][0]).max()
    assert np.isclose(one.sizes[0], own.max() / whole) and one.times[0] == found.t[own.argmax()]
    lines = str(found).splitlines()
    assert len(lines) == 3 + len(found.rows) and lines[2].split()[0] == one.body
    assert {row.body for row in found.rows} == {"rod", "crank"}


def test_ranks_are_by_the_quantity_that_changes_most():
    """Whichever of the quantities that is, each relative to its own largest change."""
    t = np.array([0.0, 0.5, 1.0])
    values = {"far": np.array([[1.0, 0.0], [3.0, 0.0], [5.0, 1.0]]), "near": np.array([0, .1, .2])}
    changes = {"far": np.zeros((3, 2, 3)), "near": np.zeros((3, 3))}
    changes["far"][1, 1] = [0.4, -2.0, 1.2]         # over 4: 0.1, 0.5, 0.3
    changes["near"][2] = [0.08, 0.002, -0.04]       # over 0.2: 0.4, 0.01, 0.2
    rows, order = ranked(["far", "near"], [(name, "rigid") for name in "abc"], t, values, changes)
    assert [one.body for one in rows] == ["b", "a", "c"] and order == [1, 0, 2]
    assert np.allclose([one.sizes for one in rows], [[0.5, 0.01], [0.1, 0.4], [0.3, 0.2]])
    assert np.allclose([one.times for one in rows], [[0.5, 1.0]] * 3)


def test_a_rigid_rotation_loses_nothing_when_made_rigid():
    """In space, with the accelerations of a constant spin: neither rates nor second rates of (24).
    """
    model, spin = scenes.hinged(), 7.0 * scenes.TURN @ np.array([0.4, -0.5, 0.8])
    run = Simulation(model, 0.005)
    state, body = run.state, model.bodies["beam"]
    middle = np.mean([node.point for node in body.nodes], axis=0)
    state.v[:], state.a[:] = 0.0, 0.0
    for node in body.nodes:
        own, turned = (coordinates(run.numbering, one) for one in (node.position, node.rotation))
        state.v[own] = np.cross(spin, node.point - middle)
        state.a[own] = np.cross(spin, state.v[own])
        R = state.R[9 * run.numbering.rotations[node.rotation]:][:9].reshape(3, 3)
        state.v[turned] = R.T @ spin
    part = Deformation(body, run.numbering).at(state)
    largest = np.abs(state.a).max()
    assert len(part.e) == 9 and np.abs(part.second).max() < 1e-12 * largest
    assert np.abs(part.e).max() < 1e-12 and np.abs(part.rate).max() < 1e-12 * np.abs(state.v).max()
    state.a[:] *= 0.5       # what is left over is seen
    assert np.abs(Deformation(body, run.numbering).at(state).second).max() > 0.1 * largest


def test_changes_below_what_the_step_changes_are_marked():
    """Whose error is of second order, so that a fourth is left with half the step."""
    coarse, fine = (contributions(scenes.driven(), h, 0.1, "slide.position")
                    for h in (0.004, 0.002))
    assert 3.0 < coarse.by_step[0] / fine.by_step[0] < 5.0
    *lines, last = str(coarse).splitlines()[2:]
    assert last.split() == ["half", "the", "step", f"{coarse.by_step[0]:.2g}"]
    below = [one.sizes[0] < coarse.by_step[0] for one in coarse.rows]
    assert [line.count("below the step") == 1 for line in lines] == below and any(below)


def test_a_rigid_start_fits_the_joints():
    """Given velocities stay: the flexible coupler hides that all others have to move, too."""
    model = scenes.four_bar(3)
    found = contributions(model, 0.002, 0.1, "c.velocity")
    run = simulate(rigid(model, "coupler").model, 0.002, 0.1, scheme=SCHEME)
    assert np.allclose(found.values["c.velocity"][0] + found.history(
        "c.velocity", "coupler", "rigid")[0], run["c.velocity"][0], atol=1e-6)
    one = next(one for one in found.rows if one.change == "rigid")
    assert one.large and "(large)" in str(found)


def test_sparse_matrices_give_the_same(monkeypatch):
    """As of models with many unknowns, with a position at the end of a rigid link."""
    found = []
    for dense in (160, 0):
        monkeypatch.setattr("sebody.gradients.linear.DENSE", dense)
        found.append(contributions(scenes.moved(), 0.005, 0.05, "end.position"))
    assert [one.change for one in found[0].rows] == [one.change for one in found[1].rows]
    for one, other in zip(found[0].rows, found[1].rows, strict=True):
        assert np.allclose(one.sizes, other.sizes, rtol=1e-6)


def test_picture(tmp_path):
    found = contributions(scenes.hinged(), 0.005, 0.1, ["tip.position", "hinge.force"])
    assert found.save_picture(tmp_path / "found.png").read_bytes()[:4] == b"\x89PNG"


def free():
    model = Model()
    model.rigid_body("ball", model.node("a", (0, 0, 0)), 1.0, (1.0, 1.0, 1.0))
    model.gravity((0, 0, -9.81))
    return model


@pytest.mark.parametrize("make, quantities, more, words", [
    (scenes.hinged, [], {}, "quantities: none is given; give names"),
    (scenes.hinged, "tip.place", {}, "'place' is unknown"),
    (scenes.hinged, "base.position", {}, "'base.position' does not change: give one"),
    (scenes.hinged, "hinge.work", {}, "'hinge.work' is no function of a state: give a motion"),
    (scenes.hinged, "tip.position", {"bodies": ["bean"]}, "did you mean 'beam'"),
    (scenes.hinged, "tip.position", {"bodies": []}, "bodies: none is given; give names"),
    (free, "a.position", {}, "no superelement: there are no modes"),
    (lambda: scenes.hinged(frame="mean"), "tip.position", {}, "frame 'mean' depends on the steps")],
    ids=["none", "unknown", "still", "work", "body", "no body", "rigid", "frame"])
def test_refused(make, quantities, more, words):
    with pytest.raises(InputError) as caught:
        contributions(make(), 0.005, 0.05, quantities, **more)
    assert words in str(caught.value)


def test_unknown_histories():
    found = contributions(scenes.hinged(), 0.005, 0.05, "tip.position")
    with pytest.raises(InputError, match="quantity"):
        found.history("tip.velocity", "beam", "rigid")
    with pytest.raises(InputError, match="beam: without mode 2"):
        found.history("tip.position", "beam", "without mode 3")
