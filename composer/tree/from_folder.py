"""View files by their paths from a folder of the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from composer.tree.files import join


class FromFolder(Mapping[str, bytes | Path]):
    """The files of `contents` under the names that a model in `folder` uses.

    >>> FromFolder({"tools/blade.obj": b"...", "arm.obj": b"..."}, "tools").get("blade.obj")
    b'...'
    """

    def __init__(self, contents: Mapping[str, bytes | Path], folder: str) -> None:
        self._contents, self._folder = contents, folder

    def __getitem__(self, name: str) -> bytes | Path:
        return self._contents[join(self._folder, name)]

    def __iter__(self) -> Iterator[str]:
        start = f"{self._folder}/" if self._folder else ""
        return (path.removeprefix(start) for path in self._contents if path.startswith(start))

    def __len__(self) -> int:
        return sum(1 for _ in self)
