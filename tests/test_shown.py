"""What objects show of themselves: lines and tables of numbers with a meaning, never arrays."""

import inspect
import pydoc
import re
from importlib import import_module

import numpy as np
import pytest
from test_public_names import PACKAGES

from sebody import Model, Simulation, generalized_alpha, simulate
from sebody.analysis import (
    Ensemble,
    campbell,
    final,
    frequency_response,
    linearize,
    modes,
    vibrations,
)
from sebody.basics.tabular import table, text
from sebody.fem import rectangle, straight_beam, tube
from sebody.io.body_file import BodyFile
from sebody.model.summary import unknowns
from sebody.reduction import component_modes, craig_bampton
from sebody.scenes import four_bar, hinged_beam, slider_crank

SECTION = rectangle(0.1, 0.05, youngs_modulus=2e9, poisson_ratio=0.3, density=1000.0)


def oscillator(ratio=0.25, omega=50.0):
    """A mass on a damped spring along x, held by stiffer springs along y and z."""
    model = Model()
    model.point_mass("mass", model.node("mass", (0.0, 0.0, 0.0), keeps="translation"), 2.0)
    for axis, factor, share in (((-1, 0, 0), 1.0, ratio), ((0, -1, 0), 4.0, 0.0),
                                ((0, 0, -1), 9.0, 0.0)):
        anchor = model.node(f"anchor {axis}", axis, keeps="translation")
        model.fix(anchor, "position")
        model.spring("mass", anchor, stiffness=2.0 * factor * omega**2,
                     damping=2 * 2.0 * share * omega)
    return model


def everything():
    """An object of every class that a user meets."""
    scene = hinged_beam.build()
    model = scene.model
    run = Simulation(model, 0.01)
    result = simulate(model, 0.01, 0.1)
    ensemble = Ensemble(model, 0.01)
    fe_model = straight_beam((0, 0, 0), (1.0, 0, 0), SECTION, 6)
    body = craig_bampton(fe_model, [(0, "full"), (6, "full")], 2)
    fitted = model.bodies["beam"]
    field = result.field("beam")
    return {
        "scene": scene, "model": model, "node": model.nodes["tip"], "body": fitted,
        "dof_block": model.nodes["tip"].position, "reduced body": body, "joint": model.joints[0],
        "load": model.loads[0], "history": model.loads[0].time_function, "beam": model.beams[0],
        "spring": oscillator().loads[0], "mass": oscillator().rigid_bodies["mass"],
        "drive": four_bar.build().model.joints[-1], "crank": slider_crank.build().model,
        "result": result, "simulation": run, "scheme": generalized_alpha(), "ensemble": ensemble,
        "outcome": ensemble.run({"beam.stiffness": np.linspace(1, 2, 5)}, 0.1, {
            "end": final("tip.position.y"), "path": "tip.position"}),
        "linearization": linearize(run), "modes": modes(run), "vibrations": vibrations(run),
        "response": frequency_response(run, model.loads[0].name, "tip.position", [1.0, 2.0]),
        "field": field, "point": field.at(3), "fe model": fe_model, "recovery": body.recovery,
        "invariants": body.invariants, "body file": BodyFile(dict(
            stiffness=body.stiffness, mass=body.mass, modes=2), ("a", "b")),
        "component modes": component_modes(fe_model.stiffness, fe_model.mass, range(6), 2),
        "moved": slider_crank.build().model.nodes["pin"].position.motions[0]}


@pytest.fixture(scope="module")
def objects():
    return everything()


def test_no_object_shows_arrays(objects):
    for name, one in objects.items():
        shown = repr(one)
        assert "array(" not in shown and " object at 0x" not in shown, (name, shown)
        assert len(shown) < 1500 and max(map(len, shown.splitlines())) < 260, (name, shown)
        if name not in ("scene", "scheme", "modes", "vibrations", "outcome", "response"):
            assert "\n" not in shown and shown[0] == "<" and shown[-1] == ">", (name, shown)


def test_lines_say_what_things_are(objects):
    said = {
        "model": "<spatial model: 1 superelement, 2 nodes, 1 joint, 1 load>",
        "node": "<Node 'tip' at (100, 100, 0): position 3 unknowns, rotation 3 unknowns>",
        "dof_block": "<tip.position: 3 unknowns>",
        "joint": "<revolute 'revolute at base' of base to ground at base: 2 equations>",
        "load": "<torque 'torque on base.rotation' on base: 4 pieces, t = 0 to 7.5>",
        "beam": "<Beam 'beam' from base to tip: 20 elements in 1 superelement>",
        "reduced body": "<ReducedBody: mass 5, nodes full, full, 2 modes>",
        "fe model": "<FEModel: ", "field": "<Field of 'beam': 21 FE nodes, 11 states>",
        "point": "<FE node 3 of 'beam': 11 states>",
        "result": "<Result of a spatial model: 1 superelement, 2 nodes, 1 joint, 1 load: 11 "
                  "states, t = 0 to 0.1>"}
    for name, line in said.items():
        assert repr(objects[name]).startswith(line), repr(objects[name])
    assert re.match(r"<Superelement 'beam' on base, tip: mass 9.92778, 4 modes, frame "
                    "converged_mean, inertia floating_field, stiffening>", repr(objects["body"]))
    assert "k 5000" in repr(objects["spring"]) and "'spring at mass'" in repr(objects["spring"])


def columns(shown):
    """Rows of the numbers of a table, by its second and later columns."""
    return [line.split() for line in shown.splitlines()[2:]]


def test_modes_are_a_table_of_hertz_and_damping():
    """Against the frequencies of a mass on springs, w sqrt(1 - D^2) / (2 pi)."""
    found = modes(Simulation(oscillator(0.25), 1e-3))
    omega = 50.0 * np.array([np.sqrt(1 - 0.25**2), 2.0, 3.0])
    assert found.frequency == pytest.approx(omega / (2 * np.pi), rel=1e-9)
    assert found.damping == pytest.approx([0.25, 0, 0], abs=1e-9)
    assert repr(found).splitlines()[0] == "3 modes of small motion"
    assert repr(found).splitlines()[1].split("  ")[0] == "mode"
    for head in ("frequency [Hz]", "damping ratio", "real part [1/s]"):
        assert head in repr(found).splitlines()[1]
    rows = columns(repr(found))
    assert [row[0] for row in rows] == ["1", "2", "3"]
    assert [float(row[1]) for row in rows] == pytest.approx(omega / (2 * np.pi), rel=1e-5)
    assert [float(row[2]) for row in rows] == pytest.approx([0.25, 0, 0], abs=1e-4)
    assert float(rows[0][3]) == pytest.approx(-12.5, rel=1e-3)
    assert "<td>7.70" in found._repr_html_() and "<th>damping ratio</th>" in found._repr_html_()
    still = vibrations(Simulation(oscillator(0.0), 1e-3))
    assert [float(row[1]) for row in columns(repr(still))] == pytest.approx(
        50.0 * np.array([1, 2, 3]) / (2 * np.pi), rel=1e-5)
    assert still.frequency == pytest.approx(still.omega / (2 * np.pi))


def test_rigid_motions_have_no_damping(objects):
    """The double eigenvalue zero is, by rounding, a pair with a frequency or two real values."""
    rows = columns(repr(objects["modes"]))
    rigid = [row for row in rows if row[2] == "-"]
    assert 1 <= len(rigid) <= 2 and rigid == rows[:len(rigid)]
    assert all(float(row[1]) < 1e-5 for row in rigid)
    assert rows[len(rigid)][2] == "0"
    assert np.isnan(objects["modes"].damping[0])


def test_outcomes_and_responses_are_tables(objects):
    outcome = objects["outcome"]
    title, heads, *rows = repr(outcome).splitlines()
    assert re.fullmatch(r"5 runs, [\d.e-]+ s(, one by one: .*)?", title)
    assert heads.split() == ["output", "shape", "smallest", "mean", "largest"]
    assert rows[0].split()[:2] == ["end", "(5)"]
    numbers = [float(one) for one in rows[0].split()[2:]]
    end = outcome["end"]
    assert numbers == pytest.approx([end.min(), end.mean(), end.max()], rel=1e-5)
    response = objects["response"]
    line = next(line for line in repr(response).splitlines() if "tip.position.x" in line).split()
    amplitudes = np.abs(response["tip.position"][:, 0])
    assert float(line[1]) == pytest.approx(amplitudes.max(), rel=1e-5)
    assert float(line[3]) == pytest.approx(
        response.omega[amplitudes.argmax()] / (2 * np.pi), rel=1e-5)


def test_a_campbell_diagram_is_a_table():
    model = Model()
    ends = model.node("root", (0.1, 0, 0)), model.node("tip", (1.1, 0, 0))
    model.beam("blade", ends, tube(0.1, 0.09, youngs_modulus=2e9, poisson_ratio=0.3,
                                   density=1000.0), 4, 1, modes=2)
    model.fix("root")
    found = campbell(model, [0.0, 5.0, 10.0], (0, 0, 1), count=3)
    title, heads, *rows = repr(found).splitlines()
    assert title == ("3 modes at 3 speeds from 0 to 10 rad/s, in turning axes (nothing turns by "
                     "itself, so all supports turn, too)")
    assert "[Hz] at 10 rad/s" in heads and len(rows) == 3
    assert float(rows[0].split()[2]) == pytest.approx(found.omega[0, 0] / (2 * np.pi), rel=1e-5)


def test_a_model_says_what_it_is_before_a_run():
    """Counts as a run has them; state of every node; courses of loads; what falls."""
    model = slider_crank.build().model
    said = model.summary()
    free = Simulation(model, 1e-3).numbering.free
    assert sum(unknowns(model)) == free
    assert f"unknowns  {free}: 4 of nodes, 5 of modes, 1 of joint equations" in said
    assert "Bodies\n" in said and "Nodes\n" in said and "Joints and drives\n" in said
    assert "prescribed by motion of pin.position, motion 2 of pin.position" in said
    masses = [body.reduced.total_mass for body in model.bodies.values()]
    assert f"mass      {sum(masses) + 0.033:.6g}" in said
    assert "free" not in said
    model = Model()
    model.gravity((0, 0, -9.81))
    model.rigid_body("ball", model.node("o", (1, 2, 3)), 2.0, (0.1, 0.1, 0.1))
    model.initial_velocity("o", (1.0, 0, 0))
    model.force("o", (1, 0, 0), 5.0)
    model.torque("o", (1, 0, 0), lambda t: 2 * t)
    said = model.summary()
    assert "free      ball: not connected to the ground" in said
    assert re.search(r"o +\(1, 2, 3\) +3 unknowns +3 unknowns +\(1, 0, 0\)", said)
    assert "constant 5" in said and "function <lambda>" in said and "gravity (0, 0, -9.81)" in said
    assert "array(" not in said


def test_tables_of_text_align_numbers_and_end():
    shown = text("title", ("name", "value"), [("a", "1"), ("long name", "12.5")])
    assert shown == "title\nname       value\na              1\nlong name   12.5"
    assert text("none", ("name",), []) == "none\nname"
    many = text("many", ("k",), [(str(k),) for k in range(60)]).splitlines()
    assert len(many) == 43 and many[-1] == "... and 20 more"
    assert "<details>" in table(("k",), [(k,) for k in range(60)])


@pytest.mark.parametrize("package", PACKAGES)
def test_help_is_readable(package):
    """Types have their names in it, not what they are made of."""
    for name in PACKAGES[package]:
        one = getattr(import_module(package), name)
        if not callable(one):
            continue
        for line in pydoc.plain(pydoc.render_doc(one)).splitlines():
            assert "_typing" not in line and "ndarray[" not in line, (name, line)
            signature = re.match(r"^[ |]*\w+\(.*\)( ->.*)?$", line)
            assert not signature or len(line) < 800, (name, line)


def test_help_of_a_model_shows_arguments_by_name():
    shown = pydoc.plain(pydoc.render_doc(Model))
    assert "force(model: 'Mechanism', node: 'Node | str', direction: 'ArrayLike', amp" in shown
    # annotations that are written out name the modules of their parts
    assert not re.search(r"numpy\._typing|collections\.abc\.|typing\.Union", shown)
    assert inspect.signature(Model.force).parameters["direction"].annotation == "ArrayLike"
