from __future__ import annotations

from pathlib import Path

import pytest
from cli.shell import run, snapshot

BUILD = ("build", "matrix.yaml", "--all", "--shared-assets")


def test_one_folder_of_assets(store: Path, folder: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    assert run(*BUILD, "-o", "b/{name}/").exit_code == 0
    run("build", "matrix.yaml", "--all", "-o", "c/{name}/")
    assert [path.name.partition("-")[0] for path in (folder / "b" / "assets").iterdir()] == ["cover"]
    for cell in sorted(path.name for path in (folder / "c").glob("cell-*")):
        shared, alone = (mujoco.MjModel.from_xml_path(str(folder / at / cell / "model.xml")) for at in "bc")
        assert (shared.mesh_vert == alone.mesh_vert).all()
        assert shared.names == alone.names
        assert run("verify", f"b/{cell}", "--recipe", "matrix.yaml").exit_code == 0


def test_what_is_known_gives_the_same(store: Path, folder: Path) -> None:
    run(*BUILD, "-o", "b/{name}/", "--no-cache")
    run(*BUILD, "-o", "c/{name}/")
    assert run(*BUILD, "-o", "d/{name}/").stdout.count("wrote d/cell") == 4
    assert snapshot(folder / "b") == snapshot(folder / "c") == snapshot(folder / "d")
    assert run(*BUILD, "-o", "d/{name}/").stdout.count("is up to date") == 4
    next((folder / "d" / "assets").iterdir()).unlink()
    run(*BUILD, "-o", "d/{name}/")
    assert snapshot(folder / "d") == snapshot(folder / "b")


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("--all", "-o", "b/{name}.zip"), "a zip cannot refer to files outside of it"),
        (("--all", "-o", "b/{name}.mjb"), "has its assets in it"),
        (("--all", "-o", "b/{name}.xml"), "none is copied"),
        (("--all", "-o", "{name}/model/"), "are not next to each other"),
        (("-o", "b/"), "one model cannot share its"),
    ],
)
def test_where_nothing_can_be_shared(store: Path, arguments: tuple[str, ...], why: str) -> None:
    result = run("build", "matrix.yaml", "--shared-assets", *arguments)
    assert result.exit_code == 2
    assert why in result.stderr
