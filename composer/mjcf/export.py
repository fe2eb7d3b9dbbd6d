"""Write a model and every file it refers to into a folder or a zip file."""

from __future__ import annotations

import os
from pathlib import Path

from composer.bundle.archive import write_archive
from composer.bundle.bundle import Bundle, BundleError, check_paths
from composer.bundle.collect import collect
from composer.bundle.output_error import OutputError
from composer.bundle.staging import move, real, staged_folder
from composer.diagnostics.call_site import call_site
from composer.diagnostics.sink import Sink
from composer.link.request import Policy
from composer.mjcf.arguments import as_path
from composer.mjcf.element import Element, RootElement
from composer.mjcf.errors import MjcfError, failure, raise_errors
from composer.mjcf.flat import flatten, issue_warnings
from composer.tree.write import write


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

    `conflict` is described in `RootElement.to_xml_string`. Raises `MjcfError` for faults of the model, and for files
    that are missing or cannot be written.

    >>> import tempfile
    >>> from composer import mjcf
    >>> out = Path(tempfile.mkdtemp())
    >>> mjcf.export_with_assets(mjcf.RootElement('arm'), out)
    >>> print((out / 'model.xml').read_text())
    <mujoco model="arm"/>
    <BLANKLINE>
    """
    out = as_path("out_dir", out_dir)
    files = _files(model, model_filename, conflict)
    try:
        with staged_folder(out, into=True) as stage:
            stage.mkdir()
            _write(files, stage)
            # The model last: until then an older model still finds all of its files.
            move(stage, real(out), sorted(files, key=lambda path: "/" not in path))
    except OutputError as error:
        raise _output_failure(error) from error


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
    >>> from composer import mjcf
    >>> file = Path(tempfile.mkdtemp()) / 'arm.zip'
    >>> mjcf.export_with_assets_as_zip(mjcf.RootElement('arm'), file)
    >>> mjcf.from_zip(file).model
    'arm'
    """
    out = as_path("zip_path", zip_path)
    files = _files(model, model_filename, conflict)
    try:
        write_archive(Bundle(files, model_filename), out, os.environ)
    except OutputError as error:
        raise _output_failure(error) from error


def _files(model: RootElement, model_filename: str, conflict: Policy) -> dict[str, bytes]:
    """Return the bytes of all files to write, by path."""
    _check_is_model(model)
    if (
        not isinstance(model_filename, str)
        or not model_filename.endswith(".xml")
        or Path(model_filename).name != model_filename
    ):
        raise failure(
            "output-kind",
            f"`model_filename` expects the name of an XML file, got `{model_filename}`",
            call_site(),
            help="a name without folders that ends in `.xml`",
        )
    flat = flatten(model._model, conflict)
    sink = Sink()
    files = collect(flat.unit, flat.files, sink)
    raise_errors(sink)
    files[model_filename] = write(flat.unit.root)
    try:
        check_paths(files)
    except BundleError as error:
        raise failure(
            "file-unreadable", f"a file of the model cannot be exported: {error}", call_site()
        ) from None
    issue_warnings(flat)
    return files


def _check_is_model(model: object) -> None:
    if isinstance(model, RootElement):
        return
    what = f"`{type(model).__name__}`"
    if isinstance(model, Element):
        what = "an element; its `root` is the model"
    raise failure("wrong-type", f"a model is a `RootElement`, got {what}", call_site())


def _write(files: dict[str, bytes], stage: Path) -> None:
    for path, content in files.items():
        file = stage / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)


def _output_failure(error: OutputError) -> MjcfError:
    return failure(error.code, error.message, call_site(), help=error.help)
