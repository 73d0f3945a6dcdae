"""One small file of every kind that is read, and how it is read."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from malformed import fe_files, file_cases
from scipy import sparse

from sebody import Model, Result, Simulation, simulate
from sebody.analysis import resume, save_state
from sebody.cli import scene_files
from sebody.cli.scene_arguments import checked_scene
from sebody.explore.ensembles import final
from sebody.explore.sweep import Table, sweep
from sebody.explore.sweep.variations import distribution
from sebody.fem import Section, planar_beam
from sebody.io import import_body, load_body, save_body, write_sid
from sebody.reduction import craig_bampton
from sebody.verify.chart import references

SECTION = Section(area=2.0, inertia_y=0.3, inertia_z=0.4, torsion=0.2, youngs_modulus=1e4,
                  poisson_ratio=0.25, density=1.5)
SCENE = '''"""A ball."""
from sebody import Model
from sebody.scenes.scene import Scene


def build(mass=2.0, push=1.0):
    model = Model(planar=True)
    model.node("ball", (1.0, 0.0))
    model.rigid_body("body", "ball", mass, 1.0)
    model.force("ball", (push, 0.0))
    return Scene("ball", "a ball", model, 0.1, 1.0, base="ball", tip="ball")
'''


class Kind(NamedTuple):
    """A kind of file.

    Parameters
    ----------
    make : function
        Writes files to a folder, and returns the one that is named to the program.
    read : function
        What the program makes of it, as nested arrays and texts.
    exact : bool
        Whether checksums tell that anything changed; of files of other programs a digit may.
    needs : str
        Package that reads it.
    """

    make: Callable[[Path], Path]
    read: Callable[[Path], Any]
    exact: bool = True
    needs: str = ""


def body():
    """A planar beam with everything a body file can have."""
    model = planar_beam((1, 2), (4, 3), SECTION, 5)
    return craig_bampton(model, {0: "full", 3: "translation", 5: "rotation"}, 2).damped(0.02)


def mechanism() -> Model:
    """A beam on a hinge with a spring, a load and a drive: some of all that a file describes."""
    model = Model(planar=True)
    base, tip = model.node("base", (0.0, 0.0)), model.node("tip", (2.0, 0.0))
    model.beam("rod", [base, tip], SECTION, elements=4, bodies=1, modes=1)
    model.revolute(base, name="hinge")
    model.drive_angle(base, [(0, 0), (1, 0.1), (2, 0.2)], name="motor")
    model.point_mass("weight", model.node("weight", (2.5, 0.5), keeps="translation"), 0.5)
    model.spring("weight", tip, 5.0)
    model.force(tip, (0.0, 1.0), [(0, 0.0), (1, 2.0)], name="push")
    return model


def ball_scene(mass: float = 2.0, push: float = 1.0):
    """What the file of a scene builds."""
    namespace: dict = {}
    exec(SCENE, namespace)
    return namespace["build"](mass, push)


def _body(folder: Path) -> Path:
    return save_body(body(), folder / "body.npz", ("a", "b", "c"), units="m, kg, s",
                     provenance={"source": "here"})


def _result(name: str, folder: Path) -> Path:
    return simulate(mechanism(), 0.05, 0.2).save(folder / name)


def _restart(folder: Path) -> Path:
    return save_state(Simulation(mechanism(), 0.05).run_to(0.2), folder / "state.npz")


def _table(folder: Path) -> Path:
    sweep(ball_scene, {"end": final("ball.position")}, sampled={
        "push": distribution("normal", (1.0, 0.1), "push")}, runs=3, fixed={"t_end": 0.2},
        output=folder / "table.npz", threads=1)
    return folder / "table.npz"


def _reference(folder: Path) -> Path:
    np.savez_compressed(folder / "reference.npz", values=np.arange(40.0).reshape(20, 2),
                        error=1e-5)
    return folder / "reference.npz"


def _scene_file(folder: Path) -> Path:
    (folder / "ball.py").write_text(SCENE)
    return folder / "ball.py"


def generated(folder: Path) -> Path:
    """A block as Abaqus writes its matrices, with labels, beside its deck."""
    fe_files.calculix(folder)
    (folder / "se.inp").rename(folder / "job.inp")
    for name, matrix in (("STIF1", fe_files.BLOCK.stiffness), ("MASS1", fe_files.BLOCK.mass)):
        entries = sparse.coo_array(sparse.tril(matrix))
        lines = [f"{fe_files.LABELS[i // 3]},{i % 3 + 1}, {fe_files.LABELS[j // 3]},{j % 3 + 1}"
                 f", {value:.15e}" for i, j, value in zip(*entries.coords, entries.data,
                                                         strict=True)]
        (folder / f"job_{name}.mtx").write_text("\n".join(lines) + "\n")
    return folder / "job_STIF1.mtx"


def _sid(folder: Path) -> Path:
    model = fe_files.BLOCK
    left, right = (np.flatnonzero(np.isclose(model.coordinates[:, 0], x)) for x in (0, 3))
    from sebody.reduction import RigidFace
    faces = [(RigidFace((x, 0.5, 0.5), nodes), "full") for x, nodes in ((0, left), (3, right))]
    return write_sid(craig_bampton(model, faces, 1), folder / "body.SID_FEM")


def _imported(interfaces: dict, modes: int, path: Path) -> Any:
    return plain(import_body(path, interfaces, modes))


def _run_of_result(path: Path) -> Any:
    found = Result.load(path)
    names = ("t", "tip.position", "motor.torque", "energy.kinetic", "rod.tip.force")
    return [found[name] for name in names], found.summary(), found.rows


def _resumed(path: Path) -> Any:
    run = resume(mechanism(), path)
    return {name: getattr(run.state, name) for name in type(run.state).__annotations__}


def _table_of(path: Path) -> Any:
    found = Table.load(path)
    return found.parameters, found.outputs, found.design, found.done, list(found.failures)


def _built(path: Path) -> Any:
    module = scene_files.load(str(path))
    scene = checked_scene(scene_files.call(str(path), module.build), path.name)
    return {name: node.point for name, node in scene.model.nodes.items()}


def plain(value: Any) -> Any:
    """An object as nested dicts, lists and arrays."""
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return {k: plain(v) for k, v in value.items()} if isinstance(value, dict) else value


def same(one: Any, other: Any) -> bool:
    """Whether two of these are the same, bit for bit."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.shape == other.shape and (
            one.tobytes() == other.tobytes() if one.dtype != object else list(one) == list(other))
    return json.dumps(one, default=str) == json.dumps(other, default=str)


KINDS = {
    "body": Kind(_body, lambda path: plain(load_body(path))),
    "result": Kind(partial(_result, "run.npz"), _run_of_result),
    "result hdf5": Kind(partial(_result, "run.h5"), _run_of_result, needs="h5py"),
    "restart": Kind(_restart, _resumed),
    "sweep table": Kind(_table, _table_of),
    "reference": Kind(_reference, references.kept),
    "scene": Kind(_scene_file, _built, exact=False),
    "calculix": Kind(fe_files.calculix, partial(_imported, file_cases.FACES, 2), exact=False),
    "matrix-market": Kind(fe_files.matrix_market, partial(
        _imported, {"a": 10, "b": 40, "c": 160}, 2), exact=False),
    "substructure": Kind(fe_files.substructure, partial(_imported, {}, 0), exact=False),
    "generated": Kind(generated, partial(_imported, file_cases.FACES, 2), exact=False),
    "op4": Kind(fe_files.op4, partial(_imported, {}, 0), exact=False, needs="pyyeti"),
    "sid": Kind(_sid, partial(_imported, {}, 0), exact=False),
}
