"""Pass: one `<compiler>` for the model, after the units have been rewritten to mean the same under it."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link.angles import model_angle
from composer.link.inertia import MEASURED
from composer.link.linking import Linking
from composer.tree.line import line_of, set_line

FOLDERS = ("meshdir", "texturedir", "assetdir", "strippath")
_MADE_EXPLICIT = ("inertiafromgeom", "inertiagrouprange", *MEASURED)
_WHOLE_MODEL = ("fusestatic", "discardvisual")
_NO_EFFECT = ("coordinate", "usethread", "conflict")


def compiler(linking: Linking) -> None:
    """Write the base's settings once, as they now hold for every part.

    >>> from composer.link.example import after
    >>> base = '<compiler angle="radian" meshdir="m" inertiafromgeom="true"/>'
    >>> after(compiler, base=base)
    model: <compiler angle="radian"/>
    """
    root = linking.base.root
    written: dict[str, str] = {}
    settings: list[Node] = []
    children = []
    first = next(root.iterchildren("*"), None)
    at = root.index(first) if first is not None and first.tag == "compiler" else None
    # Of several `<compiler>` the last one counts, for elements above it, too: in MuJoCo 4.0 `<joint ref="90"/>` between
    # `<compiler angle="radian"/>` and `<compiler angle="degree"/>` has a reference of 1.5708.
    for element in list(root.iterchildren("compiler")):
        written.update({str(name): str(value) for name, value in element.items()})
        children.extend(list(element))
        settings.append(element)
    line = next(map(line_of, settings), None)
    owner = linking.base.origins.owner(settings[0], linking.base.file) if settings else None
    for element in settings:
        root.remove(element)
    # All files stand below `assets/` with their whole path. MuJoCo 4.0 would put `meshdir` before that of
    # every mesh; where it is missing, `assetdir`, in whatever order the two stand.
    for name in FOLDERS:
        written.pop(name, None)
    if linking.composed:
        for name in (*_MADE_EXPLICIT, *_NO_EFFECT, *_WHOLE_MODEL, "alignfree", "fitaabb"):
            written.pop(name, None)
        if linking.notes.aligned:
            written["alignfree"] = "true"
    if linking.parts:
        written["angle"] = model_angle(linking)
        if model_autolimits(linking) == "true":
            written.pop("autolimits", None)
    if not written and not children:
        return
    element = root.makeelement("compiler", written)
    for child in children:
        same = element.find(str(child.tag)) if isinstance(child.tag, str) else None
        if same is None:
            element.append(child)
        else:  # in one `<compiler>` MuJoCo takes one `<lengthrange>`
            same.attrib.update(child.attrib)
    if owner is not None:
        linking.base.origins.own(element, owner)
        set_line(element, line)
    if at is None:
        linking.base.insert(element)
    else:
        root.insert(at, element)


def model_autolimits(linking: Linking) -> str:
    """Return the model's value of `autolimits`.

    MuJoCo refuses a range without an explicit `limited` under `false`, so that a unit which compiles with `false`
    means the same under `true`.
    """
    return "false" if all(unit.settings.autolimits == "false" for unit in linking.units) else "true"
