"""Files kept from run to run: read wherever they are, written to the first folder that allows it.

A file holds its checksum, a line with the hash of its sources, and the content. A file that is
damaged or made from other sources counts as absent.
"""

import os
import warnings
import zlib
from collections.abc import Iterator
from hashlib import sha1
from pathlib import Path
from uuid import uuid4

from numba import config
from numba.misc.appdirs import AppDirs

_CHECKSUM = 4       # bytes
_said = set()       # topics of warnings


def folders(source: Path) -> list[Path]:
    """Folders in which files about a module are looked for, in this order.

    ``NUMBA_CACHE_DIR`` if it is set, the ``__pycache__`` beside the module, the user's cache.
    """
    users = AppDirs(appname="sebody", appauthor=False).user_cache_dir
    roots = [root for root in (config.CACHE_DIR, users) if root and os.path.isabs(root)]
    private = f"{source.parent.name}_{sha1(str(source.parent).encode()).hexdigest()}"
    found = [Path(root) / private for root in roots]
    found.insert(1 if config.CACHE_DIR else 0, source.parent / "__pycache__")
    return found


def read(source: Path, name: str, made_from: str) -> Iterator[bytes]:
    """Contents of the files about a module under a name, from every folder that has one."""
    for folder in folders(source):
        content = _content(folder / name, made_from)
        if content is not None:
            yield content


def _content(path: Path, made_from: str) -> bytes | None:
    try:
        data = path.read_bytes()
    except OSError:
        return None
    if data[:_CHECKSUM] != _checksum(memoryview(data)[_CHECKSUM:]):
        say_once(str(path), f"{path} is damaged and not used: it is written anew where that is "
                 "allowed, otherwise delete it")
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
