"""The runs of a sweep: every combination of the listed values with every sampled set."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.explore.sweep.variations import SAMPLERS, Distribution

MOST_RUNS = 10_000_000


@dataclass(frozen=True)
class Design:
    """Parameters of the runs of a sweep.

    Parameters
    ----------
    listed : mapping
        Values by name; all combinations are run.
    sampled : mapping
        Distributions by name.
    columns : mapping
        Value of every parameter in every run, (runs,).
    """

    listed: Mapping[str, list]
    sampled: Mapping[str, Distribution]
    columns: Mapping[str, NDArray]

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(next(iter(self.columns.values()))) if self.columns else 1

    def text(self) -> str:
        """Parameters, and all their values in short, to recognise the design."""
        return json.dumps({name: [str(v) for v in values] if values.dtype == object else
                           [float(values.sum()), float(values @ np.arange(len(values)))]
                           for name, values in self.columns.items()})


def design(listed: Mapping[str, list], sampled: Mapping[str, Distribution], runs: int | None,
           seed: int, sampler: str = "lhs") -> Design:
    """All combinations of the listed values, each with all sampled sets.

    Parameters
    ----------
    runs : int, optional
        Number of sampled sets.
    seed : int
        The same seed gives the same sets.
    sampler : {'lhs', 'sobol', 'random'}
        Latin hypercube, Sobol's sequence, or independent numbers.

    Raises
    ------
    InputError
        A name that is both, sampling without a number of runs or the other way round.
    """
    seed = inputs.integer(seed, "seed", least=0)
    inputs.choice(sampler, "sampler", SAMPLERS)
    if twice := set(listed) & set(sampled):
        raise InputError(f"{', '.join(twice)} is both varied and sampled: do one of them")
    if sampled and runs is None:
        raise InputError("--sample needs the number of sampled sets: give --runs N")
    if runs is not None and not sampled:
        raise InputError("runs counts sampled sets, and nothing is sampled: give --sample "
                         "NAME=DISTRIBUTION or leave it out")
    count = 1 if runs is None else inputs.integer(runs, "runs", least=1)
    check_runs(float(count) * float(np.prod([float(len(v)) for v in listed.values()])))
    combinations = list(product(*listed.values()))
    shares = _shares(len(sampled), count, seed, sampler)
    columns: dict[str, NDArray] = {}
    for k, name in enumerate(listed):
        columns[name] = _column([c[k] for c in combinations for _ in range(count)])
    for k, (name, one) in enumerate(sampled.items()):
        columns[name] = np.tile(one.at(shares[:, k]), len(combinations))
    return Design(listed, sampled, columns)


def check_runs(runs: float) -> None:
    """Refuse more runs than a sweep can have.

    Raises
    ------
    InputError
        There are.
    """
    if runs > MOST_RUNS:
        raise InputError(f"these are {runs:.3g} runs: a sweep has at most {MOST_RUNS}; give fewer "
                         "values or a smaller --runs")


def _shares(dimensions: int, count: int, seed: int, sampler: str) -> NDArray:
    if not dimensions:
        return np.zeros((count, 0))
    if sampler == "random":
        return np.random.default_rng(seed).random((count, dimensions))
    from scipy.stats import qmc

    if sampler == "lhs":
        return qmc.LatinHypercube(dimensions, rng=seed).random(count)
    if count & (count - 1):
        raise InputError(f"runs is {count}: Sobol's sequence is balanced for powers of two, give "
                         f"{1 << count.bit_length()}")
    return qmc.Sobol(dimensions, rng=seed).random(count)


def _column(values: list[Any]) -> NDArray:
    numbers = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column.astype(float) if numbers and any(isinstance(v, float) for v in values) else column
