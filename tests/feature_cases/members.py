"""Who is in a composition, read off its recipe without mjcompose: every source with its prefix and its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import yaml
from lxml import etree
from mjcompose.base.rotation import Pose, normalize
from mjcompose.mujoco.match import AT_ORIGIN, Mount

PLACES = ("site", "body", "frame")
WHOLE = "whole-"
"""Begins the name of the file that has the `compiler` of a part in it, next to the file that the recipe names."""


@dataclass(frozen=True)
class Place:
    """Where a part's world stands: on what, by final name, and the offset there; nothing is the world.

    `offset` is None where the composed model does not tell it.
    """

    kind: str = "world"
    name: str = ""
    offset: Pose | None = AT_ORIGIN

    def mount(self, composed: mujoco.MjModel) -> Mount:
        """The place in the composed model."""
        if self.kind == "site":
            site = composed.site(self.name)
            here = Pose(tuple(site.pos), tuple(_site_quat(composed, site.id)))
            body = int(composed.site_bodyid[site.id])
            return Mount(body or None, None if self.offset is None else here @ self.offset)
        return Mount(self.name if self.kind == "body" else None, self.offset)


@dataclass(frozen=True)
class Member:
    """One source: its prefix, its file, its place, and what its keys are called (None: they are left out)."""

    prefix: str
    file: Path
    place: Place
    keys: tuple[str, ...] | None
    added: frozenset[str] = frozenset()

    def key(self, name: str) -> str:
        return "".join(reversed(self.keys or ())) + name


def members(recipe: Path) -> Iterator[Member]:
    """The base first, then the parts; nested recipes with all of theirs."""
    yield from _members(recipe, "", Place(), ())


def _members(recipe: Path, prefix: str, place: Place, keys: tuple[str, ...] | None) -> Iterator[Member]:
    given = yaml.safe_load(recipe.read_text())
    separator = given.get("separator", "/")
    base = given.get("base")
    if base is not None:
        if isinstance(base, str):
            base = {"model": base}
        own = None if _drops_keys(base) else keys
        yield from _source(_file(recipe, base), prefix, place, own)
    for name, part in (given.get("attach") or {}).items():
        inner = part.get("prefix", name)
        inner += separator if inner else ""
        apart = (inner,) if part.get("keys") == "prefix" else ()
        kept = None if keys is None or _drops_keys(part) else apart + keys
        where = _place(recipe, given, part, prefix, prefix + inner, place)
        added = frozenset(prefix + inner + each["name"] for each in part.get("joint", ()) if isinstance(each, dict))
        for member in _source(_file(recipe, part), prefix + inner, where, kept):
            yield Member(member.prefix, member.file, member.place, member.keys, member.added | added)


def _file(recipe: Path, part: dict[str, Any]) -> Path:
    file = recipe.parent / part["model"]
    return file.with_name(f"{WHOLE}{file.name}") if "compiler" in part else file


def _drops_keys(part: dict[str, Any]) -> bool:
    return "key" in part.get("drop", ()) or {"key": "**", "optional": True} in part.get("drop", ())


def _source(file: Path, prefix: str, place: Place, keys: tuple[str, ...] | None) -> Iterator[Member]:
    if file.suffix == ".yaml":
        yield from _members(file, prefix, place, keys)
    else:
        yield Member(prefix, file, place, keys)


def _place(
    recipe: Path, given: Mapping[str, Any], part: Mapping[str, Any], outer: str, prefix: str, world: Place
) -> Place:
    """`outer` is the prefix of the recipe, `prefix` that of the part, `world` where the recipe's world stands."""
    if part.get("joint") not in (None, "none"):
        return Place("body", prefix)  # the body that the joint brings
    offset = None if "mate" in part else _offset(part, given)
    kind = next((kind for kind in PLACES if kind in part), None)
    if kind is None:
        if world.offset is None or offset is None:
            return Place(world.kind, world.name, None)
        return Place(world.kind, world.name, world.offset @ offset)
    name = outer + part[kind]
    if kind != "frame":
        return Place(kind, name, offset)
    host, holder = _holder_of_frame(recipe, given, part["frame"])
    if holder:
        return Place("body", outer + holder, None)
    if host:  # in the world of another part
        separator = given.get("separator", "/")
        world = _place(recipe, given, given["attach"][host], outer, f"{outer}{host}{separator}", world)
    return Place(world.kind, world.name, None)


def _holder_of_frame(recipe: Path, given: Mapping[str, Any], name: str) -> tuple[str, str]:
    """The key of the part that has a frame, and the body it is in by the name that the recipe gives it.

    No key for the base, no body for the world.
    """
    separator = given.get("separator", "/")
    base = given.get("base")
    models = [("", "", base["model"] if isinstance(base, dict) else base)]
    models += [(key, f"{key}{separator}", part["model"]) for key, part in (given.get("attach") or {}).items()]
    for key, prefix, model in models:
        if not isinstance(model, str) or not model.endswith(".xml"):
            continue
        for frame in etree.parse(str(recipe.parent / model)).iter("frame"):
            if prefix + str(frame.get("name")) == name:
                body = next(frame.iterancestors("body"), None)
                return key, "" if body is None else prefix + str(body.get("name"))
    raise ValueError(f"{recipe}: no frame {name}")


def _offset(part: Mapping[str, Any], given: Mapping[str, Any]) -> Pose:
    x, y, z = map(float, part.get("pos", (0, 0, 0)))
    return Pose((x, y, z), _quat(part, given))


def _quat(part: Mapping[str, Any], given: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """By MuJoCo's own functions."""
    quat = np.array([1.0, 0, 0, 0])
    if "quat" in part:
        w, x, y, z = map(float, part["quat"])
        return normalize((w, x, y, z))
    if "euler" in part:
        mujoco.mju_euler2Quat(quat, _radians(part["euler"], given), given.get("eulerseq", "xyz"))
    elif "axisangle" in part:
        *axis, angle = part["axisangle"]
        direction = np.array(axis, dtype=float) / np.linalg.norm(axis)
        mujoco.mju_axisAngle2Quat(quat, direction, _radians([angle], given)[0])
    elif "zaxis" in part:
        mujoco.mju_quatZ2Vec(quat, np.array(part["zaxis"], dtype=float))
    elif "xyaxes" in part:
        x = np.array(part["xyaxes"][:3], dtype=float)
        y = np.array(part["xyaxes"][3:], dtype=float)
        x /= np.linalg.norm(x)
        y -= x * (x @ y)
        y /= np.linalg.norm(y)
        mujoco.mju_mat2Quat(quat, np.array([x, y, np.cross(x, y)]).T.flatten())
    w, x, y, z = quat.tolist()
    return (w, x, y, z)


def _radians(angles: list[Any], given: Mapping[str, Any]) -> list[float]:
    degrees = given.get("angle") == "degree"
    return [
        np.deg2rad(float(angle[:-3]))
        if isinstance(angle, str) and angle.endswith("deg")
        else float(angle[:-3])
        if isinstance(angle, str)
        else np.deg2rad(angle)
        if degrees
        else float(angle)
        for angle in angles
    ]


def _site_quat(model: mujoco.MjModel, site: int) -> tuple[float, ...]:
    return tuple(model.site_quat[site].tolist())
