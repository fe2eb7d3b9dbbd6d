from __future__ import annotations

from lxml import etree

from composer.tree.order import place_of


def places(*tags: str) -> list[str]:
    """The sections of a model, the last one put where it belongs."""
    root = etree.fromstring("<mujoco>" + "".join(f"<{tag}/>" for tag in tags[:-1]) + "</mujoco>")
    root.insert(place_of(root, tags[-1]), etree.Element(tags[-1]))
    return [str(child.tag) for child in root]


def test_in_the_order_of_the_reference() -> None:
    assert places("compiler") == ["compiler"]
    assert places("worldbody", "option") == ["option", "worldbody"]
    assert places("compiler", "worldbody", "actuator", "asset") == [
        "compiler",
        "asset",
        "worldbody",
        "actuator",
    ]
    assert places("worldbody", "sensor", "tendon") == ["worldbody", "tendon", "sensor"]
    assert places("option", "worldbody", "option") == ["option", "option", "worldbody"]


def test_behind_what_comes_before_it_however_the_file_is_ordered() -> None:
    assert places("actuator", "worldbody", "asset", "default") == [
        "default",
        "actuator",
        "worldbody",
        "asset",
    ]
    assert places("worldbody", "compiler", "default") == ["worldbody", "compiler", "default"]
    assert places("worldbody", "unheard_of") == ["worldbody", "unheard_of"]
