"""The compiler and linker for C, of the package ziglang."""

import os
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from sebody.basics.errors import InputError, WriteError
from sebody.export.platforms import PLATFORMS

SOURCES = Path(__file__).with_name("c")


def check_installed() -> None:
    """Refuse an export without the linker.

    Raises
    ------
    InputError
        The package is not installed.
    """
    if find_spec("ziglang") is None:
        raise InputError("export needs the package ziglang, which compiles and links C for all "
                         'platforms: pip install "sebody[fmu]"')


def link(folder: Path, target: Path, platform: str, objects: Sequence[Path],
         sources: Sequence[str]) -> None:
    """Link object files and sources in C to a library without symbols but those it exports.

    Parameters
    ----------
    folder : Path
        Has headers, and takes the files of the linker.
    sources : sequence of str
        Files of `SOURCES`.

    Raises
    ------
    WriteError
        The linker failed: its first lines are in the message.
    """
    own = PLATFORMS[platform]
    call("-target", own.target, "-shared", *["-fPIC"] * (own.suffix != ".dll"),
         "-fvisibility=hidden", "-s", "-o", target, *objects,
         *(SOURCES / name for name in sources), f"-I{folder}", f"-I{SOURCES}", "-lm",
         folder=folder)


def call(*arguments: str | Path, folder: Path) -> None:
    """Call the compiler for C.

    Raises
    ------
    WriteError
        It failed.
    """
    command = [sys.executable, "-m", "ziglang", "cc", "-O2", "-g0", *map(str, arguments)]
    variables = {**os.environ, "ZIG_LOCAL_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run(command, capture_output=True, text=True, env=variables)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        raise WriteError("the library cannot be linked: " + " ".join(lines[:5])[:600])
