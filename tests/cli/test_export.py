"""The command `sebody export`."""

import zipfile

import pytest

from sebody.cli.entry import main

pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")


def test_files_are_named(tmp_path, capsys):
    assert main(["export", "heavy-top", "--library", str(tmp_path / "top"), "--processor", "native",
                 "--outputs", "energy.kinetic, momentum"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0].split("/")[-1] for line in lines][:2] == ["example.c", "heavy_top.h"]
    assert all(line.endswith(" kB") for line in lines) and len(lines) == 3
    header = (tmp_path / "top" / "heavy_top.h").read_text()
    assert "/*  3: momentum.z" in header and "int heavy_top_run_to(heavy_top *model" in header


def test_an_fmu_has_what_is_asked_for(tmp_path):
    file = tmp_path / "top.fmu"
    assert main(["export", "heavy-top", "--fmu", str(file), "--processor", "native", "--fmi", "2.0",
                 "--inputs", "gravity.z", "--step", "0.002"]) == 0
    with zipfile.ZipFile(file) as archive:
        text = archive.read("modelDescription.xml").decode()
    assert 'fmiVersion="2.0"' in text and 'name="gravity.z"' in text and "0.002" in text


@pytest.mark.parametrize("arguments, said", [
    (["--outputs", "tip.speed"], "'tip.speed' is unknown"),
    (["--inputs", "wind"], "input 'wind' is unknown"),
    (["--platforms", "amiga"], "platform 'amiga' is unknown"),
    (["--fmi", "1.0"], "version of FMI '1.0' is unknown")])
def test_errors_are_one_line(arguments, said, tmp_path, capsys):
    assert main(["export", "heavy-top", "--fmu", str(tmp_path / "x.fmu"), *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ") and said in error and not list(tmp_path.iterdir())
