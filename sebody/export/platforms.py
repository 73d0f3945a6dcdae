"""Platforms and processors that libraries are made for.

Numba reads its settings when it is imported: here it is only where the processor is asked for.
"""

import platform
import sys
from typing import NamedTuple
from zlib import crc32

from sebody.basics.errors import InputError

_X86 = "e-m:{}-p270:32:32-p271:32:32-p272:64:64-i64:64-i128:128-f80:128-n8:16:32:64-S128"
_ARM = "e-m:{}-i64:64-i128:128-n32:64-S128-Fn32"


class Platform(NamedTuple):
    """An operating system and architecture."""

    triple: str         # for LLVM
    layout: str         # of data, for LLVM
    target: str         # for the linker
    prefix: str         # of the file of a library
    suffix: str
    fmi3: str           # folder in an FMU 3.0
    fmi2: str           # folder in an FMU 2.0; empty where the standard has none


PLATFORMS = {
    "linux-x86_64": Platform("x86_64-unknown-linux-gnu", _X86.format("e"),
                             "x86_64-linux-gnu.2.17", "lib", ".so", "x86_64-linux", "linux64"),
    "windows-x86_64": Platform("x86_64-pc-windows-gnu", _X86.format("w"), "x86_64-windows-gnu",
                               "", ".dll", "x86_64-windows", "win64"),
    "macos-x86_64": Platform("x86_64-apple-macosx11.0.0", _X86.format("o"), "x86_64-macos.11.0",
                             "lib", ".dylib", "x86_64-darwin", "darwin64"),
    "macos-arm64": Platform("arm64-apple-macosx11.0.0", _ARM.format("o"), "aarch64-macos.11.0",
                            "lib", ".dylib", "aarch64-darwin", ""),
    "linux-aarch64": Platform("aarch64-unknown-linux-gnu", "e-m:e-i8:8:32-i16:16:32-i64:64-"
                              "i128:128-n32:64-S128-Fn32", "aarch64-linux-gnu.2.17", "lib", ".so",
                              "aarch64-linux", ""),
}
# processors that x86 code is made for: the features that LLVM is told of
PROCESSORS = {
    "x86-64": "+sse2",
    "x86-64-v2": "+sse3,+ssse3,+sse4.1,+sse4.2,+popcnt,+cx16",
    "x86-64-v3": "+sse3,+ssse3,+sse4.1,+sse4.2,+popcnt,+cx16,+avx,+avx2,+fma,+bmi,+bmi2,+f16c,"
                 "+lzcnt,+movbe",
}
DEFAULT = "x86-64-v3"
NATIVE = "native"       # that of this machine, or whatever Numba compiles for
_ARM_PROCESSORS = {"macos-arm64": "apple-m1", "linux-aarch64": "generic"}
_HOSTS = {"linux": "linux", "win32": "windows", "darwin": "macos"}
_MACHINES = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "arm64", "aarch64": "aarch64"}


def host() -> str:
    """The platform of this machine.

    Raises
    ------
    InputError
        None of the platforms.
    """
    machine = _MACHINES.get(platform.machine().lower(), platform.machine())
    name = f"{_HOSTS.get(sys.platform, sys.platform)}-{machine}"
    if name not in PLATFORMS:
        raise InputError(f"this machine is {name}, for which no libraries are made: give "
                         f"platforms= some of {', '.join(PLATFORMS)}")
    return name


def target_processor(name: str, processor: str) -> tuple[str, str]:
    """Processor and features for LLVM on a platform; `processor` is meant for x86."""
    if processor == NATIVE:
        from sebody.compiler.choice import way

        return way().processor()
    if name in _ARM_PROCESSORS:
        return _ARM_PROCESSORS[name], ""
    return processor, PROCESSORS[processor]


def tag(processor: str) -> str:
    """Name of a processor in the names of files, also of the way in which Numba compiles for it.

    That of this machine depends on the machine.
    """
    from sebody.compiler.choice import way

    own = way().__name__.rpartition(".")[2]
    if processor != NATIVE:
        return f"{own}.{processor}"
    name, features = way().processor()
    return f"{own}.{name}-{crc32(features.encode()):08x}"


def environment(processor: str) -> dict[str, str]:
    """Environment variables with which Numba compiles for a processor."""
    if processor == NATIVE:
        return {}
    return {"NUMBA_CPU_NAME": processor, "NUMBA_CPU_FEATURES": PROCESSORS[processor]}
