"""From files of an FE program to a run, and what is said of bodies that cannot be used."""

import json
import re

import numpy as np
import pytest
from malformed.fe_files import BLOCK, LABELS, calculix, substructure
from malformed.file_cases import replaced
from scipy.linalg import eigh

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


def test_paths(tmp_path, capsys):
    """An edge along the block, whose nodes are found by the name of their set."""
    path, body = calculix(tmp_path), tmp_path / "body.npz"
    edge = np.flatnonzero((BLOCK.coordinates[:, 1:] == 1.0).all(axis=1))
    rail = [int(LABELS[node]) for node in edge]
    replaced("se.inp", "*NSET, NSET=NONE", "*NSET, NSET=Rail\n"
             + ", ".join(map(str, rail[::-1])) + "\n*NSET, NSET=NONE")(tmp_path)
    command = ["import", str(path), *FACES, "--output", str(body)]
    assert main([*command, "--path", "rail:z:2", "--modes", "1", "--lean"]) == 0
    assert "path 'rail': 4 nodes from node" in capsys.readouterr().out
    made = load_body(body)
    assert made.modes == 3 and made.recovery.labels[np.searchsorted(
        made.recovery.nodes, made.paths["rail"])].tolist() == rail[::-1]
    assert len(made.recovery.nodes) == 4 and not made.recovery.cells
    assert main([*command, "--path", "RAIL"]) == 0 and load_body(body).modes == 4
    enough, found = ["--accuracy", "1e-2", "--up-to", "8"], []
    for options in (enough, [*enough, "--path", "RAIL:z:2", "--lean"], ["--path", "RAIL", *enough],
                    [*enough, "--path", "RAIL:2", "--criterion", "frequencies"]):
        assert main([*command, *options]) == 0
        found.append(load_body(body))
        assert "within" in capsys.readouterr().out
    bare, lean, full, few = found       # loads on the path are beside the modes, and keep these
    assert bare.modes + 2 == lean.modes == full.modes - 2 and few.modes < full.modes
    assert lean.recovery.nodes.tolist() == sorted(lean.paths["RAIL"])
    inside = slice(12, 12 + bare.modes)
    for one in (lean, full):
        assert one.stiffness[inside, inside] == pytest.approx(bare.stiffness[inside, inside])
    body.unlink()
    capsys.readouterr()
    for options, told in (
            ([*enough, "--path", "RAIL", "--modes", "2"], "--accuracy chooses the number of modes"),
            ([*enough, "--path", "RAIL", "--method", "rubin"], "paths are for methods"),
            ([*enough, "--path", "RAIL", "--method", "guyan"], "method 'guyan' has none"),
            (["--path", "RAIL:w"], "path is 'RAIL:w': write the name of a node set, SET:x"),
            (["--path", "RAIL:z:0"], "path 'RAIL': number of loads is 0"),
            (["--path", "RIAL"], "path 'RIAL': node set 'RIAL' is unknown: known are"),
            (["--path", "EDGE"], "path 'EDGE': interfaces hold all its nodes"),
            (["--path", "RAIL", "--path", "RAIL"], "path 'RAIL' is given twice"),
            (["--path", "RAIL", "--method", "rubin", "--modes", "2"],
             "paths are for methods 'craig-bampton' and 'guyan'")):
        assert main([*command, *options]) == 2
        assert told in capsys.readouterr().err and not body.exists()
    assert main(["import", str(substructure(tmp_path)), "--path", "RAIL", "--output", str(body)]
                ) == 2
    assert "holds matrices that are reduced already, of which nothing" in capsys.readouterr().err


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
    assert "this is not a loss of digits" in capsys.readouterr().err


def test_modes_by_frequencies_and_damping_of_each(tmp_path, capsys):
    path, body = calculix(tmp_path), tmp_path / "body.npz"
    assert main(["import", str(path), *FACES, "--accuracy", "1e-2", "--up-to", "8", "--criterion",
                 "frequencies", "--damping", "0.01,0.02,0.05", "--output", str(body)]) == 0
    said = capsys.readouterr().out
    assert "free frequencies within" in said and "damping: 0.01, 0.02, 0.05 of critical" in said
    found = load_body(body)
    squares, shapes = eigh(found.stiffness, found.mass)
    omega, modes = np.sqrt(squares[6:]), shapes[:, 6:]
    ratios = np.diag(modes.T @ found.damping @ modes) / (2 * omega)
    np.testing.assert_allclose(ratios, [0.01, 0.02] + [0.05] * (len(omega) - 2), rtol=1e-6)
    assert main(["inspect", str(body)]) == 0
    said = capsys.readouterr().out
    assert re.search(r"\naccuracy +free frequencies within 0.001 up to .*; dynamic stiffness of "
                     r"the interfaces within 0.001 up to ", said)
    assert main(["import", str(path), *FACES, "--accuracy", "1e-2", "--up-to", "8", "--method",
                 "rubin", "--output", str(body)]) == 0
    assert "free frequencies up to" in capsys.readouterr().out
    for options, said in ((["--criterion", "stiffness"], "--criterion is that of --accuracy"),
                          (["--damping", "0.1,x"], "--damping is '0.1,x': give a ratio"),
                          (["--damping=-0.1"], "damping: ratio is -0.1"),
                          (["--damping", ",".join(["0.1"] * 99)], "99 ratios, but the body has"),
                          (["--units", "mm kg N"], "--units 'mm kg N' do not belong together"),
                          (["--accuracy", "1e-2", "--up-to", "8", "--criterion", "mass"],
                           "criterion of Accuracy 'mass' is unknown: use 'stiffness' or")):
        assert main(["import", str(path), *FACES, *options, "--output", str(body)]) == 2
        assert said in capsys.readouterr().err


def test_what_is_missing_is_said_by_every_command(tmp_path, capsys):
    """The block's deck has no section: import, inspect, run, page and report say so."""
    body, result = tmp_path / "body.npz", tmp_path / "run.npz"
    why = "elements (C3D8) are in no *SOLID SECTION"
    assert main(["import", str(calculix(tmp_path)), *FACES, "--output", str(body)]) == 0
    said = capsys.readouterr().out
    assert "caution: no stresses or stiffening: 3 of 3 " + why in said
    assert main(["inspect", str(body)]) == 0
    said = capsys.readouterr().out
    assert why in said and "remedy: correct the deck and import again" in said
    assert said.endswith("verdict: the body can be used; note the cautions above\n")
    assert main(["run", "imported-link", "--set", f"body={body}", "--t-end", "0.05", "--output",
                 str(result)]) == 0
    assert re.search(r"caution +body '\w+' has no .*: 3 of 3 " + re.escape(why),
                     capsys.readouterr().out)
    for command, name in (("animate", "page.html"), ("report", "report.html")):
        assert main([command, str(result), "--output", str(tmp_path / name)]) == 0
        assert why in (tmp_path / name).read_text()
    assert main(["import", str(calculix(tmp_path)), *FACES, "--method", "macneal", "--modes", "1",
                 "--output", str(body)]) == 0
    assert "use Rubin's, method 'rubin'" in capsys.readouterr().out
    assert main(["import", str(calculix(tmp_path)), *FACES, "--lean", "--output", str(body)]) == 0
    assert "shapes and mesh of the FE model were left out" in capsys.readouterr().out
