"""Nonlinear beams: strains of Simo and Reissner, reference solutions, order, objectivity."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.contract.layout import ENERGY, STRAIN
from sebody.engine import evaluate
from sebody.scenes import hinged_beam, slider_crank, spherical_beam_strong, spin_up
from sebody.scenes.hinged_beam import SECTION, TORQUE
from sebody.verify import references

BERNOULLI = replace(SECTION, shear_factor=None)
END = np.array([100.0, 100.0, 0.0])


def spun(elements, turned=None, planar=False):
    """The hinged beam as nonlinear beams, in other axes if wanted."""
    d = 2 if planar else 3
    turned = np.eye(3) if turned is None else turned
    model = Model(planar=planar)
    ends = model.node("base", np.zeros(d)), model.node("tip", (turned @ END)[:d])
    model.beam("beam", ends, SECTION, elements,
               up=None if planar else turned @ [-1.0, 1.0, 0.0])
    axis = turned @ [0.0, 0.0, 1.0]
    model.revolute("base", axis)
    model.torque("base", 1.0 if planar else axis, TORQUE)
    return model


def tip_error(result, reference, every):
    tip = result["tip.position"][::every]
    exact = reference[:, :tip.shape[1]]
    return np.linalg.norm(tip - exact) / np.linalg.norm(exact)


@pytest.mark.parametrize("section", [BERNOULLI, SECTION], ids=["bernoulli", "timoshenko"])
def test_strain_energy_is_that_of_simo_and_reissner(section):
    """Two nodes anywhere: half EA, GA, GJ, EI of the strains at the rotation half way."""
    model = Model()
    length = 12.0
    ends = model.node("a", (0, 0, 0)), model.node("b", (length, 0, 0))
    model.beam("beam", ends, section, 1)
    run = Simulation(model, 0.01)
    random = np.random.default_rng(4)
    turns = Rotation.from_rotvec(random.normal(size=3)) * Rotation.from_rotvec(
        0.4 * random.normal(size=(2, 3)))
    x = random.normal(size=3) + np.array([[0, 0, 0], turns[0].apply([length, 0.5, -0.3])])
    for node, place, turn in zip(ends, x, turns, strict=True):
        first = run.numbering.dof_blocks[node.position]
        run.state.q[first:first + 3] = place
        k = run.numbering.rotations[node.rotation]
        run.state.R[9 * k:9 * k + 9] = turn.as_matrix().ravel()
    run.state.frames_old[:] = turns[0].as_matrix().ravel()
    run.state.energy[:] = 0.0
    assert evaluate.run_kernels(ENERGY, 0, 1, run.system, run.state) == 0
    psi = (turns[0].inv() * turns[1]).as_rotvec()
    middle = turns[0] * Rotation.from_rotvec(psi / 2)
    gamma = middle.inv().apply(x[1] - x[0]) / length - [1.0, 0.0, 0.0]
    E, G, A = section.youngs_modulus, section.shear_modulus, section.area
    flexibility = length**2 / (12 * E * section.inertia_z)      # MacNeal's, both axes alike
    if section.shear_factor:
        flexibility += 1 / (section.shear_factor * G * A)
    strain = length / 2 * (E * A * gamma[0]**2 + (gamma[1]**2 + gamma[2]**2) / flexibility) + (
        G * section.torsion * psi[0]**2 + E * section.inertia_z * (psi[1]**2 + psi[2]**2)
    ) / (2 * length)
    # strains of 1e-2 are differences of numbers of order one, their energy is of second order
    assert run.state.energy[STRAIN] == pytest.approx(strain, rel=1e-10)


def test_hinged_beam_against_the_reference():
    """32 elements: tip within 1e-4 of a solution by elements of degree 4; five are close, too."""
    reference = references.reference("hinged_beam")["tip_position"]
    errors = {n: tip_error(simulate(spun(n), 0.0025, 30.0), reference, 4) for n in (5, 32)}
    assert errors[32] < 1e-4
    assert errors[5] < 1.5e-4


def test_planar_beams_are_the_spatial_ones():
    planar, spatial = (simulate(spun(4, planar=p), 0.01, 5.0, generalized_alpha(0.9, 1e-11))
                       for p in (True, False))
    assert np.abs(spatial["tip.position"][:, :2] - planar["tip.position"]).max() < 1e-7


def test_second_order_in_the_length_of_the_elements():
    """At one step size, against a division twice as fine as the finest."""
    finest = simulate(spun(48, planar=True), 0.01, 15.0)["tip.position"]
    counts = np.array([3, 6, 12])
    errors = [np.linalg.norm(simulate(spun(n, planar=True), 0.01, 15.0)["tip.position"] - finest)
              for n in counts]
    assert 1.8 < order(1 / counts, errors) < 2.4


def test_strong_impulse_against_the_reference():
    """The spherical beam at 2800, where one superelement bends far too much: tip within 3e-4."""
    data = references.reference("spherical_beam_strong")
    t, exact = data["t"], data["tip_position_2800"]
    scene = spherical_beam_strong.build()
    model = Model()
    ends = [model.node(n, scene.model.nodes[n].point) for n in ("base", "tip")]
    model.beam("beam", ends, SECTION, 32)
    model.fix("base", "position")
    for load in scene.model.loads:
        node = "base" if "rotation" in load.name else "tip"
        getattr(model, load.kind)(node, load.direction, load.time_function)
    h = 0.00125
    result = simulate(model, h, 20.0, output_every=40)
    assert result.cuts == 0
    rows = t <= 20.0 + 1e-9
    error = np.linalg.norm(result["tip.position"] - exact[rows]) / np.linalg.norm(exact[rows])
    assert error < 3e-4


def test_beams_are_objective():
    """The whole model turned far away: the same motion in its own axes."""
    turn = Rotation.from_rotvec([1.9, -2.2, 0.7]).as_matrix()
    exact = generalized_alpha(0.9, 1e-12)
    plain, turned = (simulate(spun(3, R), 0.01, 3.0, exact) for R in (None, turn))
    difference = turned["tip.position"] @ turn - plain["tip.position"]
    # 300 steps, of 1e-12 of their increment each
    assert np.abs(difference).max() < 1e-10 * np.linalg.norm(END)


# axial and transverse displacement of the tip in the axes of the root, by 12 quadratic
# geometrically exact elements, step 0.005; 6 of them at 0.01 differ by less than 5e-4
SPIN_UP = {
    "kane": {2: (-6.630e-4, -0.095778), 4: (-7.3195e-3, -0.318240), 6: (-1.83582e-2, -0.504706),
             7: (-2.02881e-2, -0.531617), 8: (-1.84138e-2, -0.507916), 10: (-8.4806e-3, -0.347695),
             12: (-1.4659e-3, -0.149307), 14: (8.565e-5, -0.018365)},
    "simo": {2: (-6.059e-4, -0.102381), 4: (-6.7661e-3, -0.342282), 6: (-1.69739e-2, -0.543638),
             7: (-1.86248e-2, -0.571411), 8: (-1.66392e-2, -0.542992), 10: (-7.0813e-3, -0.363035),
             12: (-8.0564e-4, -0.151003), 14: (4.9008e-4, -0.020318)}}


@pytest.mark.parametrize("case", SPIN_UP)
def test_spin_up_against_quadratic_elements(case):
    """Within 0.3 % of the largest deflection at every time of the table."""
    scene = spin_up.build(case, bodies=32, elements=32)
    result = simulate(scene.model, scene.h, 15.0)
    length, speed = spin_up.CASES[case][:2]
    largest = max(abs(v) for _, v in SPIN_UP[case].values())
    for t, (axial, across) in SPIN_UP[case].items():
        angle = spin_up.turning(speed)[0](float(t))
        c, s = np.cos(angle), np.sin(angle)
        x, y = result["tip.position"][round(t / scene.h)]
        assert abs(c * x + s * y - length - axial) < 3e-3 * largest
        assert abs(c * y - s * x - across) < 3e-3 * largest


def test_slider_crank_against_quadratic_elements():
    """Extremes of the rod's middle within 1 % of geometrically exact beams."""
    scene = slider_crank.build(bodies=24, modes=0)
    result = simulate(scene.model, scene.h / 2, scene.t_end)
    pin, slider = result["pin.position"], result["slider.position"]
    along = (slider - pin) / np.linalg.norm(slider - pin, axis=1)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    bent = ((result["rod 12.position"] - pin) * normal).sum(axis=1) / slider_crank.LENGTH
    assert (bent.max(), bent.min()) == pytest.approx((0.015422, -0.015543), rel=0.01)


def tapered(place):
    return replace(SECTION, inertia_z=6.75 * (2 - place), inertia_y=6.75 * (1 + place))


def test_a_tapered_beam_of_two_bodies_has_the_flexibility_of_one():
    """Each body has the sections of its part: tip deflections of the clamped chain add up."""
    flexibilities = []
    for bodies in (1, 2):
        model = Model()
        model.beam("beam", (model.node("a", (0, 0, 0)), model.node("b", (30, 40, 0))), tapered, 6,
                   bodies)
        K = np.zeros((6 * (bodies + 1),) * 2)
        for k, body in enumerate(model.bodies.values()):
            # reduced order: both positions, both rotations; here node after node
            rows = 6 * k + np.array([0, 1, 2, 6, 7, 8, 3, 4, 5, 9, 10, 11])
            K[np.ix_(rows, rows)] += body.reduced.stiffness
        flexibilities.append(np.linalg.inv(K[6:, 6:])[-6:, -6:])
    # inverses at a condition of 1e6
    assert np.abs(flexibilities[1] - flexibilities[0]).max() < 1e-9 * np.abs(flexibilities[0]).max()


@pytest.mark.parametrize("elements", [0, 1.5, -2])
def test_wrong_number_of_elements(elements):
    with pytest.raises(InputError, match="beam 'beam' has .* elements: give a whole number >= 1"):
        spun(elements)


@pytest.mark.parametrize("bodies", [0, 3, 1.5])
def test_wrong_number_of_bodies(bodies):
    with pytest.raises(InputError, match="20 elements cannot be divided among .* bodies: give a "
                                         "multiple"):
        hinged_beam.build(bodies=bodies)
