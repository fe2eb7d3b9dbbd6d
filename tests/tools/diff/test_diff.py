"""Pictures of both models. They need OpenGL, and skip where there is none."""

from __future__ import annotations

import json
import shutil
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest
from mjcompose.bundle.write import write
from mjcompose.cli.options import Choices
from mjcompose.contrast.changes import Diff
from mjcompose.contrast.text import as_data, render, render_markdown as in_markdown
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff

CASES = Path(__file__).parent / "cases"


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


def _diff(name: str, session: Session, **wanted: object) -> Diff:
    context = Context(folder=CASES / name)
    found = diff("a/recipe.yaml", "b/recipe.yaml", context, session, **wanted)  # type: ignore[arg-type]
    assert found is not None, context.sink.diagnostics
    return found


def test_only_what_was_asked_for(session: Session) -> None:
    found = _diff("sources", session, only=("actuator",))
    assert {each.kind for group in found.groups for each in group.changes} == {"actuator"}
    assert not found.contrast.counts and not found.same
    assert _diff("sources", session, only=("camera", "address")).same
    assert [each.name for each in _diff("part_added", session, only=("address",)).contrast.moves] == ["gripper/grip"]
    assert _diff("sections", session, only=("visual",)).groups[0].changes[0].kind == "visual/map"


def test_tolerance(session: Session) -> None:
    told = [each.field for group in _diff("sources", session, tolerance=0.3).groups for each in group.changes]
    assert "dof_damping" in told and "kp" in told and "body_mass" not in told
    found = _diff("sources", session, tolerance=10)
    assert found.same and not found.contrast.identical
    assert "not equal bit for bit" in render(found)


def test_everything_is_told_when_asked_for(session: Session) -> None:
    short, long = (_diff("sources", session, everything=each) for each in (False, True))
    assert short.follows > 0 and long.follows == 0
    counts = [sum(len(group.changes) for group in found.groups) for found in (short, long)]
    assert counts[1] == counts[0] + short.follows


def test_another_order_is_addresses_and_nothing_else(session: Session, tmp_path: Path) -> None:
    """The sums that MuJoCo makes in another order differ in their last bits, which nobody wants to be told."""
    bodies = [
        f'<body name="{name}" pos="{at} 0 0"><joint name="{name}"/><geom size="0.1" mass="{mass}"/></body>'
        for at, (name, mass) in enumerate({"a": 0.1, "b": 0.7, "c": 3.3}.items())
    ]
    for name, order in (("one.xml", bodies), ("two.xml", bodies[::-1])):
        (tmp_path / name).write_text(f"<mujoco><worldbody>{''.join(order)}</worldbody></mujoco>")
    found = diff("one.xml", "two.xml", Context(folder=tmp_path), session)
    assert found is not None
    assert not found.groups and found.contrast.moves
    assert "different: only addresses\n" in render(found)
    assert "**Different: only addresses.**" in in_markdown(found)
    assert not found.same


def test_a_bundle_and_the_recipe_that_it_is_of(session: Session, tmp_path: Path) -> None:
    built = build(
        ModelRequest(CASES / "sources" / "a" / "recipe.yaml"), context := Context(folder=tmp_path), session=session
    )
    assert built is not None, context.sink.diagnostics
    write(built.bundle, str(tmp_path / "old.zip"), environment={}, session=session)
    write(built.bundle, f"{tmp_path / 'old'}/", environment={}, session=session)
    recipe = str(CASES / "sources" / "a" / "recipe.yaml")
    for end in ("old.zip", "old"):
        found = diff(end, recipe, context, session)
        assert found is not None and found.same and found.same_bytes and found.contrast.identical
    found = diff("old.zip", str(CASES / "sources" / "b" / "recipe.yaml"), context, session)
    assert found is not None and found.files == ("model.xml",)
    cause = found.groups[0].cause
    assert cause is not None and cause.before is not None and cause.before.file == "old.zip/model.xml"


def test_a_mesh_file_of_other_bytes(session: Session, tmp_path: Path) -> None:
    mesh = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    for end, text in (("a", mesh), ("b", mesh.replace("0 0 0.1", "0 0 0.2"))):
        shutil.copytree(CASES / "same" / "a", tmp_path / end)
        hand = tmp_path / end / "hand.xml"
        shell = '<asset><mesh name="shell" file="shell.obj"/></asset>\n  <worldbody>'
        hand.write_text(
            hand.read_text()
            .replace("<worldbody>", shell)
            .replace('type="box" size="0.03 0.03 0.02" mass="0.25"', 'type="mesh" mesh="shell"')
        )
        (tmp_path / end / "shell.obj").write_text(text)
    found = diff("a/recipe.yaml", "b/recipe.yaml", Context(folder=tmp_path), session)
    assert found is not None and found.files == ("assets/hand/shell.obj",)
    text = render(found)
    assert "a/hand.xml:3 → b/hand.xml:3: `assets/hand/shell.obj` has other bytes\n" in text
    assert "mass of body `gripper/palm`: 0.166667 kg → 0.333333 kg (+100 %)" in text
    assert "vertices of mesh `gripper/shell`: 12 of 12 numbers differ, by up to 0." in text
    assert len(found.groups) == 1


def test_values_are_given_to_recipes(session: Session, tmp_path: Path) -> None:
    from mjcompose.base.diagnostic import Span
    from mjcompose.text.node import Scalar

    text = "recipe: 1\nparams: {payload: 1.0}\nadd:\n  - to: world\n    body: {name: box, geom: [{type: box, size: [1, 1, 1], mass: '${payload}'}]}\n"
    (tmp_path / "a.yaml").write_text(text)
    (tmp_path / "b.yaml").write_text(text.replace("'${payload}'", "'${2 * payload}'"))
    given = {"payload": Scalar(3, Span("--set payload", 1, 1), "3", True)}
    found = diff("a.yaml", "b.yaml", Context(folder=tmp_path), session, given=given)
    assert found is not None and "mass of body `box`: 3 kg → 6 kg (+100 %)" in render(found)


@pytest.mark.parametrize(
    ("name", "text", "code"),
    [
        ("gone.yaml", None, "file-not-found"),
        ("a.txt", "", "source-kind"),
        ("a.xml", "<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "mujoco-rejects"),
        ("b.xml", "<mujoco", "xml-syntax"),
        ("a.zip", "no zip", "file-unreadable"),
        ("a.yaml", "recipe: 1\nbas: x\n", "unknown-key"),
        ("nowhere:a.yaml", None, "git-revision"),
    ],
)
def test_faults(name: str, text: str | None, code: str, session: Session, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    good = str(CASES / "same" / "a" / "recipe.yaml")
    for ends in ((name, good), (good, name)):
        context = Context(folder=tmp_path)
        assert diff(*ends, context, session) is None
        assert [each.code for each in context.sink.diagnostics] == [code]


def test_as_data(session: Session) -> None:
    data = json.loads(json.dumps(as_data(_diff("sources", session))))
    assert data["same"] is False and data["identical"] is False and data["b"]["kind"] == "recipe"
    changes = {
        (each["name"], each["field"]): (each, group["cause"]) for group in data["groups"] for each in group["changes"]
    }
    change, cause = changes["gripper/palm", "body_mass"]
    assert change == {
        "what": "changed",
        "kind": "body",
        "name": "gripper/palm",
        "quantity": "mass",
        "field": "body_mass",
        "before": 0.25,
        "after": 0.3,
        "unit": "kg",
        "relative": pytest.approx(0.2),
    }
    assert (cause["before"]["file"], cause["before"]["line"]) == ("a/hand.xml", 5)
    assert data["counts"][-1]["name"] == "total mass"


def test_as_markdown(session: Session) -> None:
    text = in_markdown(_diff("sources", session))
    assert text.startswith("### `a/recipe.yaml` → `b/recipe.yaml`\n\n**Different: 9 changes at 6 places.**\n")
    assert '```diff\n- <joint damping="2" armature="0.1"/>\n+ <joint damping="3" armature="0.1"/>\n```\n' in text
    assert "- mass of body `gripper/palm`: 0.25 kg → 0.3 kg (+20 %)\n" in text
    assert "**The same" in in_markdown(_diff("same", session))


def test_what_only_recipes_have_is_not_passed_over(tmp_path: Path, session: Session) -> None:
    for name in ("a.xml", "b.xml"):
        (tmp_path / name).write_text("<mujoco/>")
    (tmp_path / "c.yaml").write_text("recipe: 1\nparams: {reach: 1}\n")
    given = Choices(("reach=2",), (), ()).values(Context(folder=tmp_path))
    for wanted in ({"given": given}, {"pick": "cell"}):
        context = Context(folder=tmp_path)
        assert diff("a.xml", "b.xml", context, session, **wanted) is None  # type: ignore[arg-type]
        assert "neither `a.xml` nor `b.xml` is a recipe" in context.sink.errors[0].message
    assert diff("a.xml", "c.yaml", Context(folder=tmp_path), session, given=given) is not None


def test_where_files_lie_is_no_difference(tmp_path: Path, session: Session) -> None:
    """MuJoCo keeps their paths in the model, and the memory that it needs with them."""
    for name in ("near", "far/" + "away/" * 40):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "t.obj").write_text(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        )
        (tmp_path / name / "m.xml").write_text(
            '<mujoco><asset><mesh file="t.obj"/></asset><worldbody><geom type="mesh" mesh="t"/></worldbody></mujoco>'
        )
    found = diff("near/m.xml", f"far/{'away/' * 40}m.xml", Context(folder=tmp_path), session)
    assert found is not None and found.same and found.contrast.identical


MODEL = """<mujoco>
  <worldbody>
    <light pos="0 0 3"/>
    <camera name="the whole" pos="0 -2 0" xyaxes="1 0 0 0 0 1"/>
    <camera name="away" pos="0 -2 0" xyaxes="-1 0 0 0 0 1"/>
    <geom name="ball" size="0.2" rgba="{rgba}"/>
  </worldbody>
</mujoco>
"""


def _diff_renders(folder: Path, context: Context) -> Diff | None:
    for name, rgba in (("a", "1 0 0 1"), ("b", "0 0 1 1")):
        (folder / f"{name}.xml").write_text(MODEL.format(rgba=rgba))
    with Session(rendering=True) as session:
        return diff("a.xml", "b.xml", context, session, renders=Path("out"))


def test_every_view_is_a_pair_of_pictures(tmp_path: Path) -> None:
    context = Context(folder=tmp_path)
    found = _diff_renders(tmp_path, context)
    if found is None:
        (fault,) = context.sink.errors
        assert fault.code == "no-rendering" and fault.help
        pytest.skip("there is no OpenGL")
    assert [(each.name, each.differs > 0) for each in found.views] == [
        ("the whole", True),
        ("the whole", True),
        ("away", False),
    ]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(
        f"{stem}-{side}.png" for stem in ("the_whole", "the_whole_2", "away") for side in ("before", "after")
    )
    for view in found.views:
        for name in (view.before, view.after):
            header = (tmp_path / name).read_bytes()[:24]
            assert header[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", header[16:]) == (640, 480)
    assert "away: the same: out/away-before.png, out/away-after.png" in render(found)
    assert "| `away`<br>the same | ![before](<out/away-before.png>) |" in in_markdown(found)


def test_without_opengl_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "disable")
    context = Context(folder=tmp_path)
    assert _diff_renders(tmp_path, context) is None
    (fault,) = context.sink.errors
    assert fault.code == "no-rendering" and "MUJOCO_GL=egl" in str(fault.help)
    assert not (tmp_path / "out").exists()
