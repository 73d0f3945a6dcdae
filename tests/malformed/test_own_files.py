"""Files that were tampered with are refused in words: by name, with the value and a remedy."""

import importlib.util

import pytest
from malformed import own_file_cases, state_file_cases
from malformed.other_file_cases import OTHERS
from malformed.read_files import KINDS
from malformed.tampering import ANY, ZIPS

from sebody import InputError

OWN = {"body": own_file_cases.BODY, "result": own_file_cases.RESULT,
       "restart": state_file_cases.RESTART, "sweep table": state_file_cases.TABLE,
       "reference": state_file_cases.REFERENCE}
CASES = [(kind, name, case) for kind, table in OWN.items()
         for name, case in (ANY | ZIPS | table).items()]
PLACES = [(kind, name, case) for kind in KINDS if kind not in OWN for name, case in ANY.items()]
FOREIGN = [(kind, name, case) for kind, table in OTHERS.items() for name, case in table.items()]


def made(kind, folder):
    if KINDS[kind].needs and importlib.util.find_spec(KINDS[kind].needs) is None:
        pytest.skip(f"{KINDS[kind].needs} reads it")
    return KINDS[kind].make(folder)


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    """Files of each kind, made once."""
    found = {}

    def of(kind, folder):
        if kind not in found:
            own = tmp_path_factory.mktemp("kind")
            path = made(kind, own)
            found[kind] = path.name, {one.name: one.read_bytes() for one in own.iterdir()}
        name, files = found[kind]
        for one, content in files.items():
            (folder / one).write_bytes(content)
        return folder / name
    return of


@pytest.mark.parametrize("kind, name, case", CASES + PLACES, ids=lambda one: one if isinstance(
    one, str) else "")
def test_refused(kind, name, case, originals, tmp_path):
    path = originals(kind, tmp_path)
    case.change(path)
    with pytest.raises(InputError) as caught:
        KINDS[kind].read(path)
    said = str(caught.value)
    assert case.said in said, said
    assert path.stem in said and ": " in said, said


@pytest.mark.parametrize("kind, name, case", FOREIGN, ids=lambda one: one if isinstance(
    one, str) else "")
def test_files_of_others(kind, name, case, originals, tmp_path):
    path = originals(kind, tmp_path)
    case.change(tmp_path)
    with pytest.raises(InputError) as caught:
        KINDS[kind].read(path)
    said = str(caught.value)
    assert case.said in said, said
    assert any((tmp_path / one).stem in said for one in (path.name, "se.x", "body.x")), said


@pytest.mark.parametrize("kind", KINDS)
def test_the_right_ones_are_read(kind, originals, tmp_path):
    KINDS[kind].read(originals(kind, tmp_path))


def test_there_are_enough():
    assert len(CASES + PLACES + FOREIGN) >= 300
