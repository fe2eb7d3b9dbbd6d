"""Convert MJCF to USD with `mujoco-usd-converter`, in the child process. The package is an extra."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from composer.dataclass import dataclass
from composer.engine.run import call
from composer.engine.session import Session
from composer.scratch import scratch

_WARNING = re.compile(r"^Warning: in \S+ at line \d+ of .*? -- (.*)$", re.MULTILINE)
_OWN_AFFAIRS = re.compile(r"deprecated")


@dataclass(frozen=True, slots=True)
class Exported:
    """The result of an export: `missing` is set if the converter cannot be imported, `error` if it failed.

    `textures` are images next to a layer, which a package would contain; `warnings` are the converter's messages.
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
    if not answer.ok:
        return Exported(error=answer.error)
    return Exported(
        answer.value["missing"],
        None,
        tuple(answer.value["textures"]),
        warnings=tuple(answer.value["warnings"]),
    )


def export(mujoco: Any, argument: dict[str, str]) -> dict[str, Any]:
    """Convert the model. Runs in the child."""
    found: dict[str, Any] = {"missing": None, "textures": [], "warnings": []}
    try:
        converter = import_module("mujoco_usd_converter")
        sdf, packing = import_module("pxr.Sdf"), import_module("pxr.UsdUtils")
    except ImportError as error:
        return found | {"missing": str(error)}
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
    return found | {
        "textures": textures if suffix != ".usdz" else [],
        "warnings": list(dict.fromkeys(warnings)),
    }


_SHARED = "Flattened_Prototype_"


def _settled(layer: Any, sdf: Any) -> Any:
    """Return the layer without what differs between runs: its path, and the numbers of shared prims.

    Shared prims are numbered in the order in which they are first referred to.
    """
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
            prim.referenceList.ReplaceItemEdits(
                each, sdf.Reference("", numbered[each.primPath], each.layerOffset)
            )
        waiting += prim.nameChildren
    return settled


def _shared(prim: Any) -> list[Any]:
    """Return a prim's references to shared prims."""
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
