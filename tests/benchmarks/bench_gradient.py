"""Gradients of runs: what they cost, how the tolerance of a run enters, and an optimal torque.

    python tests/benchmarks/bench_gradient.py [--json] [--picture FILE] [NAME ...]

cost: seconds of a run and of gradients of the hinged beam, quickest of some, in turns; by one
parameter and by the 1000 values of a table. memory: most that gradients along 1e5 steps have
allocated at a time, and their seconds. many: seconds of gradients of many runs with one and with
two threads, in turns. tolerance: error of a gradient on runs with a coarser
tolerance. torque: the torque history of least effort, of 1000 values, that turns a flexible arm by
a radian from rest to rest, with all its vibrations at rest at the end.
"""

import argparse
import json
import time
import tracemalloc

import numpy as np

from sebody import LimitWarning, Model, generalized_alpha, simulate
from sebody.analysis import ValueAndGradient, final, gradient, gradients
from sebody.fem import rectangle
from sebody.scenes.hinged_beam import build

NAMES = "cost", "memory", "many", "tolerance", "torque"
PARTS, MOST = 2, 8          # of the angle; steps of Newton's iteration in each
TOLERANCES = 1e-6, 1e-8, 1e-10
SCHEME = generalized_alpha(tolerance=1e-10)


def tabled(entries=1000, t_end=5.0):
    """The hinged beam with a torque given by many values."""
    model = build().model
    times = np.linspace(0.0, t_end, entries)
    old = model.loads[0]
    rows = [old.time_function.times, [piece[0] for piece in old.time_function.pieces]]
    model.loads.clear()
    model.torque("base", (0, 0, 1), np.column_stack([times, np.interp(times, *rows)]), name="motor")
    return model


def cost(repeats=5, t_end=5.0):
    """Seconds of a run and of gradients, quickest of some in turns."""
    model = tabled(t_end=t_end)
    one = {"tip": final("tip.position.y")}
    tasks = {
        "run": lambda: simulate(model, 0.01, t_end, scheme=SCHEME),
        "adjoint, 1 parameter": lambda: gradient(model, 0.01, t_end, one, ["motor.amplitude"]),
        "adjoint, 1000 values": lambda: gradient(model, 0.01, t_end, one, ["motor.table"]),
        "forward, 1 parameter": lambda: gradient(model, 0.01, t_end, one, ["motor.amplitude"],
                                                 "forward")}
    found = dict.fromkeys(tasks, np.inf)
    for _ in range(repeats):
        for name, task in tasks.items():
            began = time.perf_counter()
            task()
            found[name] = min(found[name], time.perf_counter() - began)
    return found


def memory(steps=100_000, h=0.01):
    """Largest number of MB that a gradient has allocated at a time, and seconds without counting.
    """
    model, found = tabled(t_end=10.0), {}     # its torque ends at 7.5
    for name in "motor.amplitude", "motor.table", "beam.mass":
        for mode in ("adjoint", "forward") if name != "motor.table" else ("adjoint",):
            def run(count, name=name, mode=mode):
                began = time.perf_counter()
                gradient(model, h, count * h, {"tip": final("tip.position.y")}, [name], mode,
                         scheme=generalized_alpha(tolerance=1e-8))
                return time.perf_counter() - began
            run(10)             # compiles
            seconds = run(steps)
            tracemalloc.start()
            run(steps)
            found[f"{mode}, {name}"] = {"MB": tracemalloc.get_traced_memory()[1] / 1e6,
                                        "seconds": seconds}
            tracemalloc.stop()
    return found


def many(runs=32, t_end=20.0, repeats=3):
    """Seconds of gradients of many runs, quickest of some in turns, by the number of threads."""
    model, found = tabled(t_end=10.0), dict.fromkeys((1, 2), np.inf)
    values = {"motor.amplitude": np.linspace(0.5, 1.5, runs)}
    for _ in range(repeats):
        for threads in found:
            got = gradients(model, 0.01, t_end, {"tip": final("tip.position.y")}, ["motor.table"],
                            values, threads=threads)
            found[threads] = min(found[threads], got.seconds)
    return {f"threads: {threads}": seconds for threads, seconds in found.items()}


def tolerance(t_end=3.0):
    """Error of a gradient by the tolerance of Newton's iteration, of the largest in a row."""
    model, names = build().model, ["torque on base.rotation.amplitude", "beam.mass", "gravity.y"]

    def at(value):
        return gradient(model, 0.01, t_end, {"tip": final("tip.position")}, names,
                        scheme=generalized_alpha(tolerance=value)).matrix[:2]
    exact = at(1e-13)
    return {f"{value:g}": float((np.abs(at(value) - exact) / np.abs(exact).max(
        axis=1, keepdims=True)).max()) for value in TOLERANCES}


def arm(entries=1000, t_end=1.0):
    """A flexible arm in a plane that a torque of many values turns."""
    model = Model(planar=True)
    hub, tip = model.node("hub", (0.0, 0.0)), model.node("tip", (1.0, 0.0))
    model.rigid_body("motor", hub, 1.0, 0.02)
    model.beam("arm", (hub, tip), rectangle(0.008, 0.02, 7e10, 0.3, 2700.0), 10, 1, 2)
    model.revolute(hub)
    model.point_mass("load", tip, 0.2)
    times = np.linspace(0.0, t_end, entries)
    model.torque(hub, 1.0, np.column_stack([times, np.sin(2 * np.pi * times / t_end)]),
                 name="torque")
    return model


def torque(entries=1000, t_end=1.0, angle=1.0, h=1e-3):
    """Newton's iteration for the history of least effort among those that end at rest.

    Each step is the least history that the linearized end conditions have. The angle grows in
    parts, so that the first guesses are good.
    """
    model = arm(entries, t_end)
    rest = {"hub": "hub.rotation", "place": "tip.position.y", "tip": "tip.rotation",
            "modes": "arm.modes", "spin": "hub.angular_velocity", "speed": "tip.velocity.y",
            "turning": "tip.angular_velocity", "rates": "arm.mode_rates"}
    f = ValueAndGradient(model, h, t_end, {name: final(one) for name, one in rest.items()},
                         ["torque.table"], scheme=SCHEME)
    began, u, misses = time.perf_counter(), np.zeros(entries), []
    for k in range(1, PARTS + 1):
        part, u = angle * k / PARTS, u * k / max(k - 1, 1)
        for _ in range(MOST):
            found = f.gradient_at(u)
            goal = np.zeros(len(found.value))
            goal[:3] = part, np.sin(part), part
            misses.append(float(np.abs(found.value - goal).max()))
            if misses[-1] < 1e-9:
                break
            scale = np.linalg.norm(found.matrix, axis=1)
            u = np.linalg.lstsq(found.matrix / scale[:, None],
                                (found.matrix @ u - found.value + goal) / scale, rcond=1e-9)[0]
    return {"seconds": time.perf_counter() - began, "runs": f.runs, "misses": misses,
            "largest torque": float(np.abs(u).max())}, (model, f, u)


def picture(path, found):
    """Torque, angles and deflection over time."""
    from matplotlib.figure import Figure

    model, f, u = found
    with f.point.at(u):
        run = simulate(model, f.h, f.t_end, scheme=SCHEME)
    figure = Figure(figsize=(7, 5), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(np.linspace(0, f.t_end, len(u)), u)
    above.set_ylabel("torque [N m]")
    above.grid(alpha=0.3)
    below.plot(run["t"], run["hub.rotation"], label="hub")
    place = run["tip.position"]
    below.plot(run["t"], np.arctan2(place[:, 1], place[:, 0]), label="direction of the tip")
    below.set_xlabel("time [s]")
    below.set_ylabel("angle [rad]")
    below.grid(alpha=0.3)
    below.legend(frameon=False)
    figure.savefig(path, dpi=150)


def main(given=None):
    """Print what was measured."""
    import warnings

    warnings.simplefilter("ignore", LimitWarning)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", choices=[*NAMES, []], metavar="NAME")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--picture", metavar="FILE", help="of the optimal torque")
    options = parser.parse_args(given)
    found = {}
    for name in options.names or NAMES:
        if name == "torque":
            found[name], solution = torque()
            if options.picture:
                picture(options.picture, solution)
        else:
            found[name] = {"cost": cost, "memory": memory, "many": many,
                           "tolerance": tolerance}[name]()
    if options.json:
        print(json.dumps(found))
        return
    for name, rows in found.items():
        print(name)
        for what, value in rows.items():
            print(f"  {what:24} {value}")


if __name__ == "__main__":
    main()
