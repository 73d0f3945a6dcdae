"""Friction and contact: what is asked of closed forms or independent integration, and measured.

    python tests/benchmarks/bench_contact.py [--json FILE] [ROW ...]

Rows are names or parts of them. Numbers that are integrated were found by DOP853 with tolerances of
1e-11 and less; see `tests/contact`, which has most rows in shorter form.
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sebody import Model, Simulation, Tolerance, plane, simulate, sphere

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "contact")]
from contact_models import (  # noqa: E402
    G,
    anchored,
    angle_of,
    bar,
    block,
    pendulum_with_journal,
    restitution,
    turning_points,
)

Row = list[tuple[str, float, float]]        # what, asked, measured


def decay() -> Row:
    """m 1, k 100, F 1 from 0.105, h 1e-3, for 1000 s."""
    model = anchored(block(), 100.0, 0.105)
    model.friction("slide", 1.0, preload=1.0, reaction=False, name="dry")
    result = simulate(model, 1e-3, 1000.0, output_every=100)
    x = result["block.position"][:, 0] + 0.105
    return [("rest", -0.005, x[-1]), ("work", -0.55, result["dry.work"][-1]),
            ("later drift", 0.0, float(np.ptp(x[50:])))]


def belt() -> Row:
    """m 1, k 100, v 0.1, break-away 4, sliding 3."""
    found = []
    for h in (1e-3, 1e-4):
        model = Model(planar=True)
        model.node("block", (0.0, 0.0))
        model.rigid_body("body", "block", 1.0, 0.1)
        model.initial_velocity("block", (0.1, 0.0))
        anchored(model, 100.0, 0.0)
        model.node("belt", (0.0, 0.0))
        model.move("belt", (1.0, 0.0), lambda t: 0.1 * t)
        model.fix("belt", "rotation")
        model.prismatic("belt", (1.0, 0.0), to="block", name="slide")
        model.friction("slide", 3.0, static=4.0, preload=1.0, reaction=False)
        run = Simulation(model, h).run_to(5.0)
        t, x = run.result()["t"], run.result()["block.position"][:, 0]
        up = np.flatnonzero((x[:-1] < 0.03) & (x[1:] >= 0.03))
        times = t[up] + (0.03 - x[up]) / (x[up + 1] - x[up]) * h
        late = x[len(x) // 2:]
        found += [(f"period, h {h:g}", 0.67123890, float(np.diff(times)[-1])),
                  (f"amplitude, h {h:g}", 0.01414214, float(np.ptp(late) / 2)),
                  (f"rejected steps, h {h:g}", 0, int(run.state.control.cuts))]
    return found


def cycles() -> Row:
    """1000 cycles of a load below the limit: drift after the first ten."""
    found = []
    for h in (0.05, 0.01):
        model = block()
        model.force("block", (1.0, 0.0), lambda t: 0.3 + 0.5 * np.sin(2 * np.pi * t))
        model.friction("slide", 1.0, preload=1.0, reaction=False)
        x = simulate(model, h, 1000.0)["block.position"][:, 0]
        found.append((f"drift, h {h:g}", 0.0, float(abs(x[-1] - x[round(10.0 / h)]))))
    return found


def incline() -> Row:
    """0.3 rad, h 0.05, 5 s from rest, pressed by the reaction of the joint."""
    axis, found = np.array([np.cos(0.3), np.sin(0.3)]), []
    for mu, way in ((0.31, 0.0), (0.305, -0.507983563243), (0.25, -6.951131097090)):
        model = block(axis=(*axis, 0.0))
        model.gravity((0.0, -G))
        model.friction("slide", mu)
        found.append((f"mu {mu}", way, float(simulate(model, 0.05, 5.0)["block.position"][-1]
                                             @ axis)))
    return found


def rolling() -> Row:
    """A sphere at 2 m/s, mu 0.3, slides, then rolls; fixed and variable steps."""
    found, k = [], 1e6
    for label, steps in (("fixed", {"h": 5e-3}),
                         ("variable", {"h": 1e-2, "tolerance": Tolerance(1e-5)})):
        model = Model()
        model.node("ball", (0.0, 0.0, 0.1 - (G / k)**(2 / 3)))
        model.rigid_body("body", "ball", 1.0, (0.004,) * 3)
        model.initial_velocity("ball", (2.0, 0.0, 0.0))
        model.gravity((0.0, 0.0, -G))
        model.contact("ball", on=plane((0.0, 0.0, 1.0)), radius=0.1, stiffness=k, friction=0.3)
        result = simulate(model, t_end=0.5, **steps)
        v = result["ball.velocity"][:, 0]
        found += [(f"v(0.1), {label}", 1.7057, float(v[result["t"] == 0.1][0])),
                  (f"rolling, {label}", 10 / 7, float(v[-1]))]
    return found


def journal() -> Row:
    """A pendulum with mu R 0.02 in its hinge, h 1e-3: turning angles, rest; angles at 1, 2, 3 s."""
    exact, found, angles = pendulum_with_journal(turns=4), [], []
    for joint, planar in (("revolute", True), ("revolute", False), ("spherical", False)):
        model = bar(planar, joint=joint)
        model.friction("hinge", 0.4, radius=0.05)
        result = simulate(model, 1e-3, 10.0 if planar else 3.6)
        th = angle_of(result) + np.pi / 3
        turns = turning_points(result["t"], th)[:4]
        angles.append(turns[:, 1])
        if planar:
            found += [(f"turning angle {k}", float(a), float(b)) for k, (a, b) in enumerate(
                zip(exact[:, 1], turns[:, 1], strict=True), 1)]
            found.append(("rest", -0.014280855352, float(th[-1])))
            found += [(f"angle at {s} s", value, float(th[1000 * s])) for s, value in (
                (1, -0.832402730307), (2, 0.466705372649), (3, -0.048831629692))]
    found.append(("spread of planar, spatial, ball", 0.0, float(np.ptp(angles, axis=0).max())))
    return found


def _thrown(cv: float, stiffness: float) -> Model:
    model = Model(planar=True)
    model.node("ball", (0.0, 0.03))
    model.rigid_body("body", "ball", 1.0, 0.1)
    model.initial_velocity("ball", (0.0, -1.0))
    model.contact("ball", on=plane((0.0, 1.0)), stiffness=stiffness, restitution=restitution(cv),
                  at_speed=1.0, name="hit")
    return model


def rebounds() -> Row:
    """Restitutions of Hunt and Crossley's law: variable steps, 40 steps in contact, stiff."""
    found = []
    for cv, e in ((0.1, 0.937475579949905), (0.5, 0.748434931597434), (1.0, 0.593624260040040)):
        for tolerance in (1e-6, 1e-8):
            result = simulate(_thrown(cv, 1e4), 0.01, 0.2, tolerance=Tolerance(tolerance))
            found.append((f"c v {cv}, tolerance {tolerance:g}", e,
                          float(result["ball.velocity"][-1, 1])))
        result = simulate(_thrown(cv, 1e4), 0.002, 0.2)
        found.append((f"c v {cv}, 40 steps in contact", e, float(result["ball.velocity"][-1, 1])))
    for h in (0.01, 1e-3, 2e-4):
        run = Simulation(_thrown(0.5, 1e8), h).run_to(0.2)
        found.append((f"stiffness 1e8, h {h:g}", 0.748434931597434,
                      float(run.result()["ball.velocity"][-1, 1])))
    for cv, time in ((0.1, 0.0813888333), (0.5, 0.0838531180), (1.0, 0.0873052229)):
        result = simulate(_thrown(cv, 1e4), 1e-4, 0.2)
        inside = result["t"][result["hit.gap"] < 0]
        found.append((f"contact time, c v {cv}, h 1e-4", time, float(np.ptp(inside)) + 1e-4))
    return found


def bouncing() -> Row:
    """A ball from 1 m, stiffness 1e6, restitution 0.8 at the first speed: heights of its tops."""
    model, v = Model(), np.sqrt(2 * G)
    model.node("ball", (0.0, 0.0, 1.1))
    model.rigid_body("body", "ball", 1.0, (0.004,) * 3)
    model.gravity((0.0, 0.0, -G))
    model.contact("ball", on=plane((0.0, 0.0, 1.0)), radius=0.1, stiffness=1e6, restitution=0.8,
                  at_speed=v, name="hit")
    result = simulate(model, 2e-3, 2.8, tolerance=Tolerance(1e-7))
    t, x = result["t"], result["ball.position"][:, 2] - 0.1
    found = []
    for k, (when, height) in enumerate(((0.8210692603, 0.6347640868), (1.4897871475, 0.4378258678),
                                        (2.0544082493, 0.3196612901),
                                        (2.5432794483, 0.2432582988)), 1):
        near = np.abs(t - when) < 0.02
        p = np.polyfit(t[near] - when, x[near], 2)
        found.append((f"top {k}, tolerance 1e-7", height, float(p[2] - p[1]**2 / (4 * p[0]))))
    found.append(("smallest step of the dissipation", 0.0,
                  float(np.diff(result["hit.dissipation"]).min())))
    return found


def stop() -> Row:
    """A pendulum on a stop at -0.3, stiffness 1e4, c v 0.2, h 1e-4: angles at 1, 3, 5 s."""
    model = bar()
    model.stop("hinge", lower=-0.3 - np.pi / 3, stiffness=1e4, restitution=restitution(0.2),
               at_speed=1.0)
    th = angle_of(simulate(model, 1e-4, 5.0, output_every=100)) + np.pi / 3
    return [(f"angle at {s} s", value, float(th[100 * s])) for s, value in (
        (1, 0.6849924560), (3, -0.0231997118), (5, 0.1321784945))]


def spheres() -> Row:
    """m 1 and 2, offset (0.3, 0.05, 0.02), stiffness 1e10, tolerance 1e-8: velocities after."""
    model = Model()
    for name, mass, place in (("a", 1.0, np.zeros(3)), ("b", 2.0, np.array([0.3, 0.05, 0.02]))):
        model.node(name, place)
        model.rigid_body(name + " ball", name, mass, (0.004,) * 3)
    model.initial_velocity("a", (1.0, 0.0, 0.0))
    model.contact("a", on=sphere(0.1, node="b"), radius=0.1, stiffness=1e10,
                  restitution=restitution(0.5), at_speed=1.0)
    result = simulate(model, 5e-3, 0.25, tolerance=Tolerance(1e-8))
    found = [(f"{name}.{axis}", value, float(result[f"{name}.velocity"][-1, k]))
             for name, values in (("a", (-0.08551621, -0.28178597, -0.11271439)),
                                  ("b", (0.54275810, 0.14089298, 0.05635719)))
             for k, (axis, value) in enumerate(zip("xyz", values, strict=True))]
    return [*found, ("momentum", 0.0, float(np.ptp(result["momentum"], axis=0).max()))]


def jumps() -> Row:
    """Normal force and force jump while friction slides, on no grid: largest errors."""
    from test_jumps_and_waves import exact_way, sliding
    exact, found = exact_way(np.linspace(0.0, 0.14, 15)), []
    for h in (2e-3, 1e-3, 5e-4):
        x = simulate(sliding(True), h, 0.14)["block.position"][::round(0.01 / h), 0]
        found.append((f"error, h {h:g}", 0.0, float(np.abs(x - exact).max())))
    for tolerance in (1e-4, 1e-6):
        x = simulate(sliding(True), 1e-2, 0.14, tolerance=Tolerance(tolerance))["block.position"]
        found.append((f"error, tolerance {tolerance:g} a step", 0.0,
                      float(np.abs(x[:, 0] - exact).max())))
    exact = exact_way(np.linspace(0.0, 0.5, 51))
    for h in (2e-3, 5e-4):
        x = simulate(sliding(True), h, 0.5)["block.position"][::round(0.01 / h), 0]
        found.append((f"error with two returns, h {h:g}", 0.0, float(np.abs(x - exact).max())))
    return found


def rod() -> Row:
    """A rod on a wall whose stiffness is 50 EA/L: time of contact by modes, momentum after."""
    from test_jumps_and_waves import rod as rod_at_wall
    found = []
    for modes in (0, 2, 4, 8, 16, 31):
        model, way, speed = rod_at_wall(modes)
        result = simulate(model, 1e-3, 2.5)
        on = result["t"][result["wall.normal_force"] > 1e-9]
        found += [(f"time, {modes} modes", 2.0335669398, float(np.ptp(on))),
                  (f"momentum, {modes} modes", -1.0,
                   float(result["momentum"][-1][:2] @ way / speed))]
    return found


ROWS: dict[str, Callable[[], Row]] = {
    one.__name__: one for one in (decay, belt, cycles, incline, rolling, journal, rebounds,
                                  bouncing, stop, spheres, jumps, rod)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rows", nargs="*", metavar="ROW")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    found = {}
    for name, row in ROWS.items():
        if given.rows and not any(part in name for part in given.rows):
            continue
        print(f"{name}: {row.__doc__}")
        found[name] = [{"what": what, "asked": asked, "measured": measured}
                       for what, asked, measured in row()]
        for one in found[name]:
            print(f"    {one['what']:36s} {one['asked']:18.12g} {one['measured']:18.12g} "
                  f"{abs(one['measured'] - one['asked']):9.1e}", flush=True)
    if given.json:
        given.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
