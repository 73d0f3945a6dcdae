"""Arrays of a file read by ansys-mapdl-reader: run by `ansys` in a process of its own.

Its compiled part believes the counts in a file: a damaged one ends the process.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.files.own_process import serve


def read(path: str, what: str) -> dict[str, NDArray]:
    """Arrays of the matrices of a ``.full`` file, or of the mesh of another one."""
    return _matrices(path) if what == "matrices" else _mesh(path)


def _matrices(path: str) -> dict[str, NDArray]:
    from ansys.mapdl import reader

    full = reader.read_binary(path)
    if not hasattr(full, "load_km"):
        raise ValueError("no .full file")
    reference, *matrices = full.load_km(sort=True)
    values = {"reference": reference}
    for name, matrix in zip(("stiffness", "mass"), matrices, strict=True):
        whole = matrix.tocoo()
        values |= {f"{name}_rows": whole.row, f"{name}_columns": whole.col,
                   f"{name}_values": whole.data}
    return values


def _mesh(path: str) -> dict[str, NDArray]:
    from ansys.mapdl import reader

    file = (reader.Archive if path.endswith(".cdb") else reader.read_binary)(path)
    mesh = getattr(file, "mesh", file)      # results keep it there, archives are it
    elements = [np.asarray(element)[10:] for element in mesh.elem]
    sets: dict[str, Any] = getattr(mesh, "node_components", None) or {}
    return {"labels": np.asarray(mesh.nnum), "points": np.asarray(mesh.nodes)[:, :3],
            "elements": np.concatenate([np.zeros(0, dtype=int), *elements]),
            "ends": np.cumsum([len(one) for one in elements], dtype=int),
            **{f"set {name}": np.asarray(nodes) for name, nodes in sets.items()}}


if __name__ == "__main__":
    serve(read)
