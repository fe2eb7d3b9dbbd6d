"""Convert URDF to MJCF, and MJCF to USD, in the child process."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from mjcompose.base.access import Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.scratch import scratch
from mjcompose.mujoco.attributes import save_digits
from mjcompose.mujoco.engine import Session, call, without_folder

PACKAGE = "package://"


class Converted(Struct):
    """The MJCF text of a URDF file, or the reason that there is none.

    `meshes` are the files that MuJoCo opens, under its paths: below the URDF's folder and `folder` (its `meshdir`)
    unless absolute, or still `package://…` if the package is unknown. Empty if the file could not be read.
    `warnings` are only about reading; warnings about the model are repeated when it is compiled. `error` and `crash`
    are as in `Compiled`.

    In `text` each link is a body, with a `<frame>` of its name in it. A link that MuJoCo fused with its parent is a
    frame around that frame (from MuJoCo 4.0 on; older versions remove it).
    """

    text: str | None
    meshes: tuple[str, ...] = ()
    folder: str = ""
    warnings: tuple[str, ...] = ()
    error: str | None = None
    crash: str | None = None


def convert_urdf(
    path: Path,
    packages: Mapping[str, Path],
    *,
    door: Door,
    is_fixed: bool = True,
    text: str | None = None,
    made: Mapping[str, Path] | None = None,
    massless: Sequence[str] = (),
    shells: Collection[str] = (),
    session: Session,
) -> Converted:
    """Convert a file. `packages` has the folders for `package://NAME`, and `door` limits the files that it may read.

    `text`, if given, replaces the file's own content. `made` has the generated meshes by their names in the text, which
    are also their names in the converted text. The shapes of the `massless` links weigh nothing. For `shells`, meshes
    by their names in the text, MuJoCo uses the surface if it needs a volume.

    `is_fixed` decides about the root link: if the robot is fixed in the world, MuJoCo fuses the link with the world,
    which has no inertia; a robot that moves or is attached to something keeps it as a body.

    Needs all meshes, because MuJoCo saves only models that compile. Raises Refused for a mesh that the door does not
    admit, before MuJoCo opens any mesh, but not for other faults of the file.
    """
    argument = {
        "path": str(path.absolute()),
        "is_fixed": is_fixed,
        "text": text,
        "massless": list(massless),
        "packages": {name: folder.absolute().as_posix() for name, folder in packages.items()},
        "shells": sorted(shells),
        "made": {name: file.absolute().as_posix() for name, file in (made or {}).items()},
    }
    read = call(session, read_meshes, (), argument=argument)
    found: dict[str, Any] = read.value if read.ok else {"meshes": [], "folder": ""}
    for file in found["meshes"]:  # Refused has the path that MuJoCo uses
        if not file.startswith(PACKAGE) and file not in found["made"]:
            name = file.replace("\\", "/").rpartition("/")[2] if found["strippath"] else file
            door.admit(os.path.join(path.parent.absolute(), found["folder"], name))
    converted = call(session, convert, (), argument=argument) if read.ok and not found["error"] else read
    error = converted.value["error"] if converted.ok else converted.error
    return Converted(
        converted.value.get("text") if converted.ok else None,
        tuple(found["meshes"]),
        found["folder"],
        warnings=tuple(without_folder(text, path.parent) for text in read.warnings),
        error=error and without_folder(error, path.parent),
        crash=converted.crash,
    )


def read_meshes(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """Return the meshes that MuJoCo would read, without compiling anything. Runs in the child."""
    try:
        spec = _read(mujoco, argument)
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        return {"error": str(error).strip() or type(error).__name__, "meshes": [], "folder": ""}
    return {
        "error": None,
        "meshes": [mesh.file for mesh in spec.meshes],
        "folder": spec.meshdir,
        "strippath": bool(spec.strippath),
        "made": list(argument["made"].values()),
    }


def convert(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """Return the text, or the reason that there is none. Runs in the child."""
    try:
        text = _saved(mujoco, _read(mujoco, argument), argument["is_fixed"])
        for name, file in argument["made"].items():
            text = text.replace(f'"{escape(file)}"', f'"{escape(name)}"')
        return {"error": None, "text": text}
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        return {"error": str(error).strip() or type(error).__name__}


def _read(mujoco: Any, argument: dict[str, Any]) -> Any:
    path = Path(argument["path"])
    text = argument["text"]
    made = argument["made"]
    if path.suffix == ".urdf" and text is None:
        spec = mujoco.MjSpec.from_file(argument["path"])
    else:  # MuJoCo only recognizes that suffix
        spec = mujoco.MjSpec.from_string(path.read_text(encoding="utf-8") if text is None else text)
        spec.modelfiledir = str(path.parent)
    if made and spec.strippath:  # which would take the folders of the made ones off as well
        for mesh in spec.meshes:
            mesh.file = mesh.file if mesh.file in made else mesh.file.replace("\\", "/").rpartition("/")[2]
        spec.strippath = False
    for mesh in spec.meshes:
        if mesh.file in argument["shells"]:
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        name, _, inside = mesh.file.removeprefix(PACKAGE).partition("/")
        is_known = mesh.file.startswith(PACKAGE) and name in argument["packages"]
        file = f"{argument['packages'][name]}/{inside}" if is_known else mesh.file
        mesh.file = made.get(mesh.file) or file
    for name in argument["massless"]:
        for geom in spec.body(name).geoms:
            geom.density = 0
    return spec


def _saved(mujoco: Any, spec: Any, is_fixed: bool) -> str:
    """Return the text of a spec.

    Global operations of the compiler are applied here, while it is still a model of its own: in a composition they
    would affect the other parts. Numbers are saved as they were read.
    """
    compiler = spec.compiler
    compiler.saveinertial = False
    if not (hasattr(compiler, "savecompiled") and hasattr(spec, "fuse_static")):
        return _saved_as_compiled(mujoco, spec, is_fixed)
    for body in spec.bodies[1:]:
        body.add_frame(name=body.name)  # moves along with the body, whatever happens to it
    if not is_fixed:
        for root in spec.worldbody.bodies:
            root.fuse = 0
    if compiler.discardvisual:
        spec.discard_visual()
    if compiler.fusestatic:
        spec.fuse_static()
    compiler.discardvisual = compiler.fusestatic = False
    compiler.savecompiled = compiler.savecanonical = False
    return str(spec.to_xml())


def _saved_as_compiled(mujoco: Any, spec: Any, is_fixed: bool) -> str:
    """Return the text of a spec from an older MuJoCo, which saves compiled values: correct up to rounding.

    Inertia is written explicitly, because values inferred before links were fused cannot be inferred afterwards.
    """
    save_digits(mujoco)
    spec.compiler.saveinertial = True
    if not is_fixed:
        spec.compiler.fusestatic = False  # the only way to keep the root
    text = re.sub(r' inertiafromgeom="\w+"', "", spec.to_xml())
    if spec.compiler.settotalmass > 0:  # the saved text does not include it
        text = text.replace("<compiler ", f'<compiler settotalmass="{spec.compiler.settotalmass!r}" ', 1)
    return text


_WARNING = re.compile(r"^Warning: in \S+ at line \d+ of .*? -- (.*)$", re.MULTILINE)
_OWN_AFFAIRS = re.compile(r"deprecated")


class Exported(Struct):
    """The result of an export: `missing` is set if the converter cannot be imported, `error` if it failed.

    `textures` are images next to a layer, which a package would contain, and `warnings` are the converter's messages.
    """

    missing: str | None = None
    error: str | None = None
    textures: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def export_usd(model: Path, out: Path, session: Session) -> Exported:
    """Write `out`, whose suffix selects text (`.usda`), binary, or a package with textures (`.usdz`).

    A layer with textures is not written. Never raises for contents of the model.
    """
    answer = call(session, export, (), argument={"model": str(model.absolute()), "out": str(out.absolute())})
    if not answer.ok or "missing" in answer.value:
        return Exported(answer.value and answer.value["missing"], answer.error)
    return Exported(textures=tuple(answer.value["textures"]), warnings=tuple(answer.value["warnings"]))


def export(mujoco: Any, argument: dict[str, str]) -> dict[str, Any]:
    """Convert the model. Runs in the child."""
    try:
        converter = import_module("mujoco_usd_converter")
        sdf = import_module("pxr.Sdf")
        packing = import_module("pxr.UsdUtils")
    except ImportError as error:
        return {"missing": str(error)}
    out = Path(argument["out"])
    with scratch("usd") as folder, _standard_error() as log:
        layer = converter.Converter(layer_structure=False).convert(argument["model"], str(folder)).path
        settled = _settled(sdf.Layer.FindOrOpen(layer), sdf)
        textures = sorted(path.name for path in Path(folder).glob("*/*"))
        suffix = out.suffix.lower()
        if suffix == ".usdz":
            beside = Path(layer).with_name("settled.usdc")  # in the folder from which it finds its textures
            settled.Export(str(beside))
            if not packing.CreateNewUsdzPackage(str(beside), str(out), Path(layer).name):
                raise OSError(f"USD could not pack {out.name}")
        elif not textures:
            settled.Export(str(out))
        warnings = [text for text in _WARNING.findall(log()) if not _OWN_AFFAIRS.search(text)]
    return {"textures": textures if suffix != ".usdz" else [], "warnings": list(dict.fromkeys(warnings))}


_SHARED = "Flattened_Prototype_"


def _settled(layer: Any, sdf: Any) -> Any:
    """Return the layer without its path and the numbers of shared prims, which differ between runs."""
    numbered: dict[Any, Any] = {}
    waiting = [each for each in layer.rootPrims if not each.name.startswith(_SHARED)][::-1]
    while waiting:
        prim = waiting.pop()
        for each in _shared(prim):
            if each.primPath not in numbered:
                numbered[each.primPath] = sdf.Path(f"/{_SHARED}{len(numbered) + 1}")
                waiting.insert(0, layer.GetPrimAtPath(each.primPath))
        waiting += list(prim.nameChildren)[::-1]
    settled = sdf.Layer.CreateAnonymous(".usda")
    settled.TransferContent(layer)
    settled.documentation = ""
    for each in list(settled.rootPrims):
        if each.path in numbered:
            del settled.rootPrims[each.name]
    for each, name in numbered.items():
        sdf.CopySpec(layer, each, settled, name)
    waiting = list(settled.rootPrims)
    while waiting:
        prim = waiting.pop()
        for each in _shared(prim):
            prim.referenceList.ReplaceItemEdits(each, sdf.Reference("", numbered[each.primPath], each.layerOffset))
        waiting += prim.nameChildren
    return settled


def _shared(prim: Any) -> list[Any]:
    referred = prim.referenceList.GetAddedOrExplicitItems()
    return [each for each in referred if not each.assetPath and each.primPath.name.startswith(_SHARED)]


@contextlib.contextmanager
def _standard_error() -> Iterator[Any]:
    """Yield a function that returns the output on standard error inside the block; USD's C++ code prints there."""
    kept = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)

        def read() -> str:
            file.seek(0)
            return file.read().decode("utf-8", "replace")

        try:
            yield read
        finally:
            os.dup2(kept, 2)
            os.close(kept)
