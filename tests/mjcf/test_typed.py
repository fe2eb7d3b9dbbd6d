"""What a type checker says about programs, and what `dir` and `help` show of the public modules."""

from __future__ import annotations

import inspect
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import mjcompose
import pytest
from mjcompose import mjcf, worlds
from mjcompose.mjcf import elements

_GOOD = """\
from mjcompose import mjcf
from mjcompose.mjcf import elements
import mjcompose

model = mjcf.RootElement()
pendulum = model.worldbody.add("body", name="pendulum", pos=[0, 0, 1])
pendulum.add("joint", name="hinge", type="hinge", axis=[0, 1, 0])
pendulum.add("geom", name="bob", type="sphere", size=[0.05], rgba=[1, 0, 0, 1])
model.actuator.add("motor", name="motor", joint="hinge", gear=[1])
model.compiler.angle = "radian"
model.visual.headlight.ambient = (0.1, 0.2, 0.3)
physics = model.compile_model()
hinge = model.find("joint", name="hinge")
assert hinge is not None
hinge.range = [0, 1]
hinge.limited = True
physics.bind(hinge).qpos = 0.3
pendulum.pos[2] += 0.1
del pendulum.pos
print(pendulum.geom["bob"].size, [geom.name for geom in pendulum.geom])
for body in model.find_all("body"):
    print(body.name, body.get("mass", "default"))
for tag in ("joint", "geom"):
    for each in model.find_all(tag):
        print(each.pos)


def lift(body: elements.Body, parent: mjcf.Element) -> mjcf.Element:
    body.pos = [0, 0, 2]
    return parent.add("site", name="tip")


try:
    lift(pendulum, model.worldbody)
    mjcompose.load("nowhere")
except mjcompose.MjcomposeError as error:
    print(error.diagnostics[0].code)
print(mjcompose.mjcf.PREFIX_SEPARATOR, mjcompose.worlds.Worlds, mjcompose.__version__)
"""

_BAD = """\
from mjcompose import mjcf
model = mjcf.RootElement()
body = model.worldbody.add("body", name="arm")
body.poss = [0, 0, 1]
body.add("motr")
body.add("geom", sise=[1])
body.add("geom", type="spere")
body.insert("geon", 0)
model.wordbody.add("geom")
"""


def test_the_stub_is_what_the_grammar_says() -> None:
    stub = runpy.run_path(str(Path(__file__).parents[2] / ".ci" / "element_stub.py"))["stub"]
    written = Path(mjcf.__file__).with_name("elements.pyi").read_text(encoding="utf-8")
    assert written == stub(), "`make schemas` writes it anew"


@pytest.mark.slow
def test_a_checker_passes_a_correct_program_and_reports_each_wrong_line(tmp_path: Path) -> None:
    (tmp_path / "good.py").write_text(_GOOD)
    (tmp_path / "bad.py").write_text(_BAD)
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir=.cache", "good.py", "bad.py"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    errors = [line.split(":")[:2] for line in run.stdout.splitlines() if ": error: " in line]
    assert {name for name, _ in errors} == {"bad.py"}, run.stdout + run.stderr
    assert {int(line) for _, line in errors} == {4, 5, 6, 7, 8, 9}, run.stdout


@pytest.mark.slow
def test_the_program_that_passes_runs(tmp_path: Path) -> None:
    run = subprocess.run([sys.executable, "-c", _GOOD], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "file-not-found" in run.stdout


@pytest.mark.parametrize("module", [mjcompose, mjcf, worlds], ids=["mjcompose", "mjcf", "worlds"])
def test_dir_shows_what_is_public_and_each_of_it_has_a_docstring(module: ModuleType) -> None:
    assert sorted(dir(module)) == sorted(module.__all__)
    for name in dir(module):
        value = getattr(module, name)
        assert not callable(value) or inspect.getdoc(value), name


def test_every_error_has_one_base_class() -> None:
    errors = [
        value
        for module in (mjcompose, mjcf, worlds)
        for name in dir(module)
        if isinstance(value := getattr(module, name), type) and issubclass(value, Exception)
        if not issubclass(value, Warning)
    ]
    assert len(errors) > 5 and all(issubclass(each, mjcompose.MjcomposeError) for each in errors)


def test_the_import_brings_nothing_and_finds_everything() -> None:
    code = (
        "import sys, mjcompose; early = [n for n in sys.modules if n.startswith('mjcompose.')];"
        "print(early, mjcompose.mjcf.RootElement.__name__, mjcompose.worlds.load.__name__)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[] RootElement load"


def test_the_class_of_a_kind_is_that_of_its_elements() -> None:
    body = mjcf.RootElement().worldbody.add("body")
    assert type(body) is elements.Body and isinstance(body, elements.Body)
    assert "EqualityJoint" in dir(elements)
    with pytest.raises(AttributeError, match="Bodi"):
        elements.Bodi  # type: ignore[attr-defined]  # noqa: B018
