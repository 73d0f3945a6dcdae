"""Kernels as C, compiled where a compiler is found, and called with the arguments of a case."""

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

from sebody.contract.layout import ACCELERATION, ENERGY, OK, RESIDUAL, TANGENT, VELOCITY
from sebody.verify.check.elements import element_case
from sebody.verify.check.states import arguments, called

COMPILER = next((found for name in (os.environ.get("CC", "cc"), "gcc", "clang")
                 if (found := shutil.which(name))), None)
FACTORS = (0.7, 0.4, 1.3, 1, 0.9)
TASKS = RESIDUAL, TANGENT, ENERGY, VELOCITY, ACCELERATION


def compiled(text: str, folder: Path) -> ctypes.CDLL:
    """A library; whatever the compiler remarks is an error, but for arguments not used."""
    source, library = folder / "kernels.c", folder / "kernels.so"
    source.write_text(text)
    checked(source, "-O2", "-shared", "-fPIC", "-o", str(library), "-lm")
    return ctypes.CDLL(str(library))


def checked(source: Path, *options: str) -> None:
    """Run the compiler, with warnings as errors."""
    done = subprocess.run(
        [COMPILER, "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter",
         str(source), *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def largest_difference(function, module, seed: int) -> float:
    """Of everything a C function and a compiled kernel write, in all tasks, over the largest."""
    function.restype, worst = ctypes.c_int64, 0.0
    case = element_case(module, seed)
    random = np.random.default_rng(seed)
    for task in TASKS:
        mine, other = (arguments(case, FACTORS) for _ in range(2))
        T = mine.T + 0.2 * random.normal(size=mine.T.shape)
        mine, other = mine._replace(T=T), other._replace(T=T)
        status = function(task, *map(ctypes.c_int64, (1, len(case.index), case.n)),
                          *(ctypes.c_void_p(array.ctypes.data) for array in mine))
        assert status == called(case, task, other) == OK
        for name in ("forces", "matrices", "energies"):
            a, b = getattr(mine, name), getattr(other, name)
            worst = max(worst, np.abs(a - b).max() / max(np.abs(b).max(), 1.0))
    return worst
