"""Files kept from run to run, in the folder that a user names or else in one found by itself.

A file holds its checksum, a line with the hash of its sources, and the content. A file that is
damaged or made from other sources counts as absent.
"""

import os
import sys
import warnings
import zlib
from collections.abc import Iterator
from functools import cache
from hashlib import sha1
from pathlib import Path
from uuid import uuid4

from numba import config

_CHECKSUM = 4       # bytes
_said = set()       # topics of warnings


def folders(source: Path) -> list[Path]:
    """The folders in which files about a module are looked for and written, in this order.

    A folder below ``NUMBA_CACHE_DIR`` and no other where that is set; otherwise the ``__pycache__``
    beside the module and the user's cache.
    """
    private = f"{source.parent.name}_{sha1(str(source.parent).encode()).hexdigest()}"
    if config.CACHE_DIR:
        return [_absolute(config.CACHE_DIR) / private]
    users = _users_cache()
    return [source.parent / "__pycache__"] + [users / private] * users.is_absolute()


def _users_cache() -> Path:
    """The folder where the system keeps what programs can make again."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", ""), "sebody", "Cache")
    if sys.platform == "darwin":
        return Path(os.path.expanduser("~/Library/Caches/sebody"))
    return Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "sebody")


@cache
def _absolute(folder: str) -> Path:
    """A folder as it was meant when it was first asked for, before the process changes its own."""
    return Path(folder).absolute()


def read(source: Path, name: str, made_from: str) -> Iterator[bytes]:
    """Contents of the files about a module under a name, from every folder that has one."""
    for folder in folders(source):
        content = _content(folder / name, made_from)
        if content is not None:
            yield content


def holds(source: Path, name: str, made_from: str) -> bool:
    """Tell if something is kept, by its first line alone: what follows may still be damaged."""
    line = made_from.encode() + b"\n"
    return any(_beginning(folder / name, _CHECKSUM + len(line))[_CHECKSUM:] == line
               for folder in folders(source))


def _beginning(path: Path, size: int) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(size)
    except OSError:
        return b""


def writable_folder(source: Path) -> Path | None:
    """The first folder where something about a module could be kept, as far as permissions tell."""
    for folder in folders(source):
        existing = next((f for f in (folder, *folder.parents) if f.exists()), folder)
        if existing.is_dir() and os.access(existing, os.W_OK):
            return folder
    return None


def say_not_kept(source: Path) -> None:
    """Warn that what is compiled for a module cannot be kept."""
    say_once("writing", "compiled code cannot be stored, so every start compiles it again: "
             f"{not_writable(source)}")


def not_writable(source: Path) -> str:
    """The reason why nothing about a module can be kept, and the remedy."""
    tried = " and ".join(map(str, folders(source)))
    if config.CACHE_DIR:
        return (f"{tried} cannot be written; set NUMBA_CACHE_DIR, now {config.CACHE_DIR}, to a "
                "folder that can be written, or unset it")
    return f"{tried} cannot be written; set NUMBA_CACHE_DIR to a folder that can be written"


def _content(path: Path, made_from: str) -> bytes | None:
    try:
        data = path.read_bytes()
    except OSError:
        return None
    if data[:_CHECKSUM] != _checksum(memoryview(data)[_CHECKSUM:]):
        say_once(str(path), f"{path} is damaged and not used: it is rewritten if that is allowed, "
                 "otherwise delete it")
        return None
    end = data.index(b"\n", _CHECKSUM)
    return data[end + 1:] if data[_CHECKSUM:end] == made_from.encode() else None


def write(source: Path, name: str, made_from: str, content: bytes) -> bool:
    """Write a file about a module to the first folder that allows it; False if none does."""
    data = made_from.encode() + b"\n" + content
    data = _checksum(data) + data
    return any(_written(folder, name, data) for folder in folders(source))


def _written(folder: Path, name: str, data: bytes) -> bool:
    """Write a file atomically, since other processes may write the same file."""
    part = folder / f"{name}.{uuid4().hex[:16]}.part"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        part.write_bytes(data)
        part.replace(folder / name)
    except OSError:
        try:
            part.unlink()
        except OSError:
            pass
        return False
    return True


def _checksum(data) -> bytes:
    return zlib.crc32(data).to_bytes(_CHECKSUM, "big")


def say_once(topic: str, message: str) -> None:
    """Warn, once in a process about each topic."""
    if topic not in _said:
        _said.add(topic)
        warnings.warn(message, RuntimeWarning, stacklevel=1)
