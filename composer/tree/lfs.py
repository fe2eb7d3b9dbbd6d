"""Git LFS pointers: the text in a repository for a file that is stored elsewhere."""

from __future__ import annotations

_POINTER = "version https://git-lfs"

HELP = (
    "run `git lfs pull` in its repository; of a `git+` reference such files are not fetched:"
    " name the file of a clone by its path"
)


def is_pointer(content: bytes | str) -> bool:
    """Return whether this is a Git LFS pointer instead of the file. No I/O."""
    if isinstance(content, str):
        return content.startswith(_POINTER)
    return content.startswith(_POINTER.encode())
