"""Outputs in compiled code against the same quantities of results."""

import numpy as np
import pytest
from everyday import Place, parallelogram
from exported_models import TURN, H, arm

from sebody import InputError, Model, Simulation
from sebody.catalogue import builder
from sebody.export.outputs import Quantities
from sebody.fem import hexahedral_block, rectangle, straight_beam
from sebody.fem.loads import pressure
from sebody.quantities.reading import evaluate
from sebody.reduction import RigidFace, craig_bampton

E, NU, RHO = 2.1e9, 0.3, 1200.0


def swinging() -> Model:
    """A turned solid with a pressure and a beam welded to its end, a collar that slides on it."""
    fe = hexahedral_block((1, 2, 3), (3.0, 1.0, 0.8), (3, 2, 2), E, NU, RHO)
    ends = [np.flatnonzero(np.abs(fe.coordinates[:, 0] - x) < 1e-9) for x in (1.0, 4.0)]
    points = [fe.coordinates[nodes].mean(axis=0) for nodes in ends]
    side = np.flatnonzero(np.abs(fe.coordinates[:, 2] - 3.8) < 1e-9)
    faces = [(RigidFace(point, tuple(nodes)), "full")
             for point, nodes in zip(points, ends, strict=True)]
    body = craig_bampton(fe, faces, 2, loads={"wind": pressure(fe, side, 50.0)})
    model = Model()
    model.gravity(TURN @ (0.3, -9.0, 2.0))
    a, b = (model.node(name, TURN @ point) for name, point in zip("ab", points, strict=True))
    model.superelement("block", body, [a, b], rotation=TURN)
    model.body_load("block", "wind", [(0, 2.0), (1, 200.0)])
    model.revolute(a, axis=TURN @ (0.1, 0.2, 1.0), name="hinge")
    far = model.node("far", TURN @ (points[1] + (1.5, 0.0, 0.2)))
    model.superelement("rod", craig_bampton(
        straight_beam(b.point, far.point, rectangle(0.1, 0.2, E, NU, RHO), 6, up=TURN @ (0, 0, 1)),
        [(0, "full"), (6, "full")], 2), [b, far])
    collar = model.node("collar", TURN @ (points[1] + (0.3, 0.4, 0.1)))
    model.rigid_body("ring", collar, 2.0, 0.05 * np.eye(3))
    model.prismatic(b, TURN @ (0.3, 0.4, 0.1), collar, name="slide")
    return model


def compared(model, h, steps, names=None):
    """What compiled code makes of a state, beside 1e-9 of what results make of it.

    Relative to the largest number of a quantity; forces of joints are differences of larger ones.
    """
    run = Simulation(model, h)
    made = Quantities(run.model, run.numbering, run.system, run.state)
    names = made.names(names or [one for one in run.result().names() if one != "t"])
    outputs = made.made(names, [])
    run.run_to(steps * h)
    before, result = run.state.now.tobytes(), run.result()
    assert evaluate(run.system, run.state, outputs) == 0
    assert run.state.now.tobytes() == before
    found = dict(zip(names, outputs.values, strict=False))
    for name, value in found.items():
        own, vector = float(result[name][-1]), name.rpartition(".")[0]
        size = np.abs(result[vector][-1]).max() if vector in result else 0.0
        assert abs(value - own) <= 1e-9 * max(1.0, size, abs(own)), (name, value, own)
    return found


def test_every_named_quantity_in_a_plane():
    """Of the gripper: sliding and sticking contacts, prescribed motions, axes that turn."""
    scene = builder("gripper")()
    found = compared(scene.model, scene.h, 350)
    assert len(found) > 150 and found["left low grip.power"] != 0.0
    assert {value for one, value in found.items() if one.endswith(".sticks")} == {0.0, 1.0}


def test_powers_of_prescribed_motions():
    scene, name = builder("slider-crank")(), "motion of pin.position.power"
    assert abs(compared(scene.model, scene.h, 300, [name])[name]) > 100.0


def test_every_named_quantity_in_space():
    assert len(compared(arm(), H, 100)) > 60


OF_NODES = [f"{body}.node{node}.{quantity}" for body, node in (("block", 17), ("rod", 3))
            for quantity in ("position", "velocity", "acceleration", "stress", "von_mises")] + [
                "rod.node6.section_forces", "block.node17.stress.norm"]
LENGTHS = ["slide.displacement", "far.velocity.norm", "hinge.moment.norm", "slide.local_force.norm"]


def test_fe_nodes_and_lengths_of_vectors():
    """Of a solid with a load on it and of a beam's worst fibre, while both swing and bend."""
    found = compared(swinging(), 2e-3, 200, [*OF_NODES, *LENGTHS])
    assert found["block.node17.von_mises"] > 1.0 and found["rod.node3.von_mises"] > 1e3


def test_what_cannot_be_compiled_is_refused():
    run = Simulation(swinging(), 2e-3)
    made = Quantities(run.model, run.numbering, run.system, run.state)
    with pytest.raises(InputError, match=r"'rod.node3.displacement.x' cannot be compiled"):
        made.made(["rod.node3.displacement.x"], [])


def test_of_redundant_constraints_forces_are_refused_and_all_else_is_given():
    """Results take multipliers of least norm; the loop leaves them to drift between matrices."""
    model = parallelogram(Place.at_random(3, length=2.0))
    run = Simulation(model, 1e-3)
    assert run.system.regularized[0] == 1
    made, given, refused = Quantities(run.model, run.numbering, run.system, run.state), [], set()
    for name in run.result().names():
        try:
            made.made(made.names([name]), [])
            given.append(name)
        except InputError as error:
            assert "where constraints are redundant" in str(error)
            refused.add(name.rpartition(".")[2])
    assert {"force", "moment", "local_force"} <= refused
    assert refused <= {"force", "moment", "local_force", "local_moment", "reaction", "torque",
                       "reaction_moment", "multipliers"}
    compared(model, 1e-3, 200, [name for name in given if name != "t"])
