"""The table of a sweep: parameters and outputs of every run, in memory and in files."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files import members, replacing
from sebody.basics.files.array_files import json_of, opened
from sebody.basics.files.checksums import changed, checksums
from sebody.basics.tabular import text
from sebody.explore.sweep.batches import Answer

if TYPE_CHECKING:
    import pandas

VERSION = 1
ROUNDING = 1e-13         # of the largest component
QUANTILES = (0.05, 0.5, 0.95)
MOST_LISTED = 400        # runs of one or two parameters: beyond, quantiles say more


@dataclass
class Table:
    """Runs of a sweep.

    Attributes
    ----------
    design : str
        The request as text: a sweep continues only from a file with the same text.
    parameters : dict
        Values by name, (runs,).
    outputs : dict
        By name, (runs, ...); NaN of runs that are not done or failed.
    done : (runs,)
        Whether the run was done, perhaps in vain.
    failures : (runs,) of str
        Why a run failed; empty of others.
    units : dict
        Units of outputs by name, of models that have units.
    """

    design: str
    parameters: dict[str, NDArray]
    outputs: dict[str, NDArray]
    done: NDArray
    failures: NDArray = field(default_factory=lambda: np.zeros(0, dtype=object))
    units: dict[str, str] = field(default_factory=dict)

    @classmethod
    def empty(cls, design: str, parameters: dict[str, NDArray], runs: int) -> "Table":
        """A table of runs that are still to be done."""
        failures = np.empty(runs, dtype=object)
        failures[:] = ""
        return cls(design, parameters, {}, np.zeros(runs, dtype=bool), failures)

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.done)

    @property
    def good(self) -> NDArray:
        """Runs that reached the end, (runs,)."""
        return self.done & (self.failures == "")

    def __getitem__(self, name: str) -> NDArray:
        """A parameter or output by name.

        Raises
        ------
        InputError
            There is none of this name.
        """
        for values in (self.outputs, self.parameters):
            if name in values:
                return values[name]
        raise InputError(f"{name!r} is not a column: there are "
                         f"{', '.join([*self.parameters, *self.outputs])}")

    def has(self, columns: Mapping[str, NDArray]) -> bool:
        """Tell whether its parameters are those of a design."""
        return columns.keys() == self.parameters.keys() and all(
            np.array_equal(_storable(self.parameters[name]), _storable(values))
            for name, values in columns.items())

    def take(self, answer: Answer) -> None:
        """Enter what a batch gave."""
        for name, values in answer.values.items():
            if name not in self.outputs:
                self.outputs[name] = np.full((self.runs, *values.shape[1:]), np.nan)
            if self.outputs[name].shape[1:] != values.shape[1:]:
                raise InputError(f"output {name} has shape {values.shape[1:]}, in the table "
                                 f"{self.outputs[name].shape[1:]}: give another --output")
            self.outputs[name][answer.rows] = values
        for row, reason in answer.failures.items():
            self.failures[row] = reason
        self.done[answer.rows] = True

    def columns(self) -> dict[str, NDArray]:
        """Everything by runs, (runs,) each: components of vectors have an index in their name."""
        by_name = {"run": np.arange(self.runs), **self.parameters}
        for name, values in self.outputs.items():
            flat = values.reshape(self.runs, -1)
            by_name |= ({name: flat[:, 0]} if values.ndim == 1 else
                        {f"{name}[{k}]": flat[:, k] for k in range(flat.shape[1])})
        return {**by_name, "done": self.done, "failure": self.failures}

    def label(self, column: str) -> str:
        """A column's name with its unit, where that is known."""
        unit = self.units.get(column.partition("[")[0], "")
        return f"{column} [{unit}]" if unit else column

    def axes(self) -> list[str]:
        """The one or two parameters that vary, where every combination of their values is one run.

        Of random samples and of more parameters none: quantiles say more of these.
        """
        counts = {name: count for name, values in self.parameters.items()
                  if (count := len(set(values.tolist()))) > 1}
        whole = len(counts) in (1, 2) and np.prod(list(counts.values())) == self.runs
        return list(counts) if whole and self.runs <= MOST_LISTED else []

    def _answers(self) -> tuple[list[str], list[list[str]]]:
        """Heads and rows of a table of `axes` and of the outputs, a row for each run."""
        columns, axes = self.columns(), self.axes()
        outputs = [name for name in columns if name.partition("[")[0] in self.outputs]
        return [*axes, *map(self.label, outputs)], [
            [*(_number(columns[name][k]) for name in axes),
             *(_number(self._rounded(name, columns[name][k])) for name in outputs)]
            for k in range(self.runs)]

    def _rounded(self, column: str, value: float) -> float:
        return value if not abs(value) <= self.rounding(column) else 0.0

    def quantiles(self) -> dict[str, NDArray]:
        """5 %, median and 95 % of every column of the outputs, over the good runs."""
        outputs = [name for name in self.columns() if name.partition("[")[0] in self.outputs]
        if not self.good.any():
            return {}
        return {name: np.nanquantile(self.columns()[name][self.good].astype(float), QUANTILES)
                for name in outputs}

    def rounding(self, column: str) -> float:
        """Rounding in a column of the outputs: components of a vector share their size."""
        values = np.abs(self.outputs[column.partition("[")[0]][self.good])
        return ROUNDING * float(np.max(values, initial=0.0))

    def summary(self) -> str:
        """Numbers of runs, and the outputs as text: of each run, see `axes`, or their quantiles."""
        failed = self.done & ~self.good
        lines = [f"{int(self.done.sum())} of {self.runs} runs done, {int(failed.sum())} failed"]
        reasons = sorted(set(self.failures[failed]), key=list(self.failures[failed]).count)
        lines += [f"  {list(self.failures).count(r)} x {r}" for r in reasons[-3:][::-1]]
        quantiles = self.quantiles()
        if quantiles and self.axes():
            return text("\n".join(lines), *self._answers())
        if quantiles:
            width = max(len(self.label(name)) for name in quantiles)
            lines.append(f"{'output':{width}} {'5 %':>12} {'median':>12} {'95 %':>12}")
            lines += [f"{self.label(name):{width}} " + " ".join(
                f"{self._rounded(name, q):12.6g}" for q in values)
                      for name, values in quantiles.items()]
        return "\n".join(lines)

    def to_csv(self) -> str:
        """The columns as CSV, a line for each run."""
        columns, file = self.columns(), StringIO()
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
        return file.getvalue()

    def to_pandas(self) -> "pandas.DataFrame":
        """The columns as a data frame.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise InputError('tables as data frames need pandas: pip install "sebody[tables]"'
                             ) from error
        return pandas.DataFrame({name: [str(v) for v in values] if values.dtype == object
                                 and name not in self.parameters else values
                                 for name, values in self.columns().items()})

    def save(self, path: Path) -> None:
        """Write an npz file; an older one is replaced atomically."""
        arrays = {f"parameter/{n}": _storable(v) for n, v in self.parameters.items()}
        arrays |= {f"output/{n}": v for n, v in self.outputs.items()}
        arrays |= {"design": np.array(self.design), "version": np.array(VERSION),
                   "done": self.done, "failure": _storable(self.failures)}
        if self.units:
            arrays["units"] = np.array(json.dumps(self.units))
        noted = np.array(json.dumps(checksums(arrays)))
        with replacing(path, "table") as file:
            np.savez_compressed(file, **arrays, checksums=noted)

    @staticmethod
    def is_in(path: Path) -> bool:
        """Tell the table of a sweep in an npz file from a result; see `load`."""
        with opened(path, "results file", "give one that was saved") as reader:
            return "design" in reader.headers

    @classmethod
    def load(cls, path: Path) -> "Table":
        """A table from its npz file.

        Raises
        ------
        InputError
            A file of another kind or version, or members that do not fit together.
        """
        what, remedy = "table of a sweep", "give another --output, or remove it"
        with opened(path, what, remedy) as reader:
            version = reader.read("version")
            if version.shape or version != VERSION:
                raise InputError(f"table {path} is of version {version}, this program "
                                 f"reads {VERSION}: give another --output")
            noted = json_of(reader, "checksums") if "checksums" in reader.headers else None
            table = members.Table(f"{what} {path}", remedy, _members(reader.headers))
            arrays = table.read(reader, others=["checksums"])
            if odd := changed(arrays, noted):
                raise table.fault(f"differs from what was saved in {', '.join(odd)}")
            parts = {kind: {name.partition("/")[2]: values for name, values in arrays.items()
                            if name.startswith(kind + "/")} for kind in ("parameter", "output")}
            units = json.loads(str(arrays["units"])) if "units" in arrays else {}
            return cls(str(arrays["design"]), parts["parameter"], parts["output"], arrays["done"],
                       arrays["failure"].astype(object), units)


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)


def _members(headers: Mapping[str, members.Header]) -> dict[str, members.Member]:
    """Requirements of a table with these members: parameters of any kind, outputs of any shape."""
    one = members.Member
    known = {"design": one((), "U"), "version": one((), "i"), "done": one(("runs",), "b"),
             "failure": one(("runs",), "U")}
    if "units" in headers:
        known["units"] = one((), "U")
    for name, header in headers.items():
        if name.startswith("parameter/"):
            kind = header.dtype.kind
            known[name] = one(("runs",), kind if kind in members.KINDS else "f")
        elif name.startswith("output/"):
            known[name] = one(("runs", ...), finite=False)
    return known


def _storable(values: NDArray) -> NDArray:
    """An array of plain numbers or texts."""
    if values.dtype != object:
        return values
    numbers = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
    return values.astype(float) if numbers else np.array([str(v) for v in values])
