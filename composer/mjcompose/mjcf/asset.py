"""Files of a model, arrays that write back, and checks of arguments."""

from __future__ import annotations

import contextlib
import operator
import os
import posixpath
import re
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from mjcompose.base.access import ALL, Door
from mjcompose.base.files import CODE, Refused, read_regular
from mjcompose.mjcf.errors import MjcfError, failure
from mjcompose.mjcf.flat import bundle_paths
from mjcompose.mjcf.model import ModelState
from mjcompose.tree.edit import BadBone, renamed_skin, skins
from mjcompose.tree.files import in_archive, join, read_settings, stem, written_path


def as_path(argument: str, value: object) -> Path:
    """Return the argument as a path. Raises `MjcfError` if it is not a path or contains a null character."""
    if not isinstance(value, str | os.PathLike):
        raise wrong_argument(argument, "a path", type(value).__name__)
    if "\0" in str(path := Path(value)):
        raise wrong_argument(argument, "a path", str(path).replace("\0", "\\0"))
    return path


Folders = Sequence[str | os.PathLike[str]]


def door_of(confine_to: Folders | None) -> Door:
    """Return the door of a model that a program reads: to these folders, or to all files that MuJoCo reads."""
    if confine_to is None:
        return ALL
    if isinstance(confine_to, str | bytes) or not isinstance(confine_to, Sequence):
        raise wrong_argument("confine_to", "a list of folders", repr(confine_to))
    folders = tuple(as_path("confine_to", each) for each in confine_to)
    whose = ", ".join(f"`{folder}`" for folder in folders) or "no folder"
    message = f"{whose}, which is all that `confine_to` names"
    return Door.of(folders, message, "add the folder: `confine_to=[…, '{absolute}']`")


def as_name(argument: str, value: object) -> str:
    """Return the argument if it is text. Raises `MjcfError` if it is not."""
    if isinstance(value, str):
        return value
    raise wrong_argument(argument, "a name", repr(value))


def as_index(argument: str, value: object) -> int:
    """Return the argument as an int. Raises `MjcfError` if it is not an integer of Python or numpy."""
    if not isinstance(value, bool):
        with contextlib.suppress(TypeError):  # arrays have the method too
            return operator.index(value)  # type: ignore[arg-type]
    raise wrong_argument(argument, "an integer", repr(value))


def as_files(argument: str, value: object) -> dict[str, bytes]:
    """Return the argument, the bytes of files by path or None, as a dict. Raises `MjcfError` if it is anything else."""
    if not isinstance(value, Mapping | None):
        raise wrong_argument(argument, "bytes by path", type(value).__name__)
    for name, content in (value or {}).items():
        if not isinstance(name, str) or not isinstance(content, bytes):
            got = f"{type(content).__name__}` by `{type(name).__name__}"
            raise wrong_argument(argument, "bytes by path", got)
    return dict(value or {})


def wrong_argument(argument: str, what: str, got: object) -> MjcfError:
    """Return the error that `argument` expects `what` but got something else."""
    return failure("wrong-type", f"`{argument}` expects {what}, got `{got}`")


Skins = list[tuple[ModelState, dict[str, bytes | Path]]]
"""Models, and their new skin files, by written path."""


def renamed_skins(model: ModelState, rename: Callable[[str], str | None]) -> dict[str, bytes | Path]:
    """Return the new content of the skin files in which body names change, by their written paths.

    `rename` returns the new name of a body, or None if the name stays the same. Raises `MjcfError` for a name that
    does not fit into a skin file.
    """
    found: dict[str, bytes | Path] = {}
    for skin in skins(model.unit.root):
        try:
            content = renamed_skin(model.unit.source_of(skin.path), rename)
        except BadBone as fault:
            raise failure("bad-name", f"{fault}, `{skin.written}`") from None
        if content is not None:
            found[skin.path] = content
    return found


def skins_after_renaming(model: ModelState, old: str, new: str, *, is_prefix: bool = False) -> Skins:
    """Return the new skin files of a model and those above it after a body or the prefix of a child changes."""
    changed: Skins = []
    for here, way in model.levels():

        def rename(name: str, own: Container[str] = here.names.declared.get("body", {}), way: str = way) -> str | None:
            if name == way + old or (is_prefix and name.startswith(way + old) and name not in own):
                return way + new + name[len(way + old) :]
            return None

        skins = renamed_skins(here, rename)
        if skins:
            changed.append((here, skins))
    return changed


def add_files(model: ModelState, files: Mapping[str, bytes | Path]) -> None:
    """Add files to a model's files that are not at their written paths."""
    known = model.unit.contents
    model.unit.contents = (known if isinstance(known, ModelFiles) else ModelFiles(known)).with_files(files)


class Owner(Protocol):
    """The interface of an element that its arrays use."""

    def get(self, attribute: str) -> Any: ...
    def set_attributes(self, **attributes: object) -> None: ...
    def _described(self) -> str: ...


class LiveArray(np.ndarray[Any, Any]):
    """The value of an attribute with several numbers.

    Assigned items, and `+=` and the like, are set on the element and checked like any value. An error is an
    `MjcfError` and changes nothing. Results computed from it, and its copies, are plain arrays. It has the numbers
    of the time it was read; slices of it (`pos[:2]`) are read-only.
    """

    _owner: tuple[Owner, str] | None

    @classmethod
    def of(cls, array: NDArray[Any], element: Owner, attribute: str) -> LiveArray:
        """Return a live array for an element's attribute that shares the memory of `array`."""
        live = array.view(cls)
        live._owner = element, attribute
        live.flags.writeable = False
        return live

    def __array_finalize__(self, source: object) -> None:
        self._owner = None

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        return array.view(np.ndarray) if array.ndim else array[()]

    def __setitem__(self, key: Any, value: Any) -> None:
        if self._owner is None:
            if not self.flags.writeable:
                message = "a part of an attribute's array cannot be written to by itself"
                help = "write to the whole array, `element.pos[:2] = …`, or to a `copy()`"
                raise failure("wrong-type", message, help=help)
            super().__setitem__(key, value)
            return
        element, attribute = self._owner
        now = element.get(attribute)
        changed = np.array(self if np.shape(now) != self.shape else now, dtype=np.float64)
        try:
            changed[key] = value
        except (TypeError, ValueError) as fault:
            raise self._refused(fault) from None
        element.set_attributes(**{attribute: changed})
        self.flags.writeable = True
        super().__setitem__(..., changed)
        self.flags.writeable = False

    def _refused(self, fault: Exception) -> Exception:
        element, attribute = self._owner or (None, "")
        what = "an array" if element is None else f"`{attribute}` of {element._described()}"
        return failure("wrong-type", f"{what} cannot take this: {fault}")

    def __repr__(self) -> str:
        return repr(self.view(np.ndarray))

    def __str__(self) -> str:
        return str(self.view(np.ndarray))

    def copy(self, order: Any = "C") -> Any:
        """Return a plain, writable array. Changes to it do not reach the element."""
        return np.array(self, order=order)

    def __copy__(self) -> Any:
        return np.array(self)

    def __deepcopy__(self, memo: dict[int, Any] | None, /) -> Any:
        return np.array(self)

    def __reduce__(self) -> Any:
        return np.array(self).__reduce__()


def _in_place(name: str) -> Callable[[LiveArray, Any], LiveArray]:
    compute = getattr(operator, name)

    def method(array: LiveArray, other: Any) -> LiveArray:
        try:
            changed = compute(array.view(np.ndarray), other)
        except (TypeError, ValueError) as fault:
            raise array._refused(fault) from None
        array[...] = changed
        return array

    return method


for _name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow"):
    setattr(LiveArray, f"__i{_name}__", _in_place(_name))


class Asset:
    """A file that a model needs.

    `path` is where it was read from, None for bytes in memory. `prefix` is the stem of its file name, and `extension`
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
            raise failure("wrong-type", "an `Asset` takes either `contents` or a `path`")
        self._data = contents
        self._model: ModelState | None = None
        if path is not None:
            self.path: Path | None = as_path("path", path)
            self.extension = self.path.suffix
            self.prefix = stem(self.path.name)
            return
        if not isinstance(contents, bytes):
            raise wrong_argument("contents", "bytes", type(contents).__name__)
        if not (isinstance(extension, str) and re.fullmatch(r"\.[^/\\]+", extension)):
            raise wrong_argument("extension", "a suffix such as `.stl`", extension)
        if not (isinstance(prefix, str) and re.fullmatch(r"[^/\\]+", prefix)):
            raise wrong_argument("prefix", "the name of a file without folders", prefix)
        self.path = None
        self.extension = extension
        self.prefix = prefix

    @property
    def contents(self) -> bytes:
        """The bytes of the file. Raises `MjcfError` if the file can no longer be read."""
        source = self.source
        if isinstance(source, bytes):
            return source
        try:
            return read_regular(source)
        except OSError as error:
            message = f"the file `{source}` cannot be read: {error.strerror or str(error)}"
            archive = in_archive(source)
            if archive is not None:
                message = "`{}` has no file `{}`".format(*archive)
            raise failure("asset-missing", message) from None

    @property
    def bundle_path(self) -> str | None:
        """The path that `export_with_assets` writes the file to, such as `assets/arm/shell.stl`.

        The exported model refers to the file by this path. To determine it, the whole composition is linked. It is
        None for an `Asset` that was not read from an element, and for one whose element is not written. Raises
        `MjcfError` as exporting does.

        >>> from mjcompose import mjcf
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


class ModelFiles(Mapping[str, bytes | Path]):
    """The files of a model that are not at their written paths: their bytes or their actual paths, by written path.

    A file that the caller gives without a folder is found under its name in any folder.
    """

    def __init__(self, given: Mapping[str, bytes | Path] | None = None) -> None:
        self._exact = {join("", name): content for name, content in (given or {}).items()}
        self._anywhere = {name: content for name, content in self._exact.items() if "/" not in name}

    def with_files(self, files: Mapping[str, bytes | Path]) -> ModelFiles:
        """Return these files and `files`; each of `files` is found only by its exact path."""
        more = ModelFiles()
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


def asset_of(model: ModelState, tag: str, name: str) -> Asset:
    """Return the file that an element with this tag refers to by `name`."""
    unit = model.unit
    written = _written(model, tag, name)
    known = unit.contents.get(written)
    if isinstance(known, bytes):
        asset = Asset(known, posixpath.splitext(written)[1] or ".bin", stem(written))
    else:
        try:
            asset = Asset(path=known or unit.door.admit(join(str(unit.directory), written)))
        except Refused as refused:
            raise failure(CODE, refused.message(), help=refused.help) from None
    asset._model = model
    return asset


def place_asset(model: ModelState, tag: str, asset: Asset, contents: dict[str, bytes | Path]) -> str:
    """Return a file name in the model for an asset, and add the file to `contents`. Equal assets share one name."""
    number = 1
    while True:
        name = f"{asset.prefix}{'' if number == 1 else f'-{number}'}{asset.extension}"
        written = _written(model, tag, name)
        known = contents.get(written, model.unit.contents.get(written))
        there = Path(join(str(model.unit.directory), written))
        if known is None and not os.path.exists(there):
            known = contents[written] = asset.source
        if asset.source == (there if known is None else known):
            return name
        number += 1


def _written(model: ModelState, tag: str, name: str) -> str:
    if tag == "model":  # MuJoCo looks for it next to the main file
        return join("", name)
    return written_path(read_settings(model.unit.root), etree.Element(tag), name)
