"""The memory and disk space that work needs, against what this machine has."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from cylcontact.errors import InputError

__all__ = ["as_size", "available", "require_memory", "require_space"]

_CGROUP = Path("/sys/fs/cgroup")
# Limit, use and the name of what could be dropped from it, for versions 2 and 1.
_CGROUP_FILES = (
    ("memory.max", "memory.current", "inactive_file"),
    ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes", "total_inactive_file"),
)


def as_size(number: float) -> str:
    """Return a number of bytes in words.

    Examples
    --------
    >>> as_size(3.2e9), as_size(64e6), as_size(200e3), as_size(12)
    ('3.2 GB', '64 MB', '200 kB', '12 bytes')
    """
    for unit, name in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if number >= unit:
            return f"{number / unit:.3g} {name}" if number < 1e15 else f"{number / unit:.1e} {name}"
    return f"{number:.0f} bytes"


def available() -> float:
    """Return the bytes of memory that this process may still take; inf if nothing tells.

    The least of what the machine has free, what its control group allows, and `ulimit -v`.
    """
    return min(_limits(), default=float("inf"))


def require_memory(source: str, key: str, value: object, needed: float, remedy: str) -> None:
    """Raise `InputError` if work needs more memory than there is.

    Parameters
    ----------
    source, key, value, remedy
        For the error.
    needed : float
        An estimate in bytes.
    """
    free = available()
    if needed > free:
        rule = f"needs about {as_size(needed)} of memory, and {as_size(free)} are free"
        raise InputError(source, key, value, rule, remedy)


def require_space(path: Path | str, needed: float, remedy: str) -> None:
    """Raise `InputError` if a file would need more space than its disk has.

    Parameters
    ----------
    path : path
        The file, which need not exist, nor its folder.
    needed : float
        An estimate in bytes.
    remedy : str
        For the error.
    """
    folder = next(parent for parent in Path(path).absolute().parents if parent.is_dir())
    free = shutil.disk_usage(folder).free
    if needed > free:
        rule = f"needs about {as_size(needed)} of disk space, and {as_size(free)} are free"
        raise InputError(str(path), "", None, rule, remedy)


def _limits() -> Iterator[float]:
    """Yield what each limit leaves."""
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        free = next(line.split()[1] for line in lines if line.startswith("MemAvailable:"))
        yield int(free) * 1024.0
    for limit, used, idle in _CGROUP_FILES:
        with suppress(OSError, ValueError):  # "max" is no number
            files = [int((_CGROUP / name).read_text(encoding="ascii")) for name in (limit, used)]
            statistics = (_CGROUP / limit).with_name("memory.stat").read_text(encoding="ascii")
            idle_bytes = dict(line.split() for line in statistics.splitlines()).get(idle, 0)
            yield float(files[0] - files[1] + int(idle_bytes))
    if sys.platform == "linux":
        import resource

        limit_of_process, _ = resource.getrlimit(resource.RLIMIT_AS)
        if limit_of_process != resource.RLIM_INFINITY:
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            yield float(limit_of_process - pages * os.sysconf("SC_PAGE_SIZE"))
    elif hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        yield float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
