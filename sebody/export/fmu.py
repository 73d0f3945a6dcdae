"""FMUs: archives of a model description and a library for each platform."""

from hashlib import sha256
from pathlib import Path
from typing import BinaryIO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from sebody.export.description import description, variables
from sebody.export.library import linked
from sebody.export.platforms import PLATFORMS
from sebody.export.prepared import Prepared

VERSIONS = ("3.0", "2.0")
_DATE = 1980, 1, 1, 0, 0, 0     # of all members: the same model gives the same file


def write_fmu(model: Prepared, file: BinaryIO, work: Path, platforms: list[str], processor: str,
              fmi: str, t_end: float | None) -> None:
    """Write an FMU with a library for each platform.

    Parameters
    ----------
    work : Path
        Folder for intermediate files.
    """
    token = _token(model, fmi)
    (work / "token.h").write_text(f'#define TOKEN "{token}"\n', encoding="utf-8")
    libraries = linked(model, work, platforms, processor, [f"fmi{fmi[0]}.c"])
    with ZipFile(file, "w", ZIP_DEFLATED) as archive:
        def add(name: str, content: bytes) -> None:
            info = ZipInfo(name, _DATE)
            info.compress_type, info.external_attr = ZIP_DEFLATED, 0o644 << 16
            archive.writestr(info, content)
        add("modelDescription.xml", description(model, token, fmi, t_end).encode())
        for platform, library in libraries.items():
            own = PLATFORMS[platform]
            folder = own.fmi2 if fmi == "2.0" else own.fmi3
            add(f"binaries/{folder}/{model.identifier}{own.suffix}", library.read_bytes())


def _token(model: Prepared, fmi: str) -> str:
    """A text that is the same for the same model and interface."""
    digits = sha256(repr((model.image.stored, variables(model), fmi)).encode()).hexdigest()
    return "{" + "-".join(digits[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32))
                          ) + "}"
