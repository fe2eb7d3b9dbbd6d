"""The features that some target does not support: rows of the tables in `docs/targets.md`."""

from __future__ import annotations

from collections.abc import Mapping

FEATURES: Mapping[str, str] = {
    "roots": "several bodies in the world",
    "joints": "several joints of one body",
    "ball": "ball joints",
    "references": "joints that are not at zero in the model as it is written",
    "massless": "bodies without mass",
    "damping": "damping of joints",
    "polynomials": "damping and stiffness that are not linear",
    "springs": "stiffness of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "no armature": "joints without armature",
    "effort": "limits of forces: `forcerange`, `actuatorfrcrange`",
    "shapes": "planes, ellipsoids, height fields",
    "textures": "textures",
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
    "gears": "gears of actuators",
    "gains": "damping of position servos: `kv`",
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
"""By name: words for people."""

COMPARED: Mapping[str, str] = {
    "inertia": "masses, centres of mass, inertias",
    "poses": "poses of all bodies in 50 configurations",
    "limits": "limits of joints",
    "damping": "damping of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "springs": "stiffness of joints",
    "effort": "greatest forces of joints and actuators",
    "actuators": "which joint an actuator drives",
    "gains": "gains of servos",
    "shapes": "number of geoms of each type",
    "motion": "0.2 s of motion from the key `home`",
}
"""What is compared when a model is read back, by name: words for people."""
