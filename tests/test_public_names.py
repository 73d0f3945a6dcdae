"""Names a user imports: what every package offers, and where."""

import inspect
from importlib import import_module

import pytest
from pages import public_names

PACKAGES = public_names()


def test_the_page_has_the_packages():
    assert {"sebody", "sebody.analysis", "sebody.control", "sebody.fem", "sebody.io",
            "sebody.model.variants", "sebody.reduction", "sebody.results"} <= set(PACKAGES)
    assert {"Model", "simulate"} <= PACKAGES["sebody"]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_offers_its_names(package):
    module = import_module(package)
    assert set(getattr(module, "__all__", ())) == PACKAGES[package]
    assert module.__doc__
    for name in PACKAGES[package]:
        assert inspect.getdoc(getattr(module, name)), f"{package}.{name} says nothing of itself"


def test_every_name_has_one_place():
    """But for the class of what runs return, which has a package of its own."""
    names = [name for package in PACKAGES.values() for name in package]
    assert {name for name in names if names.count(name) > 1} == {"Result"}


def test_names_of_submodules_do_not_hide_functions():
    """`from sebody.reduction import craig_bampton` is the function, not the file of that name."""
    for package, names in PACKAGES.items():
        for name in names:
            assert not inspect.ismodule(getattr(import_module(package), name))
