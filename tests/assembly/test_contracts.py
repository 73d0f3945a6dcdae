"""Kernels write through pointers: what does not fit them is refused before anything runs."""

from types import SimpleNamespace

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, simulate
from sebody.assembly import contracts
from sebody.assembly.body_constants import superelement_constants
from sebody.assembly.build import build
from sebody.contract.layout import INDEX, Row
from sebody.fem import Section, straight_beam
from sebody.kernels.loader import element_kernel, load
from sebody.model.histories import time_function
from sebody.model.parts import Attachment, Element, Joint
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes import hinged_beam

Z = (0.0, 0.0, 1.0)
SECTION = Section(area=4e-4, inertia_y=1.33e-8, inertia_z=1.33e-8, torsion=2.25e-8,
                  youngs_modulus=2.1e11, poisson_ratio=0.3, density=7800.0)


def driven():
    """Two bodies on a hinge that a drive turns, with a spring."""
    model = Model()
    for name, x in (("a", 0.0), ("b", 0.0)):
        model.rigid_body(name, model.node(name, (x, 0, 0)), 1.0, (0.1, 0.2, 0.2))
    model.fix("b")
    model.revolute("a", Z, to="b", explicit=True, name="hinge")
    model.drive_angle("a", [(0.0, 0.0), (1.0, 0.5)], Z, to="b", name="drive")
    model.torsion_spring("a", 3.0, name="spring")
    return model


def beam():
    model = Model()
    ends = model.node("base", (0, 0, 0)), model.node("tip", (1.0, 0, 0))
    model.beam("beam", ends, SECTION, 1, inertia="material")
    return model


def constraint(model, name, k=0):
    return model.element(name).constraints[k]


def fewer_multipliers(m):
    constraint(m, "hinge", 1).multipliers = 1


def more_multipliers(m):
    constraint(m, "hinge", 1).multipliers = 3


def fewer_dof_blocks(m):
    one = constraint(m, "hinge", 1)
    one.dof_blocks = one.dof_blocks[:1]


def no_history(m):
    constraint(m, "drive").time_function = None


def a_history(m):
    constraint(m, "hinge").time_function = time_function(None)


def short_row(m):
    del m.element("spring").constants["m"]


def misspelt(m):
    constants = m.element("spring").constants
    constants["axis"] = constants.pop("m")


def wrong_shape(m):
    m.element("spring").constants["m"] = np.zeros(2)


def another_kernel(m):
    constraint(m, "hinge").kind = "on_plane"


def a_body_that_works(m):
    m.element("a").kind = "torque"


@pytest.mark.parametrize("damage, message", [
    (fewer_multipliers, "'hinge' does not fit its kernel .*element_parallel: it has 7 unknowns and "
                        "the kernel 8; it has 1 multipliers and the kernel 2: regenerate the "
                        "kernels with python -m sebody.derive, or reinstall sebody"),
    (more_multipliers, "it has 9 unknowns and the kernel 8; it has 3 multipliers and the kernel 2"),
    (fewer_dof_blocks, "'hinge' .*element_parallel: .*it has 1 rotation matrices and the kernel 2"),
    (no_history, "'drive' .*element_turn_drive: it has no time function, but the kernel reads one"),
    (a_history, "'hinge' .*element_coincident: it has a time function, but the kernel reads none"),
    (short_row, "'spring' .*element_torsion_spring: constants: the kernel reads k, k3, c, rest, n, "
                "m; given are k, k3, c, rest, n:"),
    (misspelt, "the kernel reads k, k3, c, rest, n, m; given are k, k3, c, rest, n, axis"),
    (wrong_shape, r"constants: m has shape \(2,\), the kernel reads \(3,\)"),
    (another_kernel, "'hinge' .*element_on_plane: it has 9 unknowns and the kernel 10; .*it has 0 "
                     "rotation matrices and the kernel 1"),
    (a_body_that_works, "'a' .*element_torque: .*it has no power port and the kernel writes")])
def test_elements_that_do_not_fit_their_kernel(damage, message):
    model = driven()
    build(model)
    damage(model)
    with pytest.raises(InputError, match=message):
        build(model)


@pytest.mark.parametrize("planar, kind, given, message", [
    (False, "planar_aligned", "rotation", "joint 'gear' has an equation of kind 'planar_aligned': "
     "this joint exists only in planar models, and this model is spatial: build it with "
     "Model(planar=True), or use another joint"),
    (False, "aligned", "rotation", "of kind 'aligned': this joint exists only in planar models"),
    (True, "perpendicular", "rotation", "joint 'gear' has an equation of kind 'perpendicular': "
     "this joint exists only in spatial models, and this model is planar: build it with Model(), "
     "or use another joint"),
    (True, "planar_perpendicular", "rotation", "this joint exists only in spatial models"),
    (True, "distance", "position", "of kind 'distance', which is for spatial models, and this "
     "model is planar: use 'planar_distance', the kind that model.kind_of('distance') gives"),
    (False, "planar_distance", "position", "use 'distance', the kind that model.kind_of('distance")
])
def test_joints_of_the_other_dimension(planar, kind, given, message):
    """Before anything is compiled: a run says so, too, and not that kernels are to be made."""
    model = Model(planar=planar)
    ends = [model.node(name, (float(k), 0.0, 0.0)[:model.dimension])
            for k, name in enumerate("ab")]
    for node in ends:
        model.rigid_body(f"body {node.name}", node, 1.0, 1.0 if planar else (1.0, 1.0, 1.0))
    equation = Element("gear", kind, tuple(Attachment(node, given) for node in ends), {}, 1)
    model.joints.append(Joint("gear", (equation,), *ends, None, "gear"))
    for act in (build, lambda model: Simulation(model, 0.01)):
        with pytest.raises(InputError) as caught:
            act(model)
        assert message in str(caught.value) and "reinstall" not in str(caught.value)


def test_a_joint_built_with_a_multiplier_too_few(monkeypatch):
    """As if the formula of a joint had changed and the model had not followed."""
    from sebody.model import joints

    right = joints.parallel
    monkeypatch.setattr(joints, "parallel",
                        lambda *given: right(*given)._replace(multipliers=1))
    with pytest.raises(InputError, match="'hinge' does not fit its kernel .*element_parallel: it "
                                         "has 7 unknowns and the kernel 8"):
        build(driven())


@pytest.mark.parametrize("kernel, message", [
    ("superelement_f2t1_converged_mean_material",
     "'beam' does not fit its kernel .*: it has 2 positions and the kernel 3"),
    ("superelement_f2m4_converged_mean_material", "it has 0 modes and the kernel 4"),
    ("superelement_f2d_converged_mean_material",
     "it has no damping matrix and the kernel reads one"),
    ("superelement_planar_f2_converged_mean_material", "it is spatial and the kernel is not")])
def test_superelements_that_do_not_fit_their_kernel(kernel, message):
    model = beam()
    model.element("beam").kernel = kernel
    with pytest.raises(InputError, match=message):
        build(model)


def test_a_superelement_with_less_of_second_order_than_its_kernel():
    """Without stiffening a beam has nothing of second order, and a kernel for any number."""
    model = Model()
    ends = model.node("base", (0, 0, 0)), model.node("tip", (1.0, 0, 0))
    model.beam("beam", ends, SECTION, 4, bodies=1, modes=4, stiffening=False)
    body = model.element("beam")
    assert body.kernel == "superelement_f2_converged_mean_floating_field"
    body.kernel = "superelement_f2m4s2e1_converged_mean_floating_field"
    with pytest.raises(InputError, match="it has 0 slaved coordinates and the kernel 2; it has 0 "
                                         "stress resultants and the kernel 1"):
        build(model)


def test_a_superelement_of_more_nodes_than_its_kernel():
    body = craig_bampton(straight_beam((0, 0, 0), (1, 0, 0), SECTION, 2),
                         [(0, "full"), (1, "full"), (2, "full")], modes=0)
    model = Model()
    nodes = [model.node(f"node {k}", (x, 0, 0)) for k, x in enumerate((0.0, 0.5, 1.0))]
    model.superelement("beam", body, nodes, inertia="material")
    model.element("beam").kernel = "superelement_f2_converged_mean_material"
    with pytest.raises(InputError, match="it has 3 positions and the kernel 2; it has 3 rotations "
                                         "and the kernel 2"):
        build(model)


def test_a_superelement_without_a_constant(monkeypatch):
    """As if an inertia option needed one more and assembly had not followed."""
    from sebody.assembly import batches

    def fewer(body):
        return {k: v for k, v in superelement_constants(body).items() if k != "mc"}
    monkeypatch.setattr(batches, "superelement_constants", fewer)
    with pytest.raises(InputError, match="'beam' does not fit its kernel .*: constants: the kernel "
                                         "reads alphas, .*, mc, full, masses; given are .*, "
                                         "mass_rows, full, masses"):
        build(beam())


def test_rows_are_those_of_the_table():
    """Index and constants of a model, taken apart by the tables, are what the model says."""
    model = driven()
    model.point_mass("c", model.node("c", (2.0, 0, 0), keeps="translation"), 7.0)
    system, numbering = build(model)
    spring, kernel = model.element("spring"), element_kernel("torsion_spring")
    k = system.address.tolist().index(kernel.kernel.address)
    counts = {"N_ROTATIONS": 2, "n": 6}
    index = INDEX.unpack(counts, system.index[system.at_index[k]:][:INDEX.size(counts)])
    assert index["port"] == numbering.port_names.index("spring")
    assert index["nodes"].tolist() == [numbering.rotations[t] for t in spring.dof_blocks]
    row = Row("constants", kernel.CONSTANTS)
    constants = row.unpack({}, system.constants[int(index["constants"]):][:row.size({})])
    assert constants["k"] == 3.0 and constants["m"].tolist() == spring.constants["m"].tolist()


def test_a_superelements_constants_come_back_from_its_row():
    body = beam().element("beam")
    kernel, counts = load(body.kernel), contracts.counts_of(body)
    values = superelement_constants(body)
    row = contracts.constants_row("beam", kernel, counts, values)
    back = Row("constants", kernel.CONSTANTS).unpack(counts, row)
    assert back.keys() == values.keys()
    assert all(np.array_equal(back[name], values[name]) for name in values)


def test_index_rows_with_too_few_rotations():
    kernel = SimpleNamespace(__name__="kernel", N_ROTATIONS=2)
    with pytest.raises(InputError, match=r"'x' does not fit its kernel kernel: .*nodes has shape "
                                         r"\(1,\), the kernel reads \(2,\)"):
        contracts.index_row("x", kernel, [0, 1, 2], [4], constants=0, frame=0, port=0,
                            positions=1)


@pytest.mark.parametrize("modes, filled", [(0, 12), (4, 12), (9, 12)])
def test_bodies_tell_how_much_of_their_matrices_is_filled(modes, filled):
    """Normal modes are uncoupled from each other; boundary coordinates come in whole vectors."""
    body = hinged_beam.build(modes=modes).model.bodies["beam"]
    assert superelement_constants(body)["full"] == [filled]


def test_coupled_modes_are_not_taken_for_uncoupled_ones():
    """A body whose modes are mixed with each other moves as before, with option B."""
    scene = hinged_beam.build(modes=10, inertia="material")
    body = scene.model.bodies["beam"]
    plain, reduced = body.reduced, body.reduced
    n = len(reduced.mass)
    mix = np.eye(n)
    mix[12:, 12:] = np.linalg.qr(np.random.default_rng(0).normal(size=(n - 12, n - 12)))[0]
    body.reduced = ReducedBody(mix.T @ plain.stiffness @ mix, mix.T @ plain.mass @ mix,
                            plain.coordinates, plain.keeps, plain.modes)
    assert superelement_constants(body)["full"] == [n]
    mixed = simulate(scene.model, 0.01, 1.0)["tip.position"]
    exact = simulate(hinged_beam.build(modes=10, inertia="material").model, 0.01,
                     1.0)["tip.position"]
    # Newton's tolerance, 1e-8 of the increment of a step, in a hundred steps
    assert np.abs(mixed - exact).max() < 1e-6 * np.abs(exact - exact[0]).max()
