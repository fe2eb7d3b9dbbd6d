"""The features that some target does not support: the rows of the table in `docs/targets.md`."""

from __future__ import annotations

from collections.abc import Mapping

FEATURES: Mapping[str, str] = {
    "roots": "several bodies in the world",
    "joints": "several joints of one body",
    "ball": "ball joints",
    "references": "joints that are not at zero in the model as it is written",
    "massless": "bodies without mass",
    "springs": "stiffness of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "shapes": "planes, ellipsoids, height fields",
    "sites": "sites",
    "cameras": "cameras",
    "lights": "lights",
    "collisions": "contacts between shapes of all kinds",
    "margins": "margins of contacts with meshes and height fields",
    "pairs": "contact pairs",
    "excludes": "excluded contacts",
    "equality": "equality constraints",
    "tendons": "tendons",
    "actuators": "actuators",
    "control ranges": "ranges of the controls of position servos",
    "sensors": "sensors",
    "contact sensors": "contact sensors of all kinds",
    "keys": "keyframes",
    "soft": "flexes and skins",
    "sleep": "`sleep` of bodies",
    "plugins": "plugins",
    "gravity": "gravity that is not 0 0 -9.81",
    "gravcomp": "gravity compensation of bodies",
    "contacts": "softness, margins and friction of contacts",
    "bits": "which geoms collide: `contype` and `conaffinity`",
    "softness": "softness and margins of joint limits",
    "computing": "time step, integrator, friction cone, medium, flags",
    "options": "all integrators and solvers",
    "custom": "custom numbers, texts and tuples",
}
"""By name: words for people. What is not listed, every target keeps: kinematics, inertia, limits, boxes, meshes, …"""
