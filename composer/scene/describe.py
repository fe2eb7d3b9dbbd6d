"""Describe a compiled model as one JSON file and blobs that it refers to by their hashes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from composer.compiled.placed import place
from composer.scene.blobs import Blobs, short
from composer.scene.columns import columns
from composer.scene.meshes import height_fields, meshes
from composer.scene.poses import poses
from composer.scene.soft import flexes, skins, wraps
from composer.scene.textures import of_materials, textures

FORMAT = 1
FILE = "scene.json"


def describe(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write `scene.json` and its blobs into ``folder``; runs under `composer.engine.call`.

    The answer's `blobs` are all that it refers to; those in ``known`` are not written again. Lengths are in metres,
    angles in radians, quaternions are w x y z, and elements on a body are in its frame, as in `mjModel`. Equal
    models give equal bytes.
    """
    folder = Path(asked["folder"])
    blobs = Blobs(folder, asked.get("known", ()))
    data = mujoco.MjData(model)
    place(mujoco, model, data)
    found: dict[str, Any] = {"format": FORMAT, **columns(model)}
    found["material"]["texture"] = of_materials(model)
    found["mesh"] = meshes(model, blobs)
    found["hfield"] = height_fields(model, blobs)
    found["texture"] = textures(model, blobs)
    found["skin"] = skins(model, blobs)
    found["flex"] = flexes(model, data, blobs)
    found["wrap"] = wraps(model)
    found["poses"] = list(poses(mujoco, model, data))
    found["qpos0"] = short(model.qpos0)
    found["timestep"] = float(model.opt.timestep)
    found["look"] = _look(model)
    text = json.dumps(found, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    (folder / FILE).write_text(text, encoding="utf-8")
    return {"blobs": list(blobs.used)}


def _look(model: Any) -> dict[str, Any]:
    """Return the view that the author of the model has set."""
    settings, light = model.vis.global_, model.vis.headlight
    return {
        "center": short(model.stat.center), "extent": float(model.stat.extent), "azimuth": float(settings.azimuth),
        "elevation": float(settings.elevation), "fovy": float(settings.fovy),
        "headlight": {
            "active": bool(light.active), "ambient": short(light.ambient), "diffuse": short(light.diffuse),
            "specular": short(light.specular),
        },
        "haze": short(model.vis.rgba.haze), "jointwidth": float(model.vis.scale.jointwidth),
        "framewidth": float(model.vis.scale.framewidth), "meansize": float(model.stat.meansize),
    }  # fmt: skip
