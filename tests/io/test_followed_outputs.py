"""Output matrices of bodies in sensors, linear responses, gradients, exports; with a base."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import final, frequency_response, gradient, modes
from sebody.export.outputs import Quantities
from sebody.fem import hexahedral_block
from sebody.io import read_body_file, save_body
from sebody.io.body_file import body_parts
from sebody.io.importing import _grounded
from sebody.quantities.reading import evaluate_loaded
from sebody.reduction import RigidFace, craig_bampton, grounded_body

FE = hexahedral_block((1, 2, 3), (4, 1, 1), (4, 2, 2), 2e7, 0.3, 2e3)
INNER = int(np.flatnonzero(np.isclose(FE.coordinates[:, 0], 3.0))[1])
TURN = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])
MOVED, STRESS = "block.MUG1.values", "block.OTM.values"


@pytest.fixture(scope="module")
def body():
    """With displacements of an inner node, and stresses in two elements, as output matrices."""
    faces = [RigidFace((x, 2.5, 3.5), np.flatnonzero(np.isclose(FE.coordinates[:, 0], x)))
             for x in (1, 5)]
    own = craig_bampton(FE, [(face, "full") for face in faces], 4)
    n = len(own.mass)
    moved = own.recovery.shapes[:, :n].reshape(len(FE.coordinates), 3, n)
    stress, = own.recovery.stress
    return replace(own, outputs={
        "MUG1": moved[INNER], "OTM": stress.stress(moved, np.array([3, 9])).reshape(-1, n)})


def hanging(body, amplitude=2e4, held=False):
    """Placed along other axes, on a hinge or held, with a load that turns it far."""
    model = Model()
    for name, point in zip(("root", "tip"), body.coordinates @ TURN.T, strict=True):
        model.node(name, point)
    model.superelement("block", body, ["root", "tip"], rotation=TURN)
    if held:
        model.fix("root")
    else:
        model.revolute("root", axis=(1, 0, 2))
    model.force("tip", (1, 2, -1), amplitude, name="push")
    return model


def test_sensors_and_compiled_readings_have_the_values_of_results(body):
    model = hanging(body)
    model.sensor("gauge", f"{STRESS}.4", rate=100.0)
    result = simulate(model, 0.01, 0.3)
    size = np.abs(result[STRESS]).max()
    assert np.ptp(result[f"{STRESS}.4"]) > 1e-3 * size
    assert_allclose(result["gauge.value"], result[f"{STRESS}.4"], atol=1e-12 * size)
    run = Simulation(hanging(body), 0.01).run_to(0.3)
    assert_allclose(run.read(STRESS), result[STRESS][-1], atol=1e-12 * size)
    quantities = Quantities(run.model, run.numbering, run.system, run.state)
    names = quantities.names([MOVED])
    assert names == [f"{MOVED}.{k}" for k in range(3)]
    reading = quantities.made(names, [])
    evaluate_loaded(run.system, run.state, reading)
    assert_allclose(reading.values, result[MOVED][-1], atol=1e-12 * np.abs(result[MOVED]).max())


def test_linear_responses_hold_at_low_frequencies(body):
    """A cantilever's inner stresses of a slow load are those at rest."""
    run = Simulation(hanging(body, 0.0, held=True), 0.01)
    found = frequency_response(run, "push", [STRESS], [1e-3])
    y = np.zeros(len(body.mass))
    first = np.r_[3:6, 9:12, 12:16]             # tip's position and rotation, modes
    force = np.zeros(len(y))
    force[3:6] = TURN.T @ np.array([1.0, 2, -1])
    y[first] = np.linalg.solve(body.stiffness[np.ix_(first, first)], force[first])
    expected = body.outputs["OTM"] @ y
    assert_allclose(found[STRESS][0].real, expected, atol=1e-8 * np.abs(expected).max())


def test_gradients_are_those_of_differences(body):
    outputs = {"u": final(f"{MOVED}.1"), "s": final(f"{STRESS}.4")}
    found = gradient(hanging(body), 0.01, 0.2, outputs, ["push.amplitude"])
    rows = []
    for amplitude in (2e4 - 20.0, 2e4 + 20.0):
        result = simulate(hanging(body, amplitude), 0.01, 0.2)
        rows.append([result[f"{MOVED}.1"][-1], result[f"{STRESS}.4"][-1]])
    slope = (np.array(rows[1]) - rows[0]) / 40.0 * 2e4      # by a factor of the amplitude
    own = np.ravel([found.of(name, "push.amplitude") for name in outputs])
    assert_allclose(own, slope, rtol=1e-5)      # of the square of 1e-3, and of Newton's tolerance


def test_shapes_have_no_outputs_and_say_so(body):
    model = hanging(body, 0.0)
    with pytest.raises(InputError, match=f"'{MOVED}' has no shape: there are <node>.position"):
        modes(Simulation(model, 0.01)).shape(MOVED)


def test_outputs_stay_with_a_base(body, tmp_path):
    """Rows of a held structure are of motion relative to its base, wherever that moves."""
    rows = np.r_[3:6, 9:12, 12:16]      # the second interface, and the modes
    held = {name: matrix[:, rows] for name, matrix in body.outputs.items()}
    K, M = (matrix[np.ix_(rows, rows)] for matrix in (body.stiffness, body.mass))
    base, tip = body.coordinates
    made = grounded_body(K, M, [tip], modes=4, base=base, outputs=held)
    again = read_body_file(save_body(made, tmp_path / "held.npz"))
    y = np.random.default_rng(3).normal(size=len(made.mass))
    # the order of a body: the tip comes first
    own = y[np.r_[3:6, 0:3, 9:12, 6:9, 12:16]]
    relative = own - body.rigid_modes_about(base) @ own[np.r_[:3, 6:9]]
    for name, matrix in body.outputs.items():
        assert_allclose(made.outputs[name] @ y, matrix @ relative,
                        atol=1e-9 * np.abs(matrix).max())
        np.testing.assert_array_equal(again.body().outputs[name], made.outputs[name])
    plain = replace(again, parts={**body_parts(made), "stiffness": K, "mass": M, "base": None,
                                  "coordinates": tip[None], "keeps": ("full",), "outputs": held},
                    names=("tip",))
    found = _grounded(plain, base)
    for name in held:
        assert_allclose(found.parts["outputs"][name], made.outputs[name], atol=1e-12)
