"""Wrong arguments of everything that builds a model."""

import numpy as np
from malformed.cases import (
    INF,
    NAN,
    NO_COUNT,
    NO_FLAG,
    NO_NAME,
    NO_NUMBER,
    Right,
    are,
    have,
    nodes,
    not_negative,
    positive,
    vectors,
)

from sebody import Model
from sebody.fem import Section, loads, straight_beam
from sebody.io import LoadSeries
from sebody.reduction import craig_bampton, grounded_body

SECTION = Section(1.0, 1e-2, 1e-2, 1e-2, 1e6, 0.3, 1.0)
POINTS = {"a": (0.0, 0.0, 0.0), "b": (1.0, 0.2, 0.0), "c": (0.0, 0.0, 0.0), "d": (0.0, 2.0, 0.0)}
FE = straight_beam(POINTS["a"], POINTS["b"], SECTION, 2)
BODY = craig_bampton(FE, {0: "full", 2: "full"}, 1, loads={"wind": loads.line_load(FE, (0, 0, 1))})
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
TABLE = [(0.0, 0.0), (1.0, 2.0)]
SERIES = LoadSeries([0.0, 1.0], [[0.0, 1.0], [2.0, 3.0]], ["push", "a.rz"])
HELD = grounded_body(np.eye(7), np.eye(7), [POINTS["b"]], modes=1)




def spatial() -> Model:
    """Four full nodes, one without and one with nothing but a rotation; bodies, hinges, slides."""
    model = Model()
    for name, point in POINTS.items():
        model.node(name, point)
    model.node("place", (3.0, 0.0, 0.0), "translation")
    model.node("turn", (4.0, 0.0, 0.0), "rotation")
    model.superelement("beam", BODY, ["a", "b"])
    model.beam("mast", ("a", "d"), SECTION, 2, 1)
    model.rigid_body("ball", "d", 1.0, (1.0, 1.0, 1.0))
    for name, joint, x in (("p", "pin", 5.0), ("q", "axle", 6.0)):
        model.node(name, (x, 0.0, 0.0))
        model.rigid_body(f"disc on {name}", name, 1.0, (1.0, 1.0, 1.0))
        model.revolute(name, Z, name=joint)
    for name, joint, build in (("r", "sleeve", model.cylindrical), ("s", "guide", model.prismatic)):
        model.node(name, (7.0, 0.0, 0.0))
        model.rigid_body(f"cart on {name}", name, 1.0, (1.0, 1.0, 1.0))
        build(name, X, name=joint)
    return model


def planar() -> Model:
    """Two nodes at one point and one elsewhere."""
    model = Model(planar=True)
    for name in "abc":
        model.node(name, POINTS[name][:2])
    return model


OTHER = spatial().nodes["a"]
foreign = (OTHER, "node 'a' is of another model: use that of this one")
lacks_place = ("turn", "node 'turn' has no position: make it with keeps='full'")
lacks_turn = ("place", "node 'place' has no rotation: make it with keeps='full'")
itself = ("a", "node 'a' is joined to itself: give two nodes")
apart = ("b", "nodes 'a' and 'b' do not coincide: give both the same point")


def given(cases):
    """Cases without that of an argument that may be left out."""
    return [(value, said) for value, said in cases if value is not None]


def axis(what: str) -> list:
    """Wrong axes of a joint at node a."""
    return [*vectors(f"axis of the {what} at 'a'", 3),
            ((0.0, 0.0, 0.0), f"axis of the {what} at 'a' is zero: give its direction")]


def names(default: str) -> list:
    """Wrong names of a joint, load or drive."""
    return [*[pair for pair in are(f"name of the {default}", *NO_NAME) if pair[0] is not None],
            ("ball", f"{default} cannot be called 'ball': a rigid body has that name")]


def histories() -> list:
    """Wrong histories of a load."""
    return [*have("time function of a load has shape", [1.0, 2.0], [(0.0, 1.0, 2.0)]),
            *are("time function of a load", NAN, INF, True, 1j, also=": give "),
            *have("time function of a "
                  "load", "abc", [("0", "1")], [(0, 1), (1,)], [(0.0, 1j)], {}, []),
            *have("time function of a load contains NaN or infinite", [(0.0, NAN)], [(0.0, INF)]),
            *have("times of a time function of a load must not decrease", [(1.0, 0.0), (0.0, 1.0)])]


BODIES = {
    "Model": Right(lambda m, **a: Model(**a), {"planar": False},
                   {"planar": are("planar", *NO_FLAG, [])}),
    "node": Right(Model.node, {"name": "new", "point": X}, {
        "name": [*are("name of a node", *NO_NAME, also=": "),
                 ("a", "node 'a' exists already: give every node its own name"),
                 *[(name, f"a node cannot be called {name!r}: results have {name}.* of the model")
                   for name in ("constraints", "energy")]],
        "point": vectors("point of node 'new'", 3),
        "keeps": have("node 'new' keeps", "both", None, 3, [], True),
        "at": [*[pair for pair in nodes(foreign) if pair[0] is not None],
               ("b", "cannot share the position of 'b'")]}),
    "attach": Right(Model.attach, {"name": "new", "point": X, "to": "a"}, {
        "name": are("name of a node", *NO_NAME), "point": vectors("point of node 'new'", 3),
        "to": nodes(foreign, lacks_place, lacks_turn)}),
    "initial_velocity": Right(Model.initial_velocity, {"node": "a", "linear": X, "angular": X}, {
        "node": nodes(foreign, lacks_place),
        "linear": [pair for pair in vectors("initial rate of a.position", 3)
                   if pair[0] is not None],
        "angular": [pair for pair in vectors("initial rate of a.rotation", 3)
                    if pair[0] is not None]}),
    "rigid_velocity": Right(Model.rigid_velocity, {"linear": X, "angular": Z, "about": Y}, {
        "linear": vectors("linear velocity", 3), "angular": vectors("angular velocity", 3),
        "about": [pair for pair in vectors("about", 3) if pair[0] is not None]}),
    "superelement": Right(Model.superelement, {"name": "new", "body": BODY, "nodes": ["a", "b"]}, {
        "name": [*are("name of a superelement", *NO_NAME),
                 ("beam", "superelement 'beam' exists already")],
        "body": are("body of superelement 'new'", None, 3, "beam", SECTION,
                    also=": give a ReducedBody"),
        "nodes": [*are("nodes of superelement 'new'", None, "ab", 3),
                  *have("superelement 'new' has 2 boundary nodes and", ["a"], [], ["a", "b", "c"]),
                  *have("superelement 'new': the nodes do not lie where", ["b", "a"], ["a", "a"]),
                  *have("node is", [None, "b"], ["a", 3]), (["a", "x"], "node 'x' is unknown"),
                  (["a", "place"], "node 'place' has no rotation")],
        "frame": have("frame", "middle", 3, [], {}),
        "inertia": have("inertia", "z", 3, []),
        "stiffening": are("superelement 'new': stiffening", 1, "yes"),
        "rotation": [*are("rotation", "abc", 3j),
                     *have("rotation", 1.0, [[1, 0], [0, 1]], [[NAN] * 3] * 3,
                           [[2, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 0], [1, 0, 0], [0, 0, 1]])]}),
    "frame node": Right(Model.superelement, {
        "name": "new", "body": BODY, "nodes": ["a", "b"], "frame": "node", "frame_node": 1}, {
            "frame_node": [*[pair for pair in are("frame_node", *NO_COUNT) if pair[0] is not None],
                           *have("cannot carry the frame", 2, -1)]}),
    "foundation": Right(Model.foundation, {"name": "new", "body": HELD, "nodes": ["b"]}, {
        "name": [*are("name of a foundation", *NO_NAME),
                 ("beam", "superelement 'beam' exists already")],
        "body": [*are("body of foundation 'new'", None, 3, "beam"),
                 (BODY, "foundation 'new': its body is not held to the ground: use grounded_body")],
        "nodes": [*are("nodes of foundation 'new'", None, 3),
                  *have("foundation 'new' has 1 interface and", [], ["a", "b"]),
                  *have("node is", [None], [3]), (["x"], "node 'x' is unknown"),
                  (["place"], "node 'place' has no rotation")],
        "base": [("x", "node 'x' is unknown"), ("d", "the nodes do not lie where"),
                 ("place", "node 'place' has no rotation")],
        "rotation": [*are("rotation", "x"), *have("rotation", 3, [1.0])]}),
    "rigid_body": Right(Model.rigid_body, {
        "name": "new", "node": "a", "mass": 1.0, "inertia": (1.0, 2.0, 2.5), "centre": X}, {
            "name": [*are("name of a body", *NO_NAME), ("ball", "body 'ball' exists already"),
                     ("beam", "body 'beam' exists already")],
            "node": nodes(foreign, lacks_place, lacks_turn), "mass": positive("mass of 'new'"),
            "inertia": [*have("inertia of 'new'", "123", None, 1.0, (1.0, 2.0), (1, 1, NAN),
                              (1j, 1, 1), ("1", "1", "1"), [[1.0, 0], [0, 1.0]]),
                        *have("inertia of 'new' has the principal moments", (1.0, 1.0, 3.0),
                              (-1.0, 1.0, 1.0)),
                        ([[1, 1, 0], [0, 1, 0], [0, 0, 1]], "inertia of 'new' is not symmetric")],
            "centre": [pair for pair in vectors("centre of 'new'", 3) if pair[0] is not None]}),
    "unbalance": Right(Model.unbalance, {
        "node": "a", "mass_times_radius": 0.1, "phase": 0.3, "axis": X}, {
            "node": nodes(foreign, lacks_place, lacks_turn),
            "mass_times_radius": positive("unbalance at 'a': mass_times_radius"),
            "phase": are("unbalance at 'a': phase", *NO_NUMBER),
            "axis": given(axis("unbalance")), "name": names("unbalance at a")}),
    "point_mass": Right(Model.point_mass, {"name": "new", "node": "a", "mass": 1.0}, {
        "name": are("name of a body", *NO_NAME), "node": nodes(foreign, lacks_place),
        "mass": positive("mass of 'new'")}),
    "beam": Right(Model.beam, {"name": "new", "ends": ("a", "d"), "section": SECTION,
                               "elements": 4, "bodies": 2, "modes": 1, "damping": 0.1}, {
        "name": are("name of a beam", *NO_NAME),
        "ends": [*are("ends of beam 'new'", None, "ad", 3, ["a"], ["a", "b", "c"]),
                 *have("node", ["a", None], ["a", "far"]),
                 (["a", "c"], "both ends at the same point"),
                 (["a", "place"], "node 'place' has no rotation")],
        "section": have("section", None, 3, "IPE 200", BODY),
        "elements": [*are("elements", *NO_COUNT, 0, -2),
                     (3, "3 elements cannot be divided among 2 bodies: give a multiple")],
        "bodies": [pair for pair in have("elements cannot be divided among", *NO_COUNT, 0, 3, -1)
                   if pair[0] is not None],
        "modes": [*are("modes", *NO_COUNT), *have("modes is", -1, 1000)],
        "up": [pair for pair in vectors("up", 3) if pair[0] is not None] + [
            (Y, "lies along a beam")],
        "damping": are("beam 'new': damping", *NO_NUMBER, -1.0, also=": give a ratio of critical"),
        "axis": have("axis of beam 'new'", 3, "x", [X, Y]),
        "divide": have("beam 'new': divide", None, 3, "turns", [0.0, 1.0], [0.0, 2.0, 1.0],
                       ["0", "0.5", "1"]),
        "frame": have("frame", "middle", 3), "inertia": have("inertia", "z")}),
    "element": Right(Model.element, {"name": "ball"}, {
        "name": have("is unknown", "bal", "", None, 3, [])}),
}

REVOLUTE = {"node": nodes(foreign, lacks_place), "axis": axis("revolute joint"),
            "to": [pair for pair in nodes(foreign, itself, apart) if pair[0] is not None],
            "explicit": are("explicit of the revolute joint", *NO_FLAG),
            "name": names("revolute at a")}
JOINTS = {
    "fix": Right(Model.fix, {"node": "a", "what": "both"}, {
        "node": nodes(foreign, lacks_place, lacks_turn),
        "what": have("cannot fix", "all", None, 3, [], True)}),
    "revolute": Right(Model.revolute, {"node": "a", "axis": Z, "to": "c"}, REVOLUTE),
    "universal": Right(Model.universal, {"node": "a", "axis": X, "other": Z, "to": "c"}, {
        "axis": axis("universal joint"),
        "other": [*axis("universal joint"), (X, "its axes are at an angle of 0 degrees")],
        "to": [itself, apart], "explicit": are("explicit of the universal joint", "yes")}),
    "cylindrical": Right(Model.cylindrical, {"node": "a", "axis": Z, "to": "c"}, {
        "node": nodes(lacks_turn), "axis": axis("cylindrical joint"),
        "to": [itself, ("b", "cylindrical: node 'b' is off the axis through 'a'")],
        "name": names("cylindrical at a")}),
    "prismatic": Right(Model.prismatic, {"node": "a", "axis": Z, "to": "c"}, {
        "axis": axis("prismatic joint"), "to": [itself, ("b", "node 'b' is off the axis")]}),
    "slider": Right(Model.slider, {"node": "a", "axis": Z, "to": "c"}, {
        "node": nodes(lacks_place), "axis": axis("slider"), "to": [itself, lacks_turn]}),
    "planar_joint": Right(Model.planar_joint, {"node": "a", "normal": Z, "to": "c"}, {
        "normal": axis("planar joint"), "to": [itself, lacks_turn]}),
    "spherical": Right(Model.spherical, {"node": "a", "to": "c"}, {
        "node": nodes(lacks_place), "to": [itself, apart],
        "explicit": are("explicit of the spherical joint", *NO_FLAG)}),
    "weld": Right(Model.weld, {"node": "a", "to": "c"}, {
        "node": nodes(lacks_place, lacks_turn), "to": [itself, apart],
        "explicit": are("explicit of the weld", *NO_FLAG), "name": names("weld at a")}),
    "distance": Right(Model.distance, {"node": "a", "to": "b"}, {
        "node": nodes(lacks_place),
        "to": nodes(itself, ("c", "distance between 'a' and 'c' is zero")),
        "name": names("distance at a")}),
}
LOADS = {
    "force": Right(Model.force, {"node": "a", "direction": X, "amplitude": TABLE}, {
        "node": nodes(foreign, lacks_place), "direction": vectors("force on a.position", 3),
        "amplitude": histories(), "follower": are("follower", *NO_FLAG),
        "name": names("force on a.position")}),
    "torque": Right(Model.torque, {"node": "a", "direction": X, "amplitude": TABLE}, {
        "node": nodes(foreign, lacks_turn), "direction": vectors("torque on a.rotation", 3),
        "amplitude": histories(), "follower": are("follower", *NO_FLAG)}),
    "mode_force": Right(Model.mode_force, {
        "body": "beam", "mode": 0, "factor": 1.0, "amplitude": TABLE}, {
            "body": have("superelement", "ball", None, 3, [], BODY),
            "mode": [*are("mode of superelement 'beam'", *NO_COUNT),
                     *have("superelement 'beam' has no mode", 1, -1)],
            "factor": are("force on mode 0 of 'beam'", *NO_NUMBER), "amplitude": histories()[:4]}),
    "body_load": Right(Model.body_load, {"body": "beam", "load": "wind", "amplitude": TABLE}, {
        "body": have("superelement", "ball", None, 3, [], BODY),
        "load": have("superelement 'beam' has no load", "rain", None, 3, []),
        "amplitude": histories()[:4], "name": names("wind on beam")}),
    "body_series": Right(Model.body_series, {
        "body": "beam", "series": SERIES, "amplitude": TABLE, "columns": {"push": "b.y"}}, {
            "body": have("superelement", "ball", None, 3, [], BODY),
            "series": [*are("series on 'beam'", None, 3, TABLE, also=": give a LoadSeries"),
                       (LoadSeries([0.0], [[1.0]], ["c.x"]), "column 'push' is unknown")],
            "amplitude": histories()[:4], "name": names("series on beam"),
            "columns": [*are("columns", 3, ["push"]), ({"pull": "b.y"}, "column 'pull' is unknown"),
                        ({"push": "c.y"}, "superelement 'beam' has nothing that column 'c.y' acts "
                                          "on: columns are called 'a.x', 'a.rx', 'mode 0', 'wind'"),
                        ({"push": 3}, "superelement 'beam' has nothing that column 3 acts on")]}),
    "beam_series": Right(Model.beam_series, {
        "beam": "mast", "series": SERIES, "stations": [0.5, 1.0], "direction": Z}, {
            "beam": have("beam", "beam", None, 3, []),
            "series": are("series on beam 'mast'", None, 3, TABLE, also=": give a LoadSeries"),
            "stations": [*have("stations", None, [0.5], [1.0, 0.5], [0.5, 9.0], [-1.0, 1.0]),
                         *have("stations are", [0.5, 0.5])],
            "direction": vectors("direction of the series on beam 'mast'", 3)}),
    "user_force": Right(Model.user_force, {
        "name": "new", "nodes": ["a"], "function": lambda t, x, v, force: None}, {
            "name": are("name of a user force", *NO_NAME),
            "nodes": [*are("nodes of user force 'new'", None, 3, "a"), ([], "has no nodes"),
                      *have("node", [None], ["far"], ["turn"])],
            "function": [*are("user force 'new'", None, 3, "sin", also=": give a function of (t,"),
                         *have("user force 'new' has the arguments (t): give", lambda t: t)]}),
    "gravity": Right(Model.gravity, {"field": Z}, {
        "field": vectors("gravity", 3), "amplitude": histories()}),
    "spring": Right(Model.spring, {"node": "a", "to": "b", "stiffness": 1.0}, {
        "node": nodes(lacks_place),
        "to": [*[pair for pair in nodes(itself, ("c", "nodes 'a' and 'c' coincide"))
                 if pair[0] is not None], (None, "spring at 'a' has one end: give to=")],
        "stiffness": not_negative("spring: stiffness"), "damping": not_negative("spring: damping"),
        "length": [pair for pair in not_negative("spring: length") if pair[0] is not None],
        "cubic": not_negative("spring: cubic"), "name": names("spring at a")}),
    "table spring": Right(Model.spring, {
        "node": "a", "to": "b", "force": [(-1.0, -2.0), (0.0, 0.0), (1.0, 3.0)]}, {
            "force": [*have("spring at 'a': force", "no/file.csv", [1.0, 2.0], [(0.0, 1.0)], [],
                            [(1.0, 0.0), (0.0, 0.0)], [(0.0, NAN), (1.0, 0.0)])],
            "gap": [(-1.0, "spring at 'a': gap"), ("1", "spring at 'a': gap")],
            "preload": are("spring at 'a': preload", *NO_NUMBER),
            "tension_only": are("spring at 'a': tension_only", *[
                one for one in NO_FLAG if one is not None]),
            "stiffness": [(1.0, "has a stiffness and a force: give one of them")],
            "between": [((0.0, 1.0), "is a table, so leave between= out")]}),
    "table torsion": Right(Model.torsion_spring, {
        "node": "a", "to": "c", "force": [(-1.0, -2.0), (0.0, 0.0), (1.0, 3.0)]}, {
            "cubic": [(1.0, "put the cubic in force=")]}),
    "torsion_spring": Right(Model.torsion_spring, {"node": "a", "stiffness": 1.0, "to": "c"}, {
        "stiffness": not_negative("torsion spring: stiffness"),
        "axis": given(axis("torsion spring")),
        "rest": are("torsion spring at 'a': rest", *NO_NUMBER), "to": [itself, lacks_turn]}),
    "bushing": Right(Model.bushing, {"node": "a", "to": "c", "stiffness": 1.0}, {
        **{name: [pair for pair in are(
            f"bushing at 'a' has a coefficient that is negative or no number: {name}",
            "1", None, 1j, NAN, -1.0, (1.0, 2.0), (1.0, 1.0, -1.0), ("1", "1", "1"))]
           for name in ("stiffness", "damping", "turning_stiffness", "turning_damping")},
        "to": [itself, apart]}),
    "bearing by a table": Right(Model.bushing, {
        "node": "a", "to": "c", "table": {"frequency": [1.0, 2.0], "kxx": [3.0, 4.0]},
        "speed": 1.5}, {
            "table": have("bushing at 'a': table", 3, {}, {"kxx": [1.0, 2.0]},
                          {"frequency": [1.0, NAN], "kxx": [3.0, 4.0]}),
            "speed": [*[pair for pair in are("bushing at 'a': speed", *NO_NUMBER, -1.0)
                        if pair[0] is not None],
                      (9.0, "bushing at a' has a table for speeds from 1 to 2")]}),
    "drive_angle": Right(Model.drive_angle, {"node": "a", "motion": TABLE, "to": "c"}, {
        "node": nodes(lacks_turn), "axis": given(axis("drive")),
        "motion": have("motion of a drive", None, "abc", [(0.0, NAN)], [(1, 0), (0, 1)]),
        "to": [itself, lacks_turn]}),
    "drive_slide": Right(Model.drive_slide, {"node": "a", "motion": TABLE, "axis": Z, "to": "c"}, {
        "axis": [*given(axis("drive")), (None, "drive at 'a' has no axis: give axis=")],
        "motion": have("motion of a drive", None, "abc", [(0.0, "1")])}),
    "move": Right(Model.move, {"node": "a", "direction": X, "motion": TABLE}, {
        "node": nodes(foreign, lacks_place),
        "direction": [*vectors("motion of a.position", 3),
                      ((0.0, 0.0, 0.0), "motion of a.position has the direction")],
        "motion": [*have("motion of a drive", "abc", [(0.0, NAN)], []),
                   (None, "motion of a.position: give either motion= or acceleration=")],
        "what": have("cannot move", "both", None, 3, [])}),
    "move by accelerations": Right(Model.move, {
        "node": "a", "direction": X, "acceleration": TABLE, "drift": "keep"}, {
            "motion": [(TABLE, "motion of a.position: give either motion= or acceleration=")],
            "acceleration": [
                *have("acceleration of a.position", 3.0, [(0.0, NAN), (1.0, 2.0)], [], [1.0, 2.0],
                      [(1.0, 0.0), (0.0, 0.0)], [(0.0, 1.0)], {}, "no/file.csv")],
            "drift": have("acceleration of a.position: drift", "all", 3, True)}),
}
def _push(t, y, x, u, parameters):
    u[0] = -y[0]


def _flow(t, y, x, rates, u, parameters):
    u[0] = -y[0]


MOTOR, GAUGE, PUSH = "actuator 'motor'", "sensor 'gauge'", "controller 'push'"
CONTROL = {
    "actuator": Right(Model.actuator, {"name": "motor", "node": "a", "direction": X}, {
        "name": are("name of an actuator", *NO_NAME),
        "node": [(None, f"{MOTOR} acts on nothing, or on several things"),
                 *[pair for pair in nodes(foreign, lacks_place) if pair[0] is not None]],
        "direction": [*have("give", None, (1.0, 2.0), "123"),
                      ((0.0, 0.0, 0.0), f"{MOTOR} has the direction (0.0, 0.0, 0.0), along which "
                       "it pushes nothing")],
        "ratio": are(f"{MOTOR}: ratio", *NO_NUMBER, 0.0),
        "inertia": [*are(f"{MOTOR}: inertia", *NO_NUMBER, -1.0), (1.0, "no rotor turns with")],
        "lag": are(f"{MOTOR}: lag", *NO_NUMBER, -1.0), "start": are(f"{MOTOR}: start", *NO_NUMBER),
        "rate": [pair for pair in positive(f"{MOTOR}: rate") if pair[0] is not None],
        "limit": [*are(f"{MOTOR}: limit", 0.0, -1.0, NAN, (2.0, 1.0), (1.0, 2.0, 3.0))]}),
    "continuous controller": Right(Model.controller, {"name": "push", "law": _flow, "inputs": [
            "a.position.x"], "outputs": ["signal"]}, {
        "inputs": have(f"inputs of {PUSH}", None, 3),       # names are looked up where a run starts
        "delay": have("write the delay as states", 2),
        "derivatives": have(f"derivatives of {PUSH}", 3, _flow),
        "corners": have("", [NAN], "ab"), "law": have(PUSH, None, 3, "sin")}),
    "sensor": Right(Model.sensor, {"name": "gauge", "quantity": "a.position.x", "rate": 10.0}, {
        "name": are("name of a sensor", *NO_NAME),
        "quantity": are(f"{GAUGE}: quantity", *NO_NAME),
        "rate": [pair for pair in positive(f"{GAUGE}: rate") if pair[0] is not None],
        "delay": are(f"{GAUGE}: delay", *NO_COUNT, -1), "bias": are(f"{GAUGE}: bias", *NO_NUMBER),
        "noise": are(f"{GAUGE}: noise", *NO_NUMBER, -1.0),
        "seed": are(f"{GAUGE}: seed", *NO_COUNT, -1)}),
    "controller": Right(Model.controller, {"name": "push", "law": _push, "period": 0.1, "inputs": [
            "a.position.x"], "outputs": ["signal"]}, {
        "name": are("name of a controller", *NO_NAME), "law": have(PUSH, None, 3, "sin"),
        "inputs": have(f"inputs of {PUSH}", None, 3),
        "outputs": have(f"outputs of {PUSH}", None, []),
        "period": [(None, f"{PUSH} has no period, and its function is that of a sampled one"),
                   *[pair for pair in positive(f"{PUSH}: period") if pair[0] is not None]],
        "derivatives": have("leave out one of the two", _push),
        "corners": have("leave out one of the two", [0.5]),
        "delay": are(f"{PUSH}: delay", *NO_NUMBER, -1),
        "states": have(f"{PUSH}: states", "ab", [NAN], [[1.0]]),
        "parameters": have(f"{PUSH}: parameters", "ab", [INF], [[1.0]])}),
}
FLAT = {
    "planar node": Right(Model.node, {"name": "new", "point": (1.0, 2.0)},
                         {"point": vectors("point of node 'new'", 2)}),
    "planar torque": Right(Model.torque, {"node": "a", "direction": 1.0}, {
        "direction": are("torque on a.rotation", "1", None, True, 1j, NAN, (1.0, 2.0),
                         also=": give 1 finite number")}),
    "planar unbalance": Right(Model.unbalance, {"node": "a", "mass_times_radius": 1.0}, {
        "axis": have("unbalance at 'a': a model in a plane has no axis=", X, 1.0, "z")}),
    "planar body": Right(Model.rigid_body, {
        "name": "new", "node": "a", "mass": 1.0, "inertia": 1.0}, {
            "inertia": are("inertia of 'new'", *NO_NUMBER, -1.0, (1.0, 1.0, 1.0))}),
    "planar gravity": Right(Model.gravity, {"field": (0.0, 1.0)}, {"field": vectors("gravity", 2)}),
    "planar beam": Right(Model.beam, {"name": "new", "ends": ("a", "b"), "section": SECTION,
                                      "elements": 1}, {
        "up": have("beam 'new': up is for beams in space", (0.0, 1.0), X)}),
}
