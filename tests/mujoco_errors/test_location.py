from __future__ import annotations

from pathlib import Path

from composer.context import Context
from composer.stages import Request, build


def test_an_attribute_that_is_written_nowhere_is_reported_at_the_element(tmp_path: Path) -> None:
    """A texture that is neither a skybox nor named: MuJoCo asks for `name`, which has no default."""
    texture = '<texture type="2d" builtin="flat" width="8" height="8"/>'
    model = f"<mujoco>\n<asset>{texture}</asset>\n<worldbody><geom size='1'/></worldbody>\n</mujoco>"
    (tmp_path / "a.xml").write_text(model)
    (tmp_path / "a.yaml").write_text("recipe: 1\nbase: ./a.xml\n")
    context = Context(folder=tmp_path)
    assert build(Request(tmp_path / "a.yaml"), context) is None
    (fault,) = context.sink.errors
    assert fault.span is not None and (fault.span.file, fault.span.line) == ("a.xml", 2)
