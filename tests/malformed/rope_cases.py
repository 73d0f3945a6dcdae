"""Wrong sheaves and ropes."""

from malformed.cases import (
    NO_NAME,
    Right,
    are,
    have,
    nodes,
    not_negative,
    positive,
    vectors,
)
from malformed.model_cases import X, Z, foreign, lacks_place, spatial

from sebody import Model


def hoist() -> Model:
    """The model of the other cases, with sheaves in the plane of its nodes and one across it."""
    model = spatial()
    for name, node, radius, axis in (("head", "p", 0.3, Z), ("tail", "q", 0.2, Z),
                                     ("foot", "place", 0.25, Z), ("across", "d", 0.1, X),
                                     ("large", "b", 1.5, Z)):
        model.sheave(name, node, radius, axis)
    return model


FOREIGN = hoist().sheaves["head"]
NEW, ROPE = "sheave 'new'", "rope 'line'"
CASES = {
    "sheave": Right(Model.sheave, {"name": "new", "node": "a", "radius": 0.1, "axis": Z,
                                 "inertia": 0.2, "friction": 0.1}, {
        "name": [*are("name of a sheave", *NO_NAME),
                 ("head", "sheave 'head' is there already: give another name"),
                 ("a", "sheave cannot be called 'a': a node has that name")],
        "node": nodes(foreign, lacks_place), "radius": positive(f"{NEW}: radius"),
        "inertia": not_negative(f"{NEW}: inertia"), "friction": not_negative(f"{NEW}: friction"),
        "axis": [(None, f"{NEW} has no axis: give axis=, the direction it turns about"),
                 *[pair for pair in vectors("axis of the sheave 'new' at 'a'", 3)
                   if pair[0] is not None],
                 ((0.0, 0.0, 0.0), "axis of the sheave 'new' at 'a' is zero: give its direction")],
    }),
    "rope": Right(Model.rope, {"name": "line", "places": ("a", "d", "foot", "head", "tail"),
                               "stiffness": 1e4, "damping": 2.0, "pretension": 3.0,
                               "wrap": "+"}, {
        "name": [*are("name of a rope", *NO_NAME), ("ball", "rope cannot be called 'ball'")],
        "places": [*are(f"{ROPE}: places", None, "abc", 3, also=": give nodes and names of"),
                   *have(f"{ROPE} has 1 place: give", ["a"]), *have(f"{ROPE} has 0 places", []),
                   *have("node is", [None, "b"], ["a", 3]),
                   *have("node or sheave 'far' is unknown", ["a", "far"]),
                   *have("node 'turn' has no position", ["a", "turn"]),
                   *have("sheave 'head' is of another model", ["a", FOREIGN]),
                   *have("'a' and 'c' are at one point: give places that lie apart", ["a", "c"]),
                   *have("from 'b' to 'across' it leaves the plane of sheave 'across' by",
                         ["b", "across"]),
                   *have("and overlap: move them apart, or give smaller radii", ["a", "large"]),
                   *have("have axes that are not parallel", ["a", "across", "head"])],
        "stiffness": positive(f"{ROPE}: stiffness"),
        "damping": not_negative(f"{ROPE}: damping"),
        "length": [*[pair for pair in positive(f"{ROPE}: length")
                     if pair[0] is not None and not isinstance(pair[0], list | str)],
                   *have(f"is unknown: {ROPE}: the model has no drives", "1", "ram"),
                   *have("motion of a drive", [(0.0, float("nan"))]),
                   (8.0, f"{ROPE} has a length and a pretension: leave one of them out")],
        "pretension": not_negative(f"{ROPE}: pretension"),
        "wrap": are(f"{ROPE}: wrap", None, "", "x", "+-", 3, ["+"], also=": give '+' or '-'")}),
}
