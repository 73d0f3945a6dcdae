"""Numbers of others, case by case; the page shows them as a run finds them."""

import json
import re
from pathlib import Path

import pytest
from copies import ROOT

from sebody.basics.errors import SebodyError
from sebody.cli.entry import main
from sebody.verify import outside
from sebody.verify.outside.case import Case, Quantity, rows

PAGE = (ROOT / ".docs" / "outside.md").read_text()
FOLDER = Path(outside.__file__).parent


def shown(name):
    """Rows of the page by quantity: reference, value, difference, tolerance, source's own."""
    found = re.findall(rf"^\| {name} \| (.+?) \| (.+?) \| (.+?) \| (.+?) \| (.+?) \| (.+?) \|$",
                       PAGE, re.MULTILINE)
    return {quantity: numbers for quantity, *numbers in found}


@pytest.mark.parametrize("name", outside.CASES)
def test_case(name):
    found = outside.measure(name, whole=False)
    assert found and not [row for row in found if not row.passed]
    own, page = outside.load(name), shown(name)
    assert own.source in PAGE and own.note in PAGE
    assert list(page) == [one.name for one in own.quantities]
    sizes = {one.name: one.size for one in own.quantities}
    for row in found:
        reference, value, _, tolerance, source = page[row.quantity]
        assert reference == f"{row.reference:.9g}" and tolerance == f"{row.tolerance:.1e}"
        assert source == ("-" if row.source_tolerance is None else f"{row.source_tolerance:.1e}")
        apart = abs(float(value) - row.value) - 1e-8 * abs(row.value)      # printed digits
        assert apart <= 0.5 * row.tolerance * sizes[row.quantity], (row, value)


def test_every_module_of_a_case_is_in_the_table():
    modules = {path.stem for path in FOLDER.glob("*.py") if "\nCASE = " in path.read_text()}
    assert modules == {name.replace("-", "_") for name in outside.CASES}
    assert set(re.findall(r"^\| ([a-z0-9-]+) \| ", PAGE, re.MULTILINE)) == {"case", *outside.CASES}


def test_a_tolerance_is_the_least_but_not_below_what_is_printed():
    one = Quantity("length", 2.0, source_tolerance=0.05)
    assert one.tolerance(1.0) == pytest.approx(0.005)           # a tenth of the source's
    assert one.tolerance(1e-4) == pytest.approx(1e-3)           # ten times that at twice
    assert Quantity("length", 2.0, printed=0.005).tolerance(1e-5) == pytest.approx(0.0025)
    assert Quantity("length", 2.0).tolerance(0.0) == 1e-9
    assert Quantity("length", -2.0, 4.0).difference(-1.0) == 0.25


def test_numbers_that_are_wrong_do_not_pass():
    quantities = (Quantity("slider at 1 s", 0.5, source_tolerance=0.1),
                  Quantity("slider at 2 s", 0.5, source_tolerance=0.1))
    for value, passed in ((0.5, True), (0.504, True), (0.506, False), (float("nan"), False)):
        made = Case("", "", lambda division, whole, value=value: {"slider at 1 s": value},
                    quantities)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("sebody.verify.outside.case.at_twice",
                          lambda: {"made": dict.fromkeys(("slider at 1 s", "slider at 2 s"), 1.0)})
            row, = rows("made", made)
        assert row.passed is passed
    with pytest.raises(SebodyError, match="'slider at 1 s' has no difference at twice"):
        rows("made", made)


def test_command(capsys, monkeypatch):
    assert main(["verify", "squeezer"]) == 0
    text = capsys.readouterr().out
    assert "IVP test set" in text and "beta at 0.03 s" in text
    assert re.search(r"12 of 12 numbers of 1 case within tolerance, [\d.]+ s\n$", text)
    assert main(["verify", "squeezer", "--json"]) == 0
    entries = json.loads(capsys.readouterr().out)["cases"]
    assert len(entries) == 12
    assert all(list(entry) == ["case", "source", "quantity", "reference", "value", "difference",
                               "tolerance", "source_tolerance", "seconds"] for entry in entries)
    monkeypatch.setattr(Quantity, "tolerance", lambda one, at_twice: 1e-12)
    assert main(["verify", "squeezer"]) == 1
    assert "EXCEEDED" in capsys.readouterr().out
    assert main(["verify", "squeezr"]) == 2
    assert "case 'squeezr' is unknown: did you mean 'squeezer'" in capsys.readouterr().err
