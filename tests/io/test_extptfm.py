"""Files of OpenFAST's ExtPtfm: bit for bit, both forms, the command, wrong files."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from sebody import InputError, Model, Simulation
from sebody.analysis import equilibrium, modes, vibrations
from sebody.cli.entry import main
from sebody.fem import circle, straight_beam
from sebody.io import LoadSeries, import_body, load_body, read_extptfm, write_extptfm
from sebody.io.importing import Wanted, imported, tied
from sebody.io.interfaces import parsed
from sebody.io.reading import Reading
from sebody.reduction import craig_bampton, grounded_body, grounded_from_fe
from sebody.verify.outside.jacket import BASE, INTERFACE, MODES, NAMES, body, loads, matrices

WAVE = "wave elevation"


def flex(M, K, C, rows, step=0.05, total=None, size=None):
    """The text of a file as other programs write it: nine digits, noise where zeros should be."""
    total = step * (len(rows) - 1) if total is None else total

    def block(title, matrix):
        return [f"!{title}", "!Dimension: 31", *(" ".join(f"{x: .8e}" for x in row)
                                                 for row in matrix)]
    noise = 1e-11 * np.random.default_rng(3).normal(size=M.shape)
    return "\n".join([
        "!Comment", "!Comment Flex 5 Format", f"!Dimension: {size or len(M)}",
        f"!Time increment in simulation:  {step:.5f}",
        f"!Total simulation time in file:  {total:.5f}", "",
        *block("Mass Matrix ", M + noise), "", *block("STIFFNESS matrix", K), "",
        *block("Damping Matrix", C), "", "!Loading and Wave Elevation", "!Dimension: 1 time, 31",
        *(" ".join(f"{x: .8e}" for x in row) for row in rows)]) + "\n"


def rows(count=11):
    """Time, loads, wave elevation."""
    return np.column_stack([0.05 * np.arange(count), loads(end=0.05 * (count - 1)).values,
                            np.linspace(-1.0, 1.0, count)])


@pytest.fixture
def file(tmp_path):
    """A right file of the form FlexASCII."""
    path = tmp_path / "ExtPtfm_SE.dat"
    path.write_text(flex(*matrices(), rows()))
    return path


def test_a_file_of_nine_digits_has_the_frequencies_of_the_jacket(file):
    found, series = read_extptfm(file, INTERFACE)
    assert found.units == "m kg N s" and found.modes == MODES and series.names == tuple(NAMES)
    assert series.others[WAVE][-1] == 1.0 and series.t[-1] == 0.5
    model = Model()
    model.foundation("jacket", found, model.node("interface", INTERFACE))
    model.body_series("jacket", series)
    np.testing.assert_allclose(np.abs(modes(Simulation(model, 0.01)).values[:3]) / 2 / np.pi, [
        1.067671, 1.067727, 3.713898], rtol=0, atol=2e-5)       # damped ones


def same(one, other):
    for name in ("mass", "stiffness", "damping"):
        assert_array_equal(getattr(one, name), getattr(other, name))


def test_written_and_read_bit_for_bit(file, tmp_path):
    found, series = read_extptfm(file, INTERFACE)
    path = write_extptfm(found, tmp_path / "again.dat", series, comment="a jacket")
    again, table = read_extptfm(path, INTERFACE)
    same(found, again)
    assert_array_equal(table.values, series.values)
    assert_array_equal(table.t, series.t)
    assert_array_equal(table.others[WAVE], series.others[WAVE])
    twice = write_extptfm(again, tmp_path / "twice.dat", table, comment="a jacket")
    assert twice.read_bytes() == path.read_bytes()
    own = write_extptfm(body(), tmp_path / "own.dat")
    same(body(), read_extptfm(own, INTERFACE, BASE)[0])
    M, K, C = (A[:6, :6] for A in matrices())
    guyan = grounded_body(K, M, [INTERFACE], damping=C)
    path = write_extptfm(guyan, tmp_path / "guyan.dat", series.chosen(["x", "ry"]), "guyan")
    read, table = read_extptfm(path, INTERFACE)
    same(guyan, read)
    assert_array_equal(table.values[:, 4], series.values[:, 4])
    lines = path.read_text().splitlines()
    assert "#mass" in lines[1] and "damping" in lines[8] and "stiffness" in lines[15]
    path.write_text("\n".join(lines[:25]) + "\n")
    assert read_extptfm(path, INTERFACE)[1] is None


def test_an_fe_model_as_a_foundation_designer_hands_it_over(tmp_path):
    """Written and read it has the frequencies of the clamped FE model."""
    fe = straight_beam((0, 0, -30), (0, 0, 10), circle(1.0, 2.1e11, 0.3, 7850.0), 12)
    made = grounded_from_fe(fe, [(12, "full")], 0, 4)
    path = write_extptfm(made, tmp_path / "pile.dat")
    read, _ = read_extptfm(path, (0, 0, 10), (0, 0, -30))
    model = Model()
    model.foundation("pile", read, model.node("top", (0, 0, 10)))
    K, M = (A.toarray()[6:, 6:] for A in (fe.stiffness, fe.mass))
    exact = np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real.min()) / 2 / np.pi
    assert vibrations(equilibrium(model, 1), 1).frequency[0] == pytest.approx(exact, rel=1e-4)


def test_the_command_and_the_input_file(file, tmp_path, capsys):
    target = tmp_path / "jacket.npz"
    words = ["import", str(file), "--interface", "0", "0", "-20.15", "--output", str(target)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "held to the ground" in said and f"loads: {tmp_path / 'jacket.csv'}" in said
    read = load_body(target)
    assert read.base == 1 and tuple(read.coordinates[0]) == (0, 0, -20.15)
    series = LoadSeries.from_csv(tmp_path / "jacket.csv", columns=NAMES)
    assert_array_equal(series.values, read_extptfm(file, INTERFACE)[1].values)
    assert list(series.others) == [WAVE]
    same(read, import_body(file, {"platform": "@0,0,-20.15"}))
    assert main(["import", str(file), "--output", str(target)]) == 2
    assert "does not say where its interface is: give its place" in capsys.readouterr().err
    with pytest.raises(InputError, match="interface 'tip' is a place, and the file has nodes"):
        tied(straight_beam((0, 0, 0), (1, 0, 0), circle(0.1, 1.0, 0.3, 1.0), 1),
             parsed({"tip": "@0,0,1"}), {})
    other = tmp_path / "ExtPtfm.dat"
    other.write_text(
        "---- EXTPTFM INPUT FILE ----\nComment\n 1  FileFormat - switch\n"
        f'"{file.name}"  Red_FileName  - path\n 2  NActiveDOFList - count\n'
        "1, 4,25  ActiveDOFList - list\n 1 NInitPosList - count\n")
    kept, table = read_extptfm(other, INTERFACE)
    assert kept.modes == 2 and table.names[-1] == "mode 1"
    M = matrices()[0]
    assert_array_equal(kept.mass[:3, 12:], read_extptfm(file, INTERFACE)[0].mass[:3, [12, 15]])
    assert kept.mass[0, 12] == pytest.approx(M[0, 6])
    for count, modes_kept in (("-1", MODES), ("0", 0)):
        other.write_text(other.read_text().replace(" 2  NActive", f" {count}  NActive"))
        assert read_extptfm(other, INTERFACE)[0].modes == modes_kept
        other.write_text(other.read_text().replace(f" {count}  NActive", " 2  NActive"))
    other.write_text(other.read_text().replace("1, 4,25", "1,26"))
    with pytest.raises(InputError, match="line 5: 2 of the modes \\[1, 26\\] are to be kept"):
        read_extptfm(other, INTERFACE)


def without(text, start):
    """A text without the line that begins so."""
    return "\n".join(line for line in text.splitlines() if not line.startswith(start))


def changed_row(text, line, column, value):
    lines = text.splitlines()
    words = lines[line - 1].split()
    words[column] = value
    lines[line - 1] = " ".join(words)
    return "\n".join(lines)


M, K, C = matrices()
TEXT = flex(M, K, C, rows())


@pytest.mark.parametrize("text, message", [
    (without(TEXT, "!Mass"), "has no block !Mass Matrix"),
    (without(TEXT, "!STIFF"), "has no block !Stiffness Matrix"),
    (without(TEXT, "!Damping"), "has no block !Damping Matrix"),
    (without(TEXT, "!Loading"), "has no block !Loading"),
    (without(TEXT, "!Time"), "has no line !Time increment in simulation"),
    (without(TEXT, "!Dim"), "has no line !Dimension"),
    (TEXT.replace("!Dimension: 31", "!Dimension: 30", 1), "line 9: "),
    (TEXT.replace("!Dimension: 31", "!Dimension: 5", 1), "the dimension is 5, less than the six"),
    (TEXT.replace("!Dimension: 31", "!Dimension: many", 1), "line 3: '!Dimension: many' has no"),
    (flex(M, K, C, rows()[:-1], total=0.5),
     "line 120: the loading has 10 lines of numbers in place of 11"),
    (flex(M[:30], K, C, rows(), size=31),
     "line 38: the mass matrix has 30 lines of numbers in place of 31"),
    (changed_row(TEXT, 9, 4, "1e9"), "line 9: the mass matrix is not symmetric: row 1, column 5"),
    (changed_row(TEXT, 44, 2, "1e9"),
     "line 44: the stiffness matrix is not symmetric: row 2, column 3"),
    (changed_row(TEXT, 9, 4, "nan"), "line 9: "), (changed_row(TEXT, 80, 4, "abc"), "line 80: "),
    (changed_row(TEXT, 11, 2, "-9e5"),
     "(mass from line 9): mass has a negative eigenvalue"),
    (changed_row(TEXT, 45, 2, "-9e9"),
     "(stiffness from line 43): stiffness has a negative eigenvalue"),
    (changed_row(TEXT, 113, 0, "9.0"), "line 114: the time 0.15 of the loading is not after 9"),
    ("nothing\n", "is no ExtPtfm file: give a file of the form FlexASCII"),
    ("c\n#Mass\n1 2 3 4 5 6\n", "line 4: '' is no line of 6"),
    ("c\n#mass\n" + 6 * "1 0 0 0 0 0\n", "ends at line 9, within its matrices")])
def test_wrong_files_name_line_and_block(tmp_path, text, message):
    path = tmp_path / "foundation.dat"
    path.write_text(text + "\n")
    with pytest.raises(InputError) as caught:
        read_extptfm(path, INTERFACE)
    assert message in str(caught.value) and "foundation.dat" in str(caught.value)


def test_what_a_file_cannot_hold(tmp_path):
    path, own = tmp_path / "a.dat", body()
    free = craig_bampton(straight_beam((0, 0, 0), (1, 0, 0), circle(0.1, 1e9, 0.3, 1e3), 2),
                         [(0, "full"), (2, "full")], 0)
    two = grounded_body(np.eye(12), np.eye(12), [(0, 0, 1), (1, 0, 1)])
    jump = LoadSeries([0, 1, 1, 2], np.zeros((4, 1)), ["x"])
    for arguments, message in (
            ((free, path), "not held to the ground in space"),
            ((two, path), "the body has 2 interfaces, and the file holds one"),
            ((own, path, None, "guyan"), "the form 'guyan' holds no modes and the body has 25"),
            ((own, path, jump), "the series has a jump"),
            ((own, path, LoadSeries([0, 1, 3], np.zeros((3, 1)), ["x"])), "not equally spaced"),
            ((own, path, LoadSeries([0, 1], np.zeros((2, 1)), ["wind"])), "column 'wind'"),
            ((own, path, LoadSeries([0, 1], np.zeros((2, 1)), ["x"], "cubic")), "cubic"),
            ((own, tmp_path / "a.npz"), ".dat")):
        with pytest.raises(InputError) as caught:
            write_extptfm(*arguments)
        assert message in str(caught.value)
    assert not path.exists()


def test_reduced_matrices_of_a_held_structure_with_its_base_given():
    """As a reader of DMIG or OP4 gives them, with the viscous damping of the file."""
    M, K, C = matrices()
    parts = {"stiffness": K, "mass": M, "damping": C, "coordinates": np.array([INTERFACE]),
             "keeps": ("full",), "modes": MODES}
    reading = Reading(parts, ("7",), source="se.pch")
    file = imported(reading, Wanted(parsed(["top=7"]), base=BASE), "se.pch")
    assert file.names == ("top", "base") and file.body().base == 1
    same(file.body(), body())
    with pytest.raises(InputError, match="if the body is held to the ground: use grounded_body"):
        imported(reading, Wanted(parsed(["top=7"])), "se.pch").body()
    with pytest.raises(InputError, match="base is given, and se.inp holds a whole FE model"):
        imported(Reading(straight_beam((0, 0, 0), (1, 0, 0), circle(0.1, 1.0, 0.3, 1.0), 1)),
                 Wanted([], base=BASE), "se.inp")
