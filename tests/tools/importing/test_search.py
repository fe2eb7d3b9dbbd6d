from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.sources.context import Context
from mjcompose.tools.importing import search as searching
from mjcompose.tools.importing.search import Candidate, search

ARM = '<mujoco><worldbody><body name="base"><geom size="0.1"/><body name="link"><geom size="0.1"/>{}</body></body></worldbody></mujoco>'
HAND = '<body name="{0}palm"><geom size="0.1"/><body name="{0}finger"><geom size="0.1"/></body></body>'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A merged model and its parts; what this machine has besides is not looked at."""
    monkeypatch.setattr(searching, "_of_packages", lambda: iter(()))
    monkeypatch.setattr(searching, "_of_menagerie", lambda _: iter(()))
    (tmp_path / "parts" / "deep").mkdir(parents=True)
    (tmp_path / "merged.xml").write_text(ARM.format(HAND.format("left_")))
    (tmp_path / "parts" / "arm.xml").write_text(ARM.format(""))
    (tmp_path / "parts" / "deep" / "hand.xml").write_text(f"<mujoco><worldbody>{HAND.format('')}</worldbody></mujoco>")
    (tmp_path / "parts" / "other.xml").write_text(ARM.format("").replace('"link"', '"leg"'))
    (tmp_path / "parts" / "prop.xml").write_text(
        '<mujoco><worldbody><body name="link"><geom size="1"/></body></worldbody></mujoco>'
    )
    (tmp_path / "parts" / "text.xml").write_text("<sdf><body name='base'/><body name='link'/></sdf>")
    return tmp_path


def found(folder: Path, *among: str) -> tuple[list[str], int]:
    context = Context(folder=folder)
    result = search(folder / "merged.xml", [folder / each for each in among], context, lambda _: None)
    assert result is not None and not context.sink.diagnostics
    return [each.reference or each.path.relative_to(folder).as_posix() for each in result.parts], result.looked_at


def test_the_parts_are_found_and_nothing_else(folder: Path) -> None:
    assert found(folder, "parts") == (["parts/arm.xml", "parts/deep/hand.xml"], 5)
    assert found(folder) == ([], 0)


def test_parts_say_more_than_another_copy_of_the_whole(folder: Path) -> None:
    (folder / "parts" / "a_copy.xml").write_text((folder / "merged.xml").read_text())
    assert found(folder, "parts")[0] == ["parts/arm.xml", "parts/deep/hand.xml"]
    (folder / "parts" / "arm.xml").unlink()
    assert found(folder, "parts")[0] == ["parts/a_copy.xml"]


def test_folders_come_before_what_is_installed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = folder / "package"
    package.mkdir()
    for name in ("arm.xml", "deep/hand.xml"):
        (package / Path(name).name).write_text((folder / "parts" / name).read_text())
    installed = [
        Candidate(package / "arm.xml", "package:robots/arm.xml"),
        Candidate(package / "hand.xml", "package:robots/hand.xml"),
    ]
    monkeypatch.setattr(searching, "_of_packages", lambda: iter(installed))
    assert found(folder)[0] == ["package:robots/arm.xml", "package:robots/hand.xml"]
    (folder / "parts" / "deep" / "hand.xml").unlink()
    assert found(folder, "parts")[0] == ["parts/arm.xml", "package:robots/hand.xml"]


def test_what_is_installed_can_be_named_by_a_recipe() -> None:
    """Packages of the test extra have models; each reference leads to its file."""
    from mjcompose.sources.lock import resolve

    models = [each for each in searching._of_packages() if each.reference and "assets" in each.reference][:3]
    assert models
    for each in models:
        assert each.reference is not None
        source = resolve(each.reference, relative_to=Path.cwd(), environment={})
        assert source.path.resolve() == each.path.resolve()
