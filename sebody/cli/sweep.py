"""``sebody sweep``: many runs of a scene over lists and distributions of its parameters."""

import argparse
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sebody.basics.errors import InputError
from sebody.cli import interrupts
from sebody.cli.number_arguments import real, whole
from sebody.cli.scene_arguments import build_scene, check_picture, given_arguments, source

if TYPE_CHECKING:
    from sebody.explore.ensembles import Output
    from sebody.explore.sweep import Table

KEEP = re.compile(r"^(\w+)\((norm )?([^,]+)(?:,(.+))?\)$")


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "sweep", help="run a scene for lists and distributions of parameters")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene or a file, FILE.py")
    parser.add_argument("--vary", action="append", default=[], metavar="NAME=VALUES",
                        help="values 1,2,5 or 0:8 or 0:1:0.25, ends included; all combinations "
                             "are run")
    parser.add_argument("--sample", action="append", default=[], metavar="NAME=DISTRIBUTION",
                        help="normal(mean,deviation), uniform(low,high), loguniform(low,high), "
                             "triangular(low,mode,high)")
    parser.add_argument("--runs", type=whole, metavar="N", help="number of random samples")
    parser.add_argument("--seed", type=whole, default=0, metavar="S", help="seed of the samples")
    parser.add_argument("--sampler", choices=("lhs", "sobol", "random"), default="lhs",
                        help="Latin hypercube (default), Sobol sequence or independent samples")
    parser.add_argument("--sobol", type=whole, metavar="N",
                        help="compute Sobol indices from N (parameters + 2) runs")
    parser.add_argument("--keep", action="append", default=[], metavar="KIND(QUANTITY)",
                        help="output of every run: maximum(tip.position), minimum, rms, integral, "
                             "final, at_time(QUANTITY,T); maximum(norm ...) is of the vector "
                             "length")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="a parameter of the scene that does not vary")
    parser.add_argument("--t-end", type=real, metavar="T", help="end time, the scene's by default")
    parser.add_argument("--step", type=real, metavar="H", help="time step, the scene's by default")
    parser.add_argument("--equilibrium", action="store_true",
                        help="start every run from the equilibrium under gravity and the loads of "
                             "t = 0; parameters are arguments of build then")
    parser.add_argument("--output", type=Path, metavar="SWEEP",
                        help="write SWEEP.npz, SWEEP.csv or, with pandas, .parquet, and with "
                             "matplotlib SWEEP.png; an interrupted sweep continues from SWEEP.npz")
    parser.add_argument("--threads", type=whole, metavar="N",
                        help="number of threads (default: one per processor)")
    parser.add_argument("--workers", type=whole, metavar="N",
                        help="number of processes, instead of threads")
    parser.add_argument("--cluster", metavar="ADDRESS", help="address of a Dask scheduler")
    return parser


def run(options: argparse.Namespace) -> int:
    """Run the sweep; 1 if all of its runs fail."""
    from sebody.basics.progress import Progress
    from sebody.explore.sweep import sobol, sweep
    from sebody.explore.sweep.variations import distribution_of, values_of

    build, _, _ = source(options.scene)
    listed = _by_name("--vary", map(values_of, options.vary))
    sampled = _by_name("--sample", map(distribution_of, options.sample))
    stem = options.output and (options.output.with_suffix("") if options.output.suffix == ".npz"
                               else options.output)
    if stem:
        check_picture(_beside(stem, ".png"))
    fixed = given_arguments(options.scene, build, options.changes)
    fixed |= {name: value for name in ("t_end", "step")
              if (value := getattr(options, name)) is not None}
    fixed |= {"equilibrium": True} if options.equilibrium else {}
    bar = Progress()

    def progress(part: float) -> None:
        bar(part)
        interrupts.look()

    with interrupts.held():
        try:
            table = sweep(build, _outputs(options.keep, build, options), listed, sampled,
                          options.runs, options.seed, options.sampler, options.sobol,
                          fixed,
                          stem and _beside(stem, ".npz"), options.threads, options.cluster,
                          options.workers, progress)
        except KeyboardInterrupt:
            if stem:
                print(f"{_beside(stem, '.npz')} holds the completed runs: repeat the command "
                      "to continue", file=sys.stderr)
            raise
        finally:
            bar.close()
        written = _written(table, stem) if stem else []
    print(table.summary())
    if options.sobol:
        print(sobol.report(sobol.indices(table, sampled, options.sobol), list(sampled)))
    for line in written:
        print(line)
    return int(not table.good.any())


def _by_name(option: str, pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Values of an option, each name once."""
    by_name: dict[str, Any] = {}
    for name, value in pairs:
        if name in by_name:
            raise InputError(f"{option} {name} is given twice: give it once, with all its values")
        by_name[name] = value
    return by_name


def _beside(stem: Path, suffix: str) -> Path:
    return stem.with_name(stem.name + suffix)


def _outputs(texts: Sequence[str], build, options: argparse.Namespace) -> "dict[str, Output]":
    """Outputs from texts; of none the final position of the scene's tip."""
    from sebody.explore import ensembles

    if not texts:
        scene = build_scene(options.scene, options.changes)
        quantity = f"{scene.tip}.position"
        return {f"final({quantity})": ensembles.final(quantity)}
    makers = {name: getattr(ensembles, name) for name in
              ("maximum", "minimum", "rms", "integral", "final", "at_time")}
    outputs = {}
    for text in texts:
        match = KEEP.match(text.strip())
        if not match or match[1] not in makers:
            raise InputError(f"cannot read --keep {text}: write KIND(QUANTITY), such as "
                             f"maximum(tip.position), of the kinds {', '.join(makers)}")
        kind, norm, quantity, time = match.groups()
        if (time is None) == (kind == "at_time"):
            raise InputError(f"--keep {text}: at_time takes a time, such as "
                             "at_time(tip.position,2.5), and the others take none")
        arguments = [quantity.strip()] + ([_time(text, time)] if time else [])
        outputs[text.strip()] = makers[kind](*arguments, norm=bool(norm))
    return outputs


def _time(text: str, time: str) -> float:
    try:
        return float(time)
    except ValueError as error:
        raise InputError(f"--keep {text}: {time.strip()!r} is not a time") from error


def _written(table: "Table", stem: Path) -> list[str]:
    """Write what the installed extras can; lines that name the files."""
    lines = [f"table: {path}" for path in (_beside(stem, ".npz"), _flat(table, stem))]
    try:
        from sebody.explore.sweep.picture import draw

        draw(table, _beside(stem, ".png"))
        lines.append(f"picture: {_beside(stem, '.png')}")
    except ImportError:
        print('no picture: pip install "sebody[plot]"', file=sys.stderr)
    return lines


def _flat(table: "Table", stem: Path) -> Path:
    """A Parquet file where pandas can write one, else CSV."""
    from sebody.basics.files import replacing

    try:
        frame, path = table.to_pandas(), _beside(stem, ".parquet")
        with replacing(path, "table") as file:
            frame.to_parquet(file)
    except (ImportError, InputError):       # it is not installed, or lacks what writes Parquet
        path = _beside(stem, ".csv")
        with replacing(path, "table") as file:
            file.write(table.to_csv().encode())
    return path
