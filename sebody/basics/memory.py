"""Memory that is available, compared with what is wanted before it is asked for."""

import os
from pathlib import Path

from sebody.basics.errors import InputError

SMALL = 2.0**26         # bytes: less is not worth a look
UNITS = ("bytes", "KiB", "MiB", "GiB", "TiB")
_LIMITS = (("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
           ("/sys/fs/cgroup/memory/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.usage_in_bytes"))     # of a container


def check(wanted: float, what: str, remedy: str) -> None:
    """Refuse what does not fit into memory.

    Parameters
    ----------
    wanted : float
        Bytes; infinity for more than can be counted.
    what : str
        What needs them, for the message: one thing.
    remedy : str
        What to do.

    Raises
    ------
    InputError
        More is wanted than is available.
    """
    if wanted <= SMALL:
        return
    there = available()
    if wanted > there:
        raise InputError(f"{what} does not fit into memory: {remedy} ({size(wanted)} needed, "
                         f"{size(there)} available)")


def available() -> float:
    """Bytes that this process can still get; infinity where the system does not tell."""
    return max(0.0, min(_of_machine(), _of_container(), _of_process()))


def size(count: float) -> str:
    """A number of bytes in words."""
    for unit in UNITS[:-1]:
        if count < 1024:
            return f"{count:.3g} {unit}"
        count /= 1024
    return f"{count:.3g} {UNITS[-1]}"


def _of_machine() -> float:
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError):
        pass
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return float("inf")


def _of_container() -> float:
    found = float("inf")
    for limit, used in _LIMITS:
        try:
            found = min(found, float(int(Path(limit).read_text()) - int(Path(used).read_text())))
        except (OSError, ValueError):   # no such file, or "max"
            continue
    return found


def _of_process() -> float:
    """Memory that a limit of the process's address space leaves (``ulimit -v``)."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit == resource.RLIM_INFINITY:
            return float("inf")
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        return float(limit - pages * os.sysconf("SC_PAGE_SIZE"))
    except (ImportError, OSError, ValueError):
        return float("inf")
