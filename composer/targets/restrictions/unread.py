"""Limits for what a target does not read, or reads wrongly: elements, attributes and kinds of shapes."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome

_DYNAMICS = {"damping": "damping", "frictionloss": "friction", "armature": "armature"}
_WORDS = {"frictionloss": "dry friction"}
_SHOWN_GROUP = 2
"""Programs show the groups up to this one, as MuJoCo does at first."""
_ZERO = frozenset("0. ")


def left_out(feature: str, *paths: str, why: str = "") -> Limit:
    """Return a limit that removes the elements at these paths. `why` says what follows from that."""
    return Limit(feature, Outcome.LEFT_OUT, partial(_leave_out, feature, paths, why))


def only(feature: str, path: str, tags: Collection[str], why: str = "") -> Limit:
    """Return a limit that removes the elements at a path whose tag is none of these."""
    return Limit(feature, Outcome.PARTLY, partial(_only, feature, path, frozenset(tags), why))


def refused(feature: str, path: str, why: str, help: str) -> Limit:
    """Return a limit that refuses a model with an element at this path."""
    return Limit(feature, Outcome.REFUSED, partial(_refuse, feature, path, why, help))


def without_attribute(
    feature: str, path: str, name: str, what: str, why: str = "", *, also: Collection[str] = ()
) -> Limit:
    """Return a limit that removes an attribute, and those that mean nothing without it.

    A value other than zero is a loss.
    """
    return Limit(feature, Outcome.LEFT_OUT, partial(_take, feature, path, name, what, why, also))


def no_shapes(*kinds: str) -> Limit:
    """Return a limit that removes geoms of these types, and the height fields that no geom uses then."""
    return Limit("shapes", Outcome.PARTLY, partial(_without_shapes, kinds))


def unread_in(joints: str, *attributes: str) -> tuple[Limit, ...]:
    """Return limits that remove attributes from joints of a type."""
    path = f".//joint[@type='{joints}']"
    return tuple(
        without_attribute(_DYNAMICS[name], path, name, what=_WORDS.get(name, name)) for name in attributes
    )


def _leave_out(feature: str, paths: Collection[str], why: str, draft: Draft) -> None:
    for path in paths:
        for element in list(draft.root.iterfind(path)):
            draft.lose(feature, element, why)
            draft.remove(element)


def _only(feature: str, path: str, tags: frozenset[str], why: str, draft: Draft) -> None:
    for element in list(draft.root.iterfind(path)):
        if element.tag not in tags:
            draft.lose(feature, element, why)
            draft.remove(element)


def _refuse(feature: str, path: str, why: str, help: str, draft: Draft) -> None:
    for element in draft.root.iterfind(path):
        draft.lose(feature, element, why, outcome=Outcome.REFUSED, help=help)


def _take(
    feature: str, path: str, name: str, what: str, why: str, also: Collection[str], draft: Draft
) -> None:
    for element in draft.root.iterfind(path):
        value = str(element.attrib.pop(name, ""))
        for each in also:
            element.attrib.pop(each, "")
        if not _ZERO.issuperset(value):
            draft.lose(feature, element, why, what=what)


def _without_shapes(kinds: Collection[str], draft: Draft) -> None:
    for _, geom in list(draft.of("geom")):
        if geom.get("type") in kinds:
            draft.lose(
                "shapes",
                geom,
                what=f"the {'height field' if geom.get('type') == 'hfield' else geom.get('type')}",
            )
            draft.remove(geom)
    used = {geom.get("hfield") for geom in draft.root.iterfind(".//geom")}
    for field in list(draft.root.iterfind("asset/hfield")):
        if field.get("name") not in used:
            draft.remove(field)


def _hidden(draft: Draft) -> None:
    for number, geom in list(draft.of("geom")):
        touches = draft.model.geom_contype[number] or draft.model.geom_conaffinity[number]
        if not touches and draft.model.geom_group[number] > _SHOWN_GROUP:
            draft.lose("shapes", geom, "they neither collide nor are shown")
            draft.remove(geom)


def _linear(draft: Draft) -> None:
    for path in (".//joint", "tendon/*", "actuator/*"):
        for element in draft.root.iterfind(path):
            for name in ("damping", "stiffness"):
                first, *rest = str(element.get(name) or "0").split()
                if rest:
                    element.set(name, first)
                    draft.lose(
                        "polynomials", element, "what is linear is read", what=f"the higher terms of {name}"
                    )


def _plain_colours(draft: Draft) -> None:
    for material in draft.root.iterfind("asset/material"):
        layers = list(material.iterchildren("layer"))
        for layer in layers:
            material.remove(layer)
        if material.attrib.pop("texture", "") or layers:
            draft.lose("textures", material, what="textures")
    for texture in list(draft.root.iterfind("asset/texture")):
        draft.remove(texture)


def _bare(draft: Draft) -> None:
    for inertial in list(draft.root.iterfind(".//inertial")):
        if float(str(inertial.get("mass"))) == 0:
            draft.remove(inertial)
    for compiler in draft.root.iterchildren("compiler"):
        compiler.attrib.pop("inertiafromgeom", "")  # their geoms are written without a mass


NO_HIDDEN_SHAPES = Limit("shapes", Outcome.PARTLY, _hidden)
NO_EMPTY_INERTIA = Limit("massless", Outcome.KEPT, _bare)
"""For a target in which an inertia needs a mass."""
NO_KEYS = left_out("keys", "keyframe/key")
NO_SENSORS = left_out("sensors", "sensor/*")
NO_CAMERAS = left_out("cameras", ".//camera")
NO_LIGHTS = left_out("lights", ".//light")
NO_SITES = left_out("sites", ".//site")
NO_TENDONS = left_out("tendons", "tendon/*")
NO_EQUALITY = left_out("equality", "equality/*", why="what they couple moves freely")
NO_PAIRS = left_out("pairs", "contact/pair")
NO_EXCLUDES = left_out("excludes", "contact/exclude", why="these bodies collide")
NO_SOFT = left_out("soft", "deformable/*", "asset/skin")
NO_PLUGINS = left_out("plugins", "extension/*", ".//plugin")
NO_CUSTOM = left_out("custom", "custom/*")
NO_SPRINGS = without_attribute(
    "springs", ".//joint", "stiffness", what="stiffness", also=("springref", "springdamper", "springyield")
)
NO_FRICTION = without_attribute("friction", ".//joint", "frictionloss", what="dry friction")
NO_DAMPING = without_attribute("damping", ".//joint", "damping", what="damping")
NO_ARMATURE = without_attribute("armature", ".//joint", "armature", what="armature")
NO_EFFORT = without_attribute(
    "effort",
    ".//joint",
    "actuatorfrcrange",
    what="the greatest force",
    also=("actuatorfrclimited", "actuatorgravcomp"),
)
NO_TEXTURES = Limit("textures", Outcome.LEFT_OUT, _plain_colours)
NO_YIELD = without_attribute("springs", ".//joint", "springyield", what="`springyield`")
NO_POLYNOMIALS = Limit("polynomials", Outcome.LEFT_OUT, _linear)
