"""Layouts with absent blocks against the full layout, planar against spatial, finer divisions."""


import numpy as np
import pytest

from sebody import Model, generalized_alpha, simulate
from sebody.assembly import build as assembly
from sebody.fem import planar_beam, straight_beam
from sebody.kernels.loader import load, superelement_kernel_name
from sebody.model import bodies as model_bodies
from sebody.reduction import craig_bampton
from sebody.scenes import box, right_angle_frame, shaft
from sebody.scenes.hinged_beam import SECTION, TORQUE, build
from sebody.verify import references

END = np.array([100.0, 100.0, 0.0])


def displacement(result, node="tip"):
    position = result[f"{node}.position"]
    return position - position[0]


def difference(a, b):
    return np.linalg.norm(a - b) / np.linalg.norm(b)


@pytest.mark.parametrize("scene", [right_angle_frame, shaft, box])
def test_absent_triplets_cost_no_accuracy(scene):
    small, full = (simulate(s.model, s.h, s.t_end) for s in
                   (scene.build("small"), scene.build("full")))
    assert small.numbering.free < full.numbering.free
    assert difference(displacement(small), displacement(full)) <= 1e-3


def test_rotation_only_node_turns_as_the_full_one():
    small, full = (simulate(s.model, s.h, s.t_end) for s in
                   (shaft.build("small"), shaft.build("full")))
    assert difference(small["gear.angular_velocity"], full["gear.angular_velocity"]) <= 1e-3


def test_box_keeps_its_invariants():
    """After the push: energy and angular momentum about the joint stay."""
    scene = box.build()
    result = simulate(scene.model, scene.h, scene.t_end)
    free = result.t > 0.61
    energy = (result["energy.kinetic"] + result["energy.strain"])[free]
    H = result["angular_momentum"][free]
    assert np.ptp(energy) / energy.mean() < 1e-4
    assert np.abs(H - H[0]).max() / np.linalg.norm(H[0]) < 1e-5


def planar_hinged_beam(modes=4, inertia=None):
    body = craig_bampton(planar_beam((0, 0), END[:2], SECTION, 20), [(0, "full"), (20, "full")],
                         modes)
    model = Model(planar=True)
    base, tip = model.node("base", (0.0, 0.0)), model.node("tip", END[:2])
    model.superelement("beam", body, [base, tip], inertia=inertia)
    model.revolute(base)
    model.torque(base, 1.0, TORQUE)
    return model


def test_planar_beam_against_the_reference():
    reference = references.reference("hinged_beam")["tip_position"][:, :2]
    result = simulate(planar_hinged_beam(), 0.01, 30.0)
    assert result.numbering.free == 1 + 2 + 1 + 4
    assert np.linalg.norm(result["tip.position"] - reference) / np.linalg.norm(
        reference) <= 9.5e-4


def test_planar_equals_spatial_without_internal_modes():
    """Same reduced beam, same plane: the two kernels give the same motion."""
    planar = simulate(planar_hinged_beam(modes=0), 0.01, 5.0,
                      generalized_alpha(tolerance=1e-12))
    spatial = simulate(build(modes=0).model, 0.01, 5.0, generalized_alpha(tolerance=1e-12))
    assert np.abs(planar["tip.position"] - spatial["tip.position"][:, :2]).max() < 1e-8
    assert np.abs(planar["base.angular_velocity"]
                  - spatial["base.angular_velocity"][:, 2]).max() < 1e-8
    strain = spatial["energy.strain"]
    assert np.abs(planar["energy.strain"] - strain).max() < 1e-9 * strain.max()


def divided_beam(parts):
    """The hinged beam as several superelements welded by shared nodes."""
    model = Model()
    points = [END * k / parts for k in range(parts + 1)]
    names = ["base", *(f"joint{k}" for k in range(1, parts)), "tip"]
    nodes = [model.node(name, point) for name, point in zip(names, points, strict=True)]
    body = craig_bampton(straight_beam(points[0], points[1], SECTION, 20 // min(parts, 2)),
                         [(0, "full"), (20 // min(parts, 2), "full")], 4)
    for k in range(parts):
        model.superelement(f"beam{k}", body, nodes[k:k + 2])
    model.revolute("base")
    model.torque("base", (0, 0, 1), TORQUE)
    return model


@pytest.mark.parametrize("parts, h, limit", [(2, 0.01, 5e-4), (4, 0.005, 1.2e-4)])
def test_more_superelements_stiffen_centrifugally(parts, h, limit):
    reference = references.reference("hinged_beam")["tip_position"]
    result = simulate(divided_beam(parts), h, 30.0)
    tip = result["tip.position"][::round(0.01 / h)]
    assert np.linalg.norm(tip - reference) / np.linalg.norm(reference) <= limit


def test_sparse_solver_gives_the_motion_of_the_dense_one(monkeypatch):
    """Twenty superelements: above the limit the sparse factorization takes over."""
    sparse = simulate(divided_beam(20), 0.005, 0.5)
    assert sparse.numbering.free > assembly.DENSE_LIMIT
    monkeypatch.setattr(assembly, "DENSE_LIMIT", 1000)
    dense = simulate(divided_beam(20), 0.005, 0.5)
    # the same iterations, by other sums: 100 steps of EPS times 140, the length, times some tens
    assert np.abs(sparse["tip.position"] - dense["tip.position"]).max() < 1e-10


@pytest.mark.parametrize("pinned, modes, make", [
    ("f2m4", 4, lambda **given: build(**given).model),
    ("f2m8", 8, lambda **given: build(**given).model),
    ("planar_f2m2", 2, planar_hinged_beam), ("planar_f2m4", 4, planar_hinged_beam)])
def test_pinned_number_of_modes_changes_speed_alone(monkeypatch, pinned, modes, make):
    """Same text with a constant in place of a number read at run time."""
    own = make(modes=modes, inertia="material")
    body, = own.bodies.values()
    assert body.kernel == f"superelement_{pinned}_converged_mean_material"
    fast = simulate(own, 0.01, 1.0)
    monkeypatch.setattr(model_bodies, "superelement_kernel_name",
                        lambda layout, frame, inertia, *_: superelement_kernel_name(
                            layout, frame, inertia, -1))
    free = make(modes=modes, inertia="material")
    body, = free.bodies.values()
    assert load(body.kernel).N_MODES is None
    assert np.abs(fast["tip.position"] - simulate(free, 0.01, 1.0)["tip.position"]).max() < 1e-9


def test_bodies_of_one_reduction_have_frames_of_their_own():
    """Two bodies share matrices but not the node that carries the frame: as copies of them do."""
    def bent(reduce):
        model = Model(planar=True)
        names = [model.node(n, (30.0 * k, 0.0)) for k, n in enumerate(("base", "middle", "tip"))]
        for k, body in enumerate((reduce(), reduce())):
            model.superelement(f"part {k}", body, names[k:k + 2], frame="node", frame_node=k)
        model.fix("base")
        model.force("tip", (0.0, -2e3))
        return simulate(model, 1e-3, 0.05)["tip.position"]

    def reduced():
        return craig_bampton(planar_beam((0, 0), (30.0, 0), SECTION, 4),
                             [(0, "full"), (4, "full")], 0)
    one = reduced()
    assert np.array_equal(bent(lambda: one), bent(reduced))
