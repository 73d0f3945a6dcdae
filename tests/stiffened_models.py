"""Bodies and models for what one body does: with any inertia option, ``option`` as keywords.

They are those of `tests/runs/test_exact_bodies.py` and `tests/benchmarks/bench_stiffening.py`.
"""

from itertools import product

import numpy as np
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import Model, simulate, trapezoidal
from sebody.analysis import linearize
from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import assemble, to_body_axes
from sebody.fem import StiffnessSection, frame, hexahedral_block, straight_beam
from sebody.model.numbering import coordinates
from sebody.reduction import RigidFace, craig_bampton

# So stiff along its axis that the tables' beams, which do not stretch, are met to their digits.
SLENDER = StiffnessSection(axial=1e7, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=2e-7, inertia_y=1e-7, inertia_z=1e-7)


def nearest(found, value):
    """Of frequencies, the one nearest to a value."""
    return found.omega[np.argmin(np.abs(found.omega - value))]


def cantilever(option, nodes=2, internal=4, span=24, section=SLENDER, frame="converged_mean"):
    """A unit beam with so many boundary nodes in equal spans of so many elements, clamped."""
    elements = span * (nodes - 1)
    fe_model = straight_beam((0, 0, 0), (1, 0, 0), section, elements)
    boundary = [(span * k, "full") for k in range(nodes)]
    model = Model()
    ends = [model.node(f"n{k}", (k / (nodes - 1), 0, 0)) for k in range(nodes)]
    model.superelement("arm", craig_bampton(fe_model, boundary, internal), ends, frame=frame,
                       **option)
    model.fix("n0")
    return model


ARMS = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=0.8, mass=1.0,
                        inertia_x=2e-6, inertia_y=1e-6, inertia_z=1e-6)
TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
ELBOW = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0]]) @ TURN.T


def elbow(option):
    """Two arms as one body on three nodes, clamped at the long one."""
    fe_model = frame(ELBOW, [(0, 1), (1, 2)], ARMS, 8, up=TURN[:, 2])
    body = craig_bampton(fe_model, [(k, "full") for k in range(3)], 6)
    model = Model()
    nodes = [model.node(f"n{k}", x) for k, x in enumerate(ELBOW)]
    model.superelement("elbow", body, nodes, **option)
    model.fix("n0")
    return model


def divided_elbow(count):
    """The same of elements that are bodies of their own, without any option of interest here."""
    model = Model()
    a, b, c = (model.node(f"n{k}", x) for k, x in enumerate(ELBOW))
    for name, ends, part in (("long", (a, b), 2 * count), ("short", (b, c), count)):
        model.beam(name, ends, ARMS, part, part, 0, inertia="material", up=TURN[:, 2])
    model.fix("n0")
    return model


def linkage(option, bodies, internal):
    """A driven crank, a slender coupler between two ball joints, a rocker, in space."""
    soft = StiffnessSection(axial=1e5, bending_y=12.0, bending_z=12.0, torsion=10.0, mass=1.0,
                            inertia_x=2e-5, inertia_y=1e-5, inertia_z=1e-5)
    model, x = Model(), np.eye(3)
    hub, pin = model.node("hub", (0, 0, 0)), model.node("pin", (0.9, 0.3, 0))
    for name, node, axis, centre, end in (
            ("crank", hub, x[0], (0, 0.1, 0), (0, 0.2, 0)),
            ("rocker", pin, x[1], (0.9, 0.3, 0.25), (0.9, 0.3, 0.5))):
        model.rigid_body(name, node, 0.5, (0.02, 0.02, 0.02), centre)
        model.revolute(node, axis)
        model.attach(f"{name} end", end, node)
    model.drive_angle(hub, trapezoidal(24.0, 8.0, 16.0), x[0])
    ends = [model.node(name, at.point, at=at) for name, at in (
        ("first", model.nodes["crank end"]), ("second", model.nodes["rocker end"]))]
    model.beam("coupler", ends, soft, 16, bodies, internal, **option)
    return simulate(model, 1e-3, 1.0)


def idle_spin(result):
    """Largest rate of either end about the line between them."""
    line = result["second.position"] - result["first.position"]
    line = line / np.linalg.norm(line, axis=1)[:, None]
    return max(np.abs((result[f"{end}.angular_velocity"] * line).sum(axis=1)).max()
               for end in ("first", "second"))


def block(option, push=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)):
    """A solid known by the positions of its eight corners, turned, in free flight."""
    fe_model = hexahedral_block((-6, -1, -1), (12, 2, 2), (12, 2, 2), 2.1e6, 0.3, 7.8e-3)
    points = np.array(list(product((-6, 6), (-1, 1), (-1, 1))))
    corners = [int(np.argmin(np.abs(fe_model.coordinates - p).sum(axis=1))) for p in points]
    body = craig_bampton(fe_model, [(k, "translation") for k in corners], 8)
    model = Model()
    nodes = [model.node(f"n{k}", TURN @ p, "translation") for k, p in enumerate(points)]
    model.superelement("block", body, nodes, frame="positions", rotation=TURN, **option)
    model.rigid_velocity(push, spin)
    return model


def accelerations(run):
    """Of the corners, from mass and forces of the state, (8, 3)."""
    mass = linearize(run).mass
    state, n = run.state, run.numbering.free
    kept = state.a.copy()
    state.a[:] = 0.0
    assert assemble(RESIDUAL, RESIDUAL, run.system, state, state.residual) == 0
    residual = state.residual.copy()
    state.a[:] = kept
    to_body_axes(run.system, state.frames, residual, False)
    found = np.zeros(run.numbering.total)
    found[:n] = np.linalg.solve(mass, -residual[:n])
    to_body_axes(run.system, state.frames, found, True)
    return np.array([found[at] for at in places(run)])


def places(run):
    """Coordinates of the positions of all nodes."""
    return [coordinates(run.numbering, node.position) for node in run.model.nodes.values()]


def clamped_plate():
    """A plate of hexahedra and four rigid patches at its corners; the first two are held."""
    bricks = hexahedral_block((0, -0.25, -0.01), (1.0, 0.5, 0.02), (10, 5, 1), 1e6, 0.3, 1.0)
    x, y, _ = bricks.coordinates.T
    faces = []
    for place in ((0.0, -0.25), (0.0, 0.25), (1.0, -0.25), (1.0, 0.25)):
        near = (np.abs(x - place[0]) < 0.101) & (np.abs(y - place[1]) < 0.101)
        faces.append(RigidFace((*place, 0.0), tuple(np.flatnonzero(near))))
    return bricks, faces


def plate(option, internal):
    """It as one body."""
    bricks, faces = clamped_plate()
    model = Model()
    nodes = [model.node(f"n{k}", face.point) for k, face in enumerate(faces)]
    body = craig_bampton(bricks, [(face, "full") for face in faces], internal)
    model.superelement("plate", body, nodes, **option)
    for held in nodes[:2]:
        model.fix(held)
    return model


def plate_frequencies(spin, modes=60):
    """Frequencies of the plate's FE model, spinning about z, from its matrices, ascending.

    Linearised about the centrifugal displacement u: ``K + K_G(u) - W^2 M_across`` and Coriolis
    forces. The faces turn to second order under all forces on their nodes, centrifugal ones
    included. In as many vibrations of the plate at rest.
    """
    bricks, faces = clamped_plate()
    X, K, M = bricks.coordinates, bricks.stiffness, bricks.mass
    tied = [np.zeros((K.shape[0], 6)) for _ in faces]
    for motion, face in zip(tied, faces, strict=True):
        for node in face.nodes:
            arm = X[node] - face.point
            motion[3 * node:3 * node + 3] = np.hstack([np.eye(3), -np.cross(np.eye(3), arm)])
    ties = (3 * np.concatenate([face.nodes for face in faces])[:, None] + np.arange(3)).ravel()
    inner = np.setdiff1d(np.arange(len(tied[0])), ties)
    basis = np.hstack([np.eye(len(tied[0]))[:, inner], *tied[2:]])
    count = len(X)
    across = np.kron(np.eye(count), np.diag([1.0, 1.0, 0.0]))
    turn = np.kron(np.eye(count), np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))

    def reduced(A):
        return basis.T @ (A @ basis)
    stiffness, mass, centrifugal = reduced(K), reduced(M), reduced(M @ across)
    pull = spin**2 * (M @ (across @ X.ravel()))
    u = basis @ np.linalg.solve(stiffness - spin**2 * centrifugal, basis.T @ pull)
    tangent = stiffness + reduced(bricks.geometric_stiffness(u)) - spin**2 * centrifugal
    forces = (K @ u - pull - spin**2 * (M @ (across @ u))).reshape(-1, 3)
    for k, face in enumerate(faces[2:]):
        nodes, at = list(face.nodes), len(inner) + 6 * k + 3
        moments = forces[nodes].T @ (X[nodes] - face.point)
        tangent[at:at + 3, at:at + 3] += (moments + moments.T) / 2 - np.trace(moments) * np.eye(3)
    shapes = eigh(stiffness, mass, subset_by_index=(0, modes - 1))[1]
    C, K_r = (shapes.T @ A @ shapes for A in (2 * spin * reduced(M @ turn), tangent))
    none, one = np.zeros_like(C), np.eye(modes)
    values = np.linalg.eigvals(np.block([[none, one], [-K_r, -C]]))
    return np.sort(values.imag[values.imag > 0])
