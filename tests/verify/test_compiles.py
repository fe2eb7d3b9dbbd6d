from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError
from composer.mujoco_errors.message import Fault
from composer.verify.compiles import verify


@pytest.fixture(scope="module")
def session() -> Iterator[engine.Session]:
    with engine.Session(engine.Limits(seconds=60)) as session:
        yield session


def model(text: str) -> Bundle:
    return Bundle({"model.xml": text.encode()})


def test_a_model_that_compiles(session: engine.Session) -> None:
    verified = verify(model('<mujoco><worldbody><body name="b"/></worldbody></mujoco>'), session=session)
    assert verified.ok
    assert (verified.error, verified.crash, verified.code, verified.warnings) == (None, None, None, ())
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
        (
            '<mujoco>\n<worldbody>\n<geom size="-1" name="g"/></worldbody></mujoco>',
            3,
            None,
            "g",
            "must be positive",
        ),
        ('<mujoco>\n<worldbody>\n<geom siz="1"/></worldbody></mujoco>', 3, "geom", None, "'siz'"),
        ('<mujoco>\n<worldbody>\n<geom size="a"/></worldbody></mujoco>', 3, "geom", None, "'size'"),
        ("<mujoco>\n<worldbody>\n<geom", 3, "geom", None, "not well-formed XML"),
        ('<mujoco>\n<actuator>\n<motor name="m" joint="j"/></actuator></mujoco>', 3, None, "m", "'j'"),
        ('<mujoco>\n<worldbody>\n<geom class="c"/></worldbody></mujoco>', 3, "geom", None, "'c'"),
        (
            '<mujoco><worldbody><body name="b">\n<freejoint/></body></worldbody></mujoco>',
            1,
            None,
            "b",
            "mass",
        ),
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
    assert verified.warnings == (Fault("XML contains a 'NaN'. Please check it carefully."),)


def test_a_first_step_that_fails_is_an_error(session: engine.Session) -> None:
    text = """<mujoco><option gravity="nan 0 0"/><worldbody><body><joint/><geom size="1"/></body></worldbody>
      </mujoco>"""
    verified = verify(model(text), session=session)
    assert verified.code == "mujoco-rejects"
    assert verified.error == Fault(
        "the model compiles, but its first forward step fails: `qacc` is not finite"
    )


def test_a_model_that_takes_too_long() -> None:
    text = '<mujoco><worldbody><replicate count="100000000"><geom size="1"/></replicate></worldbody></mujoco>'
    verified = verify(model(text), limits=engine.Limits(seconds=1))
    assert (verified.code, verified.crash) == ("mujoco-timeout", "timeout")
    assert verified.error == Fault("MuJoCo did not finish within 1 s")


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
