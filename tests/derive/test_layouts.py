"""Names of layouts, their coordinates, and what is said about those that cannot be used."""

import pytest

from sebody.contract.names import superelement_name
from sebody.derive.kernels.layouts import Layout, LayoutError
from sebody.derive.kernels.superelement import superelement
from sebody.derive.names import kernel_of


@pytest.mark.parametrize("name, positions, rotations, first_rotation, first_mode", [
    ("f2", 2, 2, 6, 12), ("f1", 1, 1, 3, 6), ("f2t1", 3, 2, 9, 15), ("f2r1", 2, 3, 6, 15),
    ("f1t2r3", 3, 4, 9, 21), ("t8", 8, 0, 24, 24), ("t2r1", 2, 1, 6, 9),
    ("f12", 12, 12, 36, 72), ("planar-f2", 2, 2, 4, 6), ("planar-f1t2r3", 3, 4, 6, 10),
    ("planar-t4", 4, 0, 8, 8)])
def test_counts_of_coordinates(name, positions, rotations, first_rotation, first_mode):
    """DOF blocks in space; in a plane two coordinates a position and one a rotation."""
    layout = Layout.parse(name)
    assert (layout.positions, layout.rotations) == (positions, rotations)
    assert (layout.first_rotation, layout.first_mode) == (first_rotation, first_mode)
    assert layout.planar == name.startswith("planar-")
    assert layout.name == name


@pytest.mark.parametrize("name, planar, damped", [
    ("any", False, False), ("planar-any", True, False), ("anyd", False, True)])
def test_general_layouts_have_no_counts(name, planar, damped):
    layout = Layout.parse(name)
    assert layout == Layout(None, planar, None, damped) and layout.name == name
    assert {layout.positions, layout.rotations, layout.first_rotation, layout.first_mode} == {None}


def test_modes_and_what_is_of_second_order_are_pinned():
    """Slaved coordinates and stress resultants, behind the modes."""
    layout = Layout.parse("planar-f2m0s2e1")
    assert layout == Layout(("full", "full"), True, 0, False, (2, 1))
    assert layout.name == "planar-f2m0s2e1"
    assert Layout.parse("f2m12s10e0").second_order == (10, 0)
    assert Layout.parse("f2m4d").second_order is None


def test_numbers_of_second_order_where_there_are_none():
    with pytest.raises(LayoutError, match="layout f2m4s2e1: bodies with inertia option 'material' "
                                          "have no slaved coordinates and stress resultants: leave "
                                          "out s and e with their numbers"):
        superelement(Layout.parse("f2m4s2e1"), "converged_mean", "material")


def test_order_of_the_nodes_does_not_enter():
    mixed = Layout(("rotation", "full", "translation", "full"))
    assert mixed.name == "f2t1r1"
    assert Layout.parse(mixed.name).nodes == ("full", "full", "translation", "rotation")


@pytest.mark.parametrize("name, canonical", [("f0t3", "t3"), ("f02", "f2"), ("f2r0", "f2")])
def test_names_are_made_canonical(name, canonical):
    assert Layout.parse(name).name == canonical


@pytest.mark.parametrize("name", ["", "2", "f", "f-1", "x3", "t1f2", "f2 t1", "f2f2", "F2", "f2.5",
                                  "planar", "planar-", "planarf2", "flat-f2", "nonsense", "f2\n",
                                  "anym4", "anyf2", "many", "f2s2e1", "f2m4s2", "f2m4e1",
                                  "anym4s2e1", "f2m4e1s2", "f2m4ds2e1"])
def test_unreadable_name(name):
    with pytest.raises(LayoutError, match="is unknown: write counts of full, translation-only and "
                                          "rotation-only nodes, such as f2, f2t1") as caught:
        Layout.parse(name)
    assert repr(name) in str(caught.value)


@pytest.mark.parametrize("name", ["r2", "planar-r1", "f0", "t0r3"])
def test_no_position(name):
    with pytest.raises(LayoutError, match=f"layout '{name}' keeps no position: a superelement "
                                          "needs at least one node with translations"):
        Layout.parse(name)


@pytest.mark.parametrize("name, frame, message", [
    ("t3", "converged_mean", "layout t3 keeps no rotation, so the frame 'converged_mean' has "
                             "nothing to average: use the frame 'positions'"),
    ("t8", "mean", "layout t8 keeps no rotation"),
    ("f2", "positions", "layout f2 has too few positions for the frame 'positions', which needs "
                        "three nodes .two in a plane.: use 'converged_mean'"),
    ("planar-f1", "positions", "layout planar-f1 has too few positions"),
    ("planar-f2", "mean", "in a plane the frame 'mean' coincides with 'converged_mean': use that"),
    ("planar-f2", "mean_small", "in a plane the frame 'mean_small' coincides"),
    ("planar-any", "mean", "in a plane the frame 'mean' coincides with 'converged_mean'")])
def test_layouts_a_frame_cannot_carry(name, frame, message):
    with pytest.raises(LayoutError, match=message):
        superelement(Layout.parse(name), frame, "material")


@pytest.mark.parametrize("text, variant", [
    ("f2", ("f2", "converged_mean", "material")), ("t8", ("t8", "positions", "material")),
    ("f3:mean", ("f3", "mean", "material")), ("planar-f02::a", None),
    ("f2t1:positions:a", ("f2t1", "positions", "frame_axes")), ("any",
                                                                ("any", "converged_mean",
                                                                 "material")),
    ("planar-f2", ("planar-f2", "converged_mean", "material")), ("distance", "distance"),
    ("planar_body_load_positions", "planar_body_load_positions")])
def test_variant_of_the_command_line(text, variant):
    if variant is None:
        with pytest.raises(LayoutError, match="frame '' is unknown: use one of"):
            kernel_of(text)
    else:
        assert kernel_of(text) == variant


@pytest.mark.parametrize("text, message", [
    ("f2:mine", "frame 'mine' is unknown: use one of converged_mean, mean, mean_small, positions"),
    ("f2:mean:z", "inertia option 'z' is unknown: use one of frame_axes"),
    ("r2:mean", "keeps no position"),
    ("distanse", "there is no kernel 'distanse' in the catalogue: is it distance or distance_stop "
                 "or planar_dist"),
    ("sail", "layout 'sail' is unknown: .* or the name of a joint, rigid body or load, such as")])
def test_variant_that_cannot_be_read(text, message):
    with pytest.raises(LayoutError, match=message):
        kernel_of(text)


def test_kernel_name_is_a_module_name():
    name = superelement_name(Layout.parse("planar-f2t1").name, "converged_mean", "frame_axes")
    assert name == "superelement_planar_f2t1_converged_mean_frame_axes"
    assert name.isidentifier()
