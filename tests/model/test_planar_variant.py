"""A planar model in the place of a spatial one: beams and frames move alike in both."""

from dataclasses import replace

import numpy as np
import pytest
from in_plane import (
    CLOSE,
    EXACT,
    FLAT,
    SQUARE,
    TURN,
    H,
    X,
    Y,
    Z,
    assert_same,
    at,
    beam,
    reduced,
    wind,
)
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.fem import frame as beams, rectangle
from sebody.model.variants import copied, divide, keep_modes, planar
from sebody.reduction import craig_bampton
from sebody.results import Result
from sebody.scenes import hinged_beam, planar_hinged_beam

QUANTITIES = ("tip.position", "tip.velocity", "tip.rotation", "base.angular_velocity",
              "energy.kinetic", "energy.strain", "motor.power", "hinge.force", "beam.base.moment",
              "momentum", "beam.node2.displacement", "beam.node2.velocity",
              "beam.node2.section_forces")


@pytest.mark.parametrize("section", [FLAT, SQUARE])
@pytest.mark.parametrize("options", [{}, {"inertia": "material"}, {"inertia": "rigid_part"},
                                     {"frame": "node", "frame_node": 1}])
def test_a_beam_moves_in_its_plane_as_in_space(section, options):
    model = beam(section, **options)
    made, sentence = planar(model)
    assert made.planar and not model.planar
    # base: an angle in the place of three and two multipliers; tip: three; two of four modes
    assert sentence.startswith("the model is planar, normal to (")
    assert sentence.endswith(": 6 instead of 15 unknowns")
    assert made.bodies["beam"].reduced.modes == 2
    assert_same(model, made, QUANTITIES)


def test_the_hinged_beam_is_the_planar_one():
    made, sentence = planar(hinged_beam.build().model)
    assert sentence == "the model is planar, normal to (0, 0, 1): 6 instead of 15 unknowns"
    found, expected = (simulate(model, 0.01, 1.0, EXACT)
                       for model in (made, planar_hinged_beam.build().model))
    for name in ("tip.position", "base.angular_velocity", "energy.strain",
                 "beam.node10.section_forces"):
        size = np.abs(expected[name]).max()
        assert np.abs(found[name] - expected[name]).max() <= CLOSE * size, name


def test_a_beam_on_a_ball_stays_in_the_plane_of_its_torque():
    model = beam(FLAT)
    free = Model()
    nodes = [free.node(name, node.point) for name, node in model.nodes.items()]
    free.superelement("beam", model.bodies["beam"].reduced, nodes)
    free.fix("base", "position")
    free.torque("base", -2e3 * Z, wind, name="motor")
    made, sentence = planar(free)
    assert sentence.endswith(": 6 instead of 13 unknowns")
    assert_same(free, made, ("tip.position", "base.rotation", "energy.kinetic"))


def test_the_plane_is_kept_in_files_and_by_copies(tmp_path):
    made = planar(beam()).model
    plane = copied(made).plane
    assert np.array_equal(plane.axes, made.plane.axes)
    result = simulate(made, H, 2 * H, EXACT)
    again = Result.load(result.save(tmp_path / "run.npz"))
    for name in ("origin", "axes"):
        assert np.array_equal(getattr(again.model.plane, name), getattr(made.plane, name))


def test_a_frame_without_planar_kernels_is_said():
    model = Model()
    nodes = [model.node(name, at(x, 0, 0)) for name, x in (("a", 0), ("b", 50))]
    model.superelement("beam", reduced(nodes[1].point, nodes[0].point, 2), nodes, frame="mean")
    model.revolute("a", Z)
    with pytest.raises(InputError, match="^there is no kernel for layout 'planar-f2', frame"):
        planar(model)


def test_modes_of_one_frequency_are_turned_until_they_are_in_the_plane():
    model = beam()
    body = model.bodies["beam"].reduced
    frequencies = np.sqrt(np.diag(body.stiffness)[-4:])
    assert abs(frequencies[1] / frequencies[0] - 1) < 1e-6      # a pair, in any direction
    kept = planar(model).model.bodies["beam"].reduced
    assert np.allclose(np.sqrt(np.diag(kept.stiffness)[-2:]), frequencies[[0, 2]], rtol=1e-6)


@pytest.mark.parametrize("up", [Y, Z, None])
@pytest.mark.parametrize("tapered", [False, True])
def test_beams_are_divided_in_the_plane_as_in_space(up, tapered):
    """A section that bends easily about one axis, in any position that is symmetric."""
    section = SQUARE if up is None else FLAT

    def thinner(place):
        return replace(section, inertia_z=(1 - 0.5 * place) * section.inertia_z)
    model = Model()
    ends = [model.node(name, at(*xy, 0)) for name, xy in (("a", (0, 0)), ("b", (90, 50)))]
    if tapered and up is None:
        up = Y
    model.beam("rod", ends, thinner if tapered else section, 8, 2, modes=2, up=up, damping=0.01)
    model.fix("a", "position")
    model.torque("a", 2e3 * Z, wind)
    first, second = divide(planar(model).model, "rod", 4), planar(divide(model, "rod", 4).model)
    assert first.change == "rod has 4 superelements of 2 finite elements instead of 2 " + (
        "superelements of 4 finite elements")
    assert list(first.model.bodies) == list(second.model.bodies)
    for name, body in first.model.bodies.items():
        expected = second.model.bodies[name].reduced
        assert body.reduced.modes == expected.modes
        for matrix in ("stiffness", "mass"):
            # signs of modes are free: they are compared by size
            own, other = (np.abs(getattr(one, matrix)) for one in (body.reduced, expected))
            assert np.abs(own - other).max() < 1e-9 * other.max(), name


def test_half_a_pair_of_modes_is_in_no_plane():
    model = beam(SQUARE)
    with pytest.raises(InputError, match="its mass couples .*mode 2, .*symmetric about the plane, "
                                         "or has a part of the modes of one frequency: "
                                         "keep all or none of them"):
        planar(keep_modes(model, "beam", 3).model)
    assert planar(keep_modes(model, "beam", 2).model).model.bodies["beam"].reduced.modes == 1


POINTS = [(0, 0, 0), (50, 0, 0), (60, 30, 0), (10, 40, 0)]


@pytest.mark.parametrize(("keeps", "frame", "inertia"), [
    (("full", "translation", "rotation", "translation"), "converged_mean", None),
    (("full", "translation", "rotation", "translation"), "converged_mean", "rigid_part"),
    (("translation",) * 4, "positions", None)])
def test_frames_of_beams_with_any_boundary(keeps, frame, inertia):
    """A closed frame in the plane, of whose modes some move in it and others out of it."""
    points = [at(*place) for place in POINTS]
    fe_model = beams(points, [(0, 1), (1, 2), (2, 3), (3, 0)], FLAT, 4, up=Z)
    model = Model()
    nodes = [model.node(name, *one) for name, *one in zip("abcd", points, keeps, strict=True)]
    model.superelement("frame", craig_bampton(fe_model, list(enumerate(keeps)), 6), nodes,
                       frame=frame, inertia=inertia)
    model.fix("a", "position")
    model.force("b", TURN @ (0, 2e3, 0), wind)
    model.gravity(TURN @ (0, -9.0, 0))
    made = planar(model).model
    assert 0 < made.bodies["frame"].reduced.modes < 6
    assert_same(model, made, ("b.position", "d.velocity", "frame.node6.velocity", "energy.strain"))


def test_bodies_of_a_single_element_are_planar_too():
    """Their loads within the element need no modes."""
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
    model = Model()
    model.gravity(-9.81 * turn[:, 1])
    hinge = model.node("hinge", (1.0, 2.0, 3.0))
    tip = model.node("tip", hinge.point + turn @ (0.8, 0.1, 0.0))
    model.beam("link", (hinge, tip), rectangle(0.01, 0.02, 2e11, 0.3, 7800.0), 8, 8,
               up=turn[:, 2], damping=0.01)
    model.revolute(hinge, turn[:, 2])
    flat = planar(model).model
    runs = [simulate(one, 0.005, 0.2) for one in (model, flat)]
    arms = [np.linalg.norm(run["tip.position"] - run["hinge.position"], axis=1) for run in runs]
    energies = [run["energy.kinetic"][-1] for run in runs]
    assert flat.planar and energies[0] > 0.1
    # to the tolerance of Newton's iteration, 1e-6 of the motion
    np.testing.assert_allclose(arms[1], arms[0], rtol=1e-5)
    assert energies[1] == pytest.approx(energies[0], rel=1e-4)


def test_links_that_differ_by_a_rotation_in_the_plane_are_one_planar_body():
    """Loads and modes turn with them: of two links one has the load, and the other is mirrored."""
    model, body = Model(), reduced(at(0, 0, 0), at(40, 0, 0), 2)
    model.gravity(-9810.0 * Y)
    last = model.node("base", at(0, 0, 0))
    model.revolute(last, axis=Z)
    for k, angle in enumerate((0.0, 0.7, 2.9)):
        turn = TURN @ Rotation.from_rotvec((0.0, 0.0, angle)).as_matrix() @ TURN.T
        end = model.node(f"end {k}", last.point + 40.0 * turn @ X)
        model.superelement(f"link {k}", body, [end, last], rotation=turn)
        if k < 2:
            last = model.node(f"begin {k}", end.point, at=end)
            model.revolute(end, axis=Z, to=last)
    model.body_load("link 1", "wind", wind)
    made, _ = planar(model)
    assert len({one.reduced.unrotated[0] for one in made.bodies.values()}) == 1
    assert_same(model, made, ("end 2.position", "end 1.velocity", "energy.strain"))
