"""``sebody export``: a scene as a library for C, or as an FMU."""

import argparse
import os
import sys
from pathlib import Path

from sebody.cli.number_arguments import real
from sebody.cli.scene_arguments import build_scene


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("export", help="export a scene as an FMU or a library for C")
    parser.add_argument("scene", metavar="SCENE",
                        help="name of a scene, see 'sebody list', or your own FILE.py")
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("--library", type=Path, metavar="DIR",
                        help="folder for a library, a C header and an example")
    target.add_argument("--fmu", type=Path, metavar="FILE.fmu", help="FMU for co-simulation")
    parser.add_argument("--inputs", type=_names, default=[], metavar="NAMES",
                        help="actuators, loads, drives and parameters that can be set, separated "
                             "by commas")
    parser.add_argument("--outputs", type=_names, default=[], metavar="NAMES",
                        help="quantities, such as tip.position,tip.velocity.x")
    parser.add_argument("--platforms", type=_names, default=[], metavar="NAMES",
                        help="linux-x86_64, windows-x86_64, macos-x86_64, macos-arm64, "
                             "linux-aarch64; this machine's by default")
    parser.add_argument("--processor", default="x86-64-v3", metavar="NAME",
                        help="oldest x86 processor it runs on: x86-64, x86-64-v2, x86-64-v3 "
                             "(default), native")
    parser.add_argument("--fmi", default="3.0", metavar="VERSION", help="3.0 (default) or 2.0")
    parser.add_argument("--step", type=real, metavar="H", help="time step, the scene's by default")
    parser.add_argument("--tolerance", type=real, metavar="E",
                        help="allowed error of a step, relative to the model's characteristic "
                             "length, and in radians: steps are chosen, --step is the output "
                             "interval")
    parser.add_argument("--equilibrium", action="store_true",
                        help="start from the equilibrium under gravity and the loads of t = 0")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    return parser


def run(options: argparse.Namespace) -> int:
    """Export, and say what was written."""
    _compile_for(options.processor)
    from sebody.export import export
    from sebody.runs.statics import equilibrium
    from sebody.runs.tolerance import Tolerance

    scene = build_scene(options.scene, options.changes)
    written = export(
        scene.model, scene.h if options.step is None else options.step, library=options.library,
        fmu=options.fmu, inputs=options.inputs, outputs=options.outputs, name=scene.name,
        t_end=scene.t_end, fmi=options.fmi, platforms=options.platforms,
        processor=options.processor,
        tolerance=None if options.tolerance is None else Tolerance(options.tolerance),
        start=equilibrium(scene.model) if options.equilibrium else None)
    for file in sorted(written.rglob("*")) if written.is_dir() else [written]:
        if file.is_file():
            print(f"{file}  {file.stat().st_size / 1000:.0f} kB")
    return 0


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _compile_for(processor: str) -> None:
    """Let Numba compile for the processor here, too: the state at the start has the same bits."""
    from sebody.export.platforms import PROCESSORS, environment

    if processor in PROCESSORS and "numba" not in sys.modules:
        os.environ.update(environment(processor))
