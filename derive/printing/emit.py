"""Kernel files: the steps of a derivation set into the frame of a file."""

import hashlib
import inspect
import re

import sympy

from sebody.derive.formulas.frames import frame_axes
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.printing import templates
from sebody.derive.printing.printer import StepPrinter, indented

VERSION = "1.0"
ROWS = ("qe", "ve", "ae", "y", "yd", "ydd", "acc", "s", "p", "pd", "h", "beta", "Q", "e0s", "e1s",
        "b0s", "b1s", "gamma", "d", "weight", "dqe", "dve", "dae", "dy", "dyd", "dydd", "dacc",
        "ds", "dp", "dpd", "dh", "dbeta", "dgamma", "dd", "dweight", "eta", "friction", "deta",
        "dfriction", "dg")


def leaf_table(names: set[str]) -> dict[str, str]:
    """Module and content hash of every runtime function a kernel calls, and of what these call.

    Numba's cache looks at the calling file only, so the hash makes that file change too.
    """
    from sebody.kernels import dense, rotations
    from sebody.kernels import frame_search as locate
    modules = (rotations, locate, dense)
    functions = {}
    for module in modules:
        for name, value in vars(module).items():
            python = getattr(value, "py_func", getattr(value, "_defn", value))
            if inspect.isfunction(python) and python.__module__ == module.__name__:
                functions[name] = module, python
    reached, queue = {}, sorted(names)
    while queue:
        name = queue.pop(0)
        if name not in reached and name in functions:
            module, function = functions[name]
            source = inspect.getsource(function)
            reached[name] = (module.__name__, hashlib.sha256(source.encode()).hexdigest()[:12])
            queue += sorted(set(re.findall(r"\w+", source)) & set(functions))
    return {name: reached[name] for name in sorted(reached)}


def imports_and_leaves(calls: set[str]) -> tuple[str, str]:
    """Import lines of the called leaves and the table of their hashes."""
    table = leaf_table(calls)
    modules = sorted({table[name][0] for name in calls})
    imports = [f"from {module} import " + ", ".join(
        sorted(n for n in calls if table[n][0] == module)) for module in modules]
    imports = sorted([*imports, "from sebody.kernels.pipeline import KernelPasses"])
    leaves = [f'    "{name}": "{digest}",' for name, (_, digest) in table.items()]
    return "\n".join(imports), "\n".join(leaves)


def superelement_text(kernel: Superelement) -> str:
    """The file of a superelement kernel."""
    layout, planar = kernel.layout, kernel.layout.planar
    printer = StepPrinter(kernel.space, layout, kernel.names)
    located = next(k for k, step in enumerate(kernel.residual)
                   if step.title.startswith("rotation of the frame")) + 1
    before = printer.lines(kernel.residual[:located])
    residual = printer.lines(kernel.residual[located:])
    counted = printer.operations, printer.products
    energy = [*printer.lines(kernel.energy), *templates.ENERGY_OUTPUTS[planar]]
    printer.operations = printer.products = 0
    tangent = printer.lines(kernel.tangent)
    seeds = (templates.SEEDS_PLANAR if planar else templates.SEEDS_SPATIAL).strip("\n").split("\n")
    damping, friction = ((t.strip("\n").split("\n") if layout.damped else [])
                         for t in (templates.DAMPING, templates.FRICTION))
    text = "\n".join([*before, *residual, *energy, *tangent, *seeds])
    rows = [row for row in ROWS if re.search(rf"\b{row}\b", text) or row in ("qe", "ve", "ae")]
    calls = {name for name in ("columns_times", "inverse_3") if name in text}
    for step in (*kernel.residual, *kernel.tangent):
        calls |= set(getattr(step, "calls", ()))
    calls = {name for name in calls if re.search(rf"\b{name}\(", text)}
    imports, leaves = imports_and_leaves(calls)
    height = "padded(max(n, 9*N_ROTATIONS))"
    row_lines = [f"row = {height}"] + [f"{name} = at(work, {k}*row)"
                                       for k, name in enumerate(rows)]
    return templates.SUPERELEMENT.format(
        layout=layout.name, frame=kernel.frame.name, inertia=kernel.inertia.name,
        positions=layout.positions, rotations=layout.rotations,
        space="motion in a plane" if planar else "motion in space",
        frame_summary=kernel.frame.summary, inertia_summary=kernel.inertia.summary,
        version=VERSION, sympy=sympy.__version__, imports=imports,
        modes="any number of" if layout.modes is None else layout.modes, n_modes=layout.modes,
        width="width" if layout.modes is None else layout.first_mode + layout.modes,
        axes_count=layout.position_size, first_rotation=layout.first_rotation,
        first_mode=layout.first_mode, work_rows=len(rows),
        residual_operations=counted[0], residual_products=counted[1],
        column_operations=printer.operations, column_products=printer.products, leaves=leaves,
        rows=indented(row_lines, 1), residual_before=indented(before, 2),
        axes=indented(frame_axes(planar), 2), residual=indented(residual, 2),
        damping="\n" * layout.damped + indented(damping, 2),
        friction="\n" * layout.damped + indented(friction, 3), damped=layout.damped,
        names="ENERGY, HEADER, " + "POWERS, " * layout.damped + "SIGNATURE, TANGENT, at, padded",
        energy=indented(energy, 3), seeds=indented(seeds, 4), tangent=indented(tangent, 4))
