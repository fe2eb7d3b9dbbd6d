"""Write class defaults onto actuators whose class has settings for several actuator tags, as MuJoCo combines them."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator, Mapping

from lxml.etree import _Element as Node

from composer.diagnostics.call_site import call_site
from composer.grammar import GRAMMAR
from composer.mjcf.errors import MjcfWarning
from composer.mjcf.model import Model
from composer.mjcf.physics.actuators import settings
from composer.mjcf.reference import describe
from composer.mjcf.views import class_of
from composer.tree.classes import MAIN, DefaultClass
from composer.tree.kinds import ROOT, kind_of

ACTUATORS = frozenset(GRAMMAR.section("actuator").children)
_GENERAL = "general"
# What actuators of every tag have, and MuJoCo keeps in one place for all: it comes from classes for any of them.
OF_ALL = frozenset(
    name
    for name in GRAMMAR.element("actuator/motor").attributes
    if name != "class"
    and all(name in GRAMMAR.element(f"actuator/{tag}").attributes for tag in (_GENERAL, "position"))
)
# Tags of which MuJoCo takes every attribute that a class gives as if it were written on the element.
_PLAIN = frozenset({_GENERAL, "motor", "position", "velocity", "intvelocity", "adhesion"})


def is_plain(found: DefaultClass, node: Node) -> bool:
    """Return whether the attributes that a class sets for an actuator can be written onto it unchanged."""
    tag, known = str(node.tag), kind_of(node).attributes
    for element in _elements(found):
        if element.tag == tag:
            if tag not in _PLAIN:
                return False
        elif element.tag != _GENERAL or not all(
            str(name) in OF_ALL and str(name) in known
            for name in element.keys()  # noqa: SIM118
        ):
            return False
    return True


def commit(
    model: Model, node: Node, given: Mapping[str, str], found: DefaultClass, *, partly: bool = False
) -> None:
    """Write attributes onto an actuator so that MuJoCo reads the same with its classes and without them.

    `given` has the attributes from the classes that the actuator's own tag has. If these are not enough, the actuator
    becomes a `general`, which can express everything except a plugin, and an `MjcfWarning` is issued. If that is not
    enough either, the actuator still needs its class, and an `MjcfWarning` says so. With `partly`, only some of the
    attributes were requested: then the actuator keeps its tag and its class.
    """
    sections = _sections(found)
    spelled = copy.copy(node)
    spelled.attrib.pop("class", "")
    if found.name != MAIN:
        spelled.set("class", found.name)
    wanted = settings(sections, spelled)
    if wanted is None:  # MuJoCo says why when the model is compiled
        return
    as_good: Node | None = None
    bare = settings(sections, _bare(spelled)) or {}
    for candidate in _candidates(spelled, given, wanted, bare, in_general=not partly):
        if settings(sections, candidate) != wanted:
            continue
        if partly:
            _become(model, node, candidate)
            return
        as_good = candidate if as_good is None else as_good
        alone = copy.copy(candidate)
        alone.attrib.pop("class", "")
        if settings((), alone) == wanted:
            _become(model, node, candidate)
            return
    if as_good is not None:
        _become(model, node, as_good)
    _warn(f"{describe(model, node)} keeps needing its default class, which gives it what cannot be written")


def _sections(found: DefaultClass) -> list[Node]:
    """Return the default sections of the class's model, or none if the class and those above set nothing."""
    for element in _elements(found):
        above = [each for each in element.iterancestors() if each.tag == ROOT]
        return list(above[0].iterchildren("default"))
    return []


def _elements(found: DefaultClass | None) -> Iterator[Node]:
    while found is not None:
        for tag in ACTUATORS:
            yield from found.elements.get(tag, ())
        found = found.parent


def _candidates(
    node: Node,
    given: Mapping[str, str],
    wanted: Mapping[str, str],
    bare: Mapping[str, str],
    *,
    in_general: bool,
) -> Iterator[Node]:
    """Yield the element with all attributes from its classes, with those that all tags share, and as a `general`."""
    for names in (given.keys(), given.keys() & OF_ALL):
        candidate = copy.copy(node)
        candidate.attrib.update({name: given[name] for name in sorted(names)})
        yield candidate
    if node.tag == "plugin" or not in_general:
        return
    general = copy.copy(node)
    general.tag = _GENERAL
    for name in set(general.keys()) - GRAMMAR.element(f"actuator/{_GENERAL}").attributes.keys():
        del general.attrib[name]
    plain = settings((), node.makeelement(_GENERAL)) or {}
    for name, text in wanted.items():
        if text and not text == bare.get(name) == plain.get(name):
            general.set(name, text)
        elif name in general.attrib:
            del general.attrib[name]
    yield general


def _bare(node: Node) -> Node:
    """Return a `general` of the same class without any other attribute."""
    found = str(node.get("class") or "")
    return node.makeelement(_GENERAL, {"class": found} if found else {})


def _become(model: Model, node: Node, other: Node) -> None:
    """Give an element the tag and attributes of another one. Existing references to its Element stay valid."""
    model.forget(node)
    if node.tag != other.tag:
        _warn(
            f"{describe(model, node)} is written as a `{other.tag}`: its default class gives it what a "
            f"`{node.tag}` cannot say"
        )
        node.tag = other.tag
        view = model.views.get(node)
        if view is not None:
            object.__setattr__(view, "__class__", class_of(kind_of(node)))
    for name in set(node.keys()) - set(other.keys()) - {"class"}:
        del node.attrib[name]
    node.attrib.update({name: value for name, value in other.items() if name != "class"})
    model.note(node)


def _warn(message: str) -> None:
    place = call_site()
    warnings.warn_explicit(message, MjcfWarning, place.file, place.line)
