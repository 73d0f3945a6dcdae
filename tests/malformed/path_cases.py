"""Wrong paths, joints on them and drives of these."""

from dataclasses import replace

from malformed.cases import (
    INF,
    NAN,
    NO_NAME,
    NO_NUMBER,
    Right,
    are,
    have,
    nodes,
    not_negative,
    vectors,
)
from malformed.model_cases import (
    BODY,
    FE,
    OTHER,
    TABLE,
    foreign,
    histories,
    lacks_place,
    lacks_turn,
    names,
    spatial,
)

from sebody import Model
from sebody.reduction import craig_bampton

CURVE = [(3.0, 0.0, 0.0), (4.0, 0.0, 0.0), (5.0, 0.0, 1.0)]
SHORT = craig_bampton(FE, {0: "full", 2: "full"}, 1, recover=[0, 1])
BARE = replace(BODY, recovery=None)


def railway() -> Model:
    """The model of the other cases, with paths, joints on these and superelements of all kinds."""
    model = spatial()
    model.superelement("short", SHORT, ["a", "b"])
    model.superelement("bare", BARE, ["a", "b"])
    model.superelement("averaged", BODY, ["a", "b"], frame="mean", inertia="material")
    model.path("curve", points=CURVE)
    model.path("rail", on="beam")
    model.path("slot", on="c", points=[(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    model.path("open", points=CURVE, ends="straight")
    model.path_joint("place", "curve", name="runs")
    model.path_joint("place", "curve", name="moved")
    model.drive_way("moved", TABLE)
    return model


def _foreign_path():
    other = Model()
    return other.path("curve", points=CURVE)


RUB, STOP, SPRING = "friction in 'runs'", "stop of 'runs'", "spring of 'runs'"
WHERE = "path 'new'"
ENDS = f"{WHERE}: ends is"
CASES = {
    "path": Right(Model.path, {"name": "new", "on": "beam", "nodes": ("a", "b")}, {
        "name": are("name of the path", *NO_NAME),
        "on": [*are(f"{WHERE}: on", 3, 2.5, True), *have("is unknown", "far", "bea", ["far"]),
               *have("give superelements", [3], [None], {}, []),
               ("ball", f"{WHERE}: 'ball' is a rigid body: give the node that it is on"),
               (["beam", "beam"], f"{WHERE}: superelement 'beam' is given twice"),
               ("bare", f"{WHERE}: superelement 'bare' has no recovery"),
               ("short", f"{WHERE}: superelement 'short' has no FE nodes on the line"),
               ("averaged", f"{WHERE}: the frame 'mean' of superelement 'averaged' averages"),
               (OTHER, foreign[1]), ("a", f"{WHERE} is on node 'a': give its points="),
               ("place", lacks_turn[1]), ("turn", lacks_place[1]),
               (None, f"{WHERE} is on the ground: give its points="),
               (["beam", "short", "mast"], f"{WHERE} has 3 superelements and nodes= 2")],
        "nodes": [*are(f"{WHERE}: nodes", 3, 2.5),
                  ("ab", f"{WHERE}: path of superelement 'beam', 'ab' is unknown: the body has "
                   "none: import it with --path"), *have("give two at least", [], ["a"], [0]),
                  *have("node 'far' is unknown", ["a", "far"]),
                  (["a", "c"], f"{WHERE}: node 'c' is no node of superelement 'beam'"),
                  (["a", "a"], f"{WHERE}: nodes= are 'a', 'a': give two nodes of the model"),
                  (["a", "b", "a"], f"{WHERE}: nodes= are 'a', 'b', 'a'"),
                  *have(f"{WHERE}: superelement 'beam' has no FE node", [0, 9], [-1, 2]),
                  *have(f"{WHERE}: an FE node of superelement 'beam'", [0, 1.5], [0, None],
                        [0, "b"], [True, 2], [[0], [1]]),
                  ([0, 0, 2], f"{WHERE}: FE node 0 of 'beam' and FE node 0 of 'beam', which")],
        "points": have(f"{WHERE} is on a superelement: give nodes= of it", CURVE, 3, "abc", []),
        "blend": not_negative(f"{WHERE}: blend"),
        "ends": [*are(f"{WHERE}: ends", 3, "buffer", "", ("refuse",), ("refuse", "open"),
                      ("straight", None), ["refuse"] * 3),
                 ("stop", f"{WHERE}: stop: give stiffness=, the force at a depth of one"),
                 (None, "ends")],
        "stiffness": [(1.0, f"{WHERE} has no stop at its ends: leave stiffness= out")]}),
    "path with stops": Right(Model.path, {
        "name": "new", "points": CURVE, "ends": "stop", "stiffness": 1e3, "restitution": 0.4,
        "at_speed": 2.0}, {
            "stiffness": [*are(f"{WHERE}: stop: stiffness", 0.0, -1.0, NAN, "1"),
                          (None, f"{WHERE}: stop: give stiffness=")],
            "restitution": have(f"{WHERE}: stop: restitution is", 0.0, 1.5, NAN, "1"),
            "at_speed": have(f"{WHERE}: stop: at_speed is", 0.0, -1.0, NAN)}),
    "curve": Right(Model.path, {"name": "new", "on": "c", "points": CURVE}, {
        "points": [*are(f"{WHERE}: points", "abc", 3, [], [CURVE[0]], [(0.0, 1.0), (1.0, 2.0)],
                        [(0.0, NAN, 0.0), (1.0, 0.0, 0.0)], [(0.0, 0.0, INF), (1.0, 0.0, 0.0)],
                        [(1j, 0, 0), (1, 0, 0)], [("0", "1", "2"), ("1", "1", "1")]),
                   (None, f"{WHERE} is on node 'c': give its points="),
                   ([CURVE[0], CURVE[0]], f"{WHERE}: point 0 and point 1, which follow each other"),
                   ([*CURVE, CURVE[2]], f"{WHERE}: point 2 and point 3, which follow each other")],
        "nodes": have(f"{WHERE} is on node 'c': give its points=, and no nodes=", ("a", "b"),
                      [0])}),
    "bodies of a path": Right(Model.path, {"name": "new", "on": ["mast", "beam"]}, {
        "on": [(["mast", "short"], f"{WHERE}: superelement 'short' has no FE nodes on the line")],
        "nodes": [([("a", "d"), ("a", "b")], f"{WHERE}: 'beam' begins 2 away from the end of"),
                  ([("a", "d")], f"{WHERE} has 2 superelements and nodes= 1 sequences: give")],
        "blend": [(0.9, f"{WHERE}: blend is 0.9, and its shortest piece 1.0198 long")]}),
    "path_joint": Right(Model.path_joint, {"node": "place", "path": "curve", "name": "new"}, {
        "node": [*nodes(foreign, lacks_place),
                 ("b", "path joint at 'b': the node is 2.01 away from path 'curve': the nearest "
                  "place on it is (3, 0, 0)")],
        "path": [*are("path joint at 'place': path", 3, None, ["curve"], 1.5),
                 ("far", "path 'far' is unknown"),
                 ("rail", "path joint at 'place': the node is"),
                 (_foreign_path(), "path 'curve' is of another model")],
        "turns": [("free", "path joint at 'place': turns 'free' is unknown: use 'with'"),
                  (3, "turns 3 is unknown: use 'with'"), ("", "turns '' is unknown: use 'with'")],
        "axis": have("path joint at 'place': axis is of a node that turns with the path: leave it "
                     "out, or give turns='with'", "z", (1.0, 0.0, 0.0), 3),
        "across": have("axis of the freedom across a path at 'place'", 3, "level", (1.0, 0.0),
                       (0.0, 0.0, 0.0), (NAN, 0.0, 1.0)),
        "start": [*[pair for pair in are("path joint at 'place': start", *NO_NUMBER)
                    if pair[0] is not None],
                  (-1.0, "start is -1, beyond the ends of path 'curve', 0 and 2.4"),
                  *have("start is 9, beyond the ends", 9.0),
                  (1.0, "path joint at 'place': the node is 1 away from path 'curve': its place at "
                   "start=1 is (4, ")],
        "rate": [pair for pair in are("path joint at 'place': rate", *NO_NUMBER)
                 if pair[0] is not None],
        "inertia": not_negative("path joint at 'place': inertia"),
        "name": names("path at place")}),
    "path_joint with a start": Right(Model.path_joint, {
        "node": "place", "path": "open", "start": 0.0}, {
            "node": [("a", "path joint at 'a': the node is 3 away from path 'open': its place at "
                      "start=0 is (3, 0, 0), put the node there")],
            "path": [("rail", "path joint at 'place': the node is"),
                     ("slot", "path joint at 'place': the node is")]}),
    "path_joint on a rail": Right(Model.path_joint, {"node": "c", "path": "rail"}, {
        "node": [("a", "path joint at 'a': the node is one of superelement 'beam'"),
                 ("d", "path joint at 'd': the node is")],
        "path": [("slot", "path joint at 'c': the node carries path 'slot' itself")]}),
    "moving_force": Right(Model.moving_force, {
        "path": "rail", "force": (0.0, 0.0, 1.0), "way": TABLE, "spacing": (0.0, 0.5),
        "factors": (1.0, 2.0)}, {
            "path": [*are("moving force: path", 3, None, ["rail"]),
                     ("far", "path 'far' is unknown"),
                     ("slot", "moving force along 'slot': the path is a curve on 'c'"),
                     (_foreign_path(), "path 'curve' is of another model")],
            "force": vectors("moving force along 'rail': force", 3),
            "way": histories()[:6],
            "spacing": [*are("moving force along 'rail': spacing", "abc", None, 3, [], [NAN],
                             [[0.0, 1.0]], ["0", "1"]),
                        ([0.0], "moving force along 'rail': spacing has 1 forces and factors 2")],
            "factors": [*are("moving force along 'rail': factors", "abc", 3, [], [INF, 1.0]),
                        ([1.0], "spacing has 2 forces and factors 1: give one number for each")],
            "name": names("force along rail")}),
    "drive_way": Right(Model.drive_way, {"joint": "runs", "motion": TABLE}, {
        "joint": [*are("drive of the way", None, 3, ["runs"], also=": give a joint"),
                  ("far", "element 'far' is unknown"),
                  ("pin", "drive_way: joint 'pin' is a revolute, which has no way along a path"),
                  ("moved", "drive_way: joint 'moved' is driven already")],
        "motion": have("motion of a drive", None, "abc", [(0.0, NAN)], [(1, 0), (0, 1)], [],
                       [(0.0, "1")]),
        "name": names("drive of runs")}),
    "friction along a path": Right(Model.friction, {
        "joint": "runs", "coefficient": 0.3, "preload": 2.0}, {
            "coefficient": not_negative(f"{RUB}: coefficient"),
            "static": [(0.2, f"{RUB}: static is 0.2, below the coefficient of sliding 0.3")],
            "radius": [(0.1, f"{RUB}: a point on a path turns freely and bears no moment: leave "
                        "radius= out")],
            "arm": [(0.1, "bears no moment: leave arm= out")],
            "takes": [("axial", f"{RUB}: takes is of revolute and universal joints in space")],
            "preload": not_negative(f"{RUB}: preload"),
            "slip": are(f"{RUB}: slip", -1.0, 0.0, NAN, "1"),
            "bristle": are(f"{RUB}: bristle", -1.0, 0.0, NAN, "1"),
            "name": names("friction in runs")}),
    "friction of a preload along a path": Right(Model.friction, {
        "joint": "runs", "coefficient": 0.3, "preload": 2.0, "reaction": False}, {
            "preload": [(0.0, f"{RUB}: nothing presses, since the force in it is not read: give "
                         "preload= or reaction=True")]}),
    "stop along a path": Right(Model.stop, {
        "of": "runs", "lower": -0.5, "upper": 2.0, "stiffness": 1e3}, {
            "lower": [*are(f"{STOP}: lower", NAN, "1"),
                      (3.0, f"{STOP}: lower is 3 and upper 2, which leaves no room"),
                      (0.5, f"{STOP}: it starts at 0, beyond the limits 0.5 and 2")],
            "upper": [(-0.1, f"{STOP}: it starts at 0, beyond the limits")],
            "stiffness": [(None, f"{STOP}: give stiffness=, the force at a depth of one")],
            "name": names("stop of runs")}),
    "spring along a path": Right(Model.spring, {
        "node": "runs", "stiffness": 2.0, "length": 0.5}, {
            "node": [*have("has one end: give to=", "place", "pin", "far", 3, None),
                     (["runs"], "has one end: give to=")],
            "to": [("a", "acts along its path and has the node 'a': leave to= out")],
            "stiffness": not_negative(f"{SPRING}: stiffness"),
            "damping": not_negative(f"{SPRING}: damping"),
            "cubic": not_negative(f"{SPRING}: cubic"),
            "length": are(f"{SPRING}: length", NAN, INF, "1"),
            "name": names("spring of runs")}),
    "actuator along a path": Right(Model.actuator, {"name": "engine", "joint": "runs"}, {
        "what": [("torque", "actuator 'engine': what 'torque' is unknown: use 'force'")],
        "inertia": are("actuator 'engine': inertia", -1.0, NAN),
        "direction": [((1.0, 0.0, 0.0), "actuator 'engine': a direction goes with node= alone")]}),
}
