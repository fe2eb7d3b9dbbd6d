from __future__ import annotations

from pathlib import Path

import pytest

from composer.context import Context
from composer.engine import Limits
from composer.link.measure import measure_with
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
    # MuJoCo has far more to do than it is given time for, however busy the machine is.
    many = 'size="1"/><replicate count="19000" offset="1 0 0"><geom size="1"/></replicate><geom size="1"'
    found, context = measured(tmp_path, many, Limits(seconds=0.05))
    assert found == {}
    assert [each.code for each in context.sink.diagnostics] == ["mujoco-timeout"]


MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
OF_MESH = """<mujoco><compiler meshdir="{folder}"/><asset><mesh file="a.obj"/></asset>
<worldbody><body name="b"><joint type="ball"/><geom type="mesh" mesh="a"/></body></worldbody></mujoco>"""


def weighed(text: str, folder: Path, contents: dict[str, bytes | Path]) -> tuple[list[float], Context]:
    """The masses of bodies, of a unit some of whose files are not beside it."""
    context = Context(environment={}, folder=folder)
    unit = parse_text(
        text, context.sink, file="a.xml", directory=folder / "model", label="a", contents=contents
    )
    assert unit is not None
    return list(measure_with(context)(unit, ("body_mass",)).get("body_mass", [])), context


@pytest.mark.parametrize("folder", ["", "assets/arm/", "../m/", "../../m/"])
@pytest.mark.parametrize("kept", ["in memory", "elsewhere"])
def test_files_that_are_not_beside_the_unit_are_found(tmp_path: Path, folder: str, kept: str) -> None:
    elsewhere = tmp_path / "somewhere else.txt"
    elsewhere.write_text(MESH)
    content = MESH.encode() if kept == "in memory" else elsewhere
    masses, context = weighed(OF_MESH.format(folder=folder), tmp_path, {f"{folder}a.obj": content})
    assert masses == pytest.approx([0, 1000 / 6])
    assert context.sink.diagnostics == []
    assert sorted(tmp_path.iterdir()) == [elsewhere]


def test_files_may_be_in_memory_and_beside_the_unit(tmp_path: Path) -> None:
    text = OF_MESH.format(folder="").replace("</asset>", '<mesh file="d/b.obj"/></asset>')
    (tmp_path / "model" / "d").mkdir(parents=True)
    (tmp_path / "model" / "d" / "b.obj").write_text(MESH)
    masses, context = weighed(text, tmp_path, {"a.obj": MESH.encode()})
    assert masses == pytest.approx([0, 1000 / 6])
    assert context.sink.diagnostics == []


def test_a_file_that_is_nowhere_is_told(tmp_path: Path) -> None:
    masses, context = weighed(OF_MESH.format(folder=""), tmp_path, {"a.obj": tmp_path / "gone.obj"})
    assert masses == []
    assert [each.code for each in context.sink.diagnostics] == ["mujoco-rejects"]
