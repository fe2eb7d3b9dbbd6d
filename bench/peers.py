"""The others: lxml as the floor, MuJoCo's `MjSpec`, and `dm_control.mjcf` where it is installed."""

from __future__ import annotations

import contextlib
import importlib
import os
from collections.abc import Iterator
from typing import Any

from lxml import etree


def lxml_rewritten(*files: str) -> list[bytes]:
    """Every file parsed and written again, nothing done to it."""
    return [etree.tostring(etree.parse(file)) for file in files]


def read_with(file: str | os.PathLike[str]) -> list[str]:
    """A model file and all that it includes."""
    path = os.fspath(file)
    names = [str(each.get("file")) for each in etree.parse(path).iter("include")]
    inside = [os.path.join(os.path.dirname(path), name) for name in names]
    return [path, *(each for included in inside if os.path.exists(included) for each in read_with(included))]


def mjspec() -> Any | None:
    """MuJoCo, if its specs can be saved without being compiled (3.16 and newer)."""
    mujoco: Any = importlib.import_module("mujoco")
    return mujoco if hasattr(mujoco.MjSpec().compiler, "savecompiled") else None


def mjspec_attached(mujoco: Any, arm: str, hand: str, site: str, out: str) -> None:
    """Saved as written. Keys are left out: with them MuJoCo wants both models compiled, far slower."""
    base = mujoco.MjSpec.from_file(arm)
    child = mujoco.MjSpec.from_file(hand)
    _without_keys(base, child)
    base.attach(child, prefix="hand/", site=base.site(site))
    _save(base, out)


def mjspec_copies(mujoco: Any, model: str, count: int, out: str) -> None:
    base = mujoco.MjSpec()
    for number in range(count):
        child = mujoco.MjSpec.from_file(model)
        _without_keys(child)
        base.attach(child, prefix=f"{number}/", frame=base.worldbody.add_frame())
    _save(base, out)


def dm_control() -> Any | None:
    try:
        return importlib.import_module("dm_control.mjcf")
    except ImportError:
        return None


def dm_control_attached(mjcf: Any, arm: str, hand: str, site: str) -> object:
    base = mjcf.from_path(arm)
    child = mjcf.from_path(hand)
    base.find("site", site).attach(child)
    return base.to_xml_string()


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """MuJoCo writes its warnings straight to the standard error."""
    kept = os.dup(2)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _without_keys(*specs: Any) -> None:
    for spec in specs:
        for key in list(spec.keys):
            spec.delete(key)


def _save(spec: Any, out: str) -> None:
    spec.compiler.savecompiled = 0
    spec.compiler.savecanonical = 0
    spec.to_file(out)
