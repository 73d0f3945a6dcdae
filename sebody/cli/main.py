"""Command line: ``sebody run``, ``list``, ``check``, ``bench``, ``chart``, ``atlas``, ``warm``."""

import argparse
import ast
import inspect
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from sebody.errors import InputError, LimitWarning, SimulationError
from sebody.results.files import check_target

if TYPE_CHECKING:
    from sebody.results.result import Result
    from sebody.scenes.scene import Scene

BAR = 40                # characters of the progress bar
PATIENCE = 1.0          # seconds before it appears
PROCESSES = 2           # that compile at the same time


class Kernel(NamedTuple):
    """A generated kernel as its file describes it."""

    name: str           # of the file and module
    layout: str         # empty for joints and loads
    frame: str
    inertia: str
    size: int           # of its text


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the process by default.

    Returns
    -------
    int
        0, 1 when a run or a check fails, 2 when the input cannot be used.
    """
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="sebody", description="Flexible multibody dynamics with superelements.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    run = commands.add_parser("run", help="run a scene")
    run.set_defaults(command=_run)
    run.add_argument("scene", metavar="SCENE", help="name of a scene, see 'sebody list'")
    run.add_argument("--output", type=Path, metavar="FILE.npz", help="save the histories")
    run.add_argument("--plot", type=Path, metavar="FILE.png", help="draw the standard picture")
    run.add_argument("--t-end", type=float, metavar="T", help="end time, the scene's by default")
    run.add_argument("--step", type=float, metavar="H", help="time step, the scene's by default")
    run.add_argument("--accuracy", type=float, metavar="E",
                     help="allowed error of the run, of the model's extent and in radians: steps "
                          "are chosen, --step is the grid of the output")
    run.add_argument("--index", type=int, default=None, metavar="I",
                     help="2: constraints hold for velocities, too (default 3, with --accuracy 2)")
    run.add_argument("--save", type=Path, metavar="FILE.npz", help="save the state to go on from")
    run.add_argument("--resume", type=Path, metavar="FILE.npz",
                     help="go on from a saved state, with its step, scheme and accuracy")
    run.add_argument("--rho", type=float, metavar="R",
                     help="spectral radius of generalized-alpha at infinity (default 0.9)")
    run.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes",
                     help="change a parameter of the scene; may be repeated")
    listing = commands.add_parser("list", help="list scenes and kernels")
    listing.set_defaults(command=_list)
    check = commands.add_parser("check", help="test the consistency of kernels")
    check.set_defaults(command=_check)
    check.add_argument("kernels", nargs="*", metavar="KERNEL", help="all of them by default")
    bench = commands.add_parser(
        "bench", help="cost and error of scenes, beside Exudyn where it is installed")
    bench.set_defaults(command=_bench)
    bench.add_argument("scenes", nargs="*", metavar="SCENE", help="all that have one by default")
    bench.add_argument("--json", action="store_true", help="print JSON in place of a table")
    chart = commands.add_parser(
        "chart", help="error against computing time, over formulations, divisions and steps")
    chart.set_defaults(command=_chart)
    chart.add_argument("scene", metavar="SCENE", help="name of a scene that has a chart")
    chart.add_argument("--output", type=Path, metavar="FILE.png", help="draw it")
    chart.add_argument("--csv", type=Path, metavar="FILE.csv", help="write the points")
    atlas = commands.add_parser("atlas", help="where methods fail: theory and measurement")
    atlas.set_defaults(command=_atlas)
    atlas.add_argument("cases", nargs="*", metavar="CASE", help="all of them by default")
    atlas.add_argument("--output", type=Path, metavar="FILE.png", help="draw the page of pictures")
    warm = commands.add_parser("warm", help="compile everything that is shipped")
    warm.set_defaults(command=_warm)
    return parser


# run


def _run(options: argparse.Namespace) -> int:
    scene = _build(options.scene, options.changes)
    _check_outputs(options)
    print(f"{scene.name}: {scene.summary}")
    try:
        result, failure = _simulated(scene, options), ""
    except SimulationError as error:
        result, failure = error.result, str(error)
    print(result.summary())
    if options.output:
        print(f"histories            {result.save(options.output)}")
    if options.plot:
        from sebody.results.plots import save_picture
        print(f"picture              {save_picture(result, options.plot, scene.base, scene.tip)}")
    if failure:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failure else 0


def _simulated(scene: "Scene", options: argparse.Namespace) -> "Result":
    from sebody.analysis.accuracy import simulate_within
    from sebody.analysis.restart import resume, save_state
    from sebody.analysis.schemes import generalized_alpha
    from sebody.analysis.simulation import Simulation
    from sebody.analysis.tolerance import Tolerance

    h = scene.h if options.step is None else options.step
    t_end = scene.t_end if options.t_end is None else options.t_end
    if not 0.0 <= t_end < float("inf"):
        raise InputError(f"the end time is {t_end}: give a number >= 0")
    rho = 0.9 if options.rho is None else options.rho
    progress = Progress()
    warnings.simplefilter("ignore", LimitWarning)   # the summary has them
    try:
        if options.accuracy is not None:
            scheme = generalized_alpha(rho, index=2 if options.index is None else options.index)
            return simulate_within(scene.model, h, t_end, Tolerance(options.accuracy), scheme,
                                   progress)
        run = (resume(scene.model, options.resume) if options.resume else
               Simulation(scene.model, h, generalized_alpha(
                   rho, index=3 if options.index is None else options.index)))
        run.run_to(t_end, progress)
    finally:
        progress.close()
    if options.save:
        print(f"state                {save_state(run, options.save)}")
    return run.result()


def _check_outputs(options: argparse.Namespace) -> None:
    """Refuse files that cannot be written before the run, not after it."""
    from sebody.analysis.restart import TARGET
    from sebody.results.result import OUTPUT

    for path, kind in ((options.output, OUTPUT), (options.save, TARGET)):
        if path:
            check_target(path, *kind)
    if options.plot:
        from sebody.results.plots import check_picture
        check_picture(options.plot)
    if options.accuracy is not None and (options.save or options.resume):
        raise InputError("--accuracy repeats the run with finer steps: leave out --save and "
                         "--resume")
    if options.resume:
        for name in ("step", "rho", "index"):
            if getattr(options, name) is not None:
                raise InputError(f"--resume goes on with the {name} that was saved: leave out "
                                 f"--{name}")


def _build(name: str, changes: Sequence[str]) -> "Scene":
    known = scenes()
    if name not in known:
        raise InputError(f"scene {name!r} is unknown: there are {', '.join(known)}")
    build = import_module(f"sebody.scenes.{name.replace('-', '_')}").build
    return build(**_parameters(name, build, changes))


def _parameters(scene: str, build: Callable, changes: Sequence[str]) -> dict[str, Any]:
    """Keyword arguments of a scene from ``NAME=VALUE``, of the type of their defaults."""
    known = inspect.signature(build).parameters
    existing = ", ".join(f"{p.name}={p.default}" for p in known.values()) or "none"
    values = {}
    for change in changes:
        name, equals, text = change.partition("=")
        if not equals:
            raise InputError(f"cannot read --set {change}: write --set NAME=VALUE")
        if name not in known:
            raise InputError(f"scene {scene!r} has no parameter {name!r}: there are {existing}")
        values[name] = _value(name, text, known[name].default)
    return values


def _value(name: str, text: str, default: Any) -> Any:
    if isinstance(default, str):
        return text
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        value = text
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if default is None or type(value) is type(default):
        return value
    raise InputError(f"parameter {name} is {text!r}: give a value of type "
                     f"{type(default).__name__}, such as {default}")


class Progress:
    """A bar on standard error, shown on a terminal when a run takes longer than a second."""

    def __init__(self) -> None:
        self.began = time.perf_counter()
        self.shown = False

    def __call__(self, fraction: float) -> None:
        """Draw the part of the run that is done, between 0 and 1."""
        if time.perf_counter() - self.began < PATIENCE or not sys.stderr.isatty():
            return
        done = round(BAR * fraction)
        bar = "#" * done + "." * (BAR - done)
        print(f"\r[{bar}] {100 * fraction:3.0f} %", end="", file=sys.stderr, flush=True)
        self.shown = True

    def close(self) -> None:
        """End the line of the bar."""
        if self.shown:
            print(file=sys.stderr)


# list


def _list(options: argparse.Namespace) -> int:
    print("scenes")
    for name, summary in scenes().items():
        print(f"  {name:24} {summary}")
    found = kernels()
    print("\nsuperelement kernels\n  layout         frame            inertia")
    for kernel in found:
        if kernel.layout:
            print(f"  {kernel.layout:14} {kernel.frame:16} {kernel.inertia}")
    print("  frame 'node' is the converged_mean kernel with all weight on one node\n"
          "  inertia a: angular velocities in frame axes, b: material\n"
          "  other layouts: python -m sebody.derive LAYOUT")
    print("\njoints and loads")
    print("  " + ", ".join(k.name.removeprefix("element_") for k in found if not k.layout))
    return 0


def scenes() -> dict[str, str]:
    """Names of the shipped scenes and the first lines of their descriptions; runs none of them."""
    found = {}
    for path in _files("sebody.scenes"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if any(isinstance(node, ast.FunctionDef) and node.name == "build" for node in tree.body):
            lines = (ast.get_docstring(tree) or "").splitlines()
            found[path.stem.replace("_", "-")] = lines[0] if lines else ""
    return found


def kernels() -> list[Kernel]:
    """Kernels in the package and in the user's directory, read without compiling them."""
    from sebody.kernels.loader import user_directory

    paths = {path.stem: path for folder in (sorted(user_directory().glob("*.py")),
                                            _files("sebody.generated")) for path in folder}
    return [_describe(paths[name]) for name in sorted(paths)
            if name.startswith(("superelement_", "element_"))]


def _describe(path: Path) -> Kernel:
    constants, text = {}, path.read_text(encoding="utf-8")
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            constants[node.targets[0].id] = node.value.value
    return Kernel(path.stem, *(constants.get(k, "") for k in ("LAYOUT", "FRAME", "INERTIA")),
                  len(text))


def _files(package: str) -> list[Path]:
    """Modules of a package, without importing them."""
    folders = find_spec(package).submodule_search_locations
    return sorted(p for folder in folders for p in Path(folder).glob("*.py") if p.stem[0] != "_")


# check and warm


def _check(options: argparse.Namespace) -> int:
    from sebody.studies.check import check_kernels, format_table

    rows = check_kernels(options.kernels or None)
    print(format_table(rows))
    return 0 if all(row.passed for row in rows) else 1


def _bench(options: argparse.Namespace) -> int:
    from sebody.studies import bench

    rate = bench.machine_rate()
    found = bench.measure(options.scenes)
    print(bench.to_json(found, rate) if options.json else bench.report(found, rate))
    return 0


def _chart(options: argparse.Namespace) -> int:
    from sebody.studies import chart

    if options.output:
        from sebody.results.plots import check_picture
        check_picture(options.output)
    if options.csv:
        check_target(options.csv, "table")
    points, exact = chart.measure(options.scene)
    print(chart.report(options.scene, points, exact))
    if options.csv:
        chart.write_csv(points, options.csv)
        print(f"table: {options.csv}")
    if options.output:
        chart.draw(options.scene, points, chart.front(chart.own(points)), exact.error,
                   options.output)
        print(f"picture: {options.output}")
    return 0


def _atlas(options: argparse.Namespace) -> int:
    from sebody.studies import atlas

    if options.output:
        from sebody.results.plots import check_picture
        check_picture(options.output)
    atlas.check_names(options.cases)
    findings = []
    for name in options.cases or atlas.CASES:
        findings.append(atlas.explore(name))
        print(f"{name}: {atlas.report(findings[-1])}\n", flush=True)
    if options.output:
        atlas.draw(findings, options.output)
        print(f"picture: {options.output}")
    return 0 if all(row.passed for f in findings for row in f.rows) else 1


def _warm(options: argparse.Namespace) -> int:
    began = time.perf_counter()
    names = [kernel.name for kernel in sorted(kernels(), key=lambda kernel: -kernel.size)]
    with ProcessPoolExecutor(PROCESSES) as pool:
        time_loop = pool.submit(_compile_loop)      # what takes longest comes first
        for name, seconds in zip(names, pool.map(_compile, names), strict=True):
            print(f"  {name:44} {seconds:6.1f} s", flush=True)
        print(f"  {'time loop':44} {time_loop.result():6.1f} s")
    print(f"{len(names)} kernels and the time loop are compiled: "
          f"{time.perf_counter() - began:.1f} s")
    return 0


def _compile(name: str) -> float:
    """Import a kernel, which compiles it or reads it from Numba's cache."""
    from sebody.kernels.loader import load

    began = time.perf_counter()
    load(name)
    return time.perf_counter() - began


def _compile_loop() -> float:
    """Run a short spatial and a short planar scene, with what their summaries need."""
    from sebody.analysis.simulation import simulate
    from sebody.kernels.loader import without_collector
    from sebody.scenes import hinged_beam, planar_hinged_beam

    began = time.perf_counter()
    with without_collector():
        for scene in (hinged_beam, planar_hinged_beam):
            simulate(scene.build(elements=4).model, 0.01, 0.02).summary()
    return time.perf_counter() - began
