"""Option C: an error in its formulas does not survive the derivation."""

import pytest

from sebody.derive.compiler import Variant, compile_kernel
from sebody.derive.formulas.inertia import floating_field
from sebody.derive.kernels.layouts import LayoutError
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import DerivationError


def proved():
    floating_field.prove.__wrapped__()


def without_gyroscopic(m, s):
    return right["on_frame"](m, s) - cross(m.spin, s.spun)


def half_coriolis(m, r):
    return right["on_coordinate"](m, r) - m.spin.dot(r.w) / 2


def one_sided(r):
    """As if ``zdot K_k zdot`` had only one gradient."""
    place, rate, second = right["gradients"](r)
    return place, rate._replace(coupled=r.v), second


def without_coupling(m, s, squared):
    return right["kinetic_energy"](m, s, squared) - m.spin.dot(s.spun)


right = {name: getattr(floating_field, name) for name in (
    "on_frame", "on_coordinate", "gradients", "kinetic_energy")}


@pytest.mark.parametrize("name, wrong, message", [
    ("on_frame", without_gyroscopic, "inertia on the frame"),
    ("on_coordinate", half_coriolis, "inertia on a coordinate"),
    ("gradients", one_sided, "gradient of a sum by zd"),
    ("kinetic_energy", without_coupling, "kinetic energy of a mass point")])
def test_a_wrong_formula_is_refused(name, wrong, message, monkeypatch):
    monkeypatch.setattr(floating_field, name, wrong)
    with pytest.raises(DerivationError, match=message):
        proved()


@pytest.mark.parametrize("frame", ["mean", "mean_small"])
def test_frames_without_exact_rates_are_refused(frame):
    with pytest.raises(LayoutError, match="option 'floating_field' needs the exact rates .* "
                                          f"'{frame}' does "
                                          "not: use 'converged_mean' or 'positions'"):
        compile_kernel(Variant("f2", frame, "floating_field"))
