"""Report of a check: every criterion with its worst error, failures, number that hold."""

import math

from sebody.verify.check.quantities import PREFIX
from sebody.verify.check.states import CheckRow


def summary(rows: list[CheckRow]) -> str:
    """A line for each criterion with its worst row, then all rows that fail."""
    kinds: dict[tuple[str, float], list[CheckRow]] = {}
    for row in rows:
        kinds.setdefault((row.criterion, row.limit), []).append(row)
    width = max(len(criterion) for criterion, _ in kinds)
    lines = [f"{'criterion':{width}}  count       worst       limit  kernel"]
    for (criterion, _), group in kinds.items():
        worst = max(group, key=_badness)
        lines.append(f"{criterion:{width}}  {len(group):5d}  {_found(worst)} {_limit(worst)}  "
                     f"{_place(worst)}")
    failed = [row for row in rows if not row.passed]
    return "\n".join(lines + (["", table(failed)] if failed else []))


def table(rows: list[CheckRow]) -> str:
    """A line for each row: kernel, criterion, state, error or slope, and its limit."""
    width = max(len(_place(row)) for row in rows)
    lines = [f"{'kernel':{width}}  {'criterion':31}  state       found       limit"]
    lines += [f"{_place(row):{width}}  {row.criterion:31}  {row.state:5d}  {_found(row)} "
              f"{_limit(row)}{'' if row.passed else '  FAILED'}" for row in rows]
    return "\n".join(lines)


def verdict(rows: list[CheckRow]) -> str:
    """The count of criteria of kernels that hold or fail."""
    judged = [row for row in rows if row.limit < math.inf]
    failed, kernels = [row for row in judged if not row.passed], {row.kernel for row in rows}
    if failed:
        return f"{len(failed)} of {len(judged)} criteria fail"
    quantities = {name for name in kernels if name.startswith(PREFIX)}
    parts = [f"{size} {what if size == 1 else many}" for size, what, many in (
        (len(kernels - quantities), "kernel", "kernels"),
        (len(quantities), "quantity", "quantities")) if size]
    return f"{len(judged)} criteria of {' and '.join(parts)} hold"


def _place(row: CheckRow) -> str:
    """The kernel, and of a general one the positions, rotations and modes."""
    return f"{row.kernel} {tuple(row.nodes)}" if row.nodes else row.kernel


def _badness(row: CheckRow) -> float:
    """Sort key: grows with the error, or falls with the slope; NaN is the worst."""
    value = row.error if row.slope is None else -row.slope
    return math.inf if math.isnan(value) else value


def _found(row: CheckRow) -> str:
    return f"{row.error:10.1e}" if row.slope is None else f"order {row.slope:.2f}"


def _limit(row: CheckRow) -> str:
    if row.limit == math.inf:
        return f"{'none':>10}"
    return f"{row.limit:10.0e}" if row.slope is None else f"{f'> {row.limit}':>10}"
