"""Read models from MJCF text and files."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, cast

from composer.bundle.bundle import MODEL
from composer.bundle.read import ReadError, read
from composer.diagnostics.call_site import call_site
from composer.diagnostics.sink import Sink
from composer.mjcf.arguments import Folders, as_files, as_path, door_of
from composer.mjcf.asset import Files
from composer.mjcf.element import RootElement
from composer.mjcf.errors import failure, raise_errors
from composer.mjcf.intake import check_tree, one_of_each_section
from composer.mjcf.model import UNNAMED, Model
from composer.mjcf.separators import escape_separators as escape_separators_of
from composer.mjcf.views import view
from composer.reading.door import Door
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file, parse_text
from composer.tree.unit import Unit

_TEXT = "<xml_string>"


def from_path(
    path: str | os.PathLike[str], *, escape_separators: bool = False, confine_to: Folders | None = None
) -> RootElement:
    r"""Read a model from an MJCF file.

    As in MuJoCo, file names are relative to the model's folder and the folders that its `<compiler>` sets, and
    `<include>` is followed. A name may contain a `/`. With `escape_separators`, each `/` in a name becomes a `\`, so
    that a `/` always separates the prefix of an attached model.

    The model may read what MuJoCo would read for you. With `confine_to`, a list of folders, it may read files in
    these and no others: this is for models of people whom you do not know. It is checked when a file is read. Meshes
    and textures are not read yet.

    Raises `MjcfError`, with the file and line of each fault, for a file that cannot be read, is not well-formed or is
    not MJCF, for elements and attributes that MJCF does not have, and for names that repeat.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / 'ball.xml'
    >>> _ = file.write_text('<mujoco><worldbody><geom name="ball" size="1"/></worldbody></mujoco>')
    >>> from_path(file).find('geom', 'ball')
    <geom name="ball" size="1"/>
    """
    file = as_path("path", path)
    door = door_of(confine_to)
    return _model(lambda sink: parse_file(file, sink, door=door), escape_separators)


def from_xml_string(
    xml_string: str | bytes,
    *,
    assets: Mapping[str, bytes] | None = None,
    base_dir: str | os.PathLike[str] | None = None,
    escape_separators: bool = False,
    confine_to: Folders | None = None,
) -> RootElement:
    """Read a model from MJCF text.

    `assets` has the bytes of files by their path in the model (including the folder that the compiler sets) or by
    their file name alone; it may contain included files. Files that are not in it are read from `base_dir`, by default
    the working directory. `escape_separators` and `confine_to` are described in `from_path`. Raises `MjcfError` as
    `from_path` does.

    >>> model = from_xml_string('<mujoco><asset><mesh file="cube.stl"/></asset></mujoco>', assets={'cube.stl': b'...'})
    >>> model.find('mesh', 'cube').file.contents
    b'...'
    """
    if not isinstance(xml_string, str | bytes):
        raise failure(
            "wrong-type", f"`xml_string` expects text, got `{type(xml_string).__name__}`", call_site()
        )
    files = Files(as_files("assets", assets))
    directory = as_path("base_dir", base_dir) if base_dir is not None else Path()
    door = door_of(confine_to)
    return _model(
        lambda sink: parse_text(
            xml_string, sink, file=_TEXT, directory=directory, label=UNNAMED, contents=files, door=door
        ),
        escape_separators,
    )


def from_file(
    file_object: IO[str] | IO[bytes], *, escape_separators: bool = False, confine_to: Folders | None = None
) -> RootElement:
    """Read a model from an open file, in text or binary mode.

    If `file_object.name` is a path, file names in the model are relative to its folder, else to the working directory.
    `escape_separators` and `confine_to` are described in `from_path`. Raises `MjcfError` as `from_path` does.

    >>> import io
    >>> from_file(io.StringIO('<mujoco model="arm"/>')).model
    'arm'
    """
    if not callable(getattr(file_object, "read", None)):
        raise failure(
            "wrong-type",
            f"`file_object` expects an open file, got `{type(file_object).__name__}`",
            call_site(),
            help="`from_path` takes the path of a file, `from_xml_string` text",
        )
    try:
        data = file_object.read()
    except (OSError, ValueError) as error:  # closed, or not open for reading
        raise failure("file-unreadable", f"`file_object` cannot be read: {error}", call_site()) from None
    name = getattr(file_object, "name", None)
    if not isinstance(name, str):
        return from_xml_string(data, escape_separators=escape_separators, confine_to=confine_to)
    path = Path(name)
    door = door_of(confine_to)
    return _model(
        lambda sink: parse_text(data, sink, file=name, directory=path.parent, label=path.stem, door=door),
        escape_separators,
    )


def from_zip(path: str | os.PathLike[str], *, escape_separators: bool = False) -> RootElement:
    """Read a model from a zip: a bundle of mjcompose, an MJZ, or a zip with one model that no other model in it names.

    Nothing is unpacked to disk, and files are read only from the zip. `escape_separators` is described in `from_path`.
    Raises `MjcfError` as `from_path` does, and for a zip with paths outside the zip or with contents above the size
    limit.

    >>> import tempfile
    >>> from composer import mjcf
    >>> file = Path(tempfile.mkdtemp()) / 'arm.zip'
    >>> mjcf.export_with_assets_as_zip(mjcf.RootElement('arm'), file)
    >>> from_zip(file).model
    'arm'
    """
    archive = as_path("path", path)
    if os.path.isdir(archive):
        raise failure("file-unreadable", f"`{archive}` is a folder, not a zip", call_site())
    try:
        bundle = read(archive)
    except ReadError as error:
        raise failure(error.code, error.message, call_site()) from None
    folder, name = posixpath.split(bundle.model)
    files = {posixpath.relpath(each, folder or "."): content for each, content in bundle.files.items()}
    label = archive.stem if name == MODEL else posixpath.splitext(name)[0]

    def parse(sink: Sink) -> Unit | None:
        unit = parse_text(
            bundle.files[bundle.model],
            sink,
            file=f"{archive}/{bundle.model}",
            directory=archive / folder,
            label=label,
            contents=Files(files),
            door=Door.of((archive,), f"the zip `{archive}`, which may read only itself"),
        )
        if unit is not None:
            all_admitted(unit, sink)
        return unit

    return _model(parse, escape_separators)


def _model(parse: Callable[[Sink], Unit | None], escape: bool) -> RootElement:
    sink = Sink()
    unit = parse(sink)
    raise_errors(sink, call_site)
    assert unit is not None
    raise_errors(sink)
    check_tree(unit, sink)
    raise_errors(sink)
    one_of_each_section(unit)
    model = Model(unit)
    if escape:
        escape_separators_of(model)
    return cast(RootElement, view(model, model.unit.root))
