from __future__ import annotations

from tree.editing import Tree

from composer.tree.renaming import NewName, Renaming

SHEET = (
    '<mujoco><worldbody><body name="a"/><body name="b"/><replicate count="2"><site name="pad"/></replicate></worldbody>'
    '<deformable><flex name="f" body="a b a c"/></deformable>'
    '<contact><exclude name="e" body1="a" body2="b"/></contact>'
    '<sensor><framepos objtype="site" objname="pad1"/><framepos objtype="site" objname="padding"/></sensor></mujoco>'
)
SCENE = (
    '<mujoco><worldbody><body name="a"/></worldbody><contact><exclude body1="a" body2="sheet/a"/></contact>'
    '<sensor><framepos objtype="site" objname="sheet/pad0"/></sensor></mujoco>'
)


def _renamed(tree: Tree, *names: tuple[str, str, str]) -> None:
    Renaming.of([NewName(tree, *each) for each in names]).carry_out()


def test_two_names_change_places_in_a_list_too() -> None:
    tree = Tree(SHEET)
    _renamed(tree, ("body", "a", "b"), ("body", "b", "a"))
    assert tree.find("deformable/flex").get("body") == "b a b c"
    assert dict(tree.find("contact/exclude").attrib) == {"name": "e", "body1": "b", "body2": "a"}
    assert [len(tree.names.users("body", name)) for name in "abc"] == [2, 2, 1]


def test_copies_that_a_replicate_makes_follow_and_other_names_do_not() -> None:
    tree = Tree(SHEET)
    _renamed(tree, ("site", "pad", "tip"))
    assert [each.get("objname") for each in tree.find("sensor")] == ["tip1", "padding"]


def test_models_above_follow_with_the_prefix() -> None:
    scene = Tree(SCENE)
    tree = Tree(SHEET, scene, "sheet/")
    _renamed(tree, ("body", "a", "x"), ("site", "pad", "tip"))
    assert dict(scene.find("contact/exclude").attrib) == {"body1": "a", "body2": "sheet/x"}
    assert scene.find("sensor/framepos").get("objname") == "sheet/tip0"


def test_a_new_prefix_leaves_a_model_its_own_names() -> None:
    scene = Tree(SCENE.replace('name="a"', 'name="sheet/b"').replace('"a"', '"sheet/b"'))
    Renaming.of_prefix(scene, "sheet/", "cloth/").carry_out()
    assert dict(scene.find("contact/exclude").attrib) == {"body1": "sheet/b", "body2": "cloth/a"}


def test_a_name_with_a_space_cannot_stand_in_a_list() -> None:
    tree = Tree(SHEET)
    ((reference, new),) = Renaming.of([NewName(tree, "body", "b", "two words")]).unlistable()
    assert (reference.node.tag, reference.attribute, reference.name, new) == (
        "flex",
        "body",
        "b",
        "two words",
    )
    assert not list(Renaming.of([NewName(tree, "site", "pad", "two words")]).unlistable())
