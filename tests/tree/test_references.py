from __future__ import annotations

from tree.editing import Tree

from composer.tree.references import resolves, unresolved

ARM = (
    '<mujoco><worldbody><body name="a"><site name="tip"/></body><replicate count="2"><body name="pad"/></replicate>'
    "</worldbody></mujoco>"
)


def test_what_exists_always_and_what_mujoco_may_make_resolves() -> None:
    tree = Tree(ARM)
    assert (
        resolves(tree, "body", "a") and resolves(tree, "body", "world") and resolves(tree, "default", "main")
    )
    assert resolves(tree, "body", "pad1")
    assert not resolves(tree, "site", "world") and not resolves(tree, "site", "a")


def test_the_nearest_name_is_the_help() -> None:
    found = unresolved(Tree(ARM), "site", "tpi", None, written="site: {}")
    assert found.help == "did you mean `site: tip`?" and found.subjects == {"tpi"}
    assert [note.message for note in found.notes] == ["sites that exist: tip"]


def test_a_name_of_another_kind_is_said() -> None:
    found = unresolved(Tree(ARM), "joint", "tip", None)
    assert [note.message for note in found.notes] == ["`tip` is a site", "there are no joints"]
    assert found.help is None


def test_the_type_beside_it_is_the_help_where_there_is_one() -> None:
    found = unresolved(Tree(ARM), "geom", "tip", None, typed_by="objtype")
    assert found.help == "`tip` is a site: write `objtype: site`"
