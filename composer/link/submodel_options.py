"""Pass: under `conflict="merge"`, the options that a unit takes from the models it attaches become its own.

The model itself has no `conflict` setting, so the sub-models of one unit cannot change another unit.
"""

from __future__ import annotations

from pathlib import Path

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.link.linking import Linking
from composer.link.submodels import door_of_submodel, parse_held
from composer.link.written import default_of, merged, set_value, written
from composer.tree.files import join
from composer.tree.line import line_of, set_line
from composer.tree.parse import parse_file
from composer.tree.unit import Unit

# Of `visual` and `size` MuJoCo merges these, of `option` everything.
_BESIDES = frozenset({"visual/global/realtime", "visual/map/znear", "visual/map/zfar"})
_ROOM = ("memory", "njmax")
_FLAG = "option/flag/"


def submodel_options(linking: Linking) -> None:
    """Write into every such unit what it has alone. A model of one unit is left to MuJoCo.

    >>> from composer.link.example import after
    >>> part = (
    ...     '<compiler conflict="merge"/><asset><model name="m" file="m.xml"/></asset>'
    ...     '<worldbody><attach model="m" body="b" prefix="q/"/></worldbody>'
    ... )
    >>> model = '<mujoco><option timestep="0.004"/><worldbody><body name="b"/></worldbody></mujoco>'
    >>> after(submodel_options, part, files={"m.xml": model})
    part: <option timestep="0.004"/>
    """
    for unit in linking.units if linking.parts else ():
        _adopt(unit)


def _adopt(unit: Unit) -> None:
    said = [each for each in unit.root.iterchildren("compiler") if each.get("conflict")]
    # Without it MuJoCo 4.0 only warns: "parent has 0.002 (default), child has 0.004, keeping parent value".
    if not said or said[-1].get("conflict") != "merge":
        return
    models: dict[str, Unit] = {}
    for element in unit.root.iterfind("asset/model"):
        sub = _read(unit, str(element.get("file") or ""))
        if sub is not None:
            _adopt(sub)
            models[str(element.get("name") or sub.model)] = sub
    for attach in unit.root.iter("attach"):
        found = models.get(str(attach.get("model")))
        if found is not None:
            _merge(unit, found, said[-1])


def _read(unit: Unit, file: str) -> Unit | None:
    """Return a sub-model, or None if it has errors, which are reported when it is bundled."""
    known = unit.contents.get(file) if file else None
    if isinstance(known, bytes):
        return parse_held(unit, file, known, Sink())
    path = known or Path(join(str(unit.directory), file))
    return parse_file(path, Sink(), door=door_of_submodel(unit, path, known)) if file else None


def _merge(unit: Unit, sub: Unit, compiler: Node) -> None:
    have = written(unit)
    for path, wanted in written(sub).items():
        own = have.get(path)
        if path.startswith(_FLAG):
            value = None if wanted.value == default_of(path) else wanted.value
        elif path.startswith("option/") or (path in _BESIDES and own is None):
            value = merged(path, own, wanted)
        else:
            value = None
        if value is not None:
            _write(unit, path, value, compiler)
    for size in sub.root.iterchildren("size"):
        for name in _ROOM:
            if size.get(name) and not any(each.get(name) for each in unit.root.iterchildren("size")):
                _write(unit, f"size/{name}", str(size.get(name)), compiler)


def _write(unit: Unit, path: str, value: str, compiler: Node) -> None:
    """Write a setting. For messages, a new section has the place of the unit's own setting."""
    tag = path.split("/")[0]
    new = next(unit.root.iterchildren(tag), None) is None
    set_value(unit, path, value)
    if new:
        set_line(next(unit.root.iterchildren(tag)), line_of(compiler))
