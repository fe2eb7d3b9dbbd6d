from __future__ import annotations

from pathlib import Path

from composer.context import Context
from composer.engine import Limits
from composer.steps.measure import measure_with
from composer.tree.parse import parse_text

TEXT = """\
<mujoco>
  <worldbody>
    <body name="b">
      <joint/>
      <geom name="g"
            {size}/>
    </body>
  </worldbody>
</mujoco>
"""


def measured(
    tmp_path: Path, size: str, limits: Limits | None = None
) -> tuple[dict[str, list[float]], Context]:
    context = Context(environment={}, folder=tmp_path)
    unit = parse_text(TEXT.format(size=size), context.sink, file="a.xml", directory=tmp_path, label="a")
    assert unit is not None
    return dict(measure_with(context, limits)(unit, ("body_mass", "nq"))), context


def test_arrays_and_sizes(tmp_path: Path) -> None:
    found, context = measured(tmp_path, 'type="box" size="0.5 0.5 0.5" density="2"')
    assert found["nq"] == [1] and found["nv"] == [1] and found["body_mass"] == [0, 2]
    assert context.sink.diagnostics == []


def test_a_refusal_is_told_at_its_element(tmp_path: Path) -> None:
    found, context = measured(tmp_path, 'type="box"')
    assert found == {}
    (fault,) = context.sink.diagnostics
    assert (
        fault.code == "mujoco-rejects"
        and fault.message == "MuJoCo rejects the geom `g`: size 0 must be positive in geom"
    )
    assert str(fault.span) == "a.xml:5:7"


def test_no_verdict_is_told_as_such(tmp_path: Path) -> None:
    found, context = measured(tmp_path, 'size="1"', Limits(seconds=1e-4))
    assert found == {}
    assert [each.code for each in context.sink.diagnostics] == ["mujoco-timeout"]
