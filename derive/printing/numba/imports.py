"""Imports of a kernel file: what its statements use, from the modules of the runtime."""

from sebody.derive.form.kernel import Kernel
from sebody.derive.passes.uses import uses
from sebody.derive.printing.lines import WIDTH

KERNELS, LAYOUT = "sebody.kernels", "sebody.contract.layout"
DECORATOR = "sebody.compiler.decorators", "kernel_function"
POINTER = f"{KERNELS}.abi", "at"


def import_lines(kernel: Kernel, rows: tuple[str, ...] = (), classes: tuple[str, ...] = ()) -> str:
    """Imports in the order of isort, wrapped.

    Parameters
    ----------
    rows, classes : tuple of str
        Rows of constants and classes of the layout, which the head of the file uses.
    """
    used = uses(kernel.body)
    functions = {(f"{KERNELS}.{f.module}", f.name) for f in used.functions} | {DECORATOR}
    functions |= {POINTER} if used.views else set()
    modules: dict[str, list[str]] = {LAYOUT: [*sorted([*rows, *(a.name for a in used.agreed)]),
                                         *sorted(classes)]}
    for module, name in sorted(functions):
        modules.setdefault(module, []).append(name)
    lines = [f"from math import {', '.join(sorted(used.mathematics))}\n"] * bool(used.mathematics)
    lines += [_line(module, modules[module]) for module in sorted(modules) if modules[module]]
    return "\n".join(lines)


def _line(module: str, names: list[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= WIDTH:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in names), ")"])
