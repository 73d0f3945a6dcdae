"""Motion of a model as a series of VTK files, for ParaView (extra ``vtk``)."""

from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.results.field import Field
from sebody.results.field_quantities import field_of
from sebody.results.recording import Recording

SERIES = "VTK series", (".pvd",)        # see `files.check_target`


class _Part(NamedTuple):
    """A superelement in the mesh."""

    field: Field
    cells: tuple[tuple[str, NDArray], ...]
    stressed: bool


def save_vtk(recording: Recording, path: str | Path, every: int = 1) -> Path:
    """Write ``NAME.pvd`` and, in a folder of that name, a file .vtu for every state.

    Points are in their places of the moment. Data of points: displacement (of deformation),
    velocity, and von Mises's stress where the FE models have one; body, the number of the
    superelement, or of none for the nodes of the model, which are vertices.

    Raises
    ------
    InputError
        See `check_series`; a number of states that is not positive.
    WriteError
        Writing fails; states that are written remain, with a series of them.
    """
    path = check_series(path)
    every = inputs.integer(every, "every", least=1)
    times = recording.recorded("t")[:, 0]
    if not len(times):
        raise InputError("the result has no recorded state: run the model first")
    parts = [_part(recording, name) for name, body in recording.model.bodies.items()
             if body.reduced.recovery is not None]
    folder = path.with_suffix("")
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file, so the states of VTK series {path} have no folder: "
                         "give another path")
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"folder {folder} of the VTK series cannot be made ({error.strerror}): "
                         "give another path") from error
    states = np.arange(0, len(times), every)
    written: list[tuple[float, str]] = []
    for state in states:
        name = f"{path.stem}_{state:06d}.vtu"
        _write_state(recording, parts, int(state), folder / name)
        written.append((times[state], f"{folder.name}/{name}"))
        if len(written) & (len(written) - 1) == 0:      # 1, 2, 4, ...: a run may be interrupted
            _write_index(path, written)
    _write_index(path, written)
    return path


def check_series(path: str | Path) -> Path:
    """The path of a series, refused before anything is computed for it.

    Raises
    ------
    InputError
        See `check_target`; meshio is missing.
    """
    path = check_target(path, *SERIES)
    if find_spec("meshio") is None:
        raise InputError('VTK files need meshio: pip install "sebody[vtk]"')
    return path


def _part(recording: Recording, name: str) -> _Part:
    field = field_of(recording, name)
    recovery = recording.model.bodies[name].reduced.recovery
    assert recovery is not None     # see `Field`
    return _Part(field, recovery.cells, bool(recovery.stress))


def _write_state(recording: Recording, parts: list[_Part], state: int, path: Path) -> None:
    from meshio import Mesh
    from meshio.vtu import write

    points, cells = [], []
    data: dict[str, list[NDArray]] = {name: [] for name in (
        "displacement", "velocity", "von_mises", "body")}
    first = 0
    for number, part in enumerate(parts):
        field, count = part.field, part.field.count
        points.append(_spatial(field.position(state)))
        data["displacement"].append(_spatial(field.displacement(state)))
        data["velocity"].append(_spatial(field.velocity(state)))
        data["von_mises"].append(field.von_mises(state) if part.stressed
                                 else np.full(count, np.nan))
        data["body"].append(np.full(count, number))
        cells += [(kind, nodes + first) for kind, nodes in part.cells]
        first += count
    nodes, velocities = _nodes(recording, state)
    points.append(nodes)
    cells.append(("vertex", first + np.arange(len(nodes))[:, None]))
    data["displacement"].append(np.zeros((len(nodes), 3)))
    data["velocity"].append(velocities)
    data["von_mises"].append(np.full(len(nodes), np.nan))
    data["body"].append(np.full(len(nodes), -1))
    mesh = Mesh(np.concatenate(points), cells,
                {name: np.concatenate(values) for name, values in data.items()})
    with replacing(path, SERIES[0]) as file:
        write(file.name, mesh)


def _nodes(recording: Recording, state: int) -> tuple[NDArray, NDArray]:
    """Places and velocities of the nodes of the model, (n, 3)."""
    numbering, parts = recording.numbering, []
    for node in recording.model.nodes.values():
        if node.position is not None and node.position in numbering.dof_blocks:
            first = numbering.dof_blocks[node.position]
            parts.append(np.arange(first, first + node.position.start.size))
    at = np.array(parts, dtype=int).reshape(-1, recording.model.dimension)
    q, v = (_spatial(recording.recorded(name)[state][at]) for name in "qv")
    return q, v


def _spatial(vectors: NDArray) -> NDArray:
    """Vectors (n, 3), with z = 0 in a plane."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def _write_index(path: Path, written: list[tuple[float, str]]) -> None:
    """The list of the files with their times, which ParaView opens."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for t, name in written:
        ElementTree.SubElement(collection, "DataSet", timestep=repr(float(t)), part="0", file=name)
    with replacing(path, SERIES[0]) as file:
        ElementTree.ElementTree(root).write(file, xml_declaration=True)
