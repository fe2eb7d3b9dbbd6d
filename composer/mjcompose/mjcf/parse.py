"""Models are read from text, files and `MjSpec`, and written to folders and zip files."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, cast

from mjcompose.base.access import Door
from mjcompose.base.diagnostic import call_site, warn
from mjcompose.base.report import short_traceback
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import MODEL, Bundle, BundleError, OutputError, check_paths
from mjcompose.bundle.read import ReadError, read
from mjcompose.bundle.staging import check_is_no_source, move, resolved_output, staged_folder
from mjcompose.bundle.write import write_archive
from mjcompose.link.collect import collect
from mjcompose.link.linking import Policy
from mjcompose.mjcf.asset import Folders, ModelFiles, as_files, as_path, door_of
from mjcompose.mjcf.attributed import view
from mjcompose.mjcf.compile import compile_error, engine
from mjcompose.mjcf.element import Element, RootElement
from mjcompose.mjcf.errors import MjcfWarning, failure, raise_errors
from mjcompose.mjcf.flat import flatten, issue_warnings
from mjcompose.mjcf.model import UNNAMED, ModelState
from mjcompose.mjcf.mounting import check_tree, one_of_each_section
from mjcompose.mjcf.node_view import escape_separators as escape_separators_of
from mjcompose.mujoco.attributes import KINDS
from mjcompose.mujoco.references import arrays
from mjcompose.tree.parse import all_admitted, parse_file, parse_text
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write

_TEXT = "<xml_string>"


@short_traceback
def from_path(
    path: str | os.PathLike[str], *, escape_separators: bool = False, confine_to: Folders | None = None
) -> RootElement:
    r"""Read a model from an MJCF file.

    As in MuJoCo, file names are relative to the model's folder and the folders that its `<compiler>` sets, and
    `<include>` is followed. A name may contain a `/`. With `escape_separators`, each `/` in a name becomes a `\`, so a
    `/` always separates the prefix of an attached model.

    The model may read the files that MuJoCo would read for you. With `confine_to`, a list of folders, it may read files
    in these and no others: this is for models of people whom you do not know. It is checked when a file is read. Meshes
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


@short_traceback
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
        raise failure("wrong-type", f"`xml_string` expects text, got `{type(xml_string).__name__}`")
    files = ModelFiles(as_files("assets", assets))
    directory = as_path("base_dir", base_dir) if base_dir is not None else Path()
    door = door_of(confine_to)
    return _model(
        lambda sink: parse_text(
            xml_string, sink, file=_TEXT, directory=directory, label=UNNAMED, contents=files, door=door
        ),
        escape_separators,
    )


@short_traceback
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
        message = f"`file_object` expects an open file, got `{type(file_object).__name__}`"
        raise failure("wrong-type", message, help="`from_path` takes the path of a file, `from_xml_string` text")
    try:
        data = file_object.read()
    except (OSError, ValueError) as error:  # closed, or not open for reading
        raise failure("file-unreadable", f"`file_object` cannot be read: {error}") from None
    name = getattr(file_object, "name", None)
    if not isinstance(name, str):
        return from_xml_string(data, escape_separators=escape_separators, confine_to=confine_to)
    path = Path(name)
    door = door_of(confine_to)
    return _model(
        lambda sink: parse_text(data, sink, file=name, directory=path.parent, label=path.stem, door=door),
        escape_separators,
    )


@short_traceback
def from_zip(path: str | os.PathLike[str], *, escape_separators: bool = False) -> RootElement:
    """Read a model from a zip: a bundle of mjcompose, an MJZ, or a zip with one model that no other model in it names.

    Nothing is unpacked to disk, and files are read only from the zip. `escape_separators` is described in `from_path`.
    Raises `MjcfError` as `from_path` does, and for a zip with paths outside the zip or with contents above the size
    limit.

    >>> import tempfile
    >>> from mjcompose import mjcf
    >>> file = Path(tempfile.mkdtemp()) / 'arm.zip'
    >>> mjcf.export_with_assets_as_zip(mjcf.RootElement('arm'), file)
    >>> from_zip(file).model
    'arm'
    """
    archive = as_path("path", path)
    if os.path.isdir(archive):
        raise failure("file-unreadable", f"`{archive}` is a folder, not a zip")
    try:
        bundle = read(archive)
    except ReadError as error:
        raise failure(error.code, error.message) from None
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
            contents=ModelFiles(files),
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
    model = ModelState(unit)
    if escape:
        escape_separators_of(model)
    return cast(RootElement, view(model, model.unit.root))


@short_traceback
def export_with_assets(
    model: RootElement,
    out_dir: str | os.PathLike[str],
    model_filename: str = "model.xml",
    *,
    conflict: Policy = "error",
) -> None:
    """Write the model as `model_filename`, and its files below `assets/`, into the folder `out_dir`.

    The files of each model are in a folder named after the model. Files with equal bytes are stored once, and the same
    model always gives the same bytes. Other files in `out_dir` stay. Everything is first written to a temporary place
    and moved to `out_dir` when it is complete, the model last.

    `conflict` is described in `RootElement.to_xml_string`. Raises `MjcfError` for faults of the model, for files that
    are missing or cannot be written, and if a file would replace one that the model was read from.

    >>> import tempfile
    >>> from mjcompose import mjcf
    >>> out = Path(tempfile.mkdtemp())
    >>> mjcf.export_with_assets(mjcf.RootElement('arm'), out)
    >>> print((out / 'model.xml').read_text())
    <mujoco model="arm"/>
    <BLANKLINE>
    """
    out = as_path("out_dir", out_dir)
    files, sources = _files(model, model_filename, conflict)
    with _output_failures(), staged_folder(out, into=True) as stage:
        stage.mkdir()
        for path, content in files.items():
            file = stage / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        # The model last: until then an older model still finds all of its files.
        move(stage, resolved_output(out), sorted(files, key=lambda path: "/" not in path), inputs=sources)


@short_traceback
def export_with_assets_as_zip(
    model: RootElement,
    zip_path: str | os.PathLike[str],
    model_filename: str = "model.xml",
    *,
    conflict: Policy = "error",
) -> None:
    """Write the model and its files into a zip file, which MuJoCo can open directly (`MjSpec.from_zip`, MJZ).

    The bytes do not depend on the time, the path or the operating system. MuJoCo looks in the zip for `model.xml` or
    for the stem of the zip's name with `.xml`, so `model_filename` should be one of these. An existing zip is replaced
    in one step; if writing fails, it stays. Raises `MjcfError` as `export_with_assets` does.

    >>> import tempfile
    >>> from mjcompose import mjcf
    >>> file = Path(tempfile.mkdtemp()) / 'arm.zip'
    >>> mjcf.export_with_assets_as_zip(mjcf.RootElement('arm'), file)
    >>> mjcf.from_zip(file).model
    'arm'
    """
    out = as_path("zip_path", zip_path)
    files, sources = _files(model, model_filename, conflict)
    with _output_failures():
        if not os.path.isdir(out):  # the writer reports a folder itself
            check_is_no_source(out, inputs=sources)
        write_archive(Bundle(files, model_filename), out, os.environ)


def _files(model: RootElement, model_filename: str, conflict: Policy) -> tuple[dict[str, bytes], list[str]]:
    """Return the bytes of all files to write, by path, and the files that the model was read from."""
    given: object = model
    if not isinstance(given, RootElement):
        got = "an element; its `root` is the model" if isinstance(given, Element) else f"`{type(given).__name__}`"
        raise failure("wrong-type", f"a model is a `RootElement`, got {got}")
    is_xml = isinstance(model_filename, str) and model_filename.endswith(".xml")
    if not is_xml or Path(model_filename).name != model_filename:
        message = f"`model_filename` expects the name of an XML file, got `{model_filename}`"
        raise failure("output-kind", message, help="a name without folders that ends in `.xml`")
    flat = flatten(model._model, conflict)
    sink = Sink()
    files = collect(flat.unit, flat.files, sink)
    raise_errors(sink)
    files[model_filename] = write(flat.unit.root)
    try:
        check_paths(files)
    except BundleError as error:
        raise failure("file-unreadable", f"a file of the model cannot be exported: {error}") from None
    issue_warnings(flat.warnings)
    return files, [*flat.unit.origins.texts, *(use.source for use in flat.files)]


@contextmanager
def _output_failures() -> Iterator[None]:
    try:
        yield
    except OutputError as error:
        raise failure(error.code, error.message, help=error.help) from error


@short_traceback
def from_spec(spec: Any) -> RootElement:
    """Return the model of a `mujoco.MjSpec`, from the XML that MuJoCo writes for it and the files in its `assets`.

    MuJoCo compiles a copy of the spec first. Raises `MjcfError` if it cannot. The origins of elements are lines of the
    XML. Numbers are exactly the spec's numbers. MuJoCo before 3.16 writes only six digits of each, and so does a later
    version if models with different compiler settings are attached to each other. An `MjcfWarning` is issued in these
    cases, and also if the spec has a NaN, which MuJoCo does not write.

    >>> import mujoco
    >>> spec = mujoco.MjSpec()
    >>> _ = spec.worldbody.add_body(name='arm')
    >>> from_spec(spec).find('body', 'arm')
    <body name="arm"/>
    """
    mujoco = engine()
    if not isinstance(spec, mujoco.MjSpec):
        raise failure("wrong-type", f"`spec` expects an `MjSpec`, got `{type(spec).__name__}`")
    try:
        copied = spec.copy()
        compiled = copied.compile()
        text = _text(copied)
    except (ValueError, mujoco.FatalError) as error:
        raise compile_error(error) from None
    folder = getattr(spec, "modelfiledir", "")
    assets = dict(spec.assets)
    for name, data in spec.assets.items():  # MuJoCo goes by the last part of a path alone
        assets.setdefault(posixpath.basename(name), data)
    # To MuJoCo 4.0, NaN means not set, so it does not write it.
    floats = (each for kind in KINDS for each in arrays(compiled, kind) if each[1].dtype.kind == "f")
    lost = sorted(name for name, array, _ in floats if bool((array != array).any()))
    if lost:
        message = "MuJoCo does not write NaN, so these attributes of the spec have their defaults: "
        warn(message + ", ".join(lost), MjcfWarning)
    return from_xml_string(text, assets=assets, base_dir=Path(folder) if folder else None)


def _text(compiled: Any) -> str:
    """Return the XML that MuJoCo writes for a spec: with all digits if possible, else compiled, with six digits."""
    compiler = compiled.compiler
    why = "this MuJoCo cannot write more: 3.16 can"
    if hasattr(compiler, "savecompiled"):
        compiler.savecompiled = False
        compiler.savecanonical = True
        try:
            return str(compiled.to_xml())
        except (ValueError, engine().FatalError) as error:
            compiler.savecompiled = True
            why = " ".join(str(error).split())
    warn(f"MuJoCo writes the numbers of this spec in six digits only: {why}", MjcfWarning)
    return str(compiled.to_xml())
