"""What the onlooker sees is all that happens, and its looking changes nothing."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path

from composer.compose.compose import Composer
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.explain.trace import TAG, Change, Life, Trace
from composer.explain.traced import Traced
from composer.stages import Request, build
from composer.tree.parse import parse_text
from composer.tree.watch import nobody
from composer.tree.write import write


def test_a_model_is_the_same_with_an_onlooker(recipe: Path, traced: Traced) -> None:
    built = build(Request(recipe, verified=False), Context(environment={}, folder=recipe.parent))
    assert built is not None
    assert write(traced.model.root) == built.bundle.files["model.xml"]


def test_the_changes_lead_from_what_was_read_to_what_is_there(traced: Traced) -> None:
    for node in traced.model.root.iter("*"):
        life = traced.watch.life(node)
        assert _replayed(life) == (str(node.tag), {str(name): str(text) for name, text in node.items()})


def _replayed(life: Life) -> tuple[str, dict[str, str]]:
    tag, attributes = life.tag, dict(life.attributes)
    if len(life.sources) == 1:
        tag, attributes = _replayed(life.sources[0])
    for change in life.changes:
        if not isinstance(change, Change):
            continue
        if change.attribute == TAG:
            assert tag == change.before
            tag = str(change.after)
            continue
        assert attributes.get(change.attribute) == change.before
        if change.after is None:
            del attributes[change.attribute]
        else:
            attributes[change.attribute] = change.after
    return tag, attributes


def test_a_build_has_no_onlooker() -> None:
    assert Composer(Context(), None).watch is nobody


def test_an_equal_element_in_the_place_of_another_is_another() -> None:
    text = b'<mujoco><worldbody><geom name="a" size="1"/><geom name="b" size="1"/></worldbody></mujoco>'
    unit = parse_text(text, Sink(), file="model.xml", directory=Path(), label="model")
    assert unit is not None
    trace = Trace()
    trace([unit], "read")
    world = unit.root[0]
    old = world[0]
    world.replace(old, new := deepcopy(old))
    trace([unit], "replaced")
    trace([unit], "left alone")
    assert [life.node for life in trace.gone] == [old] and trace.life(new).born.done == "replaced"
    assert trace.life(world[1]).changes == []
    world.append(world[0])
    trace([unit], "moved")  # nothing has changed in the element, and its parent is the same
    assert trace.life(new).changes == []
    world[0].set("size", "2")
    trace([unit], "set")
    assert [each.cause.done for each in trace.life(world[0]).of("size")] == ["set"]
