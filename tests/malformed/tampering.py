"""What is done to the members of files npz: one thing each, packed with right checksums."""

import json
import os
import zipfile
import zlib
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np


class Packed(NamedTuple):
    """A change of a file npz, and what the message has."""

    said: str
    change: Callable[[Path], Any]


def arrays(change: Callable[[dict], Any]) -> Callable[[Path], None]:
    """The members of a file changed, and packed again with right checksums."""
    def spoil(path: Path) -> None:
        with np.load(path) as file:
            found = dict(file)
        change(found)
        np.savez(path, **found)
    return spoil


def entry(name: str, place: Any, value: Any) -> Callable[[Path], None]:
    """One number of a member."""
    return arrays(lambda found: found.update({name: _with(found[name], place, value)}))


def member(name: str, value: Any) -> Callable[[Path], None]:
    """Another member in the place of one, or a new one; a function is given the old one."""
    return arrays(lambda found: found.update({
        name: np.asarray(value(found[name]) if callable(value) else value)}))


def without(name: str) -> Callable[[Path], None]:
    """A member that is missing."""
    return arrays(lambda found: found.pop(name))


def text(name: str, change: Callable[[Any], Any]) -> Callable[[Path], None]:
    """What a member that is a JSON text says, changed in place or replaced."""
    def spoil(found: dict) -> None:
        said = json.loads(str(found[name]))
        new = change(said)
        found[name] = np.array(json.dumps(said if new is None else new))
    return arrays(spoil)


def raw(name: str, content: str) -> Callable[[Path], None]:
    """A text as it is."""
    return member(name, content)


def bomb(name: str, shape: tuple[int, ...], dtype: str = "<f8") -> Callable[[Path], None]:
    """A member of zeros, a thousand times larger than what is packed: one packed piece repeated."""
    def spoil(path: Path) -> None:
        size, piece = np.dtype(dtype).itemsize * int(np.prod(shape)), 2**24
        stream = BytesIO()
        np.lib.format.write_array_header_1_0(stream, {"descr": dtype, "fortran_order": False,
                                                      "shape": shape})
        packer = zlib.compressobj(9, zlib.DEFLATED, -15)
        begin = packer.compress(stream.getvalue()) + packer.flush(zlib.Z_FULL_FLUSH)
        zeros = packer.compress(bytes(piece)) + packer.flush(zlib.Z_FULL_FLUSH)
        with zipfile.ZipFile(path) as file:
            kept = {one: file.read(one) for one in file.namelist() if one != f"{name}.npy"}
        with zipfile.ZipFile(path, "w") as file:
            for one, content in kept.items():
                file.writestr(one, content)
            file.writestr(f"{name}.npy", begin + size // piece * zeros + packer.flush())
            info = file.getinfo(f"{name}.npy")      # as the directory at the end tells of it
            info.compress_type, info.file_size = zipfile.ZIP_DEFLATED, size + stream.tell()
    return spoil


def encrypted(name: str) -> Callable[[Path], None]:
    """A member whose flags say that it is encrypted."""
    def spoil(path: Path) -> None:
        data, mark = bytearray(path.read_bytes()), f"{name}.npy".encode()
        at = data.index(mark, data.index(b"PK\x01\x02")) - 46       # in the directory at the end
        data[at + 8] |= 1
        path.write_bytes(bytes(data))
    return spoil


def method(name: str, number: int) -> Callable[[Path], None]:
    """A member that is packed in another way."""
    def spoil(path: Path) -> None:
        data, mark = bytearray(path.read_bytes()), f"{name}.npy".encode()
        at = data.index(mark, data.index(b"PK\x01\x02")) - 46
        data[at + 10] = number
        path.write_bytes(bytes(data))
    return spoil


def twice(name: str) -> Callable[[Path], None]:
    """A member that is there twice."""
    def spoil(path: Path) -> None:
        import warnings

        with zipfile.ZipFile(path, "a") as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            file.writestr(f"{name}.npy", file.read(f"{name}.npy"))
    return spoil


def fifo(path: Path) -> None:
    """A pipe that nobody writes to."""
    path.unlink()
    os.mkfifo(path)


def folder(path: Path) -> None:
    """A folder with the name of the file."""
    path.unlink()
    path.mkdir()


def nowhere(path: Path) -> None:
    """A link to nothing."""
    path.unlink()
    path.symlink_to(path.parent / "nothing")


def circle(path: Path) -> None:
    """A link to itself."""
    path.unlink()
    path.symlink_to(path)


def device(path: Path) -> None:
    """A link to a device that never ends."""
    path.unlink()
    path.symlink_to("/dev/zero")


def _with(array: np.ndarray, place: Any, value: Any) -> np.ndarray:
    found = np.array(array)
    found[place] = value
    return found


def of_texts(path: Path) -> None:
    """A zip of something else."""
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("notes.npy", "no array")
        file.writestr("read me", "no array")


def claims(path: Path, name: str, length: int) -> None:
    """A member whose header tells of more than there is."""
    with zipfile.ZipFile(path) as file:
        kept = {one: file.read(one) for one in file.namelist()}
    stream = BytesIO()
    np.lib.format.write_array_header_1_0(stream, {
        "descr": "<f8", "fortran_order": False, "shape": (length, length)})
    kept[f"{name}.npy"] = stream.getvalue() + bytes(800)
    with zipfile.ZipFile(path, "w") as file:
        for one, content in kept.items():
            file.writestr(one, content)


# of every kind of file
ANY = {"a pipe": Packed("is a pipe or a device: give the path of a file", fifo),
       "a device": Packed("is a pipe or a device: give the path of a file", device),
       "a folder": Packed("is a folder: give the path of a file", folder),
       "a link to nothing": Packed("does not exist", nowhere),
       "a link to itself": Packed("cannot be a file", circle)}
# of every npz file
ZIPS = {"empty": Packed("is damaged or no", lambda path: path.write_bytes(b"")),
        "text": Packed("is damaged or no", lambda path: path.write_text("no zip")),
        "an empty zip": Packed(": ", lambda path: zipfile.ZipFile(path, "w").close()),
        "half of it": Packed("is damaged or no", lambda path: path.write_bytes(
            path.read_bytes()[:path.stat().st_size // 2])),
        "a zip of texts": Packed("is damaged or no", of_texts)}
