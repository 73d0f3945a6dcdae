"""Wrong arguments of friction, stops, gears and contacts."""

from malformed.cases import (
    NAN,
    NO_FLAG,
    NO_NAME,
    NO_NUMBER,
    Right,
    are,
    have,
    not_negative,
    positive,
)

from sebody import Model, plane

FRICTION, STOP, GEAR = "friction in 'pin'", "stop of 'pin'", "gear of 'pin' and 'axle'"
COUPLING = "coupling of pin.angle and axle.angle"
CONTACT = "contact of 'd'"
NO_JOINT = [("far", "element 'far' is unknown: the model has"),
            *have("give a joint of the model or its name", None, 3, NAN)]


def unless_none(cases):
    """Wrong values of an argument that may be left out."""
    return [(value, said) for value, said in cases if value is not None]


def impact(what):
    """Of everything that is struck."""
    return {"restitution": [*not_negative(f"{what}: restitution"),
                            *have("give a number from 0.01 to 1", 0.0, 1.5)],
            "at_speed": positive(f"{what}: at_speed"),
            "stiffness": unless_none(positive(f"{what}: stiffness")),
            "exponent": are(f"{what}: exponent", *NO_NUMBER, 0.5,
                            also=": give a finite number >= 1")}


CASES = {
    "friction": Right(Model.friction, {"joint": "pin", "coefficient": 0.3, "radius": 0.1}, {
        "joint": NO_JOINT, "coefficient": not_negative(f"{FRICTION}: coefficient"),
        "static": [*unless_none(not_negative(f"{FRICTION}: static")),
                   (0.2, f"{FRICTION}: static is 0.2, below the coefficient of sliding 0.3")],
        "radius": [(None, "the joint turns, so its friction acts on a radius: give radius="),
                   *unless_none(positive(f"{FRICTION}: radius"))],
        "preload": not_negative(f"{FRICTION}: preload"),
        "arm": unless_none(positive(f"{FRICTION}: arm")),
        "reaction": are(f"{FRICTION}: reaction", *NO_FLAG, also=": give True or False"),
        "bristle": unless_none(positive(f"{FRICTION}: bristle")),
        "slip": unless_none(positive(f"{FRICTION}: slip")),
        "damping": unless_none(not_negative(f"{FRICTION}: damping")),
        "takes": [("across", "takes 'across' is unknown: use 'radial', 'axial' or 'whole'")],
        "speed": not_negative(f"{FRICTION}: speed")}),
    "stop": Right(Model.stop, {"of": "pin", "lower": -0.3, "upper": 0.5, "stiffness": 1e3}, {
        "of": [*NO_JOINT, (("p", "q", "a"), "give a joint or two nodes")],
        "lower": [*unless_none(are(f"{STOP}: lower", *NO_NUMBER)),
                  *have("which leaves no room", 0.5, 1.0),
                  (0.2, "it starts at 0, beyond the limits")],
        "upper": [*unless_none(are(f"{STOP}: upper", *NO_NUMBER)),
                  (-0.5, "lower is -0.3 and upper -0.5, which leaves no room")],
        **impact(STOP)}),
    "gear": Right(Model.gear, {
        "first": "pin", "second": "axle", "ratio": -2.0, "stiffness": 1e3}, {
            "first": NO_JOINT, "second": NO_JOINT,
            "ratio": are(f"{GEAR}: ratio", *NO_NUMBER),
            "backlash": not_negative(f"{GEAR}: backlash"),
            **impact(GEAR)}),
    "couple": Right(Model.couple, {"first": "pin", "second": "axle", "ratio": -2.0}, {
        "first": [*NO_JOINT, ("axle.angle", f"{COUPLING}: give two coordinates".replace(
            "pin", "axle")), ("sleeve", "'sleeve' turns and slides: give 'sleeve.angle' or"),
            ("pin.displacement", "'pin' is a revolute, which has no displacement: give "
             "'pin.angle'")],
        "second": [*NO_JOINT, ("pin.", "element 'pin.' is unknown: did you mean 'pin'?")],
        "ratio": [*are(f"{COUPLING}: ratio", *NO_NUMBER), (0, f"{COUPLING}: ratio is 0: give the "
                                                           "first coordinate for one of the")],
        "name": unless_none(are(f"name of the {COUPLING}", *NO_NAME))}),
    "couple slides": Right(Model.couple, {
        "first": "sleeve.displacement", "second": "guide", "ratio": -2.0}, {
            "first": NO_JOINT}),
    "screw": Right(Model.screw, {"joint": "sleeve", "pitch": 0.1}, {
        "joint": [*NO_JOINT, ("guide", "screw: 'guide' is a prismatic: give a cylindrical joint")],
        "pitch": [*are("screw in sleeve: pitch", *NO_NUMBER),
                  (0, "screw in sleeve: pitch is 0: give the way of one turn")]}),
    "rack": Right(Model.rack, {"rack": "guide", "pinion": "axle", "radius": 0.1}, {
        "rack": [*NO_JOINT, ("pin", "rack: 'pin' is a revolute, which has no displacement: give a "
                             "prismatic, slider, cylindrical")],
        "pinion": [*NO_JOINT, ("guide", "pinion: 'guide' is a prismatic, which has no angle: give "
                               "a revolute, cylindrical")],
        "radius": [*are("rack guide on axle: radius", *NO_NUMBER),
                   (0, "radius is 0: give that of the pinion")]}),
    "contact": Right(Model.contact, {
        "node": "d", "on": plane((0.0, 1.0, 0.0), (0.0, -9.0, 0.0)), "radius": 0.1,
        "stiffness": 1e4}, {
            "node": have("node", "far", None, 3),
            "on": are(f"{CONTACT}: on", None, "plane", 3.0, also=": give a sebody.plane"),
            "radius": not_negative(f"{CONTACT}: radius"),
            "friction": not_negative(f"{CONTACT}: friction"),
            **{name: [(0.5, f"{CONTACT} has {name}= and no friction: give friction=, the")]
               for name in ("static", "bristle", "damping", "speed")},
            **impact(CONTACT)}),
}
