"""Export of a model as a library for C, or as an FMU."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from uuid import uuid4

from sebody.basics import inputs
from sebody.basics.errors import InputError, WriteError
from sebody.basics.files import check_target, replacing
from sebody.engine.state import Scheme
from sebody.export import fmu as fmus, toolchain
from sebody.export.library import write_library
from sebody.export.platforms import DEFAULT, NATIVE, PLATFORMS, PROCESSORS, host
from sebody.export.prepared import Prepared, Run
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.tolerance import Tolerance


def export(model: Model, h: float, *, library: str | Path | None = None,
           fmu: str | Path | None = None, inputs: Sequence[str] = (), outputs: Sequence[str] = (),
           name: str = "model", t_end: float | None = None, tolerance: Tolerance | None = None,
           scheme: Scheme | None = None, start: Result | None = None,
           platforms: Sequence[str] = (), processor: str = DEFAULT, fmi: str = "3.0") -> Path:
    """Export a model as a library for C, or as an FMU for co-simulation, without Python.

    The numbers are those of a `Simulation`, bit for bit where Numba compiles for `processor`.

    Parameters
    ----------
    model : Model
    h : float
        Step, and the output grid [time].
    library : path, optional
        Folder for a header, an example and a folder with a library for each platform.
    fmu : path, optional
        File of an FMU, in place of a library.
    inputs : sequence of str
        Actuators, loads, drives (their accelerations are set) and parameters as of an `Ensemble`,
        such as ``"spring.stiffness"``, ``"gravity.y"``, ``"loop.parameters.0"``.
    outputs : sequence of str
        Quantities as results name them; of vectors all components.
    name : str
        Of the model.
    t_end : float, optional
        End of the default experiment of an FMU [time].
    tolerance, scheme, start
        As of `Simulation`.
    platforms : sequence of str
        ``linux-x86_64``, ``windows-x86_64``, ``macos-x86_64``, ``macos-arm64``, ``linux-aarch64``;
        that of this machine by default.
    processor : str
        Oldest of x86 platforms: ``x86-64``, ``x86-64-v2`` or ``x86-64-v3``. ``native`` is that of
        this machine, with the bits of runs in this process.
    fmi : {'3.0', '2.0'}
        Version of the standard.

    Returns
    -------
    Path
        The folder or file.

    Raises
    ------
    InputError
        Unknown names, quantities that cannot be compiled, a place that cannot be written, or no
        linker.
    WriteError
        The files could not be written; what was there before is unchanged.
    """
    if (library is None) == (fmu is None):
        raise InputError("give library=, a folder, or fmu=, a file: one of the two")
    chosen = _platforms(platforms, fmi if fmu is not None else "")
    _check_end(t_end)
    _check_processor(processor, chosen)
    target = _check_folder(library) if library is not None else _check_file(fmu)
    toolchain.check_installed()
    made = Prepared(model, name, Run(h, tolerance, scheme, start), _names(inputs, "inputs"),
                    _names(outputs, "outputs"))
    work = target.resolve().with_name(f".sebody-{uuid4().hex[:16]}.part")
    try:
        work.mkdir()
        if library is not None:
            (work / "made").mkdir()
            write_library(made, work / "made", work, chosen, processor)
            _move(work / "made", target)
        else:
            with replacing(target, "FMU") as file:
                fmus.write_fmu(made, file, work, chosen, processor, fmi, t_end)
    except OSError as error:
        if isinstance(error, WriteError):
            raise
        raise WriteError(f"{target} cannot be written: {error.strerror or error}") from error
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return target


def _names(given: Sequence[str], what: str) -> list[str]:
    if isinstance(given, str):
        raise InputError(f"{what} is {given!r}: give a list of names")
    return inputs.items(given, what, "give a list of names")


def _check_end(t_end: float | None) -> None:
    if t_end is not None:
        inputs.number(t_end, "t_end", above=0)


def _platforms(given: Sequence[str], fmi: str) -> list[str]:
    """The platforms to export for.

    Raises
    ------
    InputError
        An unknown one, or one that an FMU of this version cannot have.
    """
    names = [given] if isinstance(given, str) else list(given) or [host()]
    for one in names:
        inputs.choice(one, "platform", PLATFORMS)
    if fmi:
        inputs.choice(fmi, "version of FMI", fmus.VERSIONS)
    if fmi == "2.0":
        for one in names:
            if not PLATFORMS[one].fmi2:
                raise InputError(f"FMI 2.0 has no folder for {one}: give fmi 3.0, or leave this "
                                 "platform out")
    return list(dict.fromkeys(names))


def _check_processor(processor: str, platforms: list[str]) -> None:
    """Refuse an unknown processor, and this machine's for other platforms.

    Raises
    ------
    InputError
        It is.
    """
    inputs.choice(processor, "processor", [*PROCESSORS, NATIVE])
    if processor == NATIVE and platforms != [host()]:
        raise InputError(f"processor {NATIVE!r} is that of this machine, {host()}: leave platforms "
                         f"out, or give one of {', '.join(PROCESSORS)}")


def _check_folder(folder: str | Path) -> Path:
    """The folder for a library, which need not exist.

    Raises
    ------
    InputError
        A file is there, or nothing can be written.
    """
    folder = inputs.path(folder, "folder of the library")
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file: give a folder for the library")
    check_target(folder.resolve().parent / f"{folder.name}.probe", "folder of the library")
    if folder.is_dir():
        check_target(folder / "example.c", "example")
    return folder


def _check_file(file: str | Path | None) -> Path:
    """The file for an FMU.

    Raises
    ------
    InputError
        Another ending, or it cannot be written.
    """
    assert file is not None         # one of both was given
    return check_target(file, "FMU", (".fmu",))


def _move(made: Path, target: Path) -> None:
    """Put complete files in their place, each at once."""
    if not target.exists():
        made.replace(target)
        return
    for file in sorted(made.rglob("*")):
        place = target / file.relative_to(made)
        if file.is_dir():
            place.mkdir(exist_ok=True)
        else:
            file.replace(place)
