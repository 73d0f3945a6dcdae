"""One table of models, and how each of them is read, or with which words it is refused.

| reading | against | in |
|---|---|---|
| single | its balance of energy at two steps | runs/test_readings.py |
| resumed | the whole run, bit for bit | runs/test_readings.py |
| planar | the run in space | runs/test_readings.py |
| lanes | single runs; bit for bit in other company | explore/test_lanes_of_models.py |
| gradient | both recursions, and differences of runs | gradients/test_gradient.py |
| C | the run in Python, bit for bit | export/test_library.py |
| plain | the fast way of compiling | compiler/test_plain_runs.py |

The last two take seconds, of some models alone.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import differentiated as scenes
import exported_models
import lane_models as lane
import numpy as np
from numpy.typing import NDArray

from sebody import Model
from sebody.analysis import at_time, final, integral, rms, soft_maximum
from sebody.control import pid
from sebody.gradients.parameters import columns_of

SPAN = {"amplitude": (-1.0, 2.0), "gravity": (-1.0, 2.0)}      # of factors of members
NARROW = (0.7, 1.3)


@dataclass(frozen=True)
class Row:
    """A model, the run in which it is read, and what it is asked for."""

    build: Callable[[], Model]
    h: float
    end: float
    followed: str                   # a quantity that members in lanes have as single runs do
    parameters: list[str]           # of gradients; members in lanes have other values of them
    objectives: dict = field(default_factory=dict)      # of gradients
    refused: dict[str, str] = field(default_factory=dict)      # words of refusals, of readings
    step: float = 4e-3              # of differences of runs
    noise: float = 1e-7             # that these have
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)    # of members' numbers
    index: tuple[int, ...] = (3,)   # of members in lanes
    falls: float = 2.0              # half the step divides the drift of energy by this, or more
    exported: bool = False          # it is read in C
    plain: bool = False             # it is compiled in the plain way

    @property
    def run(self) -> tuple[float, float, dict, list[str]]:
        """What a gradient is asked for."""
        return self.h, self.end, self.objectives, self.parameters

    def members(self, model: Model, runs: int, seed: int = 3) -> dict[str, NDArray]:
        """Values of the parameters for runs of an ensemble; laws keep their periods."""
        rng = np.random.default_rng(seed)
        found = {name: rng.uniform(*bounds, runs) for name, bounds in self.ranges.items()}
        for column in () if found else columns_of(model, self.parameters):
            base = np.array(column.handle.base, dtype=float)
            if column.name not in found:
                factors = rng.uniform(*SPAN.get(column.name.rpartition(".")[2] or column.name,
                                                NARROW), (runs, *base.shape))
                found[column.name] = base * np.where(base == 3 * lane.STEP, 1.0, factors)
        return found


def read(reading: str) -> list[str]:
    """Names of models that are not refused."""
    return [name for name, row in TABLE.items() if reading not in row.refused]


OF_HINGED = ["torque.amplitude", "beam.stiffness", "beam.mass"]
STARTS = "the model is built anew"          # with other positions, say
ALONE = "among rigid bodies alone"
SAMPLED = "controller 'pid' is sampled"
OUT = "not symmetric about the plane"
CONTROLLED = ["gravity", "pid.parameters"]


def made_of(build: Callable, *given, **options) -> Callable[[], Model]:
    """A builder with its arguments."""
    return lambda: build(*given, **options)


def in_loop(add: Callable, modes: int, **options) -> Callable[[], Model]:
    """A redundant loop with controllers, rigid or with a beam of some modes."""
    return lambda: add(scenes.four_bar(modes, coil=False), "a", "A", 40.0, tip="c", axis=scenes.Z,
                       **options)


def governed() -> Model:
    """A redundant loop with a flexible coupler, whose crank follows a continuous law."""
    model = scenes.four_bar(4)
    model.actuator("motor", joint="A")
    model.controller("loop", pid(kp=25.0, ki=8.0, kd=2.0, filter=60.0, reference=0.5), ["A.angle"],
                     ["motor"])
    return model


def wheel() -> Model:
    """A wheel whose torque jumps, nearly, between close rows of its table."""
    model = Model(planar=True)
    model.node("hub", (0.3, -0.2))
    model.rigid_body("wheel", "hub", 1.0, 2.0)
    model.revolute("hub", name="pin")
    model.torque("hub", 1.0, [(0, 1.0), (0.5, 1.0), (0.500001, -1.0), (1.0, -1.0), (1.000001, 0)],
                 name="motor")
    return model


def bead() -> Model:
    """A bead with a spring on a bent path."""
    model = Model()
    model.gravity((0.3, 0.2, -9.81))
    node = model.node("bead", (0.0, 0.0, 0.0), "translation")
    model.point_mass("mass", node, 2.0)
    model.path("wire", points=[(0, 0, 0), (0.4, 0.1, -0.3), (0.9, 0.3, -0.2), (1.4, 0.2, 0.3)],
               ends="straight")
    model.path_joint(node, "wire", name="runs")
    model.spring("runs", stiffness=30.0, damping=0.1, name="spring")
    return model


TABLE = {
    "hinged beam": Row(scenes.hinged, 0.005, 0.1, "tip.position", [
        "torque.amplitude", "torque.table", "spring.stiffness", "spring.damping", "spring.length",
        "beam.stiffness", "beam.mass", "gravity"], {
        "tip": final("tip.position"), "strain": final("energy.strain"),
        "force": final("spring.force")}, {
            "lanes": STARTS, "planar": "node 'wall' is .* off the plane"}),
    "given velocities": Row(scenes.spinning, 0.005, 0.1, "tip.position", [
        "torque.amplitude", "beam.stiffness", "spring.stiffness"], {
        "tip": at_time("tip.velocity", 0.0771), "base": integral("tip.acceleration")}, {
        "planar": OUT}),
    "redundant loop": Row(scenes.four_bar, 0.005, 0.2, "c.position", [
        "gravity.y", "coil.stiffness", "coil.rest", "rocker.mass", "torque.amplitude"], {
        "c": final("c.position"), "v": rms("c.velocity", norm=True)}, {"lanes": ALONE}),
    "redundant, in lanes": Row(made_of(scenes.four_bar, coil=False), 0.005, 0.2, "c.position", [
        "gravity", "torque.amplitude"], index=(3, 2)),
    "flexible loop": Row(made_of(scenes.four_bar, 3), 0.002, 0.06, "c.position", [
        "gravity", "coil.stiffness", "coupler.stiffness", "coupler.mass"], {
        "c": soft_maximum("c.position", 8), "modes": integral("coupler.modes")}, {
            "planar": OUT}),
    "moved base": Row(scenes.moved, 0.005, 0.1, "end.position", [
        "shake.amplitude", "swing.amplitude", "ball.mass", "beam.stiffness"], {
        "tip": final("tip.position"), "end": final("end.velocity"),
        "base": integral("base.position")}, {"lanes": STARTS, "planar": OUT}),
    # integrals look at the start, where velocities and positions are parameters themselves
    "a start that is a parameter": Row(scenes.thrown, 0.005, 0.1, "end.position", [
        "a.velocity", "a.angular_velocity", "a.position", "top.mass"], {
        "end": integral("end.acceleration"), "v": integral("a.velocity"),
        "energy": integral("energy.kinetic"), "x": rms("end.position")}, {"planar": OUT}),
    "driven rotor": Row(scenes.driven, 0.005, 0.1, "tip.position", [
        "motor.amplitude", "rotor.mass", "carriage.mass", "spring.stiffness"], {
        "tip": final("tip.position"), "slide": final("slide.velocity")}, {
            "lanes": STARTS, "planar": OUT}),
    "jumps of loads": Row(scenes.struck, 0.01, 0.2, "end.position", [
        "gust.amplitude", "gust.table", "kick.table", "upper.mass", "lower.mass", "gravity"], {
        "b": final("b.position"), "end": final("end.velocity"), "sum": integral("end.position")}, {
        "lanes": STARTS, "planar": OUT}, plain=True),
    "load on a body": Row(scenes.blown, 0.005, 0.1, "tip.position", [
        "gale.table", "beam.mass", "beam.stiffness", "bush.stiffness"], {
        "tip": final("tip.position"), "modes": integral("beam.modes")}, {"planar": OUT}),
    "in a plane": Row(scenes.flat, 0.002, 0.06, "d.position", [
        "torque.amplitude", "piston.mass", "rod.mass", "rod.stiffness", "gravity"], {
        "slider": final("d.position"), "b": final("b.velocity")}),
    "moved in a plane": Row(scenes.lifted, 0.005, 0.1, "end.position", [
        "lift.amplitude", "swing.amplitude", "ball.mass", "beam.damping"], {
        "end": final("end.position"), "tip": final("b.velocity")}, {
            "lanes": STARTS}),
    "joints": Row(scenes.joined, 0.005, 0.1, "d.position", [
        "upper.mass", "ball.mass", "spring.stiffness", "torque.table"], {
        "ball": final("d.position"), "c": final("c.velocity")}, {"planar": OUT}),
    "rigid-part inertia": Row(made_of(scenes.hinged, "d", modes=2), 0.005, 0.1, "tip.position",
                              OF_HINGED, {"tip": final("tip.position")}, {"planar": OUT}),
    "frame on one node": Row(made_of(scenes.hinged, "b", frame="node", modes=2), 0.005, 0.1,
                             "tip.position", OF_HINGED, {"tip": final("tip.position")}, {
                                 "planar": OUT}),
    "mean axes": Row(made_of(scenes.hinged, frame="mean_axes", modes=2), 0.005, 0.1,
                     "tip.position", OF_HINGED, {"tip": final("tip.position")}, {"planar": OUT}),
    "bearing": Row(scenes.journal, 0.005, 0.15, "a.rotation", [
        "dry.coefficient", "dry.radius", "bob.mass", "gravity", "kick.table",
        "a.angular_velocity"], {
        "x": final("a.rotation"), "v": integral("a.angular_velocity"), "f": final("hinge.force")}, {
        "lanes": ALONE}, step=1e-3, plain=True),
    "smooth law": Row(made_of(scenes.journal, speed=0.3), 0.005, 0.1, "a.rotation", [
        "dry.coefficient", "dry.radius", "bob.mass", "gravity.y"], {
        "x": final("a.rotation"), "m": final("dry.moment")}, {"lanes": ALONE}, step=1e-3),
    # differences of contacts are short, since steps are cut elsewhere beyond
    "ball": Row(scenes.ball, 0.002, 0.07, "a.position", [
        "floor.coefficient", "floor.stiffness", "floor.restitution", "floor.level", "body.mass",
        "gravity", "a.velocity"], {"x": final("a.position"), "v": final("a.velocity")}, {
        "lanes": ALONE, "planar": OUT}, step=1e-6, noise=2e-6),
    "gears": Row(scenes.gears, 0.002, 0.1, "n0.rotation", [
        "mesh.ratio", "mesh.stiffness", "mesh.backlash", "wheel 0.mass", "wheel 1.mass",
        "motor.table", "coil.stiffness"], {
        "x": final("n0.rotation"), "v": final("n1.angular_velocity")}, {"lanes": ALONE},
        step=1e-6, noise=2e-6, falls=0.9),
    "arm": Row(scenes.arm, 0.005, 0.1, "tip.position", [
        "loop.parameters", "beam.mass", "beam.stiffness", "gravity"], {
        "tip": final("tip.position"), "hub": rms("hub.angular_velocity")}, {
            "lanes": STARTS}, step=1e-4),
    "chain": Row(lane.chain, 1e-3, 0.06, "tip.position", [
        "link 0.stiffness", "link 1.stiffness", "link 2.stiffness", "load.amplitude", "gravity"],
        refused={"planar": OUT}, index=(3, 2)),
    # beyond the size of full matrices
    "long chain": Row(made_of(scenes.chain, 24), 0.01, 0.05, "tip.position", [
        "torque.amplitude", "link 7.mass"], {"tip": final("tip.position")}, {
            "lanes": "eight equal bodies or more", "planar": OUT}, step=1e-2, noise=1e-6),
    "many modes": Row(made_of(lane.beam, 32, elements=8), 1e-3, 0.06, "tip.position", [
        "beam.stiffness", "load.amplitude", "gravity"], refused={"planar": OUT}),
    "massless": Row(made_of(lane.beam, 4, "macneal"), 1e-3, 0.06, "tip.position", [
        "beam.stiffness", "load.amplitude", "gravity"], refused={
            "gradient": "has no mass, and its accelerations at the start no derivative",
            "planar": OUT}, index=(3, 2), falls=0.5,
        exported=True),
    "twisted": Row(lane.twisted, 1e-3, 0.06, "tip.position", [
        "beam.stiffness", "load.amplitude", "gravity"], refused={"planar": OUT}, falls=1.7),
    # eliminated: factorized at every sample and after it
    "sampled, chain": Row(lambda: lane.controlled(lane.chain(), "end 1", "hinge 0", 1e4), 1e-3,
                          0.06, "tip.position", ["load.amplitude", *CONTROLLED], refused={
                              "gradient": SAMPLED, "planar": OUT}),
    # redundant and dense: regularized, so factorized likewise
    "sampled, loop": Row(in_loop(lane.controlled, 0), 1e-3, 0.06, "c.position", [
        "torque.amplitude", *CONTROLLED], refused={
            "gradient": SAMPLED, "planar": "measure an angle, a motion in the plane"}),
    # dense: both factors are kept between samples
    "sampled, beam": Row(lambda: lane.controlled(lane.beam(), "base", "hinge", 4e3), 1e-3, 0.06,
                         "tip.position", ["load.amplitude", *CONTROLLED], refused={
                             "gradient": SAMPLED, "planar": OUT}),
    "laws, chain": Row(lambda: lane.flowing(lane.chain(), "end 1", "hinge 0", 1e4), 1e-3, 0.06,
                       "tip.position", ["load.amplitude", *CONTROLLED], refused={
                           "gradient": "without derivatives", "planar": OUT}),
    "laws, loop": Row(in_loop(lane.flowing, 16, held=False), 1e-3, 0.06, "c.position", [
        "torque.amplitude", *CONTROLLED], refused={
            "gradient": "without derivatives", "planar": OUT}, index=(2,)),
    "law in a loop": Row(governed, 0.002, 0.1, "c.position", [
        "coupler.stiffness", "crank.mass", "loop.parameters"], {"c": final("c.position")}, {
            "lanes": STARTS, "planar": OUT}, falls=1.4),
    "linkage": Row(lane.linkage, 4e-3, 0.3, "tip.position", [
        "spring.stiffness", "motor.amplitude", "gravity"]),
    "contacts": Row(lane.touching_linkage, 4e-3, 0.24, "tip.position", [], refused={
        "gradient": "'air'"}, falls=1.5, ranges={
        "floor.coefficient": (0.1, 0.5), "buffer.upper": (2.36, 2.5), "motor.amplitude": (-3, 4),
        "load.amplitude": (-1, 2)}),
    "stops": Row(lane.stopped_beam, 2e-3, 0.12, "tip.position", [], refused={
        "planar": OUT}, ranges={
        "beam.stiffness": (0.6, 1.6), "motor.amplitude": (-1, 2), "coil.stiffness": (1e4, 1e5)}),
    "exported arm": Row(exported_models.with_law, 2e-3, 0.1, "the hand.position", [
        "a wind.amplitude", "a pull.amplitude"], refused={
        "gradient": "controller 'loop' is sampled", "planar": OUT}, exported=True),
    "close rows": Row(wheel, 0.01, 1.5, "pin.rate", ["motor.table", "wheel.mass"], {
        "x": final("hub.rotation")}, exported=True, plain=True),
    "path": Row(bead, 0.005, 0.5, "bead.position", ["mass.mass", "spring.stiffness"], refused={
        "gradient": "is on a path, which is not differentiated",
        "lanes": ALONE, "C": "is on a path, which is not exported",
        "planar": "path 'wire' has no planar form"}),
}
