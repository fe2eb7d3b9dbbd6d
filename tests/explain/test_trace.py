"""What the onlooker sees is all that happens, and its looking changes nothing."""

from __future__ import annotations

from pathlib import Path

from composer.compose.compose import Composer
from composer.context import Context
from composer.explain.trace import TAG, Change, Life
from composer.explain.traced import Traced
from composer.stages import Request, build
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
