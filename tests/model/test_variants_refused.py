"""What variants refuse to change, and how they say it."""

import pytest
from hinged_beams import SECTION, TURN, at, linkage, reduced, slender

from sebody import InputError, Model, harmonic
from sebody.fem import straight_beam
from sebody.model.variants import copied, divide, keep_modes, rigid, with_options
from sebody.reduction import craig_bampton


def test_what_cannot_be_changed_is_said():
    original = linkage()
    cases = [
        (keep_modes, ("third", 1), "superelement 'third' is unknown: the model has second, first"),
        (keep_modes, ("first", 5), "it has 4: keep 0 to 4"),
        (with_options, ("first", "mean"), "inertia 'floating_field' needs the exact rates"),
        (divide, ("first", 2), r"model.beam has built 0 beams 'first'.*\(it has built no beam\)"),
    ]
    for change, given, message in cases:
        with pytest.raises(InputError, match=message):
            change(original, *given)
    pushed = copied(original)
    pushed.mode_force("first", 2, 1.0, name="shaker")
    with pytest.raises(InputError, match="'shaker' acts on mode 2 .*'first': keep 3 modes or more"):
        keep_modes(pushed, "first", 2)


def test_what_cannot_be_rigid_is_said():
    held = linkage()
    held.fix("elbow", "position")
    with pytest.raises(InputError, match="positions of elbow and base are both fixed"):
        rigid(held, "first")
    turned = linkage()
    turned.fix("base", "rotation")
    turned.move("elbow", TURN @ (0, 0, 1), harmonic(0.1, 3.0), what="rotation")
    with pytest.raises(InputError, match="rotations of elbow and base are both fixed"):
        rigid(turned, "first")
    thrown = linkage()
    thrown.initial_velocity("elbow", linear=TURN @ (0, 1.0, 0))
    with pytest.raises(InputError, match="initial velocity of elbow.position is not that of a "
                                         "rigid motion with base"):
        rigid(thrown, "first")
    parallel = rigid(linkage(), "second").model
    parallel.superelement("beside", reduced(at(40, 0, 0), at(40, 30, 10), 1), ["tip", "elbow2"])

    with pytest.raises(InputError, match="joined by rigid links already"):
        rigid(parallel, "beside")


def test_a_held_node_without_rotation_cannot_carry_a_rigid_body():
    model, body = Model(), straight_beam(at(0, 0, 0), at(40, 0, 0), SECTION, 2)
    model.node("base", at(0, 0, 0))
    model.node("tip", at(40, 0, 0))
    model.superelement("beam", craig_bampton(body, [(0, "translation"), (2, "full")], 0),
                       ["base", "tip"])
    assert "on node tip, with base on rigid links" in rigid(model, "beam").change
    model.fix("base", "position")
    with pytest.raises(InputError, match="'beam' cannot be made rigid: it does not keep both "
                                         "position and rotation at base, which is held"):
        rigid(model, "beam")


def test_what_a_beam_that_is_divided_must_not_lose_is_said():
    cases = [
        (lambda m: m.force("rod 1", TURN @ (0, 1, 0)), "acts on or holds its node 'rod 1'; build"),
        (lambda m: m.fix("rod 1", "position"), "acts on or holds its node 'rod 1'"),
        (lambda m: m.attach("on it", at(35, 2.5, 8), "rod 1"), "acts on or holds its node 'rod 1'"),
        (lambda m: m.mode_force("rod 2", 0, 1.0, name="shaker"),
         "'shaker' acts on superelement 'rod 2'"),
    ]
    for change, message in cases:
        model = slender(2)
        change(model)
        with pytest.raises(InputError, match=f"beam 'rod' cannot be divided anew: .*{message}"):
            divide(model, "rod", 4)
    model = rigid(slender(2), "rod 1").model
    with pytest.raises(InputError, match="superelement 'rod 1' was changed; divide the beam first"):
        divide(model, "rod", 4)
    with pytest.raises(InputError, match="8 elements cannot be divided among 3 bodies"):
        divide(slender(2), "rod", 3)
