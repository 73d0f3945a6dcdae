"""Beams of coupled sections along axes, as superelements: published digits, divisions, refusals."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.analysis import equilibrium, final, gradient, modes, sections
from sebody.fem import Axis, GeneralSection, Stations, StiffnessSection, beam_along, circle
from sebody.model.beams import part_bodies
from sebody.model.variants import copied, divide, planar
from sebody.verify.outside.composite_beam import composite
from sebody.verify.outside.curved_beam import curved
from sebody.verify.outside.curved_superelements import curved_of_chrono
from sebody.verify.outside.general_beams import LINE, cantilever, error, moved
from sebody.verify.outside.twisted_beam import twisted


@pytest.mark.parametrize(("case", "wanted"), [
    (composite, 3e-10), (twisted, 1e-7), (curved, 1e-8)])
def test_published_digits(case, wanted):
    """Errors of second and fourth order in the length of one-element bodies are extrapolated."""
    case = case()
    u = [moved(case, count) for count in (8, 16, 32)]
    once = [(4 * fine - coarse) / 3 for coarse, fine in zip(u, u[1:], strict=False)]
    twice = (16 * once[1] - once[0]) / 15
    assert error(u[2], case) < 2e-4
    assert error(twice, case) < wanted


@pytest.mark.parametrize(("case", "bodies", "divide_by", "wanted"), [
    (composite, 4, "length", 4e-5), (twisted, 4, "length", 4e-4), (curved, 4, "rotation", 4e-4),
    (curved_of_chrono, 5, "rotation", 3e-4)])
def test_superelements(case, bodies, divide_by, wanted):
    assert error(moved(case(), 8 * bodies, bodies, 4, divide=divide_by), case()) < wanted


def test_a_beam_turned_by_rotation_moves_as_before():
    turn = Rotation.from_rotvec([0.3, -1.1, 2.0]).as_matrix()
    case = curved()
    assert_allclose(turn.T @ moved(case, 8, turn=turn), moved(case, 8), rtol=0, atol=1e-6)


def softening():
    """A blade-like beam whose outer tenth is soft."""
    root = np.diag([1e10, 1e9, 1e9, 2e8, 4e9, 6e9])
    places = [0.0, 0.3, 0.7, 0.9, 1.0]
    sections = [GeneralSection(s * root, m * np.diag([500.0] * 3 + [200.0, 50.0, 150.0]))
                for s, m in ((1, 1), (0.3, 0.5), (0.05, 0.2), (4e-3, 0.08), (1e-5, 0.03))]
    axis = Axis([[0, 0, 0], [50, 1.0, 0.2], [100, -1.0, 4.0]], twist=[[0, 0.3], [1, 0]])
    return axis, Stations(places, sections), (0, 0, 1e4)


def test_division_by_equal_turning():
    """Bodies turn equally, as of a linear solution of finer elements, and are exacter so."""
    case = softening()
    exact = [moved(case, count, divide="rotation") for count in (12, 24)]
    exact = (4 * exact[1] - exact[0]) / 3
    off = {}
    for how in ("length", "rotation"):
        u = moved(case, 32, 4, 4, divide=how)
        off[how] = np.linalg.norm(u - exact) / np.linalg.norm(exact)
    assert off["rotation"] < off["length"] / 5
    model, _ = cantilever(case, 32, 4, 4, divide="rotation")
    beam = model.beams[0]
    by_places, _ = cantilever(case, 32, 4, 4, divide=beam.places)
    for one, two in zip(beam.bodies, by_places.beams[0].bodies, strict=True):
        assert_allclose(one.stiffness, two.stiffness, rtol=1e-12)
    assert np.diff(beam.places)[-1] < 0.2
    # a straight uniform beam turns as 2 s - s^2 under a force at its tip
    plain = Model(planar=True)
    ends = plain.node("a", (0.0, 0.0)), plain.node("b", (3.0, 4.0))
    plain.beam("beam", ends, circle(0.01, 2e11, 0.3, 7800.0), 4, 2, divide="rotation")
    assert_allclose(plain.beams[0].places[1], 1 - np.sqrt(0.5), atol=1e-4)
    assert_allclose(plain.nodes["beam 1"].point, (1 - np.sqrt(0.5)) * np.array([3, 4]), atol=1e-3)


def test_another_division_of_a_beam_along_an_axis():
    model, _ = cantilever(softening(), 24, 2, 3)
    other = divide(model, "beam", 4, divide="rotation").model
    assert [len(one.beams[0].parts) for one in (model, other)] == [2, 4]
    frequencies = [modes(equilibrium(one, 1)).frequency[:3] for one in (model, other)]
    assert_allclose(*frequencies, rtol=1e-2)     # elements of other lengths, h^2


def test_damping_of_coupled_beams():
    """A ratio of the first clamped mode of the whole beam, in any division and of any motion."""
    case = softening()
    for bodies in (1, 3):
        model, _ = cantilever((*case[:2], (0, 0, 0)), 24, bodies, 6, damping=(0.02, "clamped 1"))
        found = modes(equilibrium(model, 1))
        swings = found.damping < 1.0        # fast modes do not swing
        omega, ratio = found.omega[swings][:3], found.damping[swings][:3]
        assert_allclose(ratio / omega, 0.02 / omega[0], rtol=5e-3)
        assert_allclose(ratio[0], 0.02, rtol=5e-3)


def test_retardation_times_of_sections_damp_the_bodies():
    axis, stations, force = softening()
    own = Stations(stations.places, [GeneralSection(one.stiffness, one.mass, retardation=0.002)
                                     for one in stations.sections])
    model, _ = cantilever((axis, own, force), 24, 3, 4)
    for part in model.beams[0].parts:
        K = part.reduced.stiffness
        assert_allclose(part.reduced.damping, 0.002 * K, rtol=0, atol=1e-9 * np.abs(K).max())
    with pytest.raises(InputError, match="sections have retardation times of their own"):
        cantilever((axis, own, force), 24, 3, 4, damping=0.01)


def far(model):
    """Nodes of which the second is elsewhere."""
    return model.node("a", (0, 0, 0)), model.node("b", (9.0, 0, 0))


@pytest.mark.parametrize(("planar", "options", "said"), [
    (False, {}, r"from node 'a' its axis leads to \(10, 0, 0\), and node 'b' is 1 away: place"),
    (False, {"up": (0, 1, 0)}, "its axis has its own up"),
    (False, {"axis": LINE}, "axis of beam 'beam'.* give a sebody.fem.Axis"),
    (False, {"axis": None, "divide": "turning"}, "divide.*give 'length', 'rotation' or places"),
    (False, {"axis": None, "divide": [0, 0.5]}, "divide.*3 places from 0 to 1, the ends of 2"),
    (False, {"axis": None, "divide": [0, 1.5, 1]}, "places that ascend from 0 to 1"),
    (False, {"axis": None, "damping": (0.1, "hinged 1")}, "are coupled: give 'free 1'"),
    (True, {}, "an axis is for beams in space"),
    (True, {"axis": None}, "a GeneralSection is for beams in space"),
])
def test_what_is_refused(planar, options, said):
    model = Model(planar=planar)
    ends = far(model) if not planar else (model.node("a", (0, 0)), model.node("b", (10.0, 0)))
    with pytest.raises(InputError, match=said):
        model.beam("beam", ends, composite()[1], 4, 2, **{"axis": Axis(LINE), **options})


def test_stubby_elements_are_nonlinear_beams():
    """Of short elements of thick sections, too, the frame is the mean of their rotations."""
    thick = StiffnessSection(1e6, 1e5, 1e5, 1e5, 1.0, 1.0, 0.5, 0.5, 1e5, 1e5)
    model = Model()
    model.beam("beam", (model.node("a", (0, 0, 0)), model.node("b", (1.0, 0, 0))), thick, 4)
    assert {part.frame for part in model.beams[0].parts} == {"converged_mean"}
    assert not any(part.stiffening for part in model.beams[0].parts)


def test_variants_know_beams_along_an_axis():
    """Bodies made anew are those that were built; a plane has no such beams, but their bodies."""
    model, _ = cantilever(softening(), 12, 3, 2, divide="rotation",
                          turn=Rotation.from_rotvec([0.2, 0.1, 0.7]).as_matrix())
    beam = model.beams[0]
    for part, body in zip(beam.parts, part_bodies(model, beam, beam.section), strict=True):
        assert_allclose(body.stiffness, part.reduced.stiffness, rtol=1e-12)
    assert copied(model).beams[0].options["axis"] is beam.options["axis"]
    flat = Axis(lambda s: [10 * s, s * s, 0.0])
    spatial, _ = cantilever((flat, circle(0.1, 2e11, 0.3, 7800.0), (0, 1.0, 0)), 8, 1, 2)
    made = planar(spatial).model
    assert list(made.bodies) == ["beam"] and not made.beams
    with pytest.raises(InputError, match="has built 0 beams 'beam'"):
        divide(made, "beam", 2)


def test_quantities_inside_a_blade_are_read_by_name():
    """Forces and strains of sections at a node, of a recorded run and of a saved file."""
    axis, stations, force = softening()
    model, _ = cantilever((axis, stations, force), 12, 2, 2, divide="rotation")
    result = equilibrium(model, 2)
    forces, strains = (result[f"beam 2.node0.section_{name}"][-1, 0] for name in (
        "forces", "strains"))
    place = model.beams[0].places[1]
    assert_allclose(stations(place).stiffness @ strains, forces, rtol=1e-6, atol=1e-6 * 1e4)
    field = result.field("beam 2").section_strains()
    assert_allclose(field[0, 0], strains, rtol=1e-12)
    lever = axis.position(1.0) - axis.position(place)
    assert_allclose(np.linalg.norm(forces[3:]), np.linalg.norm(np.cross(lever, force)), rtol=0.02)
    with pytest.raises(InputError, match="of beams there are section_strains, section_forces"):
        result.field("beam 2").strain()


@pytest.mark.parametrize(("case", "share", "error_of"), [
    (composite, 0.02, 2e-4), (curved, 0.01, 2e-3)])
def test_geometric_stiffness_is_what_nonlinear_beams_do_in_second_order(case, share, error_of):
    """With the energy u^T G(u) u / 2 of third order, w_j = K^-1 e_j and u = K^-1 p the tip moves by
    -(w_j^T G(u) u + u^T G(w_j) u / 2) beside u: as half the sum of what p and -p do.
    """
    axis, section, force = case()[:3]
    force = share * np.array(force)
    fe = beam_along(axis, section, 32)
    held = splu(fe.stiffness[6:, 6:].tocsc())

    def moved_by(load):
        u = np.zeros(len(load))
        u[6:] = held.solve(load[6:])
        return u
    unit = np.zeros((3, fe.stiffness.shape[0]))
    unit[range(3), range(-6, -3)] = 1.0
    u = moved_by(force @ unit)
    second = np.zeros(3)
    for k in range(3):
        w = moved_by(unit[k])
        second[k] = -(w @ (fe.geometric_stiffness(u) @ u)
                      + u @ (fe.geometric_stiffness(w) @ u) / 2)
    found = [sum(moved((axis, section, sign * force), count) for sign in (1, -1)) / 2
             for count in (12, 24)]
    exact = (4 * found[1] - found[0]) / 3
    assert np.abs(second - exact).max() < error_of * np.abs(exact).max()


def test_gradients_by_the_sections_of_a_blade():
    """Exact derivatives by a factor of all stiffnesses against differences of runs."""
    axis, stations, force = softening()

    def section(x):
        return Stations(stations.places, [GeneralSection(x[0] * one.stiffness, one.mass)
                                          for one in stations.sections])
    model, _ = cantilever((axis, stations, force), 12, 2, 2, divide="rotation")
    names = "tip.position.z", "beam 2.node0.section_strains.0.4"
    found = gradient(model, 0.02, 0.2, {name: final(name) for name in names},
                     [sections(model, "beam", [1.0], section)])
    values = []
    for factor in (1 - 1e-4, 1 + 1e-4):
        other, _ = cantilever((axis, section([factor]), force), 12, 2, 2,
                              divide=model.beams[0].places)
        result = simulate(other, 0.02, 0.2)
        values.append([result["tip.position"][-1, 2],
                       result["beam 2.node0.section_strains"][-1, 0, 4]])
    differences = np.subtract(*values[::-1]) / 2e-4
    assert_allclose(found.matrix[:, 0], differences, rtol=1e-5)     # h^2, and rounding / h
