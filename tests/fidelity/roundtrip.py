"""Parse, write, compile: a model that mjcompose has read and written again is the same model, bit for bit."""

from __future__ import annotations

import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from fidelity import dmcontrol
from fidelity.building import reread
from lxml import etree
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.unchanged import compare

SIX_DIGITS = 1e-5
"""Relative: what is left of a number when MuJoCo saves it."""


@dataclass
class Trip:
    """`loads` is whether MuJoCo loads the file itself, with all that is in it; only then is there anything to be the same as.

    `mjspec` and `dm_control` are whether the model stays the same when these read and write it.
    """

    id: str
    loads: bool = True
    different: tuple[str, ...] = ()
    error: str = ""
    seconds: float = 0.0
    mjspec: bool = False
    dm_control: bool = False

    @property
    def fine(self) -> bool:
        return not self.loads or not (self.different or self.error)


def travel(path: Path, root: Path, *, rivals: bool = True) -> Trip:
    """The round trip of one file, in a mirror of `root` where only that file is new.

    Without `rivals` nobody else has to go the same way.
    """
    trip = Trip(path.relative_to(root).as_posix())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            before = mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            trip.loads = False
            return trip
        if _is_fragment(path):
            trip.loads = False
            return trip
        start = time.perf_counter()
        try:
            text = reread(path)
            with tempfile.TemporaryDirectory() as folder:
                copy = _mirror(path, root, Path(folder))
                copy.write_bytes(text)
                after = mujoco.MjModel.from_xml_path(str(copy))
        except ValueError as error:
            trip.error = str(error).replace("\n", " ")
        else:
            trip.different = tuple(unlike(before, after))
        trip.seconds = time.perf_counter() - start
        if not rivals:
            return trip
        trip.mjspec = _stays(before, lambda: _respecified(path, root), SIX_DIGITS)
        trip.dm_control = dmcontrol.version() is not None and _stays(before, lambda: dmcontrol.reread(path))
    return trip


def _is_fragment(path: Path) -> bool:
    """Whether it is there to be included: MuJoCo loads it as an empty world, without a word of its bodies.

    mjcompose refuses that.
    """
    return (
        next(etree.parse(path, etree.XMLParser(recover=True)).getroot().iterchildren("body", "frame"), None) is not None
    )


def _respecified(path: Path, root: Path) -> mujoco.MjModel:
    """The file read and saved by MuJoCo itself."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compile()
    with tempfile.TemporaryDirectory() as folder:
        copy = _mirror(path, root, Path(folder))
        copy.write_text(spec.to_xml())
        return mujoco.MjModel.from_xml_path(str(copy))


def _stays(before: mujoco.MjModel, make: Callable[[], mujoco.MjModel], tolerance: float = 0.0) -> bool:
    """Whether each element keeps its values, whatever becomes of names that nobody wrote."""
    try:
        after = make()
    except ValueError:
        return False
    return not compare(before, after, keys=KeyMode.PREFIX, tolerance=tolerance)


_OF_PATHS = frozenset(
    "paths npaths nbuffer mesh_pathadr skin_pathadr hfield_pathadr tex_pathadr tex_contenttypeadr".split()
)
"""What MuJoCo keeps of the files it read: the mirror stands elsewhere."""


def unlike(before: mujoco.MjModel, after: mujoco.MjModel) -> list[str]:
    """The attributes of two models that are not the same: arrays bit for bit, sizes, names, settings."""
    found = _unlike("", before, after)
    for group in ("opt", "stat"):
        found += _unlike(f"{group}.", getattr(before, group), getattr(after, group))
    for group in ("global_", "quality", "headlight", "map", "scale", "rgba"):
        found += _unlike(f"vis.{group}.", getattr(before.vis, group), getattr(after.vis, group))
    return found


def _unlike(prefix: str, before: object, after: object) -> list[str]:
    found = []
    for name in dir(before):
        if name.startswith("_") or name in _OF_PATHS:
            continue
        a = getattr(before, name)
        b = getattr(after, name)
        if isinstance(a, np.ndarray):
            same = a.shape == b.shape and a.tobytes() == b.tobytes()
        elif isinstance(a, (bool, int, float, bytes)):
            same = a == b
        else:
            continue
        if not same:
            found.append(prefix + name)
    return found


def _mirror(path: Path, root: Path, folder: Path) -> Path:
    """Where `path` would be in a copy of `root` in `folder`, made of links, and itself left out."""
    place = folder
    above = root
    for part in path.relative_to(root).parts[:-1]:
        for entry in above.iterdir():
            if entry.name != part:
                (place / entry.name).symlink_to(entry)
        above = above / part
        place = place / part
        place.mkdir()
    for entry in above.iterdir():
        if entry != path:
            (place / entry.name).symlink_to(entry)
    return place / path.name
