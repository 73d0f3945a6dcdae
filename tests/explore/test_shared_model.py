"""One model in several threads: ensembles, gradients and calibrations work on copies of it."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from sebody import Model, simulate
from sebody.analysis import (
    Design,
    Ensemble,
    ValueAndGradient,
    calibrate,
    final,
    gradient,
    gradients,
    sections,
)
from sebody.fem import rectangle

H, END = 0.005, 0.1
MATERIAL = 2e9, 0.3, 1200.0
OUTPUTS = {"tip": final("b.position")}


def rod() -> Model:
    model = Model(planar=True)
    a, b = model.node("a", (0.3, -0.2)), model.node("b", (1.1, 0.4))
    model.beam("rod", (a, b), rectangle(0.02, 0.02, *MATERIAL), 4, 1, 2)
    model.revolute(a)
    model.torque(a, 3.0, [(0, 0), (0.1, 1)], name="torque")
    model.gravity((0.4, -9.81))
    return model


def uses(model):
    """What changes a model for moments, with numbers of its own for each."""
    end = simulate(model, H, END)["b.position"][-1]
    measured = {"b.position": np.array([[END, *end], [END, *end]])}
    design = sections(model, "rod", 0.02, lambda x: rectangle(float(x), 0.02, *MATERIAL))
    uses = [lambda k=k: Ensemble(model, H).run(
        {"rod.stiffness": np.linspace(0.3, 3.0 + k, 5)}, END, OUTPUTS, threads=1)["tip"]
        for k in range(4)]
    uses += [lambda: gradient(model, H, END, OUTPUTS, ["rod.stiffness", design]).matrix,
             lambda: gradients(model, H, END, OUTPUTS, ["rod.mass"],
                               {"rod.stiffness": [0.5, 2.0]}, threads=1).matrix,
             lambda: ValueAndGradient(model, H, END, {"x": final("b.position.x")},
                                      ["rod.stiffness"])([1.7])[0],
             lambda: calibrate(model, H, measured, ["rod.stiffness"]).value,
             lambda: simulate(model, H, END)["b.position"][-1]]
    return uses


def test_threads_that_share_a_model_get_what_each_gets_alone():
    model = rod()
    alone = [use() for use in uses(model)]
    with ThreadPoolExecutor(6) as pool:
        together = [done.result() for done in [pool.submit(use) for use in 2 * uses(model)]]
    for one, other in zip(2 * alone, together, strict=True):
        assert np.array_equal(one, other)


def test_what_becomes_of_a_model_changes_no_ensemble_of_it():
    model = rod()
    many, alone = Ensemble(model, H), simulate(model, H, END)["b.position"][-1]
    model.gravity((5.0, 0.0))
    model.loads.clear()
    assert np.array_equal(many.run({}, END, OUTPUTS)["tip"][0], alone)


@pytest.mark.parametrize("held", [True, False])
def test_a_design_is_differentiated_at_its_own_values(held):
    """Built with a height of 0.02: the gradient at 0.03 is that of a model built with 0.03."""
    def design(model, height):
        return sections(model, "rod", height, lambda x: rectangle(float(x), 0.02, *MATERIAL),
                        held_modes=held)
    low, high = rod(), Model(planar=True)
    a, b = high.node("a", (0.3, -0.2)), high.node("b", (1.1, 0.4))
    high.beam("rod", (a, b), rectangle(0.03, 0.02, *MATERIAL), 4, 1, 2)
    high.revolute(a)
    high.torque(a, 3.0, [(0, 0), (0.1, 1)], name="torque")
    high.gravity((0.4, -9.81))
    found, wanted, other = (gradient(model, H, END, OUTPUTS, [design(model, height), "gravity.y"])
                            for model, height in ((low, 0.03), (high, 0.03), (low, 0.02)))
    assert isinstance(design(low, 0.03), Design)
    assert found.value == pytest.approx(wanted.value, rel=1e-12)
    assert np.abs(found.matrix - wanted.matrix).max() < 1e-8 * np.abs(wanted.matrix).max()
    assert np.abs(other.matrix[:, 0] - wanted.matrix[:, 0]).max() > 0.1 * np.abs(
        wanted.matrix[:, 0]).max()
    assert simulate(low, H, END)["b.position"][-1] == pytest.approx(other.value, rel=1e-7)
