"""Keys of one name under every policy: none is lost, none has no counterpart, and what is to stay apart does.

MuJoCo is the judge: it reads what comes out without the help of a verified build.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path

import mujoco
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

POLICIES = ("merge", "prefix", "none")
Row = dict[str, float]
"""What a key says: the positions of joints by name; the others are at their reference."""
Keys = list[tuple[str, Row]]
OWN: Keys = [("home", {"base_joint": 0.5}), ("", {"base_joint": 0.6})]


def model(joint: str, keys: Keys) -> str:
    """A model with one joint that no key leaves at zero; keys without a name have the name `""`."""
    written = "".join(f'<key name="{name}" qpos="{row[joint]}"/>' for name, row in keys)
    return (
        f'<mujoco><worldbody><body name="{joint}_body"><joint name="{joint}" ref="30"/><geom size=".1"/>'
        f"</body></worldbody><keyframe>{written}</keyframe></mujoco>"
    )


@dataclass
class Expected:
    """What the pages promise, worked out by hand: keys of one name are one key, but for those kept apart."""

    written: Keys = field(default_factory=list)
    keys: Keys = field(default_factory=list)
    apart: set[str] = field(default_factory=set)
    clashes: bool = False

    def come(self, policy: str, prefix: str, keys: Keys) -> None:
        """The keys of one more model come along."""
        if policy != "none":
            for name, row in keys:
                final = prefix + name if policy == "prefix" and name else name
                inside = {prefix + joint: value for joint, value in row.items()}
                earlier = next((each for each in self.keys if each[0] == final), None) if final else None
                if earlier is None:
                    self.keys.append((final, inside))
                else:
                    self.clashes |= (policy == "prefix" or final in self.apart) and final not in dict(self.written)
                    earlier[1].update(inside)
                if policy == "prefix":
                    self.apart.add(final)

    def final(self) -> Keys:
        """A key of the recipe stands in the place of the one of its name."""
        own = dict(self.written)
        kept = [(name, own.pop(name, row)) for name, row in self.keys]
        return kept + list(own.items())


def judge(folder: Path, recipe: str, files: dict[str, str], expected: Expected | None) -> None:
    for name, text in {**files, "recipe.yaml": f"recipe: 1\n{recipe}"}.items():
        (folder / name).write_text(text)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    if expected is None or expected.clashes:
        assert done is None, recipe
        assert {each.code for each in context.sink.errors} == {"keyframe-conflict"}, recipe
        return
    assert done is not None, (recipe, [each.message for each in context.sink.diagnostics])
    built = mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())
    reference = {built.joint(at).name: float(built.qpos0[at]) for at in range(built.njnt)}
    there = [
        (built.key(key).name, {joint: float(built.key_qpos[key][at]) for at, joint in enumerate(reference)})
        for key in range(built.nkey)
    ]
    assert there == [(name, {**reference, **row}) for name, row in expected.final()], recipe


def kinds_of_keys(joint: str) -> Iterator[Keys]:
    """Two of which the base has one, and one that is called as if a part had been kept apart."""
    yield [("up", {joint: 0.1}), ("home", {joint: 0.2}), ("", {joint: 0.3})]
    yield [("part/home", {joint: 0.4})]


def said(policy: str) -> str:
    """What a recipe says for a policy."""
    return 'drop: [{key: "**", optional: true}]' if policy == "none" else f"keys: {policy}"


@pytest.mark.parametrize("written", [None, "home", "other"])
@pytest.mark.parametrize(("base", "part"), list(product(POLICIES, POLICIES)))
def test_two_parts_on_a_base(tmp_path: Path, base: str, part: str, written: str | None) -> None:
    own: Keys = [(written, {"base_joint": 0.7})] if written else []
    for prefix, copies, keys, second in product(("part/", ""), (1, 2), kinds_of_keys("j"), POLICIES):
        if second == "none" or (second == "prefix" and (written or copies > 1)) or (copies > 1 and not prefix):
            continue
        expected = Expected(own)
        expected.come(base, "", OWN)
        prefixes = [prefix] if copies == 1 else ["part0/", "part1/"]
        for each in prefixes:
            expected.come(part, each, keys)
        others: Keys = [("home", {"k": 0.9})]
        expected.come(second, "second/", others)
        recipe = f"base: {{model: ./base.xml, {said(base)}}}\nattach:\n  part:\n    model: ./part.xml\n"
        recipe += f"    {said(part)}\n"
        recipe += "" if prefix else '    prefix: ""\n'
        recipe += f"    replicate: [{{count: {copies}, offset: [1, 0, 0]}}]\n" if copies > 1 else ""
        recipe += f"  second: {{model: ./second.xml, {said(second)}}}\n"
        recipe += f"keyframe: {{{written}: {{qpos: {{base_joint: 0.7rad}}}}}}\n" if written else ""
        files = {"base.xml": model("base_joint", OWN), "part.xml": model("j", keys)}
        judge(tmp_path, recipe, {**files, "second.xml": model("k", others)}, expected)


@pytest.mark.parametrize(("base", "part"), list(product(POLICIES, POLICIES)))
def test_a_recipe_in_a_recipe(tmp_path: Path, base: str, part: str) -> None:
    keys = next(kinds_of_keys("j"))
    inner_keys = next(kinds_of_keys("k"))
    for inner_base, inner_part, prefix in product(POLICIES, POLICIES, ("part/", "")):
        inner = Expected()
        inner.come(inner_base, "", keys)
        inner.come(inner_part, "hand/", inner_keys)
        expected = Expected()
        expected.come(base, "", OWN)
        expected.come(part, prefix, inner.final())
        recipe = f"base: {{model: ./base.xml, {said(base)}}}\n"
        recipe += f"attach: {{part: {{model: ./inner.yaml, {said(part)}"
        recipe += "}}\n" if prefix else ', prefix: ""}}\n'
        nested = f"recipe: 1\nbase: {{model: ./part.xml, {said(inner_base)}}}\n"
        nested += f"attach: {{hand: {{model: ./hand.xml, {said(inner_part)}}}}}\n"
        files = {"base.xml": model("base_joint", OWN), "part.xml": model("j", keys)}
        files |= {"hand.xml": model("k", inner_keys), "inner.yaml": nested}
        judge(tmp_path, recipe, files, None if inner.clashes else expected)


RENAMES = [
    # What is renamed, the key that the recipe writes, and the keys that there are then (None: names clash).
    ("home: old", None, ["old", "up"]),
    ("home: old", "home", ["home", "up", "old"]),
    ("home: old", "old", None),
    ("up: home", None, None),
    ("up: home", "home", None),
    ("up: old", "home", ["home", "old"]),
    ("up: old", "old", None),
]


@pytest.mark.parametrize(("renamed", "written", "names"), RENAMES)
def test_an_edit_renames_before_the_recipe_writes_its_keys(
    tmp_path: Path, renamed: str, written: str | None, names: list[str] | None
) -> None:
    old, new = renamed.split(": ")
    keys: Keys = [("home", {"j": 0.1}), ("up", {"j": 0.2})]
    (tmp_path / "base.xml").write_text(model("j", keys))
    (tmp_path / "recipe.yaml").write_text(
        f"recipe: 1\nbase: ./base.xml\nedit:\n  - {{select: {{key: {old}}}, rename: {new}}}\n"
        + (f"keyframe: {{{written}: {{qpos: {{j: 0.7rad}}}}}}\n" if written else "")
    )
    context = Context(environment={}, folder=tmp_path)
    done = build(ModelRequest(tmp_path / "recipe.yaml", verified=False), context)
    if names is None:
        assert [(each.code, each.span.line if each.span else 0) for each in context.sink.errors] == [("name-clash", 4)]
        return
    assert done is not None
    built = mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())
    values = dict(keys) | {new: dict(keys)[old]} | ({written: {"j": 0.7}} if written else {})
    assert [(built.key(at).name, built.key_qpos[at][0]) for at in range(built.nkey)] == [
        (name, values[name]["j"]) for name in names
    ]
