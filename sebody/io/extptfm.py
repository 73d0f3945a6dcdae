"""Foundations of OpenFAST's module ExtPtfm: matrices of a body that is held, and a series of loads.

Two forms, in SI units: FlexASCII ("Flex 5 Format") with blocks under headings, of one interface and
any number of modes; GuyanASCII of the interface alone, whose lines are counted. The order is x, y,
z, rx, ry, rz, then modes. The damping matrix stands behind the stiffness in the first form and
before it in the second. Neither says where the interface is.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.reading import existing, text as read_text
from sebody.io.grounded import AXES, Block, HeldBody, columns
from sebody.io.load_series import LoadSeries
from sebody.io.reading import Reading
from sebody.io.text import fault
from sebody.reduction.body import ReducedBody

WAVE = "wave elevation"
UNITS = "m kg N s"
# names and headings of the blocks, in the order in which they are written
BLOCKS = {"mass": "Mass Matrix", "stiffness": "Stiffness Matrix", "damping": "Damping Matrix"}
LOADING = "Loading and Wave Elevation"
FORMS = "flex", "guyan"
_GUYAN = {"mass": 2, "damping": 9, "stiffness": 16}     # lines before the first row of each
_GUYAN_LOADS = 25
_WHAT = "ExtPtfm file"
_REMEDY = ("give a file of the form FlexASCII, with !Dimension, !Mass Matrix, !Stiffness Matrix, "
           "!Damping Matrix and !Loading, one of the form GuyanASCII, or the ExtPtfm.dat that "
           "names one of them")
_STEPS = 1e-6       # of a time step: rounding of times


def read_extptfm(path: str | Path, interface: ArrayLike, base: ArrayLike | None = None
                 ) -> tuple[ReducedBody, LoadSeries | None]:
    """Body and series of loads of a foundation in a file of OpenFAST's module ExtPtfm.

    Parameters
    ----------
    path : str or Path
        A file of the form FlexASCII or GuyanASCII, or the ExtPtfm.dat that names one and the modes
        to keep.
    interface : (3,)
        Place of the interface [m]: the platform reference point of the turbine, which no file of
        this module names.
    base : (3,), optional
        Place of the base [m], see `grounded_body`.

    Returns
    -------
    ReducedBody
        For `Model.foundation`; the loads contain the weight as the writer chose, so the body has no
        coupling with its base and no weight of its own.
    LoadSeries or None
        For `Model.body_series`: columns x to rz, then mode 0 and so on; None without loads.

    Raises
    ------
    InputError
        A file that cannot be used; the message names line and block.
    """
    held = read_held(existing(path, _WHAT, _REMEDY))
    return held.body(interface, base), held.series


def write_extptfm(body: ReducedBody, path: str | Path, series: LoadSeries | None = None,
                  form: str = "flex", comment: str = "") -> Path:
    """Write a body that is held to the ground, and loads on it, for OpenFAST's module ExtPtfm.

    Numbers are written so that they are read again bit for bit.

    Parameters
    ----------
    body : ReducedBody
        Of `grounded_body`, with one interface that keeps position and rotation; SI units.
    series : LoadSeries, optional
        Columns among x to rz, mode 0 and so on; of others the wave elevation is written. Without
        it the loads are zero.
    form : 'flex' or 'guyan'
        FlexASCII, or GuyanASCII of bodies without modes.
    comment : str
        For the first line.

    Raises
    ------
    InputError
        Another body, columns that act on nothing, a series the form cannot hold, or a target that
        cannot be written.
    """
    path = check_target(path, _WHAT, (".dat", ".txt", ".inp"))
    inputs.choice(form, "form", FORMS)
    comment = inputs.text(comment, "comment").replace("\n", " ")
    matrices = _held_matrices(inputs.instance(body, "body", ReducedBody, "give a ReducedBody"))
    table = _load_table(series, body.modes)
    if form == "guyan" and body.modes:
        raise InputError(f"the form 'guyan' holds no modes and the body has {body.modes}: write "
                         "the form 'flex', or a body without modes")
    lines = _guyan_lines(matrices, table, comment) if form == "guyan" else _flex_lines(
        matrices, table, comment)
    with replacing(path, _WHAT) as stream:
        stream.write(("\n".join(lines) + "\n").encode())
    return path


def read(path: Path) -> Reading:
    """Contents of the files, for `sebody.io.import_body`; see `read_held`."""
    held = read_held(path)
    notes = {"not read": "; ".join(held.notes)} if held.notes else {}
    return Reading(held, source=f"ExtPtfm {held.path.name}", notes=notes)


def read_held(path: Path) -> HeldBody:
    """Contents of a file of any of the forms.

    Raises
    ------
    InputError
        A file that cannot be used.
    """
    lines = read_text(path, _WHAT, _REMEDY).splitlines()
    if any(re.match(r"(?i)\s*\S+\s+Red_FileName\b", line) for line in lines):
        return _of_input_file(path, lines)
    if len(lines) > 1 and "#mass" in lines[1].lower():
        return _guyan(path, lines)
    if len(lines) > 1 and lines[0].startswith("!") and any(
            "flex 5 format" in line.lower() for line in lines[:3]):
        return _flex(path, lines)
    raise InputError(f"{path} is no {_WHAT}: {_REMEDY}")


def _of_input_file(path: Path, lines: list[str]) -> HeldBody:
    """Contents of the file that an ExtPtfm.dat names, with the modes that it keeps."""
    found = {words[1]: (number, words[0].strip("\"'")) for number, line in enumerate(lines, 1)
             if len(words := _words(line)) > 1}
    _, name = found["Red_FileName"]
    held = read_held(existing(path.parent / name, _WHAT, _REMEDY))
    line, count = found.get("NActiveDOFList", (0, "-1"))
    try:
        number = int(count)
        kept = [] if number < 1 else [
            int(word) for word in found["ActiveDOFList"][1].split(",") if word][:number]
    except (KeyError, ValueError):
        raise fault(path, line, "NActiveDOFList and ActiveDOFList are no whole numbers",
                    "give -1 for all modes, 0 for none, or their number and a list") from None
    if number > 0 and (len(kept) < number or not all(1 <= k <= held.modes for k in kept)
                       or len(set(kept)) < len(kept)):
        raise fault(path, line, f"{number} of the modes {kept} are to be kept, and {name} has "
                    f"{held.modes}", "list so many different ones of them, counted from 1")
    if number >= 0:
        held = held.keeping([k - 1 for k in kept])
    given = [text for text, key in (("positions", "NInitPosList"), ("velocities", "NInitVelList"))
             if found.get(key, (0, "0"))[1] not in ("0", "-1")]
    notes = tuple(f"initial {text} of modes in {path.name} are left out" for text in given)
    return replace(held, notes=notes)


def _words(line: str) -> list[str]:
    """Value and name of a line of an input file; lists may have blanks behind their commas."""
    return re.sub(r",\s+(?=\d)", ",", line.strip()).split()


def _flex(path: Path, lines: list[str]) -> HeldBody:
    size = int(_header(path, lines, "Dimension", r"(\d+)"))
    step = float(_header(path, lines, "Time increment in simulation", r"(\S+)"))
    total = float(_header(path, lines, "Total simulation time in file", r"(\S+)"))
    if size < len(AXES):
        raise InputError(f"{path}: the dimension is {size}, less than the six of an interface: "
                         f"{_REMEDY}")
    blocks = {}
    for name, heading in BLOCKS.items():
        at = _heading(path, lines, heading)
        rows = _rows(path, lines, at, size, size, f"{name} matrix")
        blocks[name] = Block(np.array([row for _, row in rows]), rows[0][0])
    at = _heading(path, lines, LOADING)
    count = None
    if step > 0:
        count = round(total / step) + 1
    rows = _rows(path, lines, at, count, size + 2, "loading", "time, loads, wave elevation")
    table = np.array([row for _, row in rows])
    _check_course(path, rows)
    series = LoadSeries(table[:, 0], table[:, 1:-1], columns(size - len(AXES)),
                        others={WAVE: table[:, -1]})
    return HeldBody(path, blocks, series, units=UNITS)


def _guyan(path: Path, lines: list[str]) -> HeldBody:
    blocks = {}
    for name, before in _GUYAN.items():
        rows = [(number + 1, _numbers(path, number + 1, _line(path, lines, number), len(AXES),
                                      f"{name} matrix")) for number in range(
                                          before, before + len(AXES))]
        blocks[name] = Block(np.array([row for _, row in rows]), rows[0][0])
    rows = [(number, _numbers(path, number, line, len(AXES) + 1, "loading", "time, loads"))
            for number, line in enumerate(lines[_GUYAN_LOADS:], _GUYAN_LOADS + 1) if line.strip()]
    if not rows:
        return HeldBody(path, blocks, None, units=UNITS)
    _check_course(path, rows)
    table = np.array([row for _, row in rows])
    return HeldBody(path, blocks, LoadSeries(table[:, 0], table[:, 1:], AXES), units=UNITS)


def _check_course(path: Path, rows: list[tuple[int, NDArray]]) -> None:
    """Refuse times that do not increase."""
    for (_, before), (line, row) in zip(rows, rows[1:], strict=False):
        if row[0] <= before[0]:
            raise fault(path, line, f"the time {row[0]:g} of the loading is not after "
                        f"{before[0]:g}", "sort the lines")


def _header(path: Path, lines: list[str], name: str, pattern: str) -> str:
    """The value of the first line ``!NAME: value``."""
    for number, line in enumerate(lines, 1):
        if line.lower().startswith(f"!{name.lower()}"):
            match = re.fullmatch(rf"\s*:?\s*{pattern}\s*", line[1 + len(name):])
            try:
                float(match[1] if match else "")
            except ValueError:
                raise fault(path, number, f"{inputs.shown(line)} has no number for {name}",
                            _REMEDY) from None
            return match[1]
    raise InputError(f"{path} has no line !{name}: {_REMEDY}")


def _heading(path: Path, lines: list[str], heading: str) -> int:
    """Place of the first line behind the heading of a block and the line of its dimension."""
    for number, line in enumerate(lines):
        if line.lower().lstrip("! ").startswith(heading.lower()) and line.startswith("!"):
            return number + 2
    raise InputError(f"{path} has no block !{heading}: {_REMEDY}")


def _rows(path: Path, lines: list[str], first: int, count: int | None, width: int, block: str,
          of: str = "") -> list[tuple[int, NDArray]]:
    """Rows of a block with the numbers of their lines: `count` of them, or all to the next heading.
    """
    rows = []
    for number, line in enumerate(lines[first:], first + 1):
        if line.startswith("!"):
            break
        if line.strip():
            rows.append((number, _numbers(path, number, line, width, block, of)))
    wanted = "" if count is None else str(count)
    if not rows or count is not None and len(rows) != count:
        last = rows[-1][0] if rows else first
        raise fault(path, last, f"the {block} has {len(rows)} lines of numbers in place of "
                    f"{wanted or 'one at least'}", "give the dimension, the time increment and the "
                    "total time that the file has, or the missing lines")
    return rows


def _numbers(path: Path, number: int, line: str, width: int, block: str, of: str = "") -> NDArray:
    """The numbers of a line."""
    try:
        row = np.array(line.replace("D", "E").replace("d", "e").split(), dtype=float)
    except ValueError:
        row = np.zeros(0)
    if len(row) != width or not np.isfinite(row).all():
        raise fault(path, number, f"{inputs.shown(line)} is no line of {width} finite numbers of "
                    f"the {block}{f' ({of})' * bool(of)}", _REMEDY)
    return row


def _line(path: Path, lines: list[str], number: int) -> str:
    if number >= len(lines):
        raise InputError(f"{path} ends at line {len(lines)}, within its matrices: {_REMEDY}")
    return lines[number]


def _held_matrices(body: ReducedBody) -> dict[str, NDArray]:
    """Matrices in the coordinates of the interface and the modes, which the base does not move."""
    interfaces = [k for k in range(len(body.keeps)) if k != body.base]
    if body.base is None or body.planar:
        raise InputError("the body is not held to the ground in space: give one of grounded_body, "
                         "or of an FE model with its base as a boundary node and base=")
    if len(interfaces) != 1 or body.keeps[interfaces[0]] != "full":
        raise InputError(f"the body has {len(interfaces)} interfaces, and the file holds one with "
                         "position and rotation: reduce it with one 'full' interface")
    if body.units not in ("", UNITS):
        raise InputError(f"the body is in the units {body.units} and the file is in SI, {UNITS}: "
                         "make it in these units")
    own = interfaces[0]
    rows = [*range(3 * own, 3 * own + 3), *range(6 + 3 * own, 9 + 3 * own),
            *range(12, len(body.mass))]
    chosen = np.ix_(rows, rows)
    damping = np.zeros_like(body.mass) if body.damping is None else body.damping
    return {"mass": body.mass[chosen], "stiffness": body.stiffness[chosen],
            "damping": damping[chosen]}


def _load_table(series: LoadSeries | None, modes: int) -> NDArray:
    """Rows of time, loads and wave elevation."""
    names = columns(modes)
    if series is None:
        return np.zeros((1, len(names) + 2))
    inputs.instance(series, "series", LoadSeries, "give a LoadSeries")
    if series.interpolation != "linear":
        raise InputError(f"the series is {series.interpolation} between its rows, and the file is "
                         "read as linear: sample it with at(times) at shorter steps")
    for name in series.names:
        if name not in names:
            raise InputError(f"column {name!r} of the series acts on nothing that the file holds: "
                             f"columns are called {', '.join(names)}")
    if (np.diff(series.t) <= 0).any():
        raise InputError("the series has a jump, two rows of one time, which the file cannot hold")
    values = np.zeros((len(series.t), len(names)))
    values[:, [names.index(name) for name in series.names]] = series.values
    wave = series.others.get(WAVE, np.zeros(len(series.t)))
    return np.column_stack([series.t, values, wave])


def _flex_lines(matrices: dict[str, NDArray], table: NDArray, comment: str) -> list[str]:
    size, t = len(matrices["mass"]), table[:, 0]
    steps = np.diff(t)
    step = float((t[-1] - t[0]) / len(steps)) if len(steps) else 1.0
    if len(steps) and np.abs(steps - step).max() > _STEPS * step:
        raise InputError("the times of the series are not equally spaced, as this form wants them: "
                         "sample it with at(times)")
    lines = [f"!Comment {comment}".rstrip(), "!Comment Flex 5 Format", f"!Dimension: {size}",
             f"!Time increment in simulation: {step!r}",
             f"!Total simulation time in file: {float(t[-1] - t[0])!r}"]
    for name, heading in BLOCKS.items():
        lines += ["", f"!{heading}", f"!Dimension: {size}", *_written(matrices[name])]
    return [*lines, "", f"!{LOADING}", f"!Dimension: 1 time column, {size} forces, 1 elevation",
            *_written(table)]


def _guyan_lines(matrices: dict[str, NDArray], table: NDArray, comment: str) -> list[str]:
    lines = [f"# {comment}".rstrip()]
    for name in _GUYAN:
        lines += [f"#{name} matrix", *_written(matrices[name])]
    return [*lines, "#loading", "#time x y z rx ry rz", "#s N N N Nm Nm Nm",
            *_written(table[:, :-1])]


def _written(rows: NDArray) -> list[str]:
    return [" ".join(map(repr, row)) for row in rows.tolist()]
