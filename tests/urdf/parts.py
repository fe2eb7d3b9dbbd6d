"""Pieces of URDF for tests."""

from __future__ import annotations

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'


def link(name: str, inside: str = INERTIAL) -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(name: str, parent: str, child: str, inside: str = "", kind: str = "revolute") -> str:
    limit = '<limit lower="-1" upper="1.5" effort="20" velocity="2"/>' if "<limit" not in inside else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.3"/>'
        f'<axis xyz="0 1 0"/>{limit if kind != "fixed" else ""}{inside}</joint>'
    )


def robot(*parts: str) -> str:
    return '<robot name="robot">\n' + "\n".join(parts) + "\n</robot>\n"


ARM = (link("base"), link("upper"), link("fore"), joint("shoulder", "base", "upper"), joint("elbow", "upper", "fore"))
