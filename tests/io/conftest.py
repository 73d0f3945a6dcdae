"""Files of FE programs, unpacked."""

import tarfile
import time
from pathlib import Path

import pytest

from sebody.io import import_body

DATA = Path(__file__).parents[1] / "data"
INTERFACES = {"root": "900001/900002", "tip": "900003/900004"}


@pytest.fixture(scope="session")
def beam_deck(tmp_path_factory):
    """The deck of a beam, beside the matrices that CalculiX wrote; not to be changed."""
    folder = tmp_path_factory.mktemp("calculix")
    with tarfile.open(DATA / "calculix/beam.tar.xz") as archive:
        archive.extractall(folder, filter="data")
    return folder / "beam/se.inp"


@pytest.fixture(scope="session")
def beam_import(beam_deck):
    """It, reduced to its end faces and eight modes, its file, and the seconds it took."""
    began = time.process_time()
    path = beam_deck.with_name("beam.npz")
    body = import_body(beam_deck, INTERFACES, 8, output=path)
    return body, path, time.process_time() - began


@pytest.fixture(scope="session")
def beam_body(beam_import):
    """The body alone."""
    return beam_import[0]


@pytest.fixture(scope="session")
def decks(tmp_path_factory):
    """The folder of the decks that `tests/data/calculix/decks.py` makes; not to be changed."""
    folder = tmp_path_factory.mktemp("decks")
    with tarfile.open(DATA / "calculix/decks.tar.xz") as archive:
        archive.extractall(folder, filter="data")
    return folder / "decks"
