"""Consistency of the generated kernels: forces against energies, tangents against differences.

Every criterion compares a kernel with derivatives taken numerically, in seeded generic states:
rotations of the order of one radian, elastic rotations to 0.3, moving and accelerating.
"""

from collections.abc import Iterable
from pathlib import Path

import sebody.generated
from sebody.errors import InputError
from sebody.kernels.loader import load, user_directory
from sebody.studies.check.elements import check_element
from sebody.studies.check.states import CheckRow
from sebody.studies.check.superelements import check_superelement


def kernel_names() -> list[str]:
    """Names of all kernels: the shipped ones and those of the user's directory."""
    folders = [Path(sebody.generated.__file__).parent, user_directory()]
    return sorted({path.stem for folder in folders if folder.exists()
                   for path in folder.glob("*.py")
                   if path.stem.startswith(("superelement_", "element_"))})


def check_kernels(names: Iterable[str] | None = None) -> list[CheckRow]:
    """Check kernels by name, all of them by default.

    Raises
    ------
    InputError
        An unknown name.
    """
    known, rows = kernel_names(), []
    for name in names or known:
        if name not in known:
            raise InputError(f"kernel {name!r} is unknown: there are {', '.join(known)}")
        module = load(name)
        rows += (check_superelement if name.startswith("superelement_") else check_element)(
            name, module)
    return rows


def format_table(rows: list[CheckRow]) -> str:
    """The rows as a table: kernel, criterion, state, error, slope."""
    width = max(len(row.kernel) for row in rows)
    lines = [f"{'kernel':{width}}  {'criterion':31}  state    error  slope"]
    for row in rows:
        slope = f"{row.slope:5.2f}" if row.slope is not None else "    -"
        lines.append(f"{row.kernel:{width}}  {row.criterion:31}  {row.state:5d}  {row.error:7.1e}  "
                     f"{slope}{'' if row.passed else '  FAILED'}")
    return "\n".join(lines)
