"""Write a bundle for a target, in MuJoCo's child process."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from composer.compiled.index import index
from composer.compiled.kinds import NameTable
from composer.targets.plain.plain import CannotBePlain, plain
from composer.targets.same import differences
from composer.targets.table import PLAIN, TARGETS

MJCF = ".xml"


def export(mujoco: Any, argument: dict[str, str]) -> dict[str, Any]:
    """Write what the target `name` reads of the file `model` into the folder `out`.

    It is called by `composer.engine.call`. It returns the losses, the differences between the plain text and the
    model (with any, no file is written), the names of the elements by kind, and, if MuJoCo can read what was
    written, its index.
    """
    model, out = Path(argument["model"]), Path(argument["out"])
    try:
        draft = plain(mujoco, model)
        written = PLAIN.write(draft)
        _put(out, written)
        again = mujoco.MjModel.from_xml_path(str(out / draft.output))
    except (CannotBePlain, ValueError) as error:
        return {"error": " ".join(str(error).split()), "losses": [], "differences": []}
    found: dict[str, Any] = {
        "error": None,
        "differences": list(differences(draft.model, again)),
        "names": NameTable(draft.model).names,
    }
    target = TARGETS[argument["name"]]
    if target is not PLAIN:
        for path in written:
            (out / path).unlink()
        for limit in target.limits:
            limit.apply(draft)
        _put(out, target.write(draft))
    made = out / draft.output
    found |= {"losses": [asdict(each) for each in draft.losses], "model": draft.output, "index": None}
    if made.suffix == MJCF and draft.mujoco_reads:
        found["index"] = index(mujoco.MjModel.from_xml_path(str(made)), mujoco)
    return found


def _put(folder: Path, files: dict[str, bytes]) -> None:
    for path, content in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)
