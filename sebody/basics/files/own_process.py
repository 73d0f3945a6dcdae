"""Readers in a process of their own: those that end the whole process over a damaged file."""

import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError

MOST = 3600         # seconds
SAID = 3            # exit code of a reader that has said what is wrong


def read_in_own_process(module: str, path: Path, *arguments: str, remedy: str
                        ) -> dict[str, NDArray]:
    """Arrays that a module makes of a file, called by ``python -m`` with the file and a target.

    Raises
    ------
    InputError
        The reader fails, crashes or does not end.
    """
    with TemporaryDirectory() as folder:
        target = Path(folder) / "found.npz"
        command = [sys.executable, "-m", module, str(path), str(target), *arguments]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=MOST)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"{path} is damaged or of another kind (its reader does not end): "
                             f"{remedy}") from error
        if done.returncode == SAID:
            raise InputError(f"{path} is damaged or of another kind ({done.stderr.strip()}): "
                             f"{remedy}")
        if done.returncode:
            how = (f"crashed, {signal.Signals(-done.returncode).name}" if done.returncode < 0 else
                   f"ended with {done.returncode}: {done.stderr.strip()[-200:]}")
            raise InputError(f"{path} is damaged or of another kind (its reader {how}): {remedy}")
        with np.load(target, allow_pickle=False) as file:
            return dict(file)


def serve(read: Callable[..., Mapping[str, NDArray]]) -> None:
    """Do what `read_in_own_process` asks for, in the other process.

    Parameters
    ----------
    read : function
        Arrays by name, of the path of the file and the further arguments.
    """
    path, target, *arguments = sys.argv[1:]
    try:
        content = read(path, *arguments)
    except Exception as error:      # of many classes, of files that are cut off or of other kinds
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        raise SystemExit(SAID) from None
    np.savez(target, **content)
