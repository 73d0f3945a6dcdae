"""Parameters of exports are those of ensembles and gradients: same names, bounds, meaning."""

import numpy as np
import pytest
from exported_models import SECTION, TURN, H
from slave import Slave

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import Ensemble, final
from sebody.export import export
from sebody.export.prepared import Prepared, Run
from sebody.parameters.table import handle, handles, parameter

pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")
fmpy = pytest.importorskip("fmpy", reason="FMUs are read by the package fmpy")
OUTPUTS = ["hand.position", "energy.strain", "pin.force", "soft.force"]
STEPS = 40
CHANGED = {"arm.stiffness": 0.8, "arm.mass": 1.3, "hand load.mass": 0.7, "soft.stiffness": 310.0,
           "soft.damping": 2.0, "push.amplitude": -1.7, "push.table.1": 2.2, "gravity.y": -6.0,
           "dry.coefficient": 0.5, "gravity.x": 1.0}


TABLE = [(0.0, 0.5), (0.03, 1.0), (0.2, 0.4)]


def swinging(table=TABLE) -> Model:
    """A turned arm with a load at its end, a spring, a bearing with friction and a table."""
    model = Model()
    model.gravity(TURN @ (0.0, -9.81, 0.0))
    base, hand = (model.node(name, TURN @ place) for name, place in (
        ("base", (0.1, 0.2, 0.0)), ("hand", (0.7, 0.3, 0.0))))
    model.beam("arm", (base, hand), SECTION, 5, 1, 2, up=TURN @ (0.0, 0.0, 1.0))
    model.revolute(base, axis=TURN @ (0.0, 0.0, 1.0), name="pin")
    model.rigid_body("hand load", hand, 0.3, 1e-3 * np.eye(3))
    model.friction("pin", coefficient=0.3, radius=0.02, bristle=1e3, name="dry")
    wall = model.node("wall", TURN @ (0.9, 0.9, 0.2))
    model.fix(wall)
    model.spring(hand, wall, stiffness=250.0, damping=0.8,
                 name="soft")
    model.force(hand, TURN @ (0.0, 1.0, 0.3), table, name="push")
    return model


def changed(values, table=TABLE) -> Model:
    """The model built with other values, by the handles of an ensemble."""
    model = swinging(table)
    for name, value in values.items():
        of = parameter(model, name)
        whole = np.array(of.handle.base, dtype=float)
        whole.reshape(-1)[of.component or 0] = value
        of.handle.set(whole)
    return model


@pytest.fixture(scope="module")
def unit(tmp_path_factory):
    folder = tmp_path_factory.mktemp("parameters")
    path = str(export(swinging(), H, fmu=folder / "m.fmu", inputs=list(CHANGED), outputs=OUTPUTS,
                      processor="native"))
    return path, fmpy.extract(path, str(folder / "unzipped"))


def outputs_of(one):
    return one.read(*(name for name in one.names if name.rpartition(".")[0] in OUTPUTS
                      or name in OUTPUTS))


def steps(one, first, last):
    for k in range(first, last):
        one.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    return np.array(outputs_of(one))


def expected(run):
    return np.concatenate([np.ravel(run.read(name)) for name in OUTPUTS])


def test_all_together_from_the_start(unit):
    """Any order of setting; values are read back, and twice the same changes nothing."""
    own = expected(Simulation(changed(CHANGED), H).run_to(STEPS * H))
    as_built = expected(Simulation(swinging(), H).run_to(STEPS * H))
    found = {}
    for names in (list(CHANGED), list(CHANGED)[::-1]):
        one = Slave(*unit, before=[(name, CHANGED[name]) for name in names * 2])
        assert one.read(*CHANGED) == list(CHANGED.values())
        found[names[0]] = steps(one, 0, STEPS)
    first, second = found.values()
    assert first.tobytes() == second.tobytes()
    assert np.abs(as_built - own).max() > 1e-2 * np.abs(own).max()
    assert first == pytest.approx(own, rel=1e-8, abs=1e-8 * np.abs(own).max())


def test_set_during_a_run_they_hold_from_there_on(unit):
    values = {name: CHANGED[name] for name in ("arm.stiffness", "arm.mass", "soft.stiffness",
                                               "push.amplitude")}
    one = Slave(*unit)
    steps(one, 0, STEPS)
    for name, value in values.items():
        one.set([one.names[name]], [value])
    found = steps(one, STEPS, 2 * STEPS)
    begun = Simulation(swinging(), H).run_to(STEPS * H)
    t, force = np.transpose(TABLE)
    rest = [(0.0, np.interp(STEPS * H, t, force)), (t[-1] - STEPS * H, force[-1])]
    own = Simulation(changed(values, rest), H, start=begun.result())
    assert found == pytest.approx(expected(own.run_to(STEPS * H)), rel=1e-5, abs=1e-6)


def test_bounds_are_those_of_the_table(unit):
    listed = {one.name: one for one in fmpy.read_model_description(unit[0]).modelVariables}
    for name in CHANGED:
        least = parameter(swinging(), name).handle.least
        assert (listed[name].min is None) == (least is None and name not in (
            "arm.stiffness", "arm.mass", "hand load.mass")), name
    one = Slave(*unit)
    for name in ("arm.stiffness", "soft.stiffness"):
        with pytest.raises(Exception, match="[fF]ailed|status"):
            one.set([one.names[name]], [-1.0])
        with pytest.raises(InputError, match=f"{name} of run 0 is -1"):
            Ensemble(swinging(), H).run({name: [-1.0]}, H, {"x": final("hand.position")})
    assert len(steps(one, 0, 3))        # it goes on


def test_every_name_of_the_table_is_set_or_refused_by_name():
    """A number that is set alone is that of a model built with it."""
    said, settable = {}, []
    for name in handles(swinging()):
        try:
            settable += [one.name for one in
                         Prepared(swinging(), "m", Run(H), [name], ["hand.position"]).inputs]
        except InputError as error:
            said[name] = str(error)
            assert name in said[name]
    assert {"gravity.z", "arm.stiffness", "soft.length", "dry.radius", "push.table.2"} <= {
        *settable, *said}
    assert {"arm.mass", "gravity.x", "push.table.2", "dry.coefficient"} <= set(settable)
    assert "runs begin with" in said["hand.position"] and "whole bodies" in said["arm.reduced"]
    with pytest.raises(InputError, match="parameter 'soft.stifness' is unknown: did you mean "
                                         "'soft.stiffness'"):
        Prepared(swinging(), "m", Run(H), ["soft.stifness"], ["hand.position"])
    with pytest.raises(InputError, match="gravity has 3 numbers, so none is called '3'"):
        Prepared(swinging(), "m", Run(H), ["gravity.3"], ["hand.position"])


def test_ensembles_vary_single_numbers():
    """Of one parameter in any order, beside the others as built; the same number twice is none."""
    ensemble = Ensemble(swinging(), H)
    kept = {"x": final("hand.position")}
    whole = np.array([[1.0, -6.0, -2.0], [0.5, -3.0, -1.0]])
    whole[:, 2] = swinging().gravity_field[2]
    one = ensemble.run({"gravity.y": whole[:, 1], "arm.stiffness": [0.8, 0.9],
                        "gravity.x": whole[:, 0]}, 10 * H, kept)
    two = ensemble.run({"gravity": whole, "arm.stiffness": [0.8, 0.9]}, 10 * H, kept)
    alone = ensemble.run({"gravity.x": whole[:, 0]}, 10 * H, kept)
    assert one["x"] == pytest.approx(two["x"], abs=1e-13)
    model = swinging()
    handle(model, "gravity").set(np.array([0.5, *model.gravity_field[1:]]))
    assert alone["x"][1] == pytest.approx(simulate(model, H, 10 * H)["hand.position"][-1],
                                          abs=1e-12)
    with pytest.raises(InputError, match="'gravity' and 'gravity.y' give the same number"):
        ensemble.run({"gravity": whole, "gravity.y": [1.0, 2.0]}, 10 * H, kept)
