"""Libraries for C: the files of a folder."""

import re
from pathlib import Path

from sebody.basics.version import __version__
from sebody.export import toolchain
from sebody.export.objects import objects
from sebody.export.platforms import PLATFORMS
from sebody.export.prepared import Prepared
from sebody.export.tables import model_h, quoted, recorded_parts
from sebody.export.toolchain import SOURCES


def write_library(model: Prepared, folder: Path, work: Path, platforms: list[str],
                  processor: str) -> None:
    """Write a library for each platform, a header and an example into an empty folder.

    Parameters
    ----------
    work : Path
        Folder for intermediate files.
    """
    (folder / f"{model.identifier}.h").write_text(_filled(model, "header.h"), encoding="utf-8")
    (folder / "example.c").write_text(_filled(model, "example.c"), encoding="utf-8")
    for platform, library in linked(model, work, platforms, processor, ["library.c"]).items():
        place = folder / platform
        place.mkdir()
        for file in library.parent.glob(f"{library.stem}.*"):
            if file.suffix in (library.suffix, ".lib"):     # with the import library of a DLL
                file.rename(place / file.name)


def linked(model: Prepared, work: Path, platforms: list[str], processor: str,
           sources: list[str]) -> dict[str, Path]:
    """A library of the model and of sources in C for each platform."""
    (work / "model.h").write_text(model_h(model), encoding="utf-8")
    paths = {}
    for platform in platforms:
        place = work / platform
        place.mkdir()
        files = []
        for name, content in objects(model, platform, processor).items():
            files.append(work / f"{platform}.{name}.o")
            files[-1].write_bytes(content)
        own = PLATFORMS[platform]
        paths[platform] = place / f"{own.prefix}{model.identifier}{own.suffix}"
        toolchain.link(work, paths[platform], platform, files, [*sources, "memory.c"])
    return paths


def _filled(model: Prepared, name: str) -> str:
    """A file with the names and numbers of the model."""
    upper = model.identifier
    text = (SOURCES / name).read_text(encoding="utf-8")
    values = {
        "ID": upper, "NAME": _comment(model.name), "VERSION": __version__,
        "STEP": float(model.run.h).hex(), "COLUMNS": str(model.run.state.now.size),
        "ROW": recorded_parts(model),
        "INPUTS": "\n".join(f"/*  {k}: {_comment(one.name)}{_unit(one.unit)}, {one.start:.9g} at "
                            "the start */" for k, one in enumerate(model.inputs))
        or "/*  none */",
        "OUTPUTS": "\n".join(f"/*  {k}: {_comment(name)}{_unit(unit)} */" for k, (name, unit) in
                             enumerate(zip(model.names, model.units, strict=True)))
        or "/*  none */",
        "NAMES": "".join(f"{quoted(name)}, " for name in model.names)}
    return re.sub("@([A-Z]+)@", lambda found: values[found.group(1)], text)


def _comment(text: str) -> str:
    return text.replace("*/", "* /").replace("/*", "/ *")


def _unit(unit: str) -> str:
    return f" [{_comment(unit)}]" if unit else ""
