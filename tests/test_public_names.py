"""Names a user imports: what every package offers, and where."""

import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest

PACKAGES = {
    "sebody": {"InputError", "Interrupted", "LimitWarning", "Model", "Result", "SebodyError",
               "Simulation", "SimulationError", "Tolerance", "WriteError", "cylinder",
               "generalized_alpha", "harmonic", "hht", "piecewise", "plane", "ramp",
               "rest_to_rest", "simulate", "simulate_within", "sphere", "spline", "trapezoidal",
               "with_corners"},
    "sebody.analysis": {"Advice", "Campbell", "FrequencyResponse", "Gradient",
                        "Gradients", "Calibration", "Design", "ValueAndGradient", "calibrate",
                        "BeamStress", "Contribution", "Contributions", "Sizing",
                        "contributions", "size_heights",
                        "sections",
                        "campbell", "frequency_response", "gradient", "gradients", "soft_maximum",
                        "EnergyGain", "Ensemble", "Linearization", "Modes", "Outcome",
                        "Output", "Unreached", "Vibrations", "advise", "at_time", "energy_gain",
                        "equilibrium",
                        "final", "integral", "linearize", "maximum", "minimum", "modes", "resume",
                        "rms", "save_state", "spin_limit", "StateSpace", "state_space",
                        "vibrations"},
    "sebody.control": {"Law", "computed_torque", "discrete", "linear", "lookup", "low_pass",
                       "pid", "state_feedback"},
    "sebody.results": {"Field", "Recording", "Result", "Start", "animate", "plot", "report",
                       "save_picture"},
    "sebody.model.variants": {"VARIANTS", "Variant", "can_be_dropped", "can_be_shared", "copied",
                              "divide", "drop_triplet", "keep_modes", "planar", "rigid", "shared",
                              "with_options"},
    "sebody.fem": {"FEModel", "Section", "SolidStress", "StiffnessSection", "StressModes",
                   "circle", "frame", "hexahedral_block", "i_profile", "planar_beam", "rectangle",
                   "solid_stress", "straight_beam", "tube"},
    "sebody.reduction": {"Accuracy", "ComponentModes", "MeanFace", "ReducedBody", "RigidFace",
                         "body_weights", "component_modes", "craig_bampton", "frame_weights",
                         "reduce"},
    "sebody.io": {"BodyFile", "SOURCES", "Source", "from_ngsolve", "from_skfem",
                  "import_body", "load_body",
                  "read_body_file", "read_fe_model", "save_body", "write_sid"},
}


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_offers_its_names(package):
    module = import_module(package)
    assert set(getattr(module, "__all__", ())) == PACKAGES[package]
    assert module.__doc__
    for name in PACKAGES[package]:
        assert inspect.getdoc(getattr(module, name)), f"{package}.{name} says nothing of itself"


@pytest.mark.parametrize("package", PACKAGES)
def test_the_page_lists_the_names(package):
    """From it the pages of the API reference are made."""
    text = (Path(__file__).parents[1] / ".docs" / "names.md").read_text()
    row = re.search(rf"^\| `{package}` \| (.*) \|$", text, re.MULTILINE)
    assert set(re.findall(r"`(\w+)`", row[1])) == PACKAGES[package]


def test_every_name_has_one_place():
    """But for the class of what runs return, which has a package of its own."""
    names = [name for package in PACKAGES.values() for name in package]
    assert {name for name in names if names.count(name) > 1} == {"Result"}


def test_names_of_submodules_do_not_hide_functions():
    """`from sebody.reduction import craig_bampton` is the function, not the file of that name."""
    for package, names in PACKAGES.items():
        for name in names:
            assert not inspect.ismodule(getattr(import_module(package), name))
