"""Cost of a step by the order in which bodies are created, of four graphs of bodies.

    python tests/benchmarks/bench_order.py [--json]

The elimination follows an order of its own (`sebody.assembly.fill_order`), so the order of creation
should hardly matter: time of a step and entries of the factors are printed for bodies created from
the root of the graph outwards, from its far ends inwards, and in random orders.
"""

import argparse
import json
from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csc_matrix, eye
from scipy.sparse.linalg import splu

from sebody import Model, Simulation
from sebody.assembly.axes import frames, rotated_blocks
from sebody.assembly.batches import make_batches
from sebody.assembly.links import link_ends, link_tables
from sebody.assembly.numbering import number
from sebody.assembly.scatter import element_scatter
from sebody.engine.state import EVALUATED
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton

STEEL = Section(area=1e-2, inertia_y=1e-5, inertia_z=1e-5, torsion=1e-5, youngs_modulus=2e9,
                poisson_ratio=0.3, density=1e3)
RANDOM = 3              # random orders
STEPS, REPEATS = 20, 5
STEP = 1e-3


def tree(order: Sequence[int]) -> Model:
    """Rigid bodies on revolute joints as equations, every one on a random earlier one.

    A tree with branches of many lengths; body 0 is its root.
    """
    model, count = Model(planar=True), len(order)
    parents = [0, *(int(k * r) for k, r in
                    enumerate(np.random.default_rng(0).random(count - 1), start=1))]
    points = np.random.default_rng(1).normal(size=(count, 2))
    for k, point in enumerate(points):
        model.node(f"node {k}", point)
    for k in order:
        model.rigid_body(f"body {k}", f"node {k}", 1.0 + 0.1 * (k % 7), 0.1)
    for k in range(count):
        joint = (points[k] + points[parents[k]]) / 2
        if k:
            for end, body in (("in", k), ("out", parents[k])):
                model.attach(f"{end} {k}", joint, to=f"node {body}")
            model.revolute(f"in {k}", to=f"out {k}", explicit=True, name=f"hinge {k}")
    return _under_gravity(model)


def star(order: Sequence[int]) -> Model:
    """Rigid arms hinged to the rim of a rigid hub, by equations; body 0 is the hub."""
    model, count = Model(planar=True), len(order)
    turns = 2 * np.pi * np.arange(count) / (count - 1)
    rim = np.column_stack([np.cos(turns), np.sin(turns)])
    for k in range(count):
        model.node(f"node {k}", 2 * rim[k] if k else (0.0, 0.0))
    for k in order:
        model.rigid_body(f"body {k}", f"node {k}", 1.0 if k else 10.0, 0.1)
    for k in range(1, count):
        for end, body in (("in", k), ("out", 0)):
            model.attach(f"{end} {k}", rim[k], to=f"node {body}")
        model.revolute(f"in {k}", to=f"out {k}", explicit=True, name=f"hinge {k}")
    return _under_gravity(model)


def grid(order: Sequence[int]) -> Model:
    """A square sheet of rigid bodies, with bushings between neighbours."""
    model, side = Model(planar=True), round(len(order) ** 0.5)
    for k in range(side * side):
        model.node(f"node {k}", (k % side, k // side))
    for k in order:
        model.rigid_body(f"body {k}", f"node {k}", 1.0 + 0.1 * (k % 7), 0.1)
    for k in range(side * side):
        for step, there in ((1, k % side + 1 < side), (side, k // side + 1 < side)):
            if there:
                point = (np.array(divmod(k, side)) + np.array(divmod(k + step, side)))[::-1] / 2
                for end, body in (("from", k), ("to", k + step)):
                    model.attach(f"{end} {k} {step}", point, to=f"node {body}")
                model.bushing(f"from {k} {step}", to=f"to {k} {step}", stiffness=1e3,
                              turning_stiffness=10.0, name=f"bushing {k} {step}")
    return _under_gravity(model)


def ladder(order: Sequence[int]) -> Model:
    """Two rails of flexible beams and rungs between them, welded by sharing nodes."""
    model, cells, body = Model(planar=True), len(order) // 3, _beam(1)
    for k in range(cells + 1):
        model.node(f"left {k}", (0.0, k))
        model.node(f"right {k}", (1.0, k))
    for beam in order:
        k, part = divmod(beam, 3)
        ends = ((f"left {k}", f"left {k + 1}"), (f"right {k}", f"right {k + 1}"),
                (f"left {k + 1}", f"right {k + 1}"))[part]
        _place(model, f"beam {beam}", body, *ends)
    return _under_gravity(model)


GRAPHS: dict[str, tuple[Callable[[Sequence[int]], Model], int]] = {
    "tree": (tree, 1000), "star": (star, 400), "grid": (grid, 400), "ladder": (ladder, 300)}


def orders(count: int, random: int = RANDOM) -> dict[str, list[int]]:
    """Orders of creation by name."""
    found = {"root first": list(range(count)), "leaves first": list(range(count))[::-1]}
    return found | {f"random {seed}": np.random.default_rng(seed).permutation(count).tolist()
                    for seed in range(1, random + 1)}


def fill(model: Model) -> tuple[int, int]:
    """Entries of the lower factor in the order of the unknowns, and in SuperLU's own.

    SuperLU orders the unknowns themselves by minimum degree, multipliers wherever it likes: the
    pattern is given values for which every pivot will do.
    """
    numbering = number(model)
    shapes = [batch.shape for batch in make_batches(model, numbering).all]
    row, column = element_scatter(shapes, numbering.total)
    rotated, _ = rotated_blocks(shapes, frames(model, numbering))
    _, linked_row, linked_column = link_tables(shapes, link_ends(model, numbering)[0], rotated,
                                               numbering.total)
    row, column, n = np.r_[row, linked_row], np.r_[column, linked_column], numbering.free
    free = (row < n) & (column < n)
    row, column = row[free], column[free]
    matrix = csc_matrix((np.ones(len(row)), (row, column)), (n, n)).sign()
    matrix = csc_matrix(matrix + n * eye(n))
    own, other = (splu(matrix, permc_spec=order, diag_pivot_thresh=0.0,
                       options={"SymmetricMode": True}).L.nnz
                  for order in ("NATURAL", "MMD_AT_PLUS_A"))
    return own, other


def microseconds(run: Simulation) -> float:
    """Time of a step, the quickest of some stretches; each begins with a new matrix."""
    quickest = float("inf")
    for _ in range(REPEATS):
        run.state.control.wanted = EVALUATED
        began = run.seconds
        run.run_to(run.time + STEPS * STEP)
        quickest = min(quickest, (run.seconds - began) / STEPS)
    return 1e6 * quickest


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="numbers by graph and order")
    as_json = parser.parse_args(arguments).json
    found: dict[str, dict] = {}
    for name, (graph, count) in GRAPHS.items():
        for order, sequence in orders(count).items():
            model = graph(sequence)
            own, other = fill(model)
            row = {"microseconds": microseconds(Simulation(model, STEP)), "entries": own,
                   "superlu": other}
            found.setdefault(name, {})[order] = row
            if not as_json:
                print(f"{name:7} {order:13} {row['microseconds']:8.1f} us a step, {own:7} entries, "
                      f"SuperLU's order {other:7}", flush=True)
    if as_json:
        print(json.dumps(found))


def _beam(modes: int):
    return craig_bampton(planar_beam((0, 0), (1, 0), STEEL, 4), [(0, "full"), (4, "full")], modes)


def _place(model: Model, name: str, body, *ends: str) -> None:
    """A beam between two nodes, turned into its place."""
    along = model.nodes[ends[1]].point - model.nodes[ends[0]].point
    c, s = along / np.linalg.norm(along)
    model.superelement(name, body, [model.nodes[end] for end in ends],
                       rotation=np.array([[c, -s], [s, c]]))


def _under_gravity(model: Model) -> Model:
    model.gravity((0.0, -9.81))
    return model


if __name__ == "__main__":
    main()
