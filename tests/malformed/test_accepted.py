"""What looks odd and is right: other types of numbers, lists and names are accepted."""

from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from malformed.body_cases import BEAM, SECTION, K, M
from malformed.model_cases import BODY, X, Z, planar, spatial
from malformed.run_cases import Shared, ball, pendulum
from scipy import sparse

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha, simulate
from sebody.analysis import equilibrium, resume, save_state, vibrations
from sebody.fem import FEModel, Section, frame, hexahedral_block, straight_beam
from sebody.quantities.table import OF_MODEL
from sebody.reduction import ReducedBody, craig_bampton

ACCEPTED = {
    "point of integers": lambda m: m.node("new", [1, 2, 3]),
    "point as array": lambda m: m.node("new", np.array([1, 2, 3], dtype=np.int8)),
    "point of float32": lambda m: m.node("new", np.ones(3, dtype=np.float32)),
    "point of fractions": lambda m: m.node("new", (Fraction(1, 3), 0, 0)),
    "point as a column of a table": lambda m: m.node("new", np.eye(3)[:, 0]),
    "name of numpy": lambda m: m.node(np.str_("new"), X),
    "name with a dot": lambda m: m.node("left.end", X),
    "name in Greek": lambda m: m.node("κόμβος", X),
    "name of digits": lambda m: m.node("12", X),
    "keeps of numpy": lambda m: m.node("new", X, np.str_("full")),
    "mass of integer": lambda m: m.point_mass("new", "a", 3),
    "mass of numpy": lambda m: m.point_mass("new", "a", np.float32(3)),
    "mass of an array without axes": lambda m: m.point_mass("new", "a", np.array(3.0)),
    "mass as fraction": lambda m: m.point_mass("new", "a", Fraction(1, 2)),
    "tiny mass": lambda m: m.point_mass("new", "a", 1e-300),
    "no inertia": lambda m: m.rigid_body("new", "a", 1.0, (0, 0, 0)),
    "inertia as matrix": lambda m: m.rigid_body("new", "a", 1.0, np.eye(3).tolist()),
    "centre at the node": lambda m: m.rigid_body("new", "a", 1.0, (1, 1, 1), centre=[0, 0, 0]),
    "long axis": lambda m: m.revolute("a", (1e300, 1e300, 0.0)),
    "short axis": lambda m: m.revolute("a", (1e-300, 0.0, 0.0)),
    "flag of numpy": lambda m: m.revolute("a", Z, explicit=np.bool_(True)),
    "nodes by a generator": lambda m: m.superelement("new", BODY, (n for n in "ab")),
    "nodes as an array of names": lambda m: m.superelement("new", BODY, np.array(["a", "b"])),
    "whole float": lambda m: m.beam("new", ("a", "d"), SECTION, 4.0, 2.0, 1.0),
    "counts of numpy": lambda m: m.beam("new", ["a", "d"], SECTION, np.int64(4), np.int8(2)),
    "ends by name and node": lambda m: m.beam("new", ("a", m.nodes["d"]), SECTION, 2),
    "no stiffness": lambda m: m.spring("a", "b"),
    "no length": lambda m: m.spring("a", "b", length=0),
    "a coefficient an axis": lambda m: m.bushing("a", "c", [1, 2, 3], np.ones(3), 1, (1,)),
    "table of integers": lambda m: m.force("a", X, [(0, 0), (1, 2)]),
    "table as array": lambda m: m.force("a", X, np.array([[0.0, 0.0], [1.0, 2.0]])),
    "one row": lambda m: m.force("a", X, [(0.0, 3.0)]),
    "no direction": lambda m: m.force("a", (0, 0, 0)),
    "large gravity": lambda m: m.gravity([0, 0, -1e6]),
    "rate of zero of a fixed node": lambda m: (m.fix("a"), m.initial_velocity("a", (0, 0, 0))),
    "default names twice": lambda m: (m.force("a", X), m.force("a", X)),
    "rotation with rounding": lambda m: m.superelement(
        "new", BODY.rotated(np.eye(3) + 1e-14), ["a", "b"]),
}
ELSEWHERE = {
    "planar torque as a list": lambda: planar().torque("a", [2.0]),
    "planar of numpy": lambda: Model(planar=np.bool_(True)),
    "section of integers": lambda: Section(1, 1, 1, 1, 1, 0, 1),
    "points as a list": lambda: straight_beam([0, 0, 0], [1, 0, 0], SECTION, np.int64(2)),
    "members as an array": lambda: frame(np.eye(3), np.array([[0, 1], [1, 2]]), SECTION, 1),
    "divisions of floats": lambda: hexahedral_block([0] * 3, [1] * 3, [1.0, 2.0, 1.0], 1, 0, 1),
    "matrices as lists": lambda: FEModel(K.tolist(), M.tolist(), BEAM.coordinates.tolist()),
    "matrices of COO": lambda: FEModel(sparse.coo_array(K), sparse.coo_matrix(M), BEAM.coordinates),
    "integers": lambda: FEModel(np.eye(6, dtype=int), np.eye(6, dtype=int), [[0, 0, 0]],
                                ["x", "y", "z", "rx", "ry", "rz"]),
    "boundary of numpy": lambda: craig_bampton(BEAM, [(np.int64(0), "full"), (4.0, "full")], 1),
    "modes picked by an array": lambda: craig_bampton(BEAM, {0: "full"}, 4, np.array([3, 1])),
    "keeps as a list": lambda: ReducedBody(BODY.stiffness, BODY.mass, BODY.coordinates,
                                           ["full", "full"], 1.0),
    "step of integer": lambda: simulate(ball(), 1, 3),
    "no time": lambda: simulate(ball(), 0.1, 0.0),
    "every of a float": lambda: simulate(ball(), 0.1, 1.0, output_every=2.0),
    "rho of integer": lambda: simulate(ball(), 0.1, 1.0, generalized_alpha(1)),
    "same time again": lambda: Simulation(ball(), 0.1).run_to(0.3).run_to(0.3),
    "tolerance of numpy": lambda: simulate(ball(), 0.1, 1.0, tolerance=Tolerance(np.float32(1e-3))),
    "steps of a float": lambda: equilibrium(pendulum(), 2.0),
    "all vibrations": lambda: vibrations(Shared.hanging(), 99),
    "quantity of numpy": lambda: Shared.run().result()[np.str_("ball.position")],
}


@pytest.mark.parametrize("build", ACCEPTED)
def test_builders(build):
    ACCEPTED[build](spatial())


@pytest.mark.parametrize("call", ELSEWHERE)
def test_elsewhere(call):
    ELSEWHERE[call]()


def test_files(tmp_path):
    """A text and a path are the same; the name may be of the file system's own letters."""
    for path in (str(tmp_path / "a.npz"), tmp_path / "κατάσταση.npz", Path(tmp_path) / "b c.npz"):
        assert resume(ball(), save_state(Shared.run(), path)).time == pytest.approx(1.0)
        assert resume(ball(), str(path)).time == pytest.approx(1.0)


def test_odd_numbers_are_those_they_look_like():
    model = spatial()
    assert model.point_mass("new", "a", Fraction(1, 4)).constants["mass"] == 0.25
    point = np.array([1.0, 2.0, 3.0])
    node = model.node("new", point)
    point[:] = 0.0
    assert node.point.tolist() == [1.0, 2.0, 3.0]       # a copy
    with pytest.raises(InputError, match="mass of 'other' is Decimal"):
        model.point_mass("other", "a", Decimal(1))      # no number of Python's numeric tower


def test_no_node_can_be_mistaken_for_the_model():
    """Names of quantities of the whole model begin with what no node is called."""
    for name in OF_MODEL:
        owner, dot, _ = name.rpartition(".")
        if dot:
            with pytest.raises(InputError, match=f"a node cannot be called '{owner}'"):
                Model().node(owner, X)
