"""Files of FE programs that cannot be used are refused in words, and no body is written."""

import pytest
from malformed.file_cases import TABLES

from sebody import InputError
from sebody.io import import_body, load_body

NEED = {"op4": "pyyeti"}


def made(table, folder):
    make, interfaces, modes, _ = TABLES[table]
    if table in NEED:
        pytest.importorskip(NEED[table])
    return make(folder), {"interfaces": interfaces, "modes": modes}


@pytest.mark.parametrize("table, name", [
    pytest.param(table, name, id=f"{table}: {name}") for table, row in TABLES.items()
    for name in row[3]])
def test_refused(table, name, tmp_path):
    path, options = made(table, tmp_path)
    case = TABLES[table][3][name]
    case.change(tmp_path)
    output = tmp_path / case.options.get("output", "body.npz")
    with pytest.raises(InputError) as caught:
        import_body(path, **options | case.options | {"output": output})
    said = str(caught.value)
    assert case.said in said, said
    assert any(word in said for word in (":", ";", "must end in"))      # a remedy
    assert not output.is_file() and not list(tmp_path.glob(".sebody-*"))


@pytest.mark.parametrize("table", TABLES)
def test_the_right_files_are_a_body(table, tmp_path):
    path, options = made(table, tmp_path)
    body = import_body(path, **options, output=tmp_path / "body.npz")
    assert load_body(tmp_path / "body.npz").total_mass == pytest.approx(body.total_mass)


def test_there_are_enough():
    assert sum(len(row[3]) for row in TABLES.values()) >= 60


def test_other_files(tmp_path):
    for name, text, said in (("a.step", "ISO-10303", "is of an unknown kind: give --format"),
                             ("none.inp", None, "none.inp does not exist"),
                             ("x.mtx", "1 2 3", "is not named as Abaqus does, JOB_STIF1.mtx")):
        path = tmp_path / name
        if text:
            path.write_text(text)
        with pytest.raises(InputError) as caught:
            import_body(path, {"a": 1})
        assert said in str(caught.value)


def test_a_missing_extra_is_named(tmp_path, monkeypatch):
    from sebody.io import registry

    (tmp_path / "a.op4").write_text("x")
    (tmp_path / "a.full").write_text("x")
    monkeypatch.setattr(registry, "_installed", lambda package: False)
    for name, extra in (("a.op4", "nastran"), ("a.full", "ansys")):
        with pytest.raises(InputError, match=rf'pip install "sebody\[{extra}\]"'):
            import_body(tmp_path / name, {"a": 1})
