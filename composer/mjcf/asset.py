"""Files of a model: meshes, textures, height fields and skins, from disk or from memory."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from lxml import etree

from composer.diagnostics.call_site import call_site
from composer.mjcf.arguments import as_path, expects
from composer.mjcf.errors import failure
from composer.mjcf.flat import bundle_paths
from composer.mjcf.model import Model
from composer.reading.refused import CODE, Refused
from composer.reading.regular import read_regular
from composer.tree.files import in_archive, join, stem, written_path
from composer.tree.settings import read_settings
from composer.tree.unit import Unit


class Asset:
    """A file that a model needs.

    `path` is where it was read from, None for bytes in memory; `prefix` is the stem of its file name; `extension`
    is its suffix with the dot, as written. Any `file` attribute accepts an `Asset(data, '.stl')`.

    >>> asset = Asset(b'...', '.png', 'wood')
    >>> asset.path, asset.prefix, asset.extension, asset.contents, asset.bundle_path
    (None, 'wood', '.png', b'...', None)
    """

    __slots__ = ("_data", "_model", "extension", "path", "prefix")

    def __init__(
        self,
        contents: bytes | None = None,
        extension: str = "",
        prefix: str = "asset",
        *,
        path: str | os.PathLike[str] | None = None,
    ) -> None:
        """Make an asset from either `contents` or `path`. The file at a path is read when `contents` is accessed."""
        if (contents is None) == (path is None):
            message = "an `Asset` is made of `contents` or of a `path`, one of them"
            raise failure("wrong-type", message, call_site())
        self._data = contents
        self._model: Model | None = None
        if path is not None:
            self.path: Path | None = as_path("path", path)
            self.extension, self.prefix = self.path.suffix, stem(self.path.name)
            return
        if not isinstance(contents, bytes):
            raise expects("contents", "bytes", type(contents).__name__)
        if not (isinstance(extension, str) and re.fullmatch(r"\.[^/\\]+", extension)):
            raise expects("extension", "a suffix such as `.stl`", extension)
        if not (isinstance(prefix, str) and re.fullmatch(r"[^/\\]+", prefix)):
            raise expects("prefix", "the name of a file without folders", prefix)
        self.path, self.extension, self.prefix = None, extension, prefix

    @property
    def contents(self) -> bytes:
        """The bytes of the file. Raises `MjcfError` if the file can no longer be read."""
        if self._data is not None:
            return self._data
        assert self.path is not None
        try:
            return read_regular(self.path)
        except OSError as error:
            message = f"the file `{self.path}` cannot be read: {error.strerror or str(error)}"
            archive = in_archive(self.path)
            if archive is not None:
                message = "`{}` has no file `{}`".format(*archive)
            raise failure("asset-missing", message, call_site()) from None

    @property
    def bundle_path(self) -> str | None:
        """The path that `export_with_assets` writes the file to, such as `assets/arm/shell.stl`.

        The exported model refers to the file by this path. To determine it, the whole composition is linked. It is
        None for an `Asset` that was not read from an element, and for one whose element is not written. Raises
        `MjcfError` as exporting does.

        >>> from composer import mjcf
        >>> model = mjcf.RootElement('table')
        >>> wood = model.asset.add('texture', name='wood', type='2d', file=Asset(b'...', '.png', 'wood'))
        >>> wood.file.bundle_path
        'assets/table/wood.png'
        """
        return None if self._model is None else bundle_paths(self._model.top).get(self.source)

    @property
    def source(self) -> bytes | Path:
        """The bytes, if they are in memory, or the path of the file."""
        if self._data is not None:
            return self._data
        assert self.path is not None
        return self.path

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Asset) and self.source == other.source and self.extension == other.extension

    def __hash__(self) -> int:
        return hash((self.source, self.extension))

    def __repr__(self) -> str:
        size = "" if self._data is None else f", {len(self._data)} bytes"
        return f"Asset({str(self.path) if self.path else self.prefix + self.extension!r}{size})"


class Files(Mapping[str, bytes | Path]):
    """The files of a model that are not at their written paths: their bytes or their actual paths, by written path.

    A file that the caller gives without a folder is found under its name in any folder.
    """

    def __init__(self, given: Mapping[str, bytes | Path] | None = None) -> None:
        self._exact = {join("", name): content for name, content in (given or {}).items()}
        self._anywhere = {name: content for name, content in self._exact.items() if "/" not in name}

    def with_files(self, files: Mapping[str, bytes | Path]) -> Files:
        """Return these files and `files`; each of `files` is found only by its exact path."""
        more = Files()
        more._exact = {**self._exact, **files}
        more._anywhere = self._anywhere
        return more

    def __getitem__(self, name: str) -> bytes | Path:
        found = self._exact.get(name)
        return self._anywhere[posixpath.basename(name)] if found is None else found

    def __iter__(self) -> Iterator[str]:
        return iter(self._exact)

    def __len__(self) -> int:
        return len(self._exact)


def asset_of(model: Model, tag: str, name: str) -> Asset:
    """Return the file that an element with this tag refers to by `name`."""
    unit = model.unit
    written = _written(model, tag, name)
    known = unit.contents.get(written)
    if isinstance(known, bytes):
        asset = Asset(known, posixpath.splitext(written)[1] or ".bin", stem(written))
    else:
        asset = Asset(path=known if isinstance(known, Path) else _admitted(unit, written))
    asset._model = model
    return asset


def _admitted(unit: Unit, written: str) -> Path:
    """Return the path of a file that the model's text refers to. Raises `MjcfError` if it may not be read."""
    try:
        return Path(unit.door.admit(join(str(unit.directory), written)))
    except Refused as refused:
        raise failure(CODE, refused.message(), call_site(), help=refused.help) from None


def place(model: Model, tag: str, asset: Asset, contents: dict[str, bytes | Path]) -> str:
    """Return a file name in the model for an asset, and add the file to `contents`. Equal assets share one name."""
    number = 1
    while True:
        name = f"{asset.prefix}{'' if number == 1 else f'-{number}'}{asset.extension}"
        written = _written(model, tag, name)
        known = contents.get(written, model.unit.contents.get(written))
        there = Path(join(str(model.unit.directory), written))
        if known is None and not os.path.exists(there):
            contents[written] = asset.source
            return name
        if asset.source == (there if known is None else known):
            return name
        number += 1


def _written(model: Model, tag: str, name: str) -> str:
    if tag == "model":  # MuJoCo looks for it beside the main file
        return join("", name)
    return written_path(read_settings(model.unit.root), etree.Element(tag), name)
