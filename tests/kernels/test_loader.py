"""Names and files of kernels: found without compiling them, and refused where they are outdated."""

import sys

import pytest

from sebody import InputError
from sebody.compiler.sources import TEXT, folder_hash
from sebody.kernels import loader

KERNEL = '''LAYOUT = "planar-f9"
FRAME = "mean"
INERTIA = "frame_axes"
SOURCES = "{sources}"     # of today
TOUCHED = True
'''
NAME = "superelement_planar_f9_mean_frame_axes"


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """An empty directory of the user."""
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    monkeypatch.setattr(loader, "load", loader.load.__wrapped__)
    yield tmp_path
    sys.modules.pop(f"sebody_user_kernels.{NAME}", None)


@pytest.mark.parametrize("layout, modes, damped, name", [
    ("planar-f2", 4, False, "superelement_planar_f2m4_converged_mean_material"),
    ("planar-f2", 3, False, "superelement_planar_f2_converged_mean_material"),
    ("f2", 8, True, "superelement_f2d_converged_mean_material"),
    ("f5t1", 4, False, "superelement_any_converged_mean_material"),
    ("planar-f4", 0, False, "superelement_planar_any_converged_mean_material")])
def test_a_kernel_for_the_number_of_modes_or_of_nodes_or_for_any(layout, modes, damped, name):
    assert loader.superelement_kernel_name(layout, "converged_mean", "material", modes,
                                           damped) == name


@pytest.mark.parametrize("layout, modes, second_order, name", [
    ("f2", 4, (2, 1), "f2m4s2e1"), ("f2", 4, (2, 3), "f2"), ("f2", 4, None, "f2"),
    ("f2", 3, (2, 1), "f2"), ("planar-f2", 0, (2, 1), "planar_f2m0s2e1"),
    ("planar-f3", 2, (2, 1), "planar_any")])
def test_a_kernel_for_the_numbers_of_second_order(layout, modes, second_order, name):
    assert loader.superelement_kernel_name(
        layout, "converged_mean", "floating_field", modes, False, second_order
    ) == f"superelement_{name}_converged_mean_floating_field"


def test_names_are_found_without_import(monkeypatch):
    monkeypatch.setattr(loader, "import_module", None)
    assert loader.superelement_kernel_name("t8", "positions", "material", 0)
    for kind in ("planar_on_line", "user_force"):
        assert loader.element_kernel_name(kind) == f"element_{kind}"


def test_missing_kernels(mine):
    with pytest.raises(InputError, match="there is no kernel for layout 'f9d', frame 'mean', "
                       "inertia 'frame_axes': make it with\n    python -m sebody.derive "
                       "f9d:mean:frame_axes"):
        loader.superelement_kernel_name("f9", "mean", "frame_axes", 0, True)
    with pytest.raises(InputError, match="python -m sebody.derive f5d:mean:material"):
        loader.superelement_kernel_name("f5", "mean", "material", 2, True)
    with pytest.raises(InputError, match="there is no kernel for element 'sail': reinstall"):
        loader.element_kernel_name("sail")
    assert loader.load("element_sail") is None


def test_kernel_of_the_user(mine):
    (mine / f"{NAME}.py").write_text(KERNEL.format(sources=folder_hash(*TEXT)))
    assert loader.superelement_kernel_name("planar-f9", "mean", "frame_axes", 2) == NAME
    assert loader.load(NAME).TOUCHED


@pytest.mark.parametrize("text", [KERNEL.format(sources="of 0.0.1"),
                                  KERNEL.replace("SOURCES", "LEAVES")])
def test_kernel_of_another_version_is_refused(mine, text):
    (mine / f"{NAME}.py").write_text(text)
    for act in (loader.find, loader.load):
        with pytest.raises(InputError, match=f"{NAME}.py was made by another version of sebody: "
                           "make it again with\n    python -m sebody.derive "
                           "planar-f9:mean:frame_axes"):
            act(NAME)
    assert f"sebody_user_kernels.{NAME}" not in sys.modules
