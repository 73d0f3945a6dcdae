"""Sobol's indices of a sweep: which parameter the outputs vary with."""

import warnings
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.explore.sweep.design import Design, check_runs
from sebody.explore.sweep.table import Table
from sebody.explore.sweep.variations import Distribution


def saltelli(sampled: dict[str, Distribution], n: int, seed: int) -> Design:
    """The runs that `scipy.stats.sobol_indices` needs, n (parameters + 2) of them.

    Raises
    ------
    InputError
        No parameters, or a number that is no power of two.
    """
    if len(sampled) < 2:
        raise InputError("--sobol tells parameters apart: give two --sample at least")
    n = inputs.integer(n, "--sobol", least=1)
    check_runs(float(n) * (len(sampled) + 2))
    if n < 2 or n & (n - 1):
        raise InputError(f"--sobol is {n}: Sobol's sequence needs a power of two, give "
                         f"{1 << max(1, n).bit_length()}")
    asked: list[NDArray] = []

    def note(shares: NDArray) -> NDArray:
        asked.append(np.array(shares))
        return np.arange(shares.shape[1], dtype=float)      # not constant: no division by zero

    _indices(note, len(sampled), n, seed)
    shares = np.hstack(asked)
    return Design({}, sampled, {name: one.at(shares[k])
                                for k, (name, one) in enumerate(sampled.items())})


def indices(table: Table, sampled: dict[str, Distribution], n: int) -> dict[str, NDArray]:
    """First-order and total indices of every output, (2, parameters) by column.

    Raises
    ------
    InputError
        Runs that failed: their outputs are needed.
    """
    if not table.good.all():
        raise InputError(f"{int((~table.good).sum())} runs failed, and Sobol's indices need all: "
                         "narrow the distributions or take a smaller step")
    from scipy.stats import sobol_indices

    rows, d = {}, len(sampled)
    for name, values in table.columns().items():
        if name.partition("[")[0] not in table.outputs:
            continue
        f = np.asarray(values, dtype=float)
        if np.ptp(f) <= 1e-12 * np.abs(f).max():        # depends on nothing
            rows[name] = np.zeros((2, d))
            continue
        parts = {"f_A": f[None, :n], "f_B": f[None, n:2 * n],
                 "f_AB": f[2 * n:].reshape(n, d).T[:, None, :]}      # SciPy's own order
        result = sobol_indices(func=parts, n=n)
        rows[name] = np.array([result.first_order, result.total_order])
    return rows


def report(found: dict[str, NDArray], names: list[str]) -> str:
    """The indices as text."""
    width = max(map(len, found))
    lines = [f"{'index, first order / total':{width}} " + " ".join(f"{n:>20}" for n in names)]
    return "\n".join([*lines, *(f"{name:{width}} " + " ".join(
        f"{first:11.3f} / {total:6.3f}" for first, total in values.T)
        for name, values in found.items())])


def _indices(function: Any, dimensions: int, n: int, seed: int) -> None:
    from scipy.stats import sobol_indices, uniform

    # SciPy renamed the argument in version 1.15
    named = "rng" if "rng" in signature(sobol_indices).parameters else "random_state"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sobol_indices(func=function, n=n, dists=[uniform()] * dimensions, **{named: seed})
