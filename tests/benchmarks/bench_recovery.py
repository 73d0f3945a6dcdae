"""Recovered stresses against full FE solutions, and what recovery costs of a large body.

    python tests/benchmarks/bench_recovery.py [--json]

Three cantilevers, of beam elements, of hexahedra with incompatible modes and of quadratic
tetrahedra (scikit-fem), hold a load at their end, and are shaken at their root: by a smooth pulse
with the period of their second bending frequency. The full linear solution, its root shaken
likewise, is integrated by the trapezoidal rule with the same step. Errors are the largest
difference of any stress component at any instant, of the largest stress of all, at the nodes next
to the root and at those half way to the end.
"""

import argparse
import json
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from sebody import Model, simulate
from sebody.analysis import equilibrium
from sebody.fem import FEModel, hexahedral_block, rectangle, straight_beam
from sebody.fem.stress import SolidStress, elasticity
from sebody.reduction import RigidFace, craig_bampton
from sebody.reduction.recovery import Recovery
from sebody.results.field import Field
from sebody.results.recording import Recording

E, NU, RHO, LENGTH, SIDE = 7e10, 0.3, 2700.0, 1.0, 0.1
MODES = (0, 2, 6, 12)
STEPS = 200         # of the pulse, and as many after it
AMPLITUDE = 1e-7    # of the shaking, of the length: everything stays linear
FORCE = 10.0
LARGE = (40, 28, 27)        # elements of the large body: 100 000 DOFs


class Cantilever(NamedTuple):
    """An FE model along x, its boundary, and DOFs of the full solution that root and end move."""

    model: FEModel
    boundary: list
    tied: NDArray       # (n_dofs, independent DOFs): root (6), end (6), then all others
    near: NDArray       # nodes next to the root, and half way to the end
    middle: NDArray


def beam() -> Cantilever:
    """20 beam elements."""
    count = 20
    model = straight_beam((0, 0, 0), (LENGTH, 0, 0), rectangle(SIDE, SIDE, E, NU, RHO), count)
    order = np.r_[0:6, 6 * count:6 * count + 6, 6:6 * count]
    return Cantilever(model, [(0, "full"), (count, "full")], np.eye(6 * count + 6)[:, order],
                      np.array([0]), np.array([count // 2]))


def hexahedra() -> Cantilever:
    """16 x 3 x 3 hexahedra."""
    return solid(hexahedral_block((0, -SIDE / 2, -SIDE / 2), (LENGTH, SIDE, SIDE), (16, 3, 3), E,
                                  NU, RHO))


def tetrahedra() -> Cantilever:
    """Quadratic tetrahedra of scikit-fem."""
    from skfem import Basis, ElementTetP2, ElementVector, MeshTet, asm
    from skfem.assembly import BilinearForm
    from skfem.helpers import dot
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    from sebody.io import from_skfem

    mesh = MeshTet.init_tensor(np.linspace(0, LENGTH, 9), np.linspace(-SIDE / 2, SIDE / 2, 2),
                               np.linspace(-SIDE / 2, SIDE / 2, 2))
    basis = Basis(mesh, ElementVector(ElementTetP2()), intorder=4)

    @BilinearForm
    def inertia(u, v, w):
        return RHO * dot(u, v)
    stiffness = asm(linear_elasticity(*lame_parameters(E, NU)), basis)
    return solid(from_skfem(basis, stiffness, asm(inertia, basis), E, NU))


def solid(model: FEModel) -> Cantilever:
    """A solid whose end faces are rigid."""
    points, x = model.coordinates, model.coordinates[:, 0]
    ends = [np.flatnonzero(np.abs(x - place) < 1e-9) for place in (0.0, LENGTH)]
    centres = [(place, 0.0, 0.0) for place in (0.0, LENGTH)]
    tied = np.zeros((model.stiffness.shape[0], 12))
    for k, (nodes, centre) in enumerate(zip(ends, centres, strict=True)):
        for node in nodes:
            arm = points[node] - centre
            tied[model.rows[node], 6 * k:6 * k + 6] = np.hstack(
                [np.eye(3), -np.cross(np.eye(3), arm)])
    inner = model.rows[np.setdiff1d(np.arange(len(points)), np.concatenate(ends))].ravel()
    whole = np.hstack([tied, np.eye(len(tied))[:, inner]])
    faces = [(RigidFace(centre, tuple(nodes)), "full")
             for centre, nodes in zip(centres, ends, strict=True)]
    return Cantilever(model, faces, whole, ends[0], np.flatnonzero(np.abs(x - LENGTH / 2) < 1e-9))


BODIES = {"beam": beam, "hexahedra": hexahedra, "tetrahedra": tetrahedra}


def stresses_at(case: Cantilever, u: NDArray, nodes: NDArray) -> NDArray:
    """Stresses of displacements (n_dofs, s) at nodes, or section forces over their scale."""
    one = case.model.stress[0]
    moved = np.zeros((len(case.model.coordinates), case.model.rows.shape[1], u.shape[1]))
    moved[:] = u[case.model.rows]
    if isinstance(one, SolidStress):
        values = one.at_nodes(one.stress(moved))
        return np.array([values[one.nodes == node].mean(axis=0) for node in nodes])
    values = one.section_forces(moved)[:, :, 4:]        # bending moments
    return np.array([values[one.nodes == node].mean(axis=0) for node in nodes])


def recovered_at(field: Field, case: Cantilever, nodes: NDArray, static: bool) -> NDArray:
    """The same of a recovered field."""
    points = [field.at(int(node), static=static) for node in nodes]
    if isinstance(case.model.stress[0], SolidStress):
        return np.array([point.stress.T for point in points])
    return np.array([point.section_forces.mean(axis=1)[:, 4:].T for point in points])


def placed(case: Cantilever, modes: int) -> Model:
    """The reduced cantilever on two nodes."""
    model = Model()
    nodes = [model.node("root", (0, 0, 0)), model.node("end", (LENGTH, 0, 0))]
    model.superelement("body", craig_bampton(case.model, case.boundary, modes), nodes)
    model.fix("root", "rotation")
    return model


def static_errors(case: Cantilever, modes: int, static: bool) -> tuple[float, float]:
    """At the root and half way, under a force at the end."""
    direction = np.array([0.0, 0.6, 0.8])
    K = case.tied.T @ (case.model.stiffness @ case.tied)
    load = np.zeros(len(K) - 6)
    load[:3] = FORCE * direction
    u = case.tied[:, 6:] @ np.linalg.solve(K[6:, 6:], load)
    model = placed(case, modes)
    model.fix("root")
    model.force("end", direction, [(0.0, FORCE), (1.0, FORCE)])
    field = equilibrium(model, 1).field("body")
    return _errors(case, u[:, None],
                   lambda nodes: recovered_at(field, case, nodes, static)[..., -1:])


def moving_errors(case: Cantilever, found: tuple[NDArray, Field], static: bool
                  ) -> tuple[float, float]:
    """At the root and half way, of the root shaken."""
    u, field = found
    return _errors(case, u, lambda nodes: recovered_at(field, case, nodes, static))


def _errors(case: Cantilever, u: NDArray, recovered) -> tuple[float, float]:
    own = {name: stresses_at(case, u, nodes)
           for name, nodes in (("near", case.near), ("middle", case.middle))}
    size = max(np.abs(values).max() for values in own.values())
    return tuple(float(np.abs(recovered(nodes) - own[name]).max() / size)
                 for name, nodes in (("near", case.near), ("middle", case.middle)))


def shaken(case: Cantilever, modes: int) -> tuple[NDArray, Field]:
    """Full and reduced motion, the root shaken along (0, 0.6, 0.8) by ``sin^4`` of a pulse."""
    direction = np.array([0.0, 0.6, 0.8])
    K, M = (case.tied.T @ (A @ case.tied) for A in (case.model.stiffness, case.model.mass))
    omega = np.sqrt(linalg.eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True, subset_by_index=[0, 3]))
    period = 2 * np.pi / omega[2]       # bending in two planes: the second pair
    h, count = period / STEPS, 2 * STEPS
    t = h * np.arange(count + 1)
    root, rate, second = pulse(t, period)
    model = placed(case, modes)
    table = np.column_stack([np.r_[t, t[-1] + 1], np.r_[root, root[-1]]])
    model.move("root", direction, table, name="shaker")
    result = simulate(model, h, t[-1])
    # the same motion: that of the spline through the table
    field = result.field("body")
    place, acceleration = (result[f"root.{name}"] @ direction for name in ("position",
                                                                           "acceleration"))
    held, free = K[6:, :3] @ direction, M[6:, :3] @ direction
    K, M = K[6:, 6:], M[6:, 6:]
    factor = linalg.cho_factor(M + h * h / 4 * K)
    x, v = np.zeros(len(K)), np.zeros(len(K))
    a = linalg.solve(M, -free * acceleration[0], assume_a="pos")
    history = [x]
    for k in range(1, len(t)):
        ahead = x + h * v + h * h / 4 * a
        after = linalg.cho_solve(factor, -free * acceleration[k] - held * place[k] - K @ ahead)
        v = v + h / 2 * (a + after)
        x, a = ahead + h * h / 4 * after, after
        history.append(x)
    root = np.zeros((6, len(t)))
    root[:3] = direction[:, None] * place
    return case.tied @ np.vstack([root, np.array(history).T]), field


def pulse(t: NDArray, period: float) -> tuple[NDArray, NDArray, NDArray]:
    """Motion of the root, its rate and acceleration: still after one period."""
    inside = t < period
    s = np.where(inside, np.sin(np.pi * t / period), 0.0)
    c, w = np.where(inside, np.cos(np.pi * t / period), 0.0), np.pi / period
    scale = AMPLITUDE * LENGTH
    return (scale * s**4, 4 * scale * w * s**3 * c,
            4 * scale * w**2 * (3 * s**2 * c**2 - s**4))


def errors(bodies=BODIES, modes=MODES) -> dict[str, dict[str, dict[str, list[float]]]]:
    """Errors at the root and half way, by body, case and number of modes."""
    found: dict = {}
    for name, build in bodies.items():
        case, own = build(), {}
        for count in modes:
            motion = shaken(case, count)
            own[str(count)] = {
                "static": static_errors(case, count, True),
                "moving, without": moving_errors(case, motion, False),
                "moving": moving_errors(case, motion, True)}
        found[name] = own
    return found


def large_field(divisions: tuple[int, int, int] = LARGE, states: int = 3000,
                amplitudes: int = 30) -> Field:
    """A field of a large body: only sizes matter, its shapes are those of a small one, spread."""
    small = hexahedra()
    body = craig_bampton(small.model, small.boundary, amplitudes - 12)
    counts = np.array(divisions) + 1
    axes = [np.linspace(0, LENGTH, counts[0]), *(np.linspace(-SIDE / 2, SIDE / 2, n)
                                                 for n in counts[1:])]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(counts)
    corner = number[:-1, :-1, :-1].ravel()
    step = np.array([0, counts[1] * counts[2], (counts[1] + 1) * counts[2], counts[2]])
    cells = corner[:, None] + np.r_[step, step + 1]
    nearest = _nearest(small.model.coordinates, points)

    def spread(shapes: NDArray) -> NDArray:
        rows = shapes.reshape(-1, 3, shapes.shape[1])[nearest]
        return rows.reshape(3 * len(points), -1)
    own = SolidStress("hexahedron", cells, points, elasticity(E, NU))
    recovery = Recovery(spread(body.recovery.shapes), points, ("x", "y", "z"),
                        cells=(("hexahedron", cells),), stress=(own,),
                        static=spread(body.recovery.static))
    model = placed(small, amplitudes - 12)
    model.fix("root")
    model.force("end", (0, 0, 1), [(0, 0), (1e-3, FORCE)])
    object.__setattr__(model.bodies["body"].reduced, "recovery", recovery)
    result = simulate(model, 1e-6, states * 1e-6)
    recording = Recording(result.model, result.numbering, result.system, result.state,
                          result.rows[:states], 0.0)
    return Field(recording, "body")


def _nearest(known: NDArray, points: NDArray) -> NDArray:
    from scipy.spatial import cKDTree
    return cKDTree(known).query(points)[1]


def seconds(field: Field) -> dict[str, float]:
    """Quickest of three, of each task; the first ones prepare what all states share."""
    node = field.count // 2

    def new() -> Field:
        return Field(field._recording, "body")
    tasks = {"first frame: von Mises at all nodes": lambda: new().von_mises(7),
             "first point: von Mises, all states": lambda: new().at(node).von_mises,
             "frame: places": lambda: field.position(7),
             "frame: velocities": lambda: field.velocity(7),
             "frame: von Mises at all nodes": lambda: field.von_mises(7),
             "point: places, all states": lambda: field.at(node).position,
             "point: accelerations, all states": lambda: field.at(node).acceleration,
             "point: von Mises, all states": lambda: field.at(node).von_mises}
    found = {}
    for name, task in tasks.items():
        times = []
        for _ in range(3):
            began = time.perf_counter()
            task()
            times.append(time.perf_counter() - began)
        found[name] = min(times)
    return found


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="errors and seconds, to be read")
    as_json = parser.parse_args(arguments).json
    found = errors()
    field = large_field()
    times = seconds(field)
    if as_json:
        print(json.dumps({"errors": found, "seconds": times, "dofs": 3 * field.count,
                          "states": len(field.t)}))
        return
    print("| body | modes | at rest: root / half way | moving, without the static answer | "
          "moving |\n|---|---|---|---|---|")
    for name, own in found.items():
        for count, row in own.items():
            print(f"| {name} | {count} | " + " | ".join(
                f"{a:.2%} / {b:.2%}" for a, b in row.values()) + " |")
    print(f"\n{3 * field.count} DOFs, {len(field.t)} states, {field.amplitudes.shape[1]} shapes")
    for name, value in times.items():
        print(f"{name:36} {value:7.3f} s")


if __name__ == "__main__":
    main()
