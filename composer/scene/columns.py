"""The arrays of `mjModel` for a page, by kind of element: the name in the page, and the array."""

from __future__ import annotations

from typing import Any

from composer.compiled.kinds import NameTable
from composer.scene.blobs import short

COLUMNS: dict[str, dict[str, str]] = {
    "body": {
        "parent": "body_parentid", "pos": "body_pos", "quat": "body_quat", "mass": "body_mass",
        "inertia": "body_inertia", "ipos": "body_ipos", "iquat": "body_iquat", "mocap": "body_mocapid",
    },
    "joint": {
        "body": "jnt_bodyid", "type": "jnt_type", "pos": "jnt_pos", "axis": "jnt_axis", "range": "jnt_range",
        "limited": "jnt_limited", "qpos": "jnt_qposadr", "group": "jnt_group",
    },
    "geom": {
        "body": "geom_bodyid", "type": "geom_type", "pos": "geom_pos", "quat": "geom_quat", "size": "geom_size",
        "data": "geom_dataid", "material": "geom_matid", "rgba": "geom_rgba", "group": "geom_group",
        "contype": "geom_contype", "conaffinity": "geom_conaffinity",
    },
    "site": {
        "body": "site_bodyid", "type": "site_type", "pos": "site_pos", "quat": "site_quat", "size": "site_size",
        "material": "site_matid", "rgba": "site_rgba", "group": "site_group",
    },
    "camera": {
        "body": "cam_bodyid", "mode": "cam_mode", "target": "cam_targetbodyid", "pos": "cam_pos", "quat": "cam_quat",
        "fovy": "cam_fovy", "pos0": "cam_pos0", "mat0": "cam_mat0", "poscom0": "cam_poscom0",
    },
    "light": {
        "body": "light_bodyid", "type": "light_type", "pos": "light_pos", "dir": "light_dir",
        "active": "light_active", "shadow": "light_castshadow", "ambient": "light_ambient",
        "diffuse": "light_diffuse", "specular": "light_specular", "cutoff": "light_cutoff",
        "exponent": "light_exponent", "attenuation": "light_attenuation",
    },
    "material": {
        "rgba": "mat_rgba", "repeat": "mat_texrepeat", "uniform": "mat_texuniform", "emission": "mat_emission",
        "specular": "mat_specular", "shininess": "mat_shininess", "reflectance": "mat_reflectance",
    },
    "tendon": {
        "first": "tendon_adr", "count": "tendon_num", "rgba": "tendon_rgba", "material": "tendon_matid",
        "width": "tendon_width", "group": "tendon_group", "range": "tendon_range", "limited": "tendon_limited",
    },
    "actuator": {
        "transmission": "actuator_trntype", "target": "actuator_trnid", "gear": "actuator_gear",
    },
    "key": {"time": "key_time", "qpos": "key_qpos", "ctrl": "key_ctrl", "mpos": "key_mpos", "mquat": "key_mquat"},
}  # fmt: skip
"""A kind's names are added as `name`; every column is one flat list."""


def columns(model: Any) -> dict[str, dict[str, list[Any]]]:
    """Return the columns of every kind."""
    table = NameTable(model)
    found = {
        kind: {
            "name": table.names[kind],
            **{name: short(getattr(model, array)) for name, array in arrays.items()},
        }
        for kind, arrays in COLUMNS.items()
    }
    found["actuator"] |= _controls(model)
    found["exclude"] = _excludes(model)
    return found


def _excludes(model: Any) -> dict[str, list[Any]]:
    """Return the bodies whose contacts are excluded, in pairs. MuJoCo keeps both in one number."""
    signatures = [int(each) for each in model.exclude_signature]
    return {"body1": [each >> 16 for each in signatures], "body2": [each & 0xFFFF for each in signatures]}


def _controls(model: Any) -> dict[str, list[Any]]:
    """Return the addresses of an actuator's controls: one each before MuJoCo 4.0."""
    count = len(model.actuator_trntype)
    first = getattr(model, "actuator_ctrladr", None)
    return {
        "control": list(range(count)) if first is None else short(first),
        "range": short(model.actuator_ctrlrange),
        "limited": short(model.actuator_ctrllimited),
    }
