from __future__ import annotations

from pathlib import Path

from mjcompose.sources.ros import beside, folders, packages_in


def test_names() -> None:
    text = "<mesh filename='package://b/x/a.stl'/><mesh filename=\"package://a/c.stl\"/> package://broken"
    assert packages_in(text) == ("a", "b")


def test_the_folder_above_of_that_name(tmp_path: Path) -> None:
    urdf = tmp_path / "arm" / "arm" / "urdf" / "arm.urdf"
    assert folders(("arm", "hand"), urdf, {}) == {"arm": tmp_path / "arm" / "arm"}


def test_what_is_given_wins(tmp_path: Path) -> None:
    given = {"arm": tmp_path / "elsewhere", "unused": tmp_path}
    assert folders(("arm",), tmp_path / "arm" / "arm.urdf", given) == {"arm": tmp_path / "elsewhere"}


def test_a_folder_beside_is_no_answer_and_a_hint(tmp_path: Path) -> None:
    (tmp_path / "hand").mkdir()
    urdf = tmp_path / "arm" / "urdf" / "arm.urdf"
    assert folders(("hand",), urdf, {}) == {}
    assert beside("hand", urdf) == tmp_path / "hand"
    assert beside("foot", urdf) is None
