"""Wrong arguments of everything that runs a model or reads what a run gives."""

from functools import cache

import numpy as np
from malformed.cases import (
    INF,
    NAN,
    NO_COUNT,
    NO_NUMBER,
    Right,
    are,
    have,
    positive,
    vectors,
)
from malformed.model_cases import spatial

from sebody import (
    Model,
    PhasedSimulation,
    Simulation,
    Tolerance,
    generalized_alpha,
    harmonic,
    hht,
    piecewise,
    ramp,
    rest_to_rest,
    simulate,
    simulate_within,
    spline,
    trapezoidal,
    with_corners,
)
from sebody.analysis import (
    energy_gain,
    equilibrium,
    linearize,
    modes,
    resume,
    save_state,
    spin_limit,
    vibrations,
)
from sebody.results import save_picture


def ball() -> Model:
    """A mass in a plane that a force pushes."""
    model = Model(planar=True)
    model.node("ball", (1.0, 0.0))
    model.rigid_body("body", "ball", 2.0, 1.0)
    model.force("ball", (1.0, 0.0))
    return model


def pendulum() -> Model:
    """The same on a hinge and under gravity: it has a frequency."""
    model = Model(planar=True)
    model.node("pin", (0.0, 0.0))
    model.rigid_body("body", "pin", 2.0, 1.0, centre=(0.0, -1.0))
    model.fix("pin", "position")
    model.gravity((0.0, -9.81))
    return model


def struck() -> Model:
    """The pendulum under a torque."""
    model = pendulum()
    model.torque("pin", 3.0)
    return model


def beam():
    """A superelement."""
    return spatial().bodies["beam"]


class Shared:
    """Runs that are made once, and changed by no case."""

    model = ball()

    @staticmethod
    @cache
    def run() -> Simulation:
        """A ball that is pushed."""
        return Simulation(Shared.model, 0.1).run_to(1.0)

    @staticmethod
    @cache
    def hanging() -> Simulation:
        """A pendulum at rest."""
        return Simulation(pendulum(), 0.1)


def run_to(**arguments):
    """Go on with a run of its own."""
    return Simulation(Shared.model, 0.1).run_to(**arguments)


SCHEME = {
    "tolerance": are("tolerance", *NO_NUMBER, 0.0, 1.0, -1e-8, also=": use a number between 0"),
    "tangent": have("tangent", "none", None, 3, []),
    "index": are("index", 1, "3", None, True, 2.5, [3], also=": use 3, or 2")}
NO_MODEL = are("model", None, 3, "chain", Model, also=": give a sebody.Model")
STEP = positive("the time step")
END = [*have("t_end is", *NO_NUMBER), *have("cannot run to t = ", -1.0, -INF),
       (1e12, "t_end is 1e+12: that is 1e+13 steps of 0.1"),
       (0.01, "cannot run to t_end = 0.01 from t = 0: the step is 0.1"),
       (1e11, "a record of 1000000000000 states does not fit into memory: keep fewer with")]
PROGRESS = are("progress", 3, "yes", [], also=": give a function")
NO_SCHEME = are("scheme", 3, "hht", (0.5, 0.5), generalized_alpha,
                also=": give generalized_alpha() or hht()")[:3]
NO_TOLERANCE = are("tolerance", 1e-3, "fine", True, (1e-3, 0.0, 0.0), also=": give a Tolerance")
ERRORS = [(Tolerance(value), f"tolerance relative is {value!r}")
          for value in (-1.0, NAN, "1", None)]
SPIN = are("spin", "1", True, 1j, NAN, (0.0, 0.0, 1.0), also=": give a number")
NO_RUN = are("run", None, 3, "chain", also=": give a Simulation")

PROFILES = {
    "rest_to_rest": Right(rest_to_rest, {"distance": 1.0, "duration": 2.0}, {
        "distance": are("distance", *NO_NUMBER), "duration": positive("duration"),
        "start": are("start", *NO_NUMBER), "origin": are("origin", *NO_NUMBER[:4])}),
    "trapezoidal": Right(trapezoidal, {"distance": 1.0, "speed": 2.0, "acceleration": 3.0}, {
        "distance": are("distance", *NO_NUMBER, 0), "speed": positive("speed"),
        "acceleration": positive("acceleration")}),
    "ramp": Right(ramp, {"rate": 1.0}, {
        "rate": are("rate", *NO_NUMBER),
        "duration": [pair for pair in positive("duration") if pair[0] != INF]}),
    "harmonic": Right(harmonic, {"amplitude": 1.0, "omega": 2.0}, {
        name: are(name, *NO_NUMBER) for name in ("amplitude", "omega", "phase", "mean")}),
    "spline": Right(spline, {"rows": [(0, 0), (1, 2), (2, 1)]}, {
        "rows": have("table", None, 3, "abc", [], [(0, 0)], [(0, 0), (1,)], [(0, 0), (1, NAN)],
                     [(0, 0), (1, "2")], [(1, 0), (0, 0)], [(0, 0), (0, 1)], [(0, 0), None]),
        "rates": have("rates is", None, 1.0, "ab", (0.0, NAN), (0.0,), (0.0, 1j))}),
    "piecewise": Right(lambda parts: piecewise(*parts), {"parts": [(0, 1.0), (1, 2.0)]}, {
        "parts": [*have("part of a piecewise function", [3], [(0,)], [(0, "a")], [(0, None)],
                        [(0, with_corners(lambda t: t, [1.0]))], [None]),
                  *have("time of a part is", [("0", 1.0)], [(NAN, 1.0)], [(None, 1.0)]),
                  *have("times of parts of a piecewise function must increase",
                        [(1, 1.0), (0, 2.0)], [(0, 1.0), (0, 2.0)]),
                  ([], "parts of a piecewise function are missing")]}),
}
RUNS = {
    "generalized_alpha": Right(generalized_alpha, {"rho": 0.9}, {
        "rho": are("rho", *NO_NUMBER, 1.5, -0.1, also=": use a spectral radius"), **SCHEME}),
    "hht": Right(hht, {"alpha": -0.05}, {
        "alpha": are("alpha", *NO_NUMBER, 0.1, -0.5, also=": HHT needs a value"), **SCHEME}),
    "with_corners": Right(with_corners, {"function": lambda t: t, "corners": [1.0]}, {
        "function": [*are("function", None, 3, "sin", also=": give a function of time"),
                     *have("time function of a load", np.linalg.norm, lambda a, b: a)],
        "corners": have("corners are", None, "abc", 3.0, [[1.0]], [NAN], ["1"])}),
    **{kind.__name__: Right(kind, {"model": Shared.model, "h": 0.1}, {
        "model": NO_MODEL, "h": STEP, "scheme": NO_SCHEME,
        "output_every": are("output_every", *NO_COUNT, 0, also=": give a whole number of steps"),
        "tolerance": [*NO_TOLERANCE, *ERRORS, (Tolerance(0.0), "the tolerance allows no error")]})
        for kind in (Simulation, PhasedSimulation)},
    "run_to": Right(run_to, {"t_end": 0.5}, {"t_end": END, "progress": PROGRESS}),
    "simulate": Right(simulate, {"model": Shared.model, "h": 0.1, "t_end": 0.5}, {
        "model": NO_MODEL, "h": [*STEP, (1e-300, "t_end is 0.5: that is 5e+299 steps"),
                                 (1.0, "cannot run to t_end = 0.5 from t = 0: the step is 1"),
                                 (10.0, "cannot run to t_end = 0.5 from t = 0: the step is 10")],
        "t_end": END, "scheme": NO_SCHEME, "output_every": are("output_every", *NO_COUNT, -1),
        "tolerance": NO_TOLERANCE, "progress": PROGRESS}),
    "simulate_within": Right(simulate_within, {"model": Shared.model, "h": 0.1, "t_end": 0.5}, {
        "model": NO_MODEL, "h": STEP, "t_end": END[:7],
        "tolerance": [*NO_TOLERANCE, *ERRORS, *have(
            "give at least 1e-09, below which shorter steps do not help", Tolerance(1e-30),
            Tolerance(0.0, 1e-20, 1e-3), Tolerance(0.0, 1e-3, 1e-20))]}),
    "equilibrium": Right(equilibrium, {"model": pendulum(), "steps": 2}, {
        "model": NO_MODEL, "steps": are("steps", *NO_COUNT, 0, -1, also=": give a whole number"),
        "t": are("t", *NO_NUMBER), "tolerance": are("tolerance", *NO_NUMBER, 0.0, -1.0, 1.0),
        "spin": SPIN}),
    "linearize": Right(lambda **a: linearize(**{"run": Shared.hanging(), **a}), {}, {
        "run": NO_RUN, "spin": SPIN}),
    "modes": Right(lambda **a: modes(**{"run": Shared.hanging(), **a}), {}, {
        "run": NO_RUN, "spin": SPIN}),
    "vibrations": Right(lambda **a: vibrations(**{"run": Shared.hanging(), **a}), {"count": 1}, {
        "run": NO_RUN,
        "count": [pair for pair in are("count", *NO_COUNT, 0, -1) if pair[0] is not None]}),
    "energy_gain": Right(energy_gain, {"model": struck(), "until": 0.1}, {
        "model": [*NO_MODEL, (ball(), "nothing vibrates at t = 0.1: give the model loads")],
        "until": are("until", *NO_NUMBER, 0.0, -1.0)}),
    "spin_limit": Right(spin_limit, {"body": beam(), "axis": (0.0, 0.0, 1.0)}, {
        "body": are("body", None, 3, "beam", also=": give a superelement"),
        "axis": [*[pair for pair in vectors("axis", 3) if pair[0] is not None],
                 ((0.0, 0.0, 0.0), "axis is [0.0, 0.0, 0.0]: give its direction")]}),
}
FILES = {
    "save_state": Right(lambda path: save_state(Shared.run(), path), {"path": "new.npz"}, {
        "path": [*are("restart file", None, 3, "", " ", b"a.npz", also=": give the path"),
                 *have("must end in .npz", "a.txt", "a"), ("folder.npz", "folder.npz is a folder"),
                 ("none/a.npz", "folder none of the restart file does not exist"),
                 *have("cannot be a file", "x" * 300 + ".npz", "a\0.npz")]}),
    "resume": Right(lambda path: resume(ball(), path), {"path": "state.npz"}, {
        "path": [*are("restart file", None, 3, "", also=": give the path"),
                 ("none.npz", "restart file none.npz does not exist"),
                 ("folder.npz", "folder.npz is a folder"),
                 ("broken.npz", "is damaged or no restart file"),
                 ("histories.npz", "is damaged or no restart file"),
                 ("x" * 300 + ".npz", "cannot be a file"),
                 ("nan.npz", "holds numbers in q_old that are not finite"),
                 ("short.npz", "is of another model")]}),
    "save": Right(lambda path: Shared.run().result().save(path), {"path": "new.npz"}, {
        "path": [*are("output file", None, 3, ""), ("a.csv", "must end in .npz"),
                 ("folder.npz", "is a folder"), ("x" * 300 + ".npz", "cannot be a file")]}),
    "save_picture": Right(
        lambda **a: save_picture(**{"result": Shared.run().result(), **a}),
        {"path": "new.png", "base": "ball", "tip": "ball"}, {
            "result": are("result", None, 3), "base": have("is unknown", "top", 3, None),
            "path": [*are("picture", None, 3, ""), ("a.txt", "must end in .png"),
                     ("none/a.png", "does not exist"), ("x" * 300 + ".png", "cannot be a file")]}),
    "quantity": Right(lambda name: Shared.run().result()[name], {"name": "ball.position"}, {
        "name": [*are("name of a quantity", None, 3, "", ["t"]),
                 *have("is unknown", "ball", "ball.colour", "x.position", ".", "t.t", "ball.modes"),
                 ("ball.reaction", "only fixed and prescribed nodes have a reaction")]}),
}
