from __future__ import annotations

import pytest
from grammar.keywords import keywords_in

from composer.grammar import GRAMMAR


@pytest.mark.parametrize(
    ("path", "name", "separated"),
    [
        ("geom", "size", True),
        ("geom", "mass", False),
        ("geom", "material", False),
        ("flex", "body", True),
        ("camera", "output", True),
        ("keyframe/key", "qpos", True),
        ("compiler", "eulerseq", False),
    ],
)
def test_separated(path: str, name: str, separated: bool) -> None:
    assert GRAMMAR.element(path).attributes[name].separated is separated


def test_lengths() -> None:
    geom = GRAMMAR.element("geom").attributes
    assert (geom["size"].min_length, geom["size"].max_length) == (1, 3)
    assert (geom["rgba"].min_length, geom["rgba"].max_length) == (4, 4)
    assert (geom["mass"].min_length, geom["mass"].max_length) == (1, 1)
    assert (geom["user"].min_length, geom["user"].max_length) == (1, None)
    assert (geom["name"].min_length, geom["name"].max_length) == (None, None)
    assert GRAMMAR.element("frame").attributes["scale"].lengths == (1, 3)
    assert GRAMMAR.element("compiler").attributes["eulerseq"].max_length == 3


def test_keywords_by_version() -> None:
    integrator = GRAMMAR.element("option").attributes["integrator"]
    assert "discrete" in keywords_in(integrator, "3.13.0")
    assert "discrete" not in keywords_in(integrator, "3.12.0")
    equality = GRAMMAR.element("flexcomp/edge").attributes["equality"]
    assert "vert" in keywords_in(equality, "3.17.0")
    assert "vert" not in keywords_in(equality, "4.0.0")
    cone = GRAMMAR.element("option").attributes["cone"]
    assert keywords_in(cone, "3.12.0") == cone.keywords == ("pyramidal", "elliptic")


def test_exists_in() -> None:
    springyield = GRAMMAR.element("joint").attributes["springyield"]
    assert springyield.exists_in("4.0.0")
    assert not springyield.exists_in("3.17.0")


def test_files_have_a_folder() -> None:
    texture = GRAMMAR.element("texture").attributes
    files = {name for name, attribute in texture.items() if attribute.type == "file"}
    assert len(files) == 7
    assert {texture[name].folder for name in files} == {"texture"}


def test_defaults_are_plain_values() -> None:
    geom = GRAMMAR.element("geom").attributes
    assert geom["friction"].default == (1, 0.005, 0.0001)
    assert geom["density"].default == 1000
    assert geom["type"].default == "sphere"
    assert geom["castshadow"].default is True
    assert geom["mass"].default is None
