"""Factors with row exchanges of the engine against SuperLU, where every matrix needs them.

    python tests/benchmarks/bench_row_exchanges.py [--json] [--pairs N]

Chains whose multipliers are numbered before what they act on, and Bricard's redundant loop, turned
and in other units, before it is regularized. Both factorize the same scaled matrix in the same
order with the same threshold, in turns; times are the best of all. Errors are backward errors
(Oettli and Prager). "Whole" is the time with what is around a factorization: gathering the matrix
by columns, which for SuperLU is done with SciPy, as the time loop did before.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import splu

sys.path.insert(0, str(Path(__file__).parents[1]))

from everyday import Place, bricard  # noqa: E402
from helpers import multipliers_first  # noqa: E402

import sebody.assembly.build as assembly  # noqa: E402
from sebody import Simulation  # noqa: E402
from sebody.assembly.evaluation import assembled, matrix  # noqa: E402
from sebody.engine.matrix import equilibrate, sum_matrices  # noqa: E402
from sebody.engine.row_exchanges import Exchanges, exchange  # noqa: E402
from sebody.engine.sparse_lu import ROOM, THRESHOLD, factorize, substitute  # noqa: E402
from sebody.engine.state import FACTORS, SOLUTION  # noqa: E402
from sebody.scenes import chain  # noqa: E402

MODELS = {"chain of 8": lambda: chain.build(links=8).model,
          "chain of 32": lambda: chain.build(links=32).model,
          "chain of 128": lambda: chain.build(links=128).model,
          "Bricard's loop": lambda: bricard(Place.at_random(4, length=1e3, mass=0.01))}


def best(pairs: int, *functions) -> list[float]:
    """Least time of each function in microseconds, called in turns."""
    found = [np.inf] * len(functions)
    for _ in range(pairs):
        for k, function in enumerate(functions):
            began = time.perf_counter()
            function()
            found[k] = min(found[k], 1e6 * (time.perf_counter() - began))
    return found


def measure(name: str, pairs: int) -> dict:
    """Times, entries and errors of both."""
    own_number = assembly.number
    assembly.number = multipliers_first(own_number)
    try:
        run = Simulation(MODELS[name](), 2e-3).run_to(0.1)
    finally:
        assembly.number = own_number
    system, state, n = run.system, run.state, run.system.diagonal.size
    matrix(system, state, "the state", mass=1.0, damping=1e-3, stiffness=1e-6, constraint=1.0)
    equilibrate(system, state)
    state.control.regularized, state.control.restart = 0, 0
    stored = system.rows.size
    found = Exchanges.of(n, stored)
    while exchange(system, state, found, FACTORS) == ROOM:
        found = Exchanges.of(n, stored, int(found.kind[1]))
    sum_matrices(system, state, state.residual, False)      # a singular one was regularized
    exchange(system, state, found, SOLUTION)

    def gathered() -> csc_matrix:
        scale = diags(state.scale[:n])
        return csc_matrix(scale @ assembled(system, state) @ scale)

    def by_superlu(A: csc_matrix):
        return splu(A, permc_spec="NATURAL", diag_pivot_thresh=THRESHOLD)
    A, right, x = gathered(), np.random.default_rng(1).normal(size=n), np.zeros(n)
    other = by_superlu(A)
    whole = best(pairs, lambda: exchange(system, state, found, FACTORS),
                 lambda: by_superlu(gathered()))
    factored = best(pairs, lambda: factorize(found.matrix, n, found.factors), lambda: by_superlu(A))
    solution = best(pairs, lambda: substitute(found.factors, n, right.copy(), x),
                    lambda: other.solve(right))
    errors = [float(np.max(np.abs(A @ y - right) / (abs(A) @ np.abs(y) + np.abs(right))))
              for y in (x, other.solve(right))]
    return {"unknowns": n, "whole us": whole, "factors us": factored, "solution us": solution,
            "entries": [int(found.factors.starts[n]), int(other.L.nnz + other.U.nnz)],
            "errors": errors}


def main(arguments: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--pairs", type=int, default=30)
    options = parser.parse_args(arguments)
    found = {name: measure(name, options.pairs) for name in MODELS}
    if options.json:
        print(json.dumps(found))
        return
    print("| matrix | unknowns | whole, us: own, SuperLU | factors | solution | entries | error |\n"
          "|---|---|---|---|---|---|---|")
    for name, row in found.items():
        times = " | ".join(f"{a:.0f}, {b:.0f}" for a, b in (
            row[what] for what in ("whole us", "factors us", "solution us")))
        print(f"| {name} | {row['unknowns']} | {times} | {row['entries'][0]}, {row['entries'][1]} "
              f"| {row['errors'][0]:.1g}, {row['errors'][1]:.1g} |")


if __name__ == "__main__":
    main()
