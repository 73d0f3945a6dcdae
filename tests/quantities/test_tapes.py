"""Tapes of quantities: values against histories, derivatives against differences of states."""

import differentiated
import numpy as np
import pytest
from differentiated import place

from sebody import Model, Simulation, rest_to_rest
from sebody.analysis import final, gradient
from sebody.catalogue import builder
from sebody.contract.read_numbers import NOW
from sebody.fem import planar_beam, rectangle, straight_beam
from sebody.gradients import objectives
from sebody.gradients.followed import Followed
from sebody.gradients.sensors import Evaluated
from sebody.kernels.tapes import play, play_along, play_back
from sebody.quantities.expressions import Tape, angle, choice, cosine, inverse, positive, root, sine
from sebody.quantities.names import names
from sebody.quantities.reading import evaluate, reading
from sebody.quantities.symbols import NoTape
from sebody.reduction import craig_bampton
from sebody.results.tapes import States

ENERGIES = ("energy.strain", "energy.potential", "energy.kinetic", "momentum", "momentum.norm",
            "angular_momentum")
INSIDE = [f"beam.node2.{name}" for name in ("position", "velocity", "acceleration",
                                            "section_forces")]


def linked() -> Model:
    """A hinged beam with a body on a rigid arm, a spring, a slider and a distance, turned."""
    model = Model()
    model.gravity((0.4, -9.0, 2.0))
    fe = straight_beam(place(0, 0, 0), place(1, 0, 0), rectangle(0.03, 0.02, 2e9, 0.3, 1200.0), 4)
    ends = [model.node(name, point) for name, point in zip(
        "ab", (place(0, 0, 0), place(1, 0, 0)), strict=True)]
    model.superelement("beam", craig_bampton(fe, [(0, "full"), (4, "full")], 2), ends)
    model.revolute(ends[0], axis=(0.2, 0.3, 1.0), name="hinge")
    tip = model.attach("tip", place(1.1, 0.2, 0.1), ends[1])
    ball = model.node("ball", place(1.4, -0.3, 0.2))
    model.rigid_body("bob", ball, 0.7, 0.02 * np.eye(3))
    model.distance(tip, ball, name="rod")
    collar = model.node("collar", place(0.4, 0.5, 0.0))
    model.rigid_body("ring", collar, 0.3, 0.01 * np.eye(3))
    model.prismatic(ends[1], collar.point - ends[1].point, collar, name="slide")
    model.spring(ball, collar, stiffness=20.0, damping=0.3, name="spring")
    model.torque(ends[0], (0.1, 0.0, 1.0), 2.0, name="motor")
    return model


def started(model, h, steps=12):
    run = Simulation(model, h)
    start = run.state.now.copy()
    run.run_to(steps * h)
    return run, start


@pytest.mark.parametrize("made", [lambda: (linked(), 1e-3), *(
    lambda name=name: (builder(name)().model, builder(name)().h) for name in ("squeezer", "door"))])
def test_every_quantity_has_its_value(made):
    """Of all names that results have, in a state that the run has reached."""
    run, start = started(*made())
    result = run.result()
    states = States(run.model, run.numbering, run.system, run.state, start)
    shapes = {name: states.put(name) for name in names(result)}
    read = states.reading()
    assert evaluate(run.system, run.state, read) == 0
    first = 0
    for name, shape in shapes.items():
        own, last = result[name], first + int(np.prod(shape))
        assert own.shape[1:] == shape
        np.testing.assert_allclose(read.values[first:last].reshape(shape), own[-1], rtol=0,
                                   atol=1e-12 * max(1e-2, np.abs(own).max()), err_msg=name)
        first = last


def compared(monkeypatch, model, quantities, t_end=0.02):
    """Derivatives followed backwards beside differences in states moved forth and back."""
    made = {}
    look = objectives.sensor_of

    def sensor_of(run, quantity, shape, linear, history):
        made.update(run=run, linear=linear, history=history)
        return look(run, quantity, shape, linear, history)
    monkeypatch.setattr(objectives, "sensor_of", sensor_of)
    gradient(model, 1e-3, t_end, {"x": final("energy.kinetic")}, ["gravity.y"])
    run, linear, history = made["run"], made["linear"], made["history"]
    event, seen = len(history.rows) - 2, set()
    for name in quantities:
        followed = Followed(run, name, linear, history)
        size = len(followed.reading.outputs)
        other = Evaluated(run, name, size, linear, history)._differentiated(event)
        largest = max(np.abs(part).max() for part in other)
        for own, part in zip(followed.at(0, event), other, strict=True):
            scale = max(np.abs(part).max(), 1e-4 * largest)     # rounding: 1e-12 of the largest
            assert np.abs(own - part).max() < 1e-8 * scale, name
        seen.add(followed.kinematic)
    return seen


def test_derivatives_of_motions_and_forces(monkeypatch):
    assert compared(monkeypatch, linked(), (
        "rod.force", "rod.local_force.x", "slide.local_moment", "hinge.angle",
        "slide.displacement", "slide.speed", "hinge.rate", "tip.acceleration", "beam.a.force",
        "b.rotation", "beam.forces", "hinge.moment", "spring.force.norm", "tip.velocity.norm",
        *ENERGIES, *INSIDE)) == {True, False}


@pytest.mark.parametrize("inertia", ["frame_axes", "material", "floating_field", "rigid_part"])
@pytest.mark.parametrize("planar", [False, True])
def test_derivatives_of_energies(monkeypatch, inertia, planar):
    """Of bodies with each option of inertia, on a base that is moved."""
    model = Model(planar=planar)
    points, gravity = [(0.0, 0.0, 0.0), (0.8, 0.6, 0.0)], (0.4, -9.0, 2.0)
    if planar:
        points, gravity = [point[:2] for point in points], gravity[:2]
    section = rectangle(0.03, 0.02, 2e9, 0.3, 1200.0)
    fe = (planar_beam if planar else straight_beam)(*points, section, elements=4)
    base, tip = (model.node(name, point) for name, point in zip(("base", "tip"), points,
                                                                strict=True))
    model.gravity(gravity)
    model.superelement("beam", craig_bampton(fe, [(0, "full"), (4, "full")], 2), [base, tip],
                       inertia=inertia)
    model.move(base, np.eye(len(gravity))[0], rest_to_rest(0.3, 0.1))
    compared(monkeypatch, model, [*ENERGIES, *INSIDE])


@pytest.mark.parametrize("scene", ["hinged", "driven", "blown", "flat", "lifted"])
def test_derivatives_of_powers(monkeypatch, scene):
    """Of loads, drives, springs, dampers, bushings, prescribed motions and damped bodies."""
    model = getattr(differentiated, scene)()
    powers = [name for name in names(Simulation(model, 1e-3).result()) if name.endswith(".power")]
    assert powers
    compared(monkeypatch, model, powers)


def test_derivatives_inside_a_large_body(monkeypatch):
    """Of a body with 72 coordinates, whose second-order displacements have a term for each pair."""
    model = Model()
    ends = [model.node(name, point) for name, point in zip(
        "ab", (place(0, 0, 0), place(1, 0, 0)), strict=True)]
    model.beam("beam", ends, rectangle(0.03, 0.02, 2e9, 0.3, 1200.0), 16, 1, 60)
    model.revolute(ends[0], axis=(0.2, 0.3, 1.0), name="hinge")
    model.gravity((0.4, -9.0, 2.0))
    compared(monkeypatch, model, ["beam.node2.velocity", "beam.node2.section_forces"])


def test_functions_forth_and_back():
    """Rates along and bars back of one tape are those of one matrix, which differences give."""
    tape = Tape()
    x, y, z = (tape.read(NOW, k) for k in range(3))
    for value in (angle(x * y, z), choice([x, y], [z * z, y]), root(x * x + y * y), inverse(z),
                  cosine(x * y) + sine(z), positive(x) * y, x * y * z + 2.0, (x + y) * (y + z)):
        tape.put(value)
    made = reading(tape)
    own = made.steps, made.factors, made.weights
    at, point = made.inputs[:, 0], np.array([0.7, 1.3, -0.4])

    def values(moved):
        made.numbers[1:] = 0.0
        made.numbers[at] = moved
        play(*own, made.numbers)
        return made.numbers[made.outputs].copy()
    h = 1e-5
    by_differences = np.array([(values(point + h * e) - values(point - h * e)) / (2 * h)
                               for e in np.eye(3)]).T
    values(point)
    for k, output in enumerate(made.outputs):
        bars = np.zeros(len(made.numbers))
        bars[output] = 1.0
        play_back(*own, made.numbers, bars)
        np.testing.assert_allclose(bars[at], by_differences[k], atol=1e-8)
    for k in range(3):
        rates = np.zeros(len(made.numbers))
        rates[at[k]] = 1.0
        play_along(*own, made.numbers, rates)
        np.testing.assert_allclose(rates[made.outputs], by_differences[:, k], atol=1e-8)


def test_what_has_no_tape_says_why():
    run, start = started(linked(), 1e-3, 1)
    states = States(run.model, run.numbering, run.system, run.state, start)
    with pytest.raises(NoTape, match="a rotation vector, which is followed through turns"):
        states.put("b.rotation.z")
    with pytest.raises(NoTape, match="the displacement of FE nodes"):
        states.put("beam.node2.displacement")
