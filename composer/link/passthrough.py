"""Pass: `passthrough`, which makes MuJoCo leave textures in their files. It applies to a whole model or not at all."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking
from composer.tree.files import file_attributes
from composer.tree.unit import Unit

_NAME = "passthrough"


def passthrough(linking: Linking) -> None:
    """Let the model say what its textures are used to; refuse units of which some ask for it and some do not.

    >>> from composer.link.example import after
    >>> part = '<compiler passthrough="textures"/><asset><texture name="t" type="2d" file="t.png"/></asset>'
    >>> after(passthrough, part)
    base: <compiler passthrough="textures"/>
    """
    if not linking.parts or not any(map(_asks, linking.units)):
        return
    asking: list[tuple[Unit, Node]] = []
    others: list[tuple[Unit, Node]] = []
    for unit in linking.units:
        textures = (element for element, _, _ in file_attributes(unit.root) if element.tag == "texture")
        if (texture := next(textures, None)) is not None:
            (asking if _asks(unit) else others).append((unit, texture))
    if asking and others:
        _refuse(linking, asking[0][0], *others[0])
    for compiler in linking.base.root.iterchildren("compiler"):
        compiler.attrib.pop(_NAME, "")
    if asking:
        linking.base.section("compiler").set(_NAME, "textures")


def _asks(unit: Unit) -> bool:
    said = [each.get(_NAME) for each in unit.root.iterchildren("compiler") if each.get(_NAME)]
    return bool(said) and said[-1] == "textures"


def _refuse(linking: Linking, unit: Unit, other: Unit, texture: Node) -> None:
    compiler = next(each for each in unit.root.iterchildren("compiler") if each.get(_NAME))
    linking.sink.error(
        "compiler-setting",
        f"`{_NAME}` of `{unit.label}` cannot be kept in a composition with `{other.label}`, whose textures are loaded",
        linking.span(unit, compiler, _NAME),
        notes=(Note("such a texture", linking.span(other, texture)),),
        help="let all of them say it, or none",
    )
