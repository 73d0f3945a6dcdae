"""References of a chart: nonlinear beams, extrapolated in the element length and in the step."""

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files import replacing
from sebody.basics.files.array_files import opened
from sebody.basics.files.members import Member, Table
from sebody.basics.warned import warn
from sebody.kernels.loader import user_directory
from sebody.runs.schemes import generalized_alpha
from sebody.runs.whole_runs import simulate
from sebody.verify.chart.cases import COARSEST, SCENES, builder

ELEMENTS = 24       # of the first run; the second has twice as many
FINER = 8           # scene's own step over that of the first run; twice that in the second
MEMBERS = {"values": Member((None, ...)), "error": Member((), least=0)}


class Reference(NamedTuple):
    """A time function on the grid of a chart and the estimate of its relative L2 error."""

    values: NDArray
    error: float


def reference(scene: str, folder: Path | None = None) -> Reference:
    """The reference of a scene, computed once and kept in the user's directory.

    Both errors are of second order, so a third of the change by halving is taken off; the estimate
    of what is left is the change that this makes.
    """
    folder = folder or user_directory().parent / "references"
    path = folder / f"{scene}-{_key(scene)}.npz"
    try:
        return kept(path)
    except InputError:      # none, or a damaged one
        pass
    coarse = history(scene, ELEMENTS, FINER)
    finer_beams = history(scene, 2 * ELEMENTS, FINER)
    finer_steps = history(scene, ELEMENTS, 2 * FINER)
    correction = (finer_beams - coarse) / 3 + (finer_steps - coarse) * 4 / 3
    values = finer_beams + correction
    computed = Reference(values, float(np.linalg.norm(correction) / np.linalg.norm(values)))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(path, "reference") as file:
            np.savez_compressed(file, values=computed.values, error=computed.error)
    except OSError as error:
        warn(f"the reference is computed again next time: {error}", RuntimeWarning)
    return computed


def kept(path: Path) -> Reference:
    """A reference that was kept.

    Raises
    ------
    InputError
        There is none, or it is damaged.
    """
    with opened(path, "reference", "remove it") as reader:
        table = Table(f"reference {path}", "remove it", MEMBERS).read(reader)
    return Reference(table["values"], float(table["error"]))


def history(scene: str, elements: int, finer: int) -> NDArray:
    """The compared quantity of nonlinear beams, on the grid of the chart.

    Their limit does not depend on the inertia option; B is the fastest.
    """
    built = builder(scene)(bodies=elements, modes=0, elements=elements, inertia="material")
    result = simulate(built.model, built.h / finer, built.t_end, generalized_alpha(0.9, 1e-9),
                      output_every=COARSEST * finer)
    return result[SCENES[scene]]


def _key(scene: str) -> str:
    """Changes with what the scene is."""
    built = builder(scene)()
    text = [built.h, built.t_end, ELEMENTS, FINER, COARSEST]
    text += [(load.name, [(k, np.asarray(v).tolist()) for k, v in load.constants.items()],
              load.time_function.times, load.time_function.pieces,
               load.time_function.waves) for load in built.model.loads]
    text += [b.reduced.stiffness.tobytes() + b.reduced.mass.tobytes()
             for b in built.model.bodies.values()]
    return hashlib.sha256(repr(text).encode()).hexdigest()[:12]
