"""Option C: its kernels against an independent code, its coordinates against their frames."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation
from sebody.assembly import contracts
from sebody.assembly.body_constants import superelement_constants
from sebody.assembly.floating import determining, floating_constants, frame_conditions
from sebody.contract.counts import floating_counts, superelement_counts
from sebody.contract.layout import ENERGY, KINETIC, RESIDUAL, STRAIN
from sebody.fem import Section, straight_beam
from sebody.kernels.loader import load
from sebody.kernels.packed import unpack
from sebody.reduction import reduce
from sebody.reduction.invariants import InertiaInvariants
from sebody.verify.check import states
from sebody.verify.check.definitions import local_coordinates
from sebody.verify.check.superelement_cases import superelement_case

DATA = dict(np.load(Path(__file__).parents[1] / "data" / "stiffened_states.npz"))
ORDER = np.r_[0:3, 6:9, 3:6, 9:12, 12:20]      # positions, rotations, modes, slaved coordinates
OURS = ORDER[:18]


def reference_body(frame):
    """Constants of the reference's beam in our order, about the origin of the frame."""
    b = {name[5:]: value for name, value in DATA.items() if name.startswith("body.")}
    J2 = (b["J2"] + b["J2"].swapaxes(0, 1)) / 2
    body = InertiaInvariants(
        float(b["m"]), b["c0"], b["S1"][:, ORDER], b["J0"], b["g"][:, ORDER], b["h"][..., ORDER],
        b["K"][:, ORDER][..., ORDER], J2[:, :, ORDER][..., ORDER], b["Mbar"][ORDER][:, ORDER],
        b["Q"][:, OURS][..., OURS], b["lam"], b["E"][OURS], b["Ghat"][:, OURS][..., OURS])
    stiffness = b["Sbar"][OURS][:, OURS]
    return (body if frame == "mean" else body.about(b["X"][0])), stiffness, b["X"]


def reference_case(frame, state):
    """The kernel in a state of the reference."""
    kernel = load("superelement_f2_converged_mean_floating_field")
    body, stiffness, X = reference_body(frame)
    weights = np.array([0.5, 0.5] if frame == "mean" else [1.0, 0.0])
    s = {name[5:]: value[state] for name, value in DATA.items() if name.startswith(f"{frame}.")}
    q, v, a = (np.concatenate([s[x].ravel(), s[turn].ravel()[:6], s[y]]) for x, turn, y in (
        ("x", "R", "y_I"), ("v", "Omega", "ydot_I"), ("xddot", "A", "yddot_I")))
    counts = superelement_counts(2, 2, False, 18) | floating_counts(False, 18, 2, 6)
    values = {"alphas": weights, "fits": weights, "alpha_rs": weights, "X": X - weights @ X,
              "S": stiffness, "M": body.Mbar[:18, :18], "mass_columns": np.zeros((18, 3)),
              "mass_rows": np.zeros((3, 18)), "mc": np.zeros(3), "full": [18],
              "masses": [body.mass]}
    conditions = frame_conditions("converged_mean", counts, values)
    first = s["R"][0].ravel()
    case = states.Case(kernel, 18, states.index_row(18, 2, 2), np.zeros(0), q, s["R"].ravel(), v, a,
                       first, first, slaved=2, resultants=6)
    return states.with_constants(case, values | floating_constants(
        body, stiffness, conditions, case.counts)), s


@pytest.mark.parametrize("frame", ["mean", "node"])
def test_forces_and_energies_of_an_independent_code(frame):
    for state in range(8):
        case, expected = reference_case(frame, state)
        forces, energy = (states.evaluate(case, task)[k] for task, k in ((RESIDUAL, 0),
                                                                         (ENERGY, 2)))
        # the reference differentiates its rates numerically, to 1e-9
        assert states.difference(forces, expected["G"][OURS]) < 2e-9
        assert energy[[KINETIC, STRAIN]] == pytest.approx([expected["T"], expected["V"]], rel=1e-12)


@pytest.mark.parametrize("name", ["f2_converged_mean_material", "f2t1_positions_material",
                                  "planar_f2_converged_mean_material",
                                  "planar_f2_positions_material"])
def test_local_coordinates_follow_from_those_that_are_kept(name):
    """Coordinates found by SciPy obey the conditions, with unequal weights and nodes."""
    case = superelement_case(load(f"superelement_{name}"), 3)
    counts = case.counts | floating_counts(case.planar, case.n, 0, 0)
    conditions = frame_conditions(case.module.FRAME, counts, states.constants_of(case))
    kept, basis = determining(conditions, case.first_mode)
    y = local_coordinates(case)
    assert len(kept) == counts["free"] == case.n - len(conditions)
    assert np.abs(basis @ y[kept] - y).max() < 1e-13 * np.abs(y).max()  # sums of a few products
    assert np.abs(np.delete(y, kept)).max() > 0.01


SECTION = Section(area=0.01, inertia_y=3e-6, inertia_z=5e-6, torsion=4e-6, youngs_modulus=2e11,
                  poisson_ratio=0.3, density=7800.0)


def beam(frame="converged_mean", inertia="floating_field"):
    """An oblique beam away from the origin."""
    model = Model()
    ends = model.node("a", (3.0, -1.0, 2.0)), model.node("b", (4.0, 0.5, 2.5))
    model.beam("beam", ends, SECTION, 4, 1, 2, frame=frame, inertia=inertia)
    return model.element("beam")


@pytest.mark.parametrize("frame", ["converged_mean", "node"])
def test_a_rigidly_moving_body_is_a_rigid_body(frame):
    """T, momentum and its moment of a body of FE constants that turns and moves."""
    body = beam(frame)
    kernel, counts, reduced = load(body.kernel), contracts.counts_of(body), body.reduced
    row = contracts.constants_row("beam", kernel, counts, superelement_constants(body))
    turn = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
    spin, push = np.array([0.7, -0.2, 0.5]), np.array([3.0, 1.0, -2.0])     # global
    x = reduced.coordinates @ turn.T
    n, i = len(reduced.mass), reduced.invariants
    q, v = np.zeros((2, n))
    q[:6], v[:6] = x.ravel(), (push + np.cross(spin, x)).ravel()
    v[6:12] = np.tile(turn.T @ spin, 2)
    case = states.Case(kernel, n, states.index_row(n, 2, 2), row, q, np.tile(turn.ravel(), 2), v,
                       np.zeros(n), turn.ravel(), turn.ravel(), slaved=i.slaved,
                       resultants=i.resultants)
    energy = states.evaluate(case, ENERGY)[2]
    about = i.about(np.zeros(3))
    c, J = turn @ about.c0, turn @ about.J0 @ turn.T
    p, H = i.mass * push + np.cross(spin, c), np.cross(c, push) + J @ spin
    # the body is two thousand times as heavy and stiff as its parts: rounding of the constants
    assert energy[KINETIC] == pytest.approx((push @ p + spin @ H) / 2, rel=1e-9)
    assert np.abs(energy[2:8] - np.r_[p, H]).max() < 1e-9 * np.abs(H).max()
    assert abs(energy[STRAIN]) < 1e-9 * energy[KINETIC]


@pytest.mark.parametrize("modes", [4, 52])
def test_constants_of_a_beam_have_the_same_zeros_in_any_place_and_unit(modes):
    """High modes are less exact: what they leave of zeros is no entry."""
    found, turned = [], Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
    for unit, turn in ((1.0, np.eye(3)), (1.0, turned), (25.4, turned.T)):
        section = Section(9.0 * unit**2, 6.75 * unit**4, 6.75 * unit**4, 11.387 * unit**4,
                          2.1e6 / unit**2, 0.3, 7.8e-3 / unit**3)
        model, ends = Model(), unit * np.array([[1.0, 2.0, 3.0], [146.0, 2.0, 3.0]]) @ turn.T
        nodes = [model.node(f"n{k}", x) for k, x in enumerate(ends)]
        model.beam("beam", nodes, section, 20, 1, modes)
        body = model.bodies["beam"]
        values, i, free = superelement_constants(body), body.invariants, 6 + modes
        N = free + i.slaved
        shapes = {"couplings": (15, N, N), "Mz": (1, N, N),
                  "followers": (2, free, free), "stretched": (2, free, free)}
        matrices = [unpack(values[name], shape) for name, shape in shapes.items()]
        matrices[-1] = matrices[-1][:1]      # that of the tension, not the elastic one
        found.append([np.count_nonzero(one) for one in matrices])
    assert found[1] == found[0] and found[2] == found[0]
    assert sum(found[0]) < 0.12 * sum(np.prod(shape) for shape in shapes.values())


@pytest.mark.parametrize("frame", ["mean", "mean_small"])
def test_frames_that_depend_on_the_last_step_are_refused(frame):
    with pytest.raises(InputError, match="inertia 'floating_field' needs the exact rates of a "
                                         "frame "
                                         f".* which '{frame}' does not: use one of "
                                         f"converged_mean, mean"):
        beam(frame)


def test_a_body_of_reduced_matrices_alone_is_refused():
    one = replace(beam(inertia="material").reduced, invariants=None)
    model = Model()
    ends = [model.node(f"n{k}", x) for k, x in enumerate(one.coordinates)]
    with pytest.raises(InputError, match="'one': inertia 'floating_field' needs the mass and modes "
                                         "of "
                                         "the FE model, .*reduced matrices alone: reduce it .*or "
                                         "use "
                                         "inertia='material'"):
        model.superelement("one", one, ends, inertia="floating_field")


def test_more_slaved_coordinates_than_a_kernel_has_memory_for():
    body = beam()
    i = body.reduced.invariants
    many = 13
    n, N = len(body.reduced.mass), len(body.reduced.mass) + many
    grown = InertiaInvariants(
        i.mass, i.c0, np.zeros((3, N)), i.J0, np.zeros((3, N)), np.zeros((3, 3, N)),
        np.zeros((3, N, N)), np.zeros((3, 3, N, N)), np.eye(N), np.zeros((many, n, n)), i.lam, i.E,
        i.Ghat, i.origin)
    object.__setattr__(body.reduced, "invariants", grown)
    with pytest.raises(InputError, match="'beam' .*it has 13 slaved coordinates and the kernel "
                                         "memory for 12"):
        contracts.check_superelement(body, load(body.kernel))


def test_mean_axes_of_bodies_of_a_micrometre():
    """In metres; modal masses are one in all units. A raw LinAlgError before."""
    def accelerations(length):
        section = Section(4e-4 * length**2, 1.4e-8 * length**4, 3e-8 * length**4,
                          2.2e-8 * length**4, 7e10, 0.3, 2700.0)
        places = length * np.array([[0.2, -0.3, 0.5], [0.7, 0.1, 0.8]])
        body = reduce(straight_beam(*places, section, 4), [(0, "full"), (4, "full")], 3, "rubin")
        model = Model()
        ends = [model.node(*given) for given in zip("ab", places, strict=True)]
        model.superelement("beam", body, ends, frame="mean_axes", inertia="c")
        model.spherical("a")
        model.gravity(length * np.array([1.0, -9.0, 3.0]))
        return Simulation(model, 1e-3).result()["b.acceleration"][0] / length
    assert_allclose(accelerations(1e-6), accelerations(1.0), rtol=1e-8)
