"""Windows: a job object that ends its processes when the system closes the handle of the process that created it."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

_EXTENDED_LIMITS, _KILL_ON_JOB_CLOSE = 9, 0x2000
# sizeof(JOBOBJECT_EXTENDED_LIMIT_INFORMATION) in pointers is 18 on 64 bits; the flags follow two 64-bit times
_SIZE, _FLAGS_AT = 144, 16


def tie(handle: int) -> None:
    """End a process and all its children together with this one. Errors of the system are ignored."""
    kernel = _kernel()
    job = _job()
    if job:
        kernel.AssignProcessToJobObject(job, ctypes.c_void_p(handle))


@cache
def _job() -> Any:
    kernel = _kernel()
    job = ctypes.c_void_p(kernel.CreateJobObjectW(None, None))
    limits = ctypes.create_string_buffer(_SIZE)
    ctypes.memmove(ctypes.addressof(limits) + _FLAGS_AT, _KILL_ON_JOB_CLOSE.to_bytes(4, "little"), 4)
    kernel.SetInformationJobObject(job, _EXTENDED_LIMITS, limits, _SIZE)
    return job


def _kernel() -> Any:
    kernel = getattr(ctypes, "windll").kernel32  # noqa: B009  it exists on Windows alone
    kernel.CreateJobObjectW.restype = ctypes.c_void_p
    return kernel
