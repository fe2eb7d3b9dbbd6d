"""What a fetched recipe may not name, and that every judgement that fails is a refusal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mjcompose.base import files
from mjcompose.sources import fetched, web_archive
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import PATH, kind_called, parse
from mjcompose.sources.reference import Origin, SourceError, Trust, check_reach
from mjcompose.sources.web_archive import unpack as unpacked

FAULTS = [RecursionError, MemoryError, OSError, UnicodeError]
FETCHED = Origin("git+https://host/repo@v1", fetched.GIT, Path("/store/git/1"), commit="1" * 40, tree="2" * 40)


def fails(kind: type[Exception]) -> Any:
    def failing(*_: object, **__: object) -> Any:
        raise kind

    return failing


@pytest.mark.parametrize(
    "text", ["./arm.xml", "git+file:///srv/robots@v1#arm.xml", "package:arms/arm.xml", "https://10.0.0.7/a.zip#arm.xml"]
)
def test_what_is_of_this_machine_is_refused_but_for_what_is_trusted(text: str) -> None:
    reference = parse(text)
    kind = kind_called(reference.kind.name)
    assert kind is not None
    if text == "./arm.xml":  # which leads into what was fetched, and the door judges it
        check_reach(reference, kind, FETCHED, Trust(), offline=True)
        return
    with pytest.raises(SourceError) as caught:
        check_reach(reference, kind, FETCHED, Trust(), offline=True)
    assert caught.value.code == "source-outside"
    check_reach(reference, kind, FETCHED, Trust(references=(text,)), offline=True)


@pytest.mark.parametrize("kind", FAULTS)
@pytest.mark.parametrize("inner", ["mjcompose.sources.reference._begins", "mjcompose.sources.reference.is_private"])
def test_a_reference_that_cannot_be_judged_is_refused(
    monkeypatch: pytest.MonkeyPatch, kind: type[Exception], inner: str
) -> None:
    monkeypatch.setattr(inner, fails(kind))
    reference = parse("https://robots.example.org/a.zip#arm.xml")
    with pytest.raises(SourceError) as caught:
        check_reach(reference, fetched.ARCHIVE, FETCHED, Trust(references=("package:arms",)), offline=True)
    assert caught.value.code == "source-outside" and "`https://robots.example.org" in caught.value.message


def test_of_nested_origins_the_innermost_counts(tmp_path: Path) -> None:
    """In any order: a package inside of another is not what is around it."""
    roots = [tmp_path, tmp_path / "a", tmp_path / "a" / "b"]
    roots[-1].mkdir(parents=True)
    made = {
        str(each): Origin(f"git+https://host/{number}@v1", fetched.GIT, each, commit="1" * 40, tree="2" * 40)
        for number, each in enumerate(roots)
    }
    for order in (list(made), list(reversed(made)), [*list(made)[1:], *list(made)[:1]]):
        fetching = Fetching(origins={each: made[each] for each in order})
        for root in roots:
            found = fetching.around(root / "arm.xml")
            assert found is not None and found.root == root
            assert fetching.door_of_text(root).roots == (str(root),)
        assert fetching.around(tmp_path.parent / "arm.xml") is None
    assert PATH.is_local


@pytest.mark.parametrize("kind", FAULTS)
def test_a_folder_that_cannot_be_judged_is_not_trusted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, kind: type[Exception]
) -> None:
    if not hasattr(files.os, "geteuid"):
        pytest.skip("there are no such owners")
    assert files.untrusted(tmp_path) is None and files.untrusted(tmp_path / "none") is None
    monkeypatch.setattr(files.os, "stat", fails(kind))
    assert files.untrusted(tmp_path) is not None and files.untrusted(tmp_path, is_temporary=True) is not None


@pytest.mark.parametrize("kind", FAULTS)
@pytest.mark.parametrize("inner", ["check_name", "check", "_zip_members"])
def test_an_archive_that_cannot_be_judged_is_not_unpacked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, kind: type[Exception], inner: str
) -> None:
    import zipfile

    with zipfile.ZipFile(tmp_path / "a.zip", "w") as file:
        file.writestr("arm.xml", "<mujoco/>")
    (tmp_path / "into").mkdir()
    monkeypatch.setattr(web_archive, inner, fails(kind))
    with pytest.raises((kind, web_archive.Unsafe)):
        unpacked(tmp_path / "a.zip", tmp_path / "into")
    assert not list((tmp_path / "into").iterdir())
