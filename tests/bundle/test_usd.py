from __future__ import annotations

import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.form import Form, form_of
from composer.bundle.output_error import OutputError
from composer.bundle.write import write
from composer.context import Context
from composer.engine import usd
from composer.stages import Request, build

ROOT = Path(__file__).resolve().parents[2]
BALL = Bundle(
    {"model.xml": b'<mujoco model="ball"><worldbody><geom size="1"/><camera/></worldbody></mujoco>'}
)
needs_converter = pytest.mark.skipif(
    find_spec("mujoco_usd_converter") is None,
    reason="mujoco-usd-converter (the extra `usd`) is not installed",
)


@pytest.mark.parametrize("name", ["a.usd", "a.usda", "a.USDC", "a.usdz"])
def test_names_of_usd(name: str) -> None:
    assert form_of(name) is Form.USD


def test_without_the_converter_the_line_to_install_it_is_told(tmp_path: Path) -> None:
    def missing(*_: Any) -> usd.Exported:
        return usd.Exported(missing="No module named 'mujoco_usd_converter'")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(usd, "export_usd", missing)
        with pytest.raises(OutputError) as caught:
            write(BALL, tmp_path / "ball.usdz", environment={})
    assert caught.value.code == "usd-missing"
    assert 'pip install "mjcompose[usd]"' in (caught.value.help or "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(find_spec("mujoco_usd_converter") is not None, reason="the converter is installed")
def test_the_child_says_that_it_is_missing(tmp_path: Path) -> None:
    with engine.Session() as session:
        exported = usd.export_usd(tmp_path / "model.xml", tmp_path / "a.usda", session)
    assert exported.missing is not None and exported.error is None


@needs_converter
def test_the_demo_cell_is_exported_with_its_textures(tmp_path: Path) -> None:
    built = build(Request(ROOT / "recipes" / "demo.yaml"), Context(folder=tmp_path))
    assert built is not None
    heard: list[str] = []
    write(built.bundle, tmp_path / "demo.usdz", environment={}, warn=heard.append)
    with zipfile.ZipFile(tmp_path / "demo.usdz") as package:
        assert {Path(name).suffix for name in package.namelist()} == {".usdc", ".png"}
    assert "cameras are not supported" in heard
    with pytest.raises(OutputError, match="cannot hold the 1 textures"):
        write(built.bundle, tmp_path / "demo.usda", environment={})
    assert not (tmp_path / "demo.usda").exists()


@needs_converter
@pytest.mark.parametrize("name", ["cell.usdz", "cell.usda", "cell.usdc"])
def test_the_same_model_is_the_same_bytes(tmp_path: Path, name: str) -> None:
    """With meshes that are there several times, which USD shares and numbers in an order of its own."""
    built = build(Request(ROOT / "recipes" / "arm_gripper.yaml"), Context(folder=tmp_path))
    assert built is not None
    for folder in ("one", "two"):
        write(built.bundle, tmp_path / folder / name, environment={"SOURCE_DATE_EPOCH": "1700000000"})
    one = (tmp_path / "one" / name).read_bytes()
    assert one == (tmp_path / "two" / name).read_bytes()
    assert b"/tmp" not in one
    if name == "cell.usdz":
        with zipfile.ZipFile(tmp_path / "one" / name) as package:
            assert {info.date_time[:3] for info in package.infolist()} == {(2023, 11, 14)}
            assert package.testzip() is None


@needs_converter
def test_a_layer_of_its_own(tmp_path: Path) -> None:
    write(BALL, tmp_path / "ball.usda", environment={})
    text = (tmp_path / "ball.usda").read_text()
    assert text.startswith("#usda") and "def Sphere" in text


@needs_converter
@pytest.mark.slow
def test_usd_for_isaac_has_every_mass(tmp_path: Path) -> None:
    """The plain model has an inertia for each body; USD alone has those that are written."""
    from cli.shell import run
    from pxr import Usd, UsdPhysics

    result = run(
        "build", str(ROOT / "recipes" / "demo.yaml"), "--target", "isaac", "-o", str(tmp_path / "demo.usdz")
    )
    assert result.exit_code == 0, result.output
    bundle = tmp_path / "demo"
    assert run("build", str(ROOT / "recipes" / "demo.yaml"), "-o", str(bundle)).exit_code == 0
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(bundle / "model.xml"))
    stage = Usd.Stage.Open(str(tmp_path / "demo.usdz"))
    masses = [UsdPhysics.MassAPI(prim) for prim in stage.TraverseAll() if prim.HasAPI(UsdPhysics.MassAPI)]
    total = sum(each.GetMassAttr().Get() or 0 for each in masses)
    assert total == pytest.approx(model.body_mass.sum(), rel=1e-5)
