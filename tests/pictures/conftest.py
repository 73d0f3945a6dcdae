"""A minute of a beam, a moving arm, and a browser for their animations."""

import browser
import moving_arm
import pytest

from sebody import Result, simulate
from sebody.scenes import hinged_beam


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("animations")


@pytest.fixture(scope="session")
def beam(folder):
    """A minute, from the file alone."""
    scene = hinged_beam.build()
    simulate(scene.model, 0.01, 60.0).save(folder / "beam.npz")
    return Result.load(folder / "beam.npz")


@pytest.fixture(scope="module")
def chrome(folder):
    one = browser.Browser(folder / "profile", 900, 640)
    yield one
    one.close()


@pytest.fixture(scope="session")
def arm():
    return moving_arm.run()
