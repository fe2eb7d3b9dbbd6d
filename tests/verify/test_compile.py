"""What the MuJoCo that judged a model passes over is told by the version of that MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import mujoco
import pytest
from lxml import etree
from mjcompose.bundle.bundle import Bundle, OutputError
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import EngineMessage
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.verify import compile
from mjcompose.verify.compile import unmoved_flexes, verify

# An attribute of MuJoCo 4.0, which older ones pass over inside a frame and refuse elsewhere.
NEW = '<mujoco><worldbody>{}<frame><body><geom size=".1" castshadow="false"/></body></frame></worldbody></mujoco>'


def told(folder: Path, monkeypatch: pytest.MonkeyPatch, version: str | None, model: str) -> list[str]:
    """Codes and messages that are reported where a MuJoCo of that version compiled the model."""
    verdict = SimpleNamespace(
        warnings=(), error=None, code=None, crash=None, compiled=SimpleNamespace(mujoco_version=version, names=None)
    )
    (folder / "m.xml").write_text(model)
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=folder)
    built = build(ModelRequest(Path("r.yaml"), verified=False), context)
    assert built is not None
    monkeypatch.setattr(compile, "verify", lambda *_, **__: verdict)
    judged = compile.compile_and_report(built.bundle, built.composed.model, context, session=cast(Session, None))
    assert judged is cast(Any, verdict.compiled)
    return [f"{each.severity.name}: {each.code}" for each in context.sink.sorted() if each.code != "license-missing"]


@pytest.mark.parametrize(
    ("version", "model", "said"),
    [
        ("4.0.0", NEW.format(""), []),
        ("3.12.0", NEW.format(""), ["WARNING: unknown-attribute"]),
        ("99.0.0", NEW.format("").replace("castshadow", "new_in_99"), []),
        (None, NEW.format(""), ["WARNING: unknown-attribute"]),
    ],
    ids=["has it", "has it not", "newer than the grammar", "nobody knows which"],
)
def test_an_attribute_inside_a_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str | None, model: str, said: list[str]
) -> None:
    assert told(tmp_path, monkeypatch, version, model) == said


@pytest.fixture(scope="module")
def session() -> Iterator[engine.Session]:
    with engine.Session(engine.RequestLimits(seconds=60)) as session:
        yield session


def model(text: str) -> Bundle:
    return Bundle({"model.xml": text.encode()})


def test_a_model_that_compiles(session: engine.Session) -> None:
    verified = verify(model('<mujoco><worldbody><body name="b"/></worldbody></mujoco>'), session=session)
    assert verified.ok
    assert (verified.error, verified.crash, verified.warnings) == (None, None, ())
    assert verified.compiled.index is not None
    assert verified.compiled.index.bodies == ("world", "b")


def test_the_files_of_the_bundle_are_beside_the_model(session: engine.Session) -> None:
    mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    text = """<mujoco><asset><mesh name="m" file="assets/left/t.obj"/></asset>
      <worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"""
    verified = verify(Bundle({"model.xml": text.encode(), "assets/left/t.obj": mesh}), session=session)
    assert verified.ok, verified.error


# what MuJoCo says today about real faults; a change of its wording shows here
@pytest.mark.parametrize(
    ("text", "line", "element", "name", "part"),
    [
        ('<mujoco>\n<worldbody>\n<geom size="-1" name="g"/></worldbody></mujoco>', 3, None, "g", "must be positive"),
        ('<mujoco>\n<worldbody>\n<geom siz="1"/></worldbody></mujoco>', 3, "geom", None, "'siz'"),
        ('<mujoco>\n<worldbody>\n<geom size="a"/></worldbody></mujoco>', 3, "geom", None, "'size'"),
        ("<mujoco>\n<worldbody>\n<geom", 3, "geom", None, "not well-formed XML"),
        ('<mujoco>\n<actuator>\n<motor name="m" joint="j"/></actuator></mujoco>', 3, None, "m", "'j'"),
        ('<mujoco>\n<worldbody>\n<geom class="c"/></worldbody></mujoco>', 3, "geom", None, "'c'"),
        ('<mujoco><worldbody><body name="b">\n<freejoint/></body></worldbody></mujoco>', 1, None, "b", "mass"),
        ('<mujoco><asset>\n<mesh name="m" file="m.stl"/></asset></mujoco>', None, None, None, "'m.stl'"),
    ],
)
def test_a_model_that_mujoco_refuses(
    session: engine.Session, text: str, line: int | None, element: str | None, name: str | None, part: str
) -> None:
    verified = verify(model(text), session=session)
    assert not verified.ok
    assert verified.code == "mujoco-rejects"
    assert verified.error is not None
    assert part in verified.error.message
    assert "\n" not in verified.error.message
    assert (verified.error.line, verified.error.element, verified.error.name) == (line, element, name)


def test_warnings_are_taken_apart(session: engine.Session) -> None:
    verified = verify(model('<mujoco><keyframe><key time="nan"/></keyframe></mujoco>'), session=session)
    assert verified.ok
    assert verified.warnings == (EngineMessage("XML contains a 'NaN'. Please check it carefully."),)


def test_a_first_step_that_fails_is_an_error(session: engine.Session) -> None:
    text = """<mujoco><option gravity="nan 0 0"/><worldbody><body><joint/><geom size="1"/></body></worldbody>
      </mujoco>"""
    verified = verify(model(text), session=session)
    assert verified.code == "mujoco-rejects"
    assert verified.error == EngineMessage("the model compiles, but its first forward step fails: `qacc` is not finite")


def test_a_model_that_takes_too_long() -> None:
    text = '<mujoco><worldbody><replicate count="100000000"><geom size="1"/></replicate></worldbody></mujoco>'
    verified = verify(model(text), limits=engine.RequestLimits(seconds=1))
    assert (verified.code, verified.crash) == ("mujoco-timeout", "timeout")
    assert verified.error == EngineMessage("MuJoCo did not finish within 1 s")


def test_a_model_that_crashes_mujoco() -> None:
    text = """<mujoco><asset><model name="m" file="model.xml"/></asset>
<worldbody><attach model="m"/></worldbody></mujoco>"""
    verified = verify(model(text))
    assert not verified.ok
    assert verified.code in ("mujoco-crash", "mujoco-rejects")


def test_without_mujoco(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mujoco.py").write_text("raise ImportError('gone')")
    monkeypatch.syspath_prepend(tmp_path)
    verified = verify(model("<mujoco/>"))
    assert (verified.code, verified.crash) == ("mujoco-missing", "missing")


def test_a_bundle_that_cannot_be_staged_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    with pytest.raises(OutputError) as caught:
        verify(model("<mujoco/>"))
    assert caught.value.code == "output-unwritable"
    assert "a temporary folder" in caught.value.message


FLEX = '<flexcomp name="f" type="grid" count="3 2 1" spacing=".1 .1 .1" dim="2" radius=".01"/>'


@pytest.mark.parametrize(
    ("inside", "found"),
    [
        (FLEX, []),
        (f'<frame childclass="c">{FLEX}</frame>', []),
        (f'<frame pos="1 2 3">{FLEX}</frame>', ["f"]),
        (f'<frame euler="1 2 3"><replicate count="2"><frame>{FLEX}</frame></replicate></frame>', ["f"]),
        (f'<frame pos="1 2 3"><body>{FLEX}</body></frame>', []),
    ],
)
def test_in_a_frame_with_a_pose(inside: str, found: list[str]) -> None:
    root = etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    assert [flex.get("name") for flex in unmoved_flexes(root, "3.16.0")] == found
    assert not [*unmoved_flexes(root, "4.0.0"), *unmoved_flexes(root, None)]


def test_that_is_what_mujoco_does() -> None:
    text = f'<mujoco><worldbody><frame pos="1 2 3">{FLEX}</frame></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    moved = float(model.body_pos[1][1]) > 1
    assert moved != bool([*unmoved_flexes(etree.fromstring(text), mujoco.__version__)])
