from __future__ import annotations

import logging
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path

import mjcompose
import pytest
from mjcompose import mjcf
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

GEOM = '<worldbody><geom size="1"/></worldbody>'
ARM = f'<mujoco model="arm"><compiler boundmass="1"/>{GEOM}</mujoco>'
OTHER = '<mujoco model="other"><compiler boundmass="2"/></mujoco>'


def _warned() -> list[warnings.WarningMessage]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default", mjcf.MjcfWarning)
        for _ in range(2):
            arm = mjcf.from_xml_string(ARM)
            arm.include_copy(mjcf.from_xml_string(OTHER), override=True)
    return caught


def test_a_warning_is_at_the_line_of_the_program_and_comes_once() -> None:
    (warning,) = _warned()
    assert warning.filename == __file__
    assert "include_copy" in Path(__file__).read_text(encoding="utf-8").splitlines()[warning.lineno - 1]


def test_a_filter_names_the_module_of_the_program() -> None:
    with warnings.catch_warnings():
        warnings.filterwarnings("error", category=mjcf.MjcfWarning, module=__name__)
        arm = mjcf.from_xml_string(ARM)
        with pytest.raises(mjcf.MjcfWarning):
            arm.include_copy(mjcf.from_xml_string(OTHER), override=True)


def test_a_build_is_logged_under_mjcompose(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    recipe = "recipe: 1\nname: cell\nadd:\n  - to: world\n    geom: {size: [1]}\n"
    (tmp_path / "cell.yaml").write_text(recipe, encoding="utf-8")
    with caplog.at_level(logging.DEBUG, "mjcompose"):
        build(ModelRequest(Path("cell.yaml"), verified=False), Context(folder=tmp_path, environment={}))
    assert {each.name for each in caplog.records} == {"mjcompose"}
    messages = [each.getMessage() for each in caplog.records]
    assert "building `cell` from cell.yaml" in messages
    assert any(each.startswith("compose: ") for each in messages)


def test_a_program_without_logging_does_not_import_it() -> None:
    code = "import sys; import mjcompose.pipeline.stages; print('logging' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@pytest.mark.parametrize(
    "call",
    [
        lambda: mjcf.from_xml_string("<mujoco"),
        lambda: mjcf.from_xml_string(ARM).worldbody.add("geomm"),
        lambda: mjcompose.load("nowhere"),
    ],
)
def test_a_traceback_ends_at_the_line_of_the_program(call: Callable[[], object]) -> None:
    with pytest.raises(mjcompose.MjcomposeError) as raised:
        call()
    assert [each.filename for each in traceback.extract_tb(raised.value.__traceback__)][:2] == [__file__] * 2
    assert len(traceback.extract_tb(raised.value.__traceback__)) == 3
