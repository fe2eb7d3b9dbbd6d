"""What `--cluster` may name, and what is said without the package."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main
from mjcompose.tools.cluster.client import client_of
from mjcompose.tools.cluster.uploads import ClusterError

MODEL = '<mujoco><worldbody><geom name="g" size="0.1"/></worldbody></mujoco>'
RECIPE = (
    "recipe: 1\nbase: ./model.xml\nparams: {size: 1}\n"
    'edit: [{select: {geom: g}, set: {size: ["${size}"]}}]\nmatrix: {axes: {size: [1, 2]}}\n'
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text(RECIPE)
    return tmp_path


@pytest.mark.parametrize("verb", ["build", "check"])
@pytest.mark.parametrize("package", ["distributed", "cryptography"])
def test_without_a_package_there_is_one_error_and_nothing_is_written(
    folder: Path, verb: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if package != "distributed":
        pytest.importorskip("distributed", reason="needs `mjcompose[cluster]`")
    for name in [package, *(name for name in sys.modules if name.startswith(f"{package}."))]:
        monkeypatch.setitem(sys.modules, name, None)
    words = ["-o", "out/{name}/"] if verb == "build" else []
    result = CliRunner().invoke(main, [verb, "r.yaml", "--all", "--no-cache", "--cluster", "local", *words])
    assert result.exit_code == 1 and result.stderr.count("error[cluster-missing]") == 1
    assert f"needs the Python package `{package}`" in result.stderr
    assert 'pip install "mjcompose[cluster]"' in result.stderr and not (folder / "out").exists()


def test_what_is_neither_a_file_nor_an_address() -> None:
    pytest.importorskip("distributed", reason="needs `mjcompose[cluster]`")
    with pytest.raises(ClusterError, match="`nowhere` is not a cluster") as caught, client_of("nowhere", 1):
        pass
    assert caught.value.code == "cluster-unreachable" and "write `local`" in (caught.value.help or "")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--cluster", "local"], "--cluster needs --all, --pick or --sample"),
        (["--all", "--cluster", "a:1", "--jobs", "2"], "--jobs needs --cluster local"),
    ],
)
def test_what_does_not_go_together(folder: Path, words: list[str], said: str) -> None:
    result = CliRunner().invoke(main, ["build", "r.yaml", *words])
    assert result.exit_code == 2 and said in result.stderr
