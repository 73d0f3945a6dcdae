"""From files of an FE program to a run, and what is said of bodies that cannot be used."""

import json

import pytest
from malformed.file_cases import calculix, replaced, substructure

from sebody.cli.entry import main
from sebody.io import load_body

FACES = ["--interface", "left=rbe2:LEFT", "--interface", "right=rbe2:RIGHT"]


def test_import_inspect_run(tmp_path, capsys):
    body = tmp_path / "body.npz"
    assert main(["import", str(calculix(tmp_path)), *FACES, "--modes", "3", "--units", "m, kg, s",
                 "--output", str(body)]) == 0
    said = capsys.readouterr().out
    assert "source: CalculiX se.inp" in said and "method: craig-bampton, 3 modes" in said
    assert said.endswith(f"body: {body}, see 'sebody inspect {body}'\n")
    assert main(["inspect", str(body), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["layout"]["names"] == ["left", "right"] and found["units"] == "m kg N s"
    assert found["mass"] == pytest.approx(6.0)
    assert main(["run", "imported-link", "--set", f"body={body}", "--t-end", "0.05"]) == 0
    assert "four-bar with a coupler of 2 interfaces and 3 modes" in capsys.readouterr().out


def test_as_many_modes_as_needed(tmp_path, capsys):
    path, body = calculix(tmp_path), tmp_path / "body.npz"
    assert main(["import", str(path), *FACES, "--accuracy", "1e-2", "--up-to", "8", "--lean",
                 "--output", str(body)]) == 0
    assert load_body(body).modes > 0 and load_body(body).recovery is None
    assert "within" in capsys.readouterr().out
    for options, said in ((["--accuracy", "1e-2"], "--accuracy and --up-to belong together"),
                          (["--accuracy", "1e-2", "--up-to", "8", "--modes", "2"],
                           "--accuracy chooses the number of modes: leave out --modes")):
        assert main(["import", str(path), *FACES, *options, "--output", str(body)]) == 2
        assert said in capsys.readouterr().err


def test_a_body_with_a_defect(tmp_path, capsys):
    path, body = substructure(tmp_path), tmp_path / "body.npz"
    replaced("se.inp", "7, 1.", "7, 1.5")(tmp_path)
    assert main(["import", str(path), "--output", str(body)]) == 2
    assert "stiffness resists rigid motion" in capsys.readouterr().err
    assert not body.exists()
    assert main(["import", str(path), "--unchecked", "--output", str(body)]) == 0
    assert main(["inspect", str(body)]) == 1
    assert "verdict: the body cannot be used" in capsys.readouterr().out
    assert main(["inspect", str(body), "--repair", "rigid-modes", "--save",
                 str(tmp_path / "good.npz")]) == 2
    assert "this is no loss of digits" in capsys.readouterr().err
