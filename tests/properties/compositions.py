"""Random compositions: a random base, parts on random places of it, written as files and a recipe."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import yaml
from feature_cases.members import WHOLE
from hypothesis import strategies as st
from lxml import etree
from properties.elements import Maker
from properties.models import Model, models


@dataclass(frozen=True)
class Composition:
    """Files by name; `recipe.yaml` is the recipe."""

    files: dict[str, str]

    @property
    def recipes(self) -> list[str]:
        return [text for name, text in self.files.items() if name.endswith(".yaml")]

    def write(self, folder: Path) -> Path:
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        return folder / "recipe.yaml"

    def __repr__(self) -> str:
        return "\n".join(f"--- {name}\n{text}" for name, text in self.files.items())


@st.composite
def compositions(draw: Any) -> Composition:
    """One to three parts, some of them compositions of their own, some on one another."""
    random = draw(st.randoms(use_true_random=True))
    files: dict[str, str] = {}
    _recipe(draw, random, files, "", nested=False)
    return Composition(files)


def _recipe(draw: Any, random: Random, files: dict[str, str], stem: str, *, nested: bool) -> Model | None:
    """Write a recipe and its sources; a nested one has one part and no floating ones."""
    make = Maker(random, "")
    base = draw(models(floating=not nested))
    recipe: dict[str, Any] = {
        "recipe": 1,
        "angle": make.pick(("degree", "radian")),
        "base": _source(make, files, f"{stem}base.xml", base.text),
        "attach": {},
    }
    if make.chance(30):
        recipe["eulerseq"] = make.pick(("zyx", "XYZ", "xzX"))
    hosts = [("", base)]
    for number in range(1 if nested else make.pick((1, 2))):
        key = f"p{number}"
        where = make.chance(70)
        host, model = make.pick(hosts)
        part: dict[str, Any] = {}
        floating = False
        places = [("site", model.sites), ("body", model.bodies), ("frame", model.frames)]
        kind, names = make.pick(places)
        if where and names:
            part[kind] = host + make.pick(names)
        else:
            floating = not nested
        if not nested and make.chance(15):
            _recipe(draw, random, files, f"{stem}{key}-", nested=True)
            part["model"] = f"./{stem}{key}-recipe.yaml"
        else:
            own = draw(models(floating=floating))
            part |= _source(make, files, f"{stem}{key}.xml", own.text)
            hosts.append((f"{key}/", own))
        _offset(make, part, recipe)
        if not floating and make.chance(15):
            part["joint"] = make.pick(
                ("ball", {"type": "slide", "axis": [0, 1, 0]}, [{"name": "added", "type": "hinge"}])
            )
        if make.chance(30):
            policy = make.pick(("prefix", "none", "merge"))
            if policy == "none":
                part["drop"] = [{"key": "**", "optional": True}]
            else:
                part["keys"] = policy
        recipe["attach"][key] = part
    files[f"{stem}recipe.yaml"] = yaml.safe_dump(recipe, sort_keys=False)
    return base


def _source(make: Maker, files: dict[str, str], name: str, text: str) -> dict[str, Any]:
    """Write the file of a part; sometimes without its `<compiler>`, whose attributes the recipe then gives."""
    root = etree.fromstring(text)
    compilers = root.findall("compiler")
    written = {str(key): str(value) for each in compilers for key, value in each.items()}
    if not written or not make.chance(30):
        files[name] = text
        return {"model": f"./{name}"}
    for each in compilers:
        root.remove(each)
    files[name] = etree.tostring(root).decode()
    files[f"{WHOLE}{name}"] = text
    return {"model": f"./{name}", "compiler": {key: _value(value) for key, value in written.items()}}


def _value(text: str) -> Any:
    """Return an attribute's value as YAML reads it; several numbers are a list."""
    values = [yaml.safe_load(each) for each in text.split()]
    return values[0] if len(values) == 1 else values


def _offset(make: Maker, part: dict[str, Any], recipe: dict[str, Any]) -> None:
    scale = 170 if recipe["angle"] == "degree" else 3

    def draw(count: int, low: float, high: float) -> list[float]:
        return [make.number(low, high) for _ in range(count)]

    if make.chance(70):
        part["pos"] = draw(3, -1, 1)
    match make.pick(("quat", "euler", "axisangle", "zaxis", "xyaxes", None)):
        case "quat":
            part["quat"] = draw(4, 0.1, 1)
        case "euler":
            part["euler"] = draw(3, -scale, scale)
        case "axisangle":
            part["axisangle"] = [*draw(3, 0.1, 1), *draw(1, -scale, scale)]
        case "zaxis":
            part["zaxis"] = draw(3, 0.1, 1)
        case "xyaxes":
            part["xyaxes"] = [*draw(3, 0.5, 1), *draw(3, -1, -0.2)]
