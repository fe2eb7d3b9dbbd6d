"""The error for an output that cannot be written."""

from __future__ import annotations

import errno
from os import PathLike

from composer.diagnostics.error import DiagnosticError


class OutputError(DiagnosticError):
    """An output cannot be written. The raising code has restored the previous state."""


_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}
_HELP = {
    errno.EACCES: "choose a place that you may write to",
    errno.EPERM: "choose a place that you may write to",
    errno.EROFS: "choose a place that you may write to",
    **dict.fromkeys(_FULL, "make room on the disk, or choose another place"),
    errno.ENAMETOOLONG: "choose a shorter name",
}


def unwritable(out: str | PathLike[str], error: OSError) -> OutputError:
    """Return the operating system's error in the user's terms."""
    reason = error.strerror or str(error) or type(error).__name__
    return OutputError(
        "output-full" if error.errno in _FULL else "output-unwritable",
        f"cannot write `{out}`: {reason.lower()}",
        _HELP.get(error.errno or 0, "choose another place"),
    )
