"""Limits for what several targets do not read at all."""

from __future__ import annotations

from composer.targets.restrictions.attributes import without_attribute
from composer.targets.restrictions.left_out import left_out

NO_KEYS = left_out("keys", "keyframe/key", why="keyframes are not read")
NO_SENSORS = left_out("sensors", "sensor/*", why="sensors are not read")
NO_CAMERAS = left_out("cameras", ".//camera", why="cameras are not read")
NO_LIGHTS = left_out("lights", ".//light", why="lights are not read")
NO_SITES = left_out("sites", ".//site", why="sites are not read")
NO_TENDONS = left_out("tendons", "tendon/*", why="tendons are not read")
NO_EQUALITY = left_out(
    "equality", "equality/*", why="equality constraints are not read: what it couples moves freely"
)
NO_PAIRS = left_out("pairs", "contact/pair", why="contact pairs are not read")
NO_EXCLUDES = left_out("excludes", "contact/exclude", why="excluded contacts are not read: the two collide")
NO_SOFT = left_out("soft", "deformable/*", "asset/skin", why="flexes and skins are not read")
NO_PLUGINS = left_out("plugins", "extension/*", ".//plugin", why="plugins are not read")
NO_CUSTOM = left_out("custom", "custom/*", why="custom data are not read")
NO_SPRINGS = without_attribute("springs", ".//joint", "stiffness", "the stiffness of joints is not read")
NO_FRICTION = without_attribute(
    "friction", ".//joint", "frictionloss", "the dry friction of joints is not read"
)
