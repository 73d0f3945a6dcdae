"""One grammar of quantities: of results, tables, plots, ensembles, sweeps, advice, responses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, simulate
from sebody.analysis import Ensemble, advise, final, frequency_response, maximum, modes, rms
from sebody.cli.entry import main
from sebody.explore.sweep import sweep
from sebody.fem import rectangle, straight_beam
from sebody.pictures.drawing import plot
from sebody.quantities.names import split
from sebody.reduction import ReducedBody, craig_bampton
from sebody.results.naming import component_names, values
from sebody.scenes import planar_hinged_beam

SECTION = rectangle(0.1, 0.05, youngs_modulus=2e9, poisson_ratio=0.3, density=1000.0)
ENDS = np.array([[0.2, -0.1, 0.3], [1.2, 0.4, 0.1]])


def build():
    """A beam with stresses on a hinge about a slant axis, at its tip a weight and a dotted name."""
    model = Model()
    base, tip = model.node("base", ENDS[0]), model.node("arm.tip", ENDS[1])
    body = craig_bampton(straight_beam(*ENDS, SECTION, 6), [(0, "full"), (6, "full")], modes=3)
    model.superelement("rod", body, [base, tip])
    model.rigid_body("weight", tip, 2.0, (0.1, 0.2, 0.2))
    model.revolute(base, axis=(0.3, -0.4, 1.0), name="hinge")
    model.gravity((0, 0, -9.81))
    model.force(tip, (1.0, 2.0, -1.0), 0.5, name="push")
    return model


@pytest.fixture(scope="module")
def result():
    return simulate(build(), 0.01, 0.5)


@pytest.mark.parametrize("name", ["arm.tip.position", "arm.tip.angular_velocity", "hinge.force",
                                  "rod.arm.tip.moment", "momentum", "rod.node3.displacement"])
def test_components_of_vectors(result, name):
    whole = result[name]
    assert whole.shape == (len(result.t), 3)
    for k, letter in enumerate("xyz"):
        assert np.array_equal(result[f"{name}.{letter}"], whole[:, k])
    assert result[f"{name}.norm"] == pytest.approx(np.linalg.norm(whole, axis=1), rel=1e-14)
    assert split(result, f"{name}.y") == (name, ["y"])


def test_components_of_everything_else(result):
    R = result["arm.tip.rotation"]
    assert np.array_equal(result["arm.tip.rotation.zx"], R[:, 2, 0])
    vectors = np.unwrap(np.linalg.norm(Rotation.from_matrix(R).as_rotvec(), axis=1))
    assert result["arm.tip.rotation.norm"] == pytest.approx(vectors, abs=1e-12)
    assert np.linalg.norm([result[f"arm.tip.rotation.{x}"] for x in "xyz"], axis=0) == (
        pytest.approx(vectors, abs=1e-12))
    assert np.array_equal(result["rod.modes.2"], result["rod.modes"][:, 2])
    assert np.array_equal(result["rod.forces.7"], result["rod.forces"][:, 7])
    stress = result["rod.node3.stress"]
    assert np.array_equal(result["rod.node3.stress.zx"], stress[:, 4])
    inner = result["rod.node3.section_forces"]
    assert inner.shape[2] == 6
    assert np.array_equal(result["rod.node3.section_forces.1.5"], inner[:, 1, 5])
    energy = result["energy"]
    assert energy.shape == (len(result.t), 4)
    assert np.array_equal(energy[:, 1], result["energy.strain"])
    assert np.array_equal(result["constraints.norm"], np.linalg.norm(result["constraints"], axis=1))


def test_rotations_go_on_through_full_turns():
    model = Model()
    model.rigid_body("top", model.node("o", (0, 0, 0)), 1.0, (1.0, 1.0, 2.0))
    model.fix("o", "position")
    model.initial_velocity("o", angular=(0, 0, 20.0))
    found = simulate(model, 0.01, 1.0)
    assert found["o.rotation.z"][-1] == pytest.approx(20.0, rel=1e-6)
    assert found["o.rotation.norm"][-1] == pytest.approx(20.0, rel=1e-6)


def test_in_a_plane():
    found = simulate(planar_hinged_beam.build().model, 0.01, 0.2)
    assert np.array_equal(found["tip.position.y"], found["tip.position"][:, 1])
    assert np.array_equal(found["momentum.x"], found["momentum"][:, 0])
    for name, said in (("tip.position.z", "tip.position has the components x, y, norm"),
                       ("tip.rotation.x", "tip.rotation is one number, it has no components")):
        with pytest.raises(InputError, match=f"{name} is unknown: {said}"):
            found[name]


def test_every_name_is_in_and_can_be_asked_for(result, tmp_path):
    names = result.names()
    assert list(result) == names and len(set(names)) == len(names)
    assert {"t", "arm.tip.position", "hinge.force", "push.work", "rod.modes"} <= set(names)
    loaded = Result.load(result.save(tmp_path / "arm.npz"))
    assert loaded.names() == names
    for name in names:
        assert name in result and len(result[name]) == len(result.t)
        for label in component_names(result[name], name):
            if label:
                assert f"{name}.{label}" in result
                assert np.array_equal(loaded[f"{name}.{label}"], result[f"{name}.{label}"])
    for name in ("arm.tip.position.norm", "rod.node3.von_mises", "energy", "energy.norm"):
        assert name in result and name in loaded
    for name in ("arm.tip", "tip.position", "arm.tip.position.w", "rod.node99.stress", "", None, 3,
                 "rod.modes.3", "base.reaction.x.x", "arm.tip.reaction", "t.x"):
        assert name not in result


@pytest.mark.parametrize("name, said", [
    ("arm.tip.positon.y", "'arm.tip.positon.y' is unknown: did you mean 'arm.tip.position.y'"),
    ("Arm.Tip.Position", "did you mean 'arm.tip.position'"),
    ("hinge.forces", "did you mean 'hinge.force'"),
    ("arm.tip.position.w", r"arm.tip.position.w is unknown: arm.tip.position has the components x, "
                           "y, z, norm"),
    ("arm.tip.rotation.w", "has the components x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz, norm"),
    ("rod.modes.3", "rod.modes has the components 0, 1, 2, norm"),
    ("t.x", "t.x is unknown: t is one number, it has no components"),
    ("energy.kinetc", "did you mean 'energy.kinetic'"),
    ("rod.von_mises", r"'rod.von_mises' is unknown: it is a quantity of FE nodes, such as "
                      r"'rod.node0.von_mises'; for all FE nodes at one time use "
                      r"result.field\('rod'\).von_mises\(t=...\); "
                      r"the largest over the run result.field\('rod'\)."
                      r"envelope\('von_mises'\)"),
    ("rod.strain", r"as in 'rod.node0.stress'|result.field\('rod'\).strain"),
    ("weight.von_mises", "a body has modes, mode_rates, forces")])
def test_unknown_names_say_what_was_meant(result, name, said):
    with pytest.raises(InputError, match=said):
        result[name]


def test_of_a_body_without_its_mesh_the_message_says_what_to_do():
    model = Model()
    bare = build().bodies["rod"].reduced
    body = ReducedBody(bare.stiffness, bare.mass, bare.coordinates, bare.keeps, bare.modes)
    model.superelement("rod", body, [model.node("base", ENDS[0]), model.node("tip", ENDS[1])])
    with pytest.raises(InputError, match="'rod' was reduced without the shapes of its FE model"):
        simulate(model, 0.01, 0.01)["rod.von_mises"]


def test_tables_have_the_names_of_components(result):
    pytest.importorskip("pandas")
    table = result.to_pandas(result.names())
    for name in table.columns:
        assert np.array_equal(table[name].to_numpy(), result[name]), name
    assert np.array_equal(result.to_pandas(["arm.tip.position.y"])["arm.tip.position.y"],
                          result["arm.tip.position.y"])


def test_data_sets_too(result):
    pytest.importorskip("xarray")
    found = result.to_xarray(["arm.tip.position", "arm.tip.position.y", "arm.tip.rotation.z",
                              "rod.modes"])
    assert found["arm.tip.position.y"].attrs["units"] == "length"
    assert found["arm.tip.rotation.z"].attrs["units"] == "rad"
    assert found["rod.modes"].dims == ("t", "number_3")


def test_plots_take_whatever_results_do(result):
    pytest.importorskip("matplotlib")
    words = ["arm.tip.position.y", "rod.node3.section_forces.1.5", "arm.tip.rotation.norm",
             "arm.tip.position.x:y", "energy"]
    figure = plot(result, *words)
    for axes, word in zip(figure.axes, words, strict=True):
        if ":" not in word and word != "energy":
            assert np.array_equal(axes.lines[0].get_ydata(), result[word])
    assert [label for label in values(result, "energy").labels] == [
        "kinetic", "strain", "potential", "external work"]


def test_ensembles_and_sweeps_take_them(result, tmp_path, capsys):
    ensemble = Ensemble(build(), 0.01)
    outcome = ensemble.run({"weight.mass": np.array([1.0, 1.5])}, 0.5, {
        "y": "arm.tip.position.y", "end": final("arm.tip.position.y"),
        "lift": maximum("hinge.force.norm"), "turn": rms("arm.tip.rotation.z"),
        "energy": final("energy")})
    assert outcome["y"][0] == pytest.approx(result["arm.tip.position.y"], abs=1e-9)
    assert outcome["end"][0] == pytest.approx(result["arm.tip.position"][-1, 1], abs=1e-9)
    assert outcome["lift"][0] == pytest.approx(result["hinge.force.norm"].max(), rel=1e-9)
    assert outcome["energy"].shape == (2, 4)
    assert main(["sweep", "planar-hinged-beam", "--t-end", "0.1", "--vary", "modes=1,2", "--keep",
                 "maximum(tip.position.y)", "--output", str(tmp_path / "table")]) == 0
    with np.load(tmp_path / "table.npz", allow_pickle=False) as table:
        assert any("maximum(tip.position.y)" in name for name in table.files)
    with pytest.raises(InputError, match="did you mean 'tip.position.y'"):
        sweep(planar_hinged_beam.build, {"y": final("tip.positoin.y")}, {"modes": [1, 2]},
              fixed={"t_end": 0.1})


def test_frequency_responses_take_them(result):
    model = build()
    model.gravity((0, 0, 0))
    model.torsion_spring("base", 500.0, 5.0, axis=(0.3, -0.4, 1.0))
    state = simulate(model, 0.01, 0.01)
    omega = np.array([3.0, 40.0, 300.0])
    names = ["arm.tip.position", "arm.tip.position.y", "hinge.force", "hinge.force.z"]
    found = frequency_response(state, "push", names, omega)
    assert found["arm.tip.position.y"] == pytest.approx(found["arm.tip.position"][:, 1], rel=1e-6)
    assert found["hinge.force.z"] == pytest.approx(found["hinge.force"][:, 2], rel=1e-6)
    shapes = modes(state)
    assert np.array_equal(shapes.shape("arm.tip.position.y"), shapes.shape("arm.tip.position")[1])
    with pytest.raises(InputError, match="arm.tip.position has the components x, y, z, norm"):
        shapes.shape("arm.tip.position.w")


def test_advice_keeps_a_component():
    """Of a spatial model, for which planar models are candidates."""
    model = Model()
    ends = model.node("base", (0, 0, 0)), model.node("tip", (1.0, 0, 0))
    model.beam("beam", ends, SECTION, 4, 1, modes=2)
    model.revolute("base", name="hinge")
    model.torque("base", (0, 0, 1), [(0, 0), (0.1, 20.0), (0.2, 0.0)])
    advice = advise(model, 0.005, 0.2, ["tip.position.y", "tip.rotation.z"], 0.05)
    assert advice.error <= 0.05
    with pytest.raises(InputError, match="did you mean 'tip.position.y'"):
        advise(model, 0.005, 0.2, "tip.positon.y", 0.05)
