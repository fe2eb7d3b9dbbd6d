"""Git LFS: the text that stands in a repository where it keeps a file somewhere else."""

from __future__ import annotations

_POINTER = "version https://git-lfs"

HELP = (
    "run `git lfs pull` in its repository; of a `git+` reference such files are not fetched:"
    " name the file of a clone by its path"
)


def is_pointer(content: bytes | str) -> bool:
    """Whether this is not a file itself but where Git LFS has it. No I/O."""
    if isinstance(content, str):
        return content.startswith(_POINTER)
    return content.startswith(_POINTER.encode())
