"""Results read from files: they answer every question as the saved ones do."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, SimulationError, simulate
from sebody.assembly.build import build
from sebody.quantities.table import OF_MODEL, OWNERS
from sebody.results import save_picture
from sebody.results.description import described, restored
from sebody.scenes import chain, four_bar, heavy_top, hinged_beam, squeezer


def drag(t, positions, velocities, force):
    force[0] = -0.1 * velocities[0]


def dragged():
    """Functions, which no file can hold: of a force and of a load; a drive, a spring, a damper."""
    model = Model(planar=True)
    anchor = model.node("anchor", (0.0, 0.0), keeps="translation")
    model.move(anchor, (1.0, 0.0), [(0.0, 0.0), (1.0, 0.3), (2.0, 0.4)], name="motor")
    model.move(anchor, (0.0, 1.0), [(0.0, 0.0), (1.0, 0.2)])
    model.point_mass("weight", model.node("weight", (1.0, 0.5), keeps="translation"), 0.5)
    model.user_force("drag", ["weight"], drag)
    model.force("weight", (0.0, 1.0), lambda t: t * t)
    model.spring("weight", anchor, 3.0, damping=0.2)
    model.initial_velocity("weight", (2.0, 0.0))
    return model


SCENES = {"flexible": lambda: simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.2),
          "functions": lambda: simulate(dragged(), 0.1, 0.5),
          "loops": lambda: simulate(four_bar.build().model, 1e-3, 0.05, output_every=7),
          "spring": lambda: simulate(squeezer.build().model, 1e-5, 3e-4),
          "multipliers": lambda: simulate(heavy_top.build(explicit=True).model, 1e-3, 0.02)}


def answers(result):
    """Everything there is by name, with the messages where a name has no such quantity."""
    found = {}
    names = [f"{owner}.{quantity}" for kind in OWNERS for owner in kind.names(result)
             for quantity in kind.quantities]
    for name in ["nothing.position", *OF_MODEL, *names]:
        try:
            found[name] = result[name]
        except InputError as error:
            found[name] = str(error)
    return found


@pytest.mark.parametrize("scene", SCENES)
def test_a_result_from_a_file_knows_what_the_saved_one_knew(scene, tmp_path):
    saved = SCENES[scene]()
    saved.warnings += "a remark",
    path = saved.save(tmp_path / "result.npz")
    loaded = Result.load(path)
    expected, found = answers(saved), answers(loaded)
    assert list(found) == list(expected) and len(found) > 20
    for name, values in expected.items():
        assert np.array_equal(found[name], values), name
    assert loaded.summary() == saved.summary()
    assert loaded.energy_balance() == saved.energy_balance()
    assert loaded.start == saved.start and loaded.warnings == saved.warnings
    # and it can be saved again
    with np.load(path) as first, np.load(loaded.save(tmp_path / "again.npz")) as second:
        assert first.files == second.files
        assert [n for n in first.files if not np.array_equal(first[n], second[n])] == []


def test_a_file_holds_rotated_bodies_alone():
    """The body that they were made of serves runs, and a model from a file cannot be run."""
    body, model = chain.link_body(1, elements=4), Model()
    for k, angle in enumerate((0.4, -0.7)):
        turn = Rotation.from_rotvec([0.1, angle, 0.3]).as_matrix()
        ends = [model.node(f"{end} {k}", (0.2, 0.1, k) + x * turn[:, 0])
                for x, end in enumerate(("start", "end"))]
        model.superelement(f"link {k}", body, ends, rotation=turn)
    assert all(one.reduced.unrotated[0] is body for one in model.bodies.values())
    text, numbers = described(model, build(model)[1])
    parts = json.loads(text)
    assert [kind for kind, _ in parts["parts"]].count("ReducedBody") == 2
    made = restored(parts, numbers)[0]
    for name, one in model.bodies.items():
        found = made.bodies[name].reduced
        assert np.array_equal(found.mass, one.reduced.mass) and found.unrotated[0] is found


def test_failure_estimate_and_picture(tmp_path):
    scene = hinged_beam.build(modes=2, elements=4)
    scene.model.force("tip", (0, 0, 1e12), [(0.1, 0.0), (0.11, 1.0), (0.12, 0.0)])
    with pytest.raises(SimulationError) as caught:
        simulate(scene.model, 0.01, 0.5)
    caught.value.result.error = 0.25
    loaded = Result.load(caught.value.result.save(tmp_path / "kept.npz"))
    assert loaded.failure.startswith("stopped at t = 0.1") and loaded.error == 0.25
    assert save_picture(loaded, tmp_path / "kept.png", "base", "tip").stat().st_size > 10_000


def test_files_that_hold_no_result(tmp_path):
    with pytest.raises(InputError, match="none.npz does not exist: give one that was saved"):
        Result.load(tmp_path / "none.npz")
    path = hinged_result().save(tmp_path / "result.npz")
    data = path.read_bytes()
    at = data.index(b"sebody/rows.npy") + 500
    garbage = data[:at] + b"garbage" + data[at + 7:]
    for content in (b"", b"no zip", data[:len(data) // 2], garbage):
        (tmp_path / "other.npz").write_bytes(content)
        with pytest.raises(InputError, match="other.npz is damaged or no results file: give one "
                                             "written by Result.save"):
            Result.load(tmp_path / "other.npz")
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(tmp_path / "plain.npz", t=arrays["t"])
    with pytest.raises(InputError, match="plain.npz is damaged or no results file"):
        Result.load(tmp_path / "plain.npz")
    arrays["sebody/notes"] = np.array(json.dumps({"version": 0}))
    np.savez(tmp_path / "older.npz", **arrays)
    with pytest.raises(InputError, match="older.npz is of version 0, this program reads 8"):
        Result.load(tmp_path / "older.npz")


def hinged_result():
    return simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.05)
