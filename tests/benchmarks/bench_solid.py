"""Reduction of a large solid with four mean interfaces, and what factors its stiffness best.

    python tests/benchmarks/bench_solid.py [--json] [--factors]

A curved bar of hexahedra, meshed and assembled by scikit-fem, is held by the means of both ends and
of two patches. Times are those of the reduction, inertia constants and stiffening included; seconds
of processors beside them tell how busy the machine was.
"""

import argparse
import json
import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from sebody.fem import FEModel
from sebody.io import from_skfem
from sebody.reduction import MeanFace, craig_bampton

DIVISIONS, MODES = (61, 18, 18), 30
STEEL, DENSITY = (2.1e11, 0.3), 7800.0
PATCHES = {"start": lambda x: x[0] < 1e-9, "end": lambda x: x[0] > 3 - 1e-9,
           "top": lambda x: (x[2] > 1 - 1e-9) & (x[0] > 1) & (x[0] < 1.4),
           "side": lambda x: (x[1] < 1e-9) & (x[0] > 2) & (x[0] < 2.5)}


def curved_bar(divisions: Sequence[int] = DIVISIONS) -> FEModel:
    """A bar 3 x 1 x 1 with an axis that bends by 1.5 rad, of linear hexahedra."""
    import skfem
    from skfem.models.elasticity import lame_parameters, linear_elasticity
    grid = (np.linspace(0, size, count + 1) for size, count in zip((3, 1, 1), divisions,
                                                                   strict=True))
    mesh = skfem.MeshHex.init_tensor(*grid).with_boundaries(PATCHES)
    x, y, z = mesh.p
    radius = 2.0 + y
    mesh = replace(mesh, doflocs=np.array([radius * np.sin(x / 2), radius * np.cos(x / 2),
                                           z + 0.1 * x]))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()), intorder=2)
    stiffness = linear_elasticity(*lame_parameters(*STEEL)).assemble(basis)
    mass = skfem.BilinearForm(lambda u, v, w: DENSITY * sum(a * b for a, b in zip(
        u, v, strict=True))).assemble(basis)
    return from_skfem(basis, stiffness, mass, *STEEL, units="SI")


def gigabytes() -> float:
    """Largest memory of this process so far [GiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def timed(work: Callable) -> tuple[object, dict]:
    """A result, seconds of the clock and of the processors, and memory."""
    clock, processors = time.perf_counter(), time.process_time()
    result = work()
    return result, {"seconds": time.perf_counter() - clock,
                    "processor_seconds": time.process_time() - processors, "GiB": gigabytes()}


def reduction(model: FEModel, modes: int = MODES) -> dict:
    """The body of four means, with and without stiffening."""
    faces = [(MeanFace(model.node_set(name)), "full") for name in PATCHES]
    plain = replace(model, geometric_stiffness=None)
    _, without = timed(lambda: craig_bampton(plain, faces, modes))
    body, whole = timed(lambda: craig_bampton(model, faces, modes))
    return {"dofs": model.stiffness.shape[0], "order": len(body.mass), "reduced": without,
            "with_stiffening": whole, "resultants": body.invariants.resultants,
            "load_modes": body.invariants.slaved}


def factors(model: FEModel) -> dict:
    """The stiffness with one end clamped, by every solver at hand."""
    held = model.rows[list(model.node_set("start"))].ravel()
    inside = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
    matrix = model.stiffness[inside][:, inside]
    name = "SuperLU, minimum degree"
    factor, measured = timed(lambda: splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                                          options={"SymmetricMode": True}))
    _, solve = timed(lambda: factor.solve(np.ones(len(inside))))
    found = {name: {**measured, "entries": factor.nnz, "solve": solve["processor_seconds"]}}
    del factor
    try:
        import cvxopt
        import cvxopt.cholmod
    except ImportError:
        return found
    lower = sparse.tril(matrix).tocoo()
    entries = cvxopt.spmatrix(lower.data, lower.row.astype(int), lower.col.astype(int),
                              matrix.shape)

    def cholmod() -> object:
        factor = cvxopt.cholmod.symbolic(entries)
        cvxopt.cholmod.numeric(entries, factor)
        return factor

    factor, found["CHOLMOD (GPL, not used)"] = timed(cholmod)
    right = cvxopt.matrix(np.ones(len(inside)))
    _, solve = timed(lambda: cvxopt.cholmod.solve(factor, right))
    found["CHOLMOD (GPL, not used)"]["solve"] = solve["processor_seconds"]
    return found


def main(arguments: Sequence[str] | None = None, divisions: Sequence[int] = DIVISIONS,
         modes: int = MODES) -> None:
    """Print what was measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--factors", action="store_true", help="compare solvers instead")
    chosen = parser.parse_args(arguments)
    model, assembled = timed(lambda: curved_bar(divisions))
    found = factors(model) if chosen.factors else {
        "assembly by scikit-fem": assembled, **reduction(model, modes)}
    if chosen.json:
        print(json.dumps(found, indent=1))
        return
    for name, value in found.items():
        print(name, {key: round(number, 3) for key, number in value.items()}
              if isinstance(value, dict) else value)


if __name__ == "__main__":
    main()
