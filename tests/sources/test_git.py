from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import Lock, Locked, resolve
from mjcompose.sources.reference import SourceError


def lock_with(id: str, commit: str) -> Lock:
    return Lock(mjcompose="0", mujoco=None, sources={id: Locked(kind="git", commit=commit, files={})})


def test_a_tag_a_branch_a_commit_and_its_beginning_are_the_same_file(robots: Any, take: Callable[..., Any]) -> None:
    commit = robots.git("rev-parse", "HEAD")
    found = {take(robots.reference(each)).path for each in ("v1", "main", "refs/heads/main", commit, commit[:10])}
    assert len(found) == 1
    assert found.pop().read_text() == (robots.folder / "arm" / "arm.xml").read_text()


def test_names_with_characters_of_references_are_escaped(
    robots: Any, take: Callable[..., Any], refused: Callable[..., SourceError]
) -> None:
    robots.git("tag", "arm@1.0")
    robots.git("branch", "fix#7%")
    assert take(robots.reference("arm%401.0")).path == take(robots.reference("fix%237%25")).path
    assert "@arm%401.0#arm/arm.xml`" in str(refused(robots.reference("arm%401.1")).help)
    assert "`%40`" in str(refused(robots.reference("arm@1.0")).help)


def test_a_source_tells_commit_tree_and_license(robots: Any, take: Callable[..., Any]) -> None:
    source = take(robots.reference("v1"))
    assert source.version == source.origin.commit == robots.git("rev-parse", "v1^{commit}")
    assert source.origin.tree == robots.git("rev-parse", "v1^{tree}")
    assert [path.name for path in source.licenses] == ["LICENSE"]
    assert source.origin.id == f"git+file://{robots.folder}@v1"


def test_an_annotated_tag_is_its_commit(robots: Any, take: Callable[..., Any]) -> None:
    robots.git("tag", "-a", "-m", "two", "v2")
    assert take(robots.reference("v2")).version == robots.git("rev-parse", "HEAD")


def test_a_moved_branch_is_followed_unless_it_is_locked(robots: Any, take: Callable[..., Any]) -> None:
    old = take(robots.reference("main")).version
    new = robots.commit(**{"arm/arm.xml": "<mujoco/>"})
    assert take(robots.reference("main")).version == new
    lock = lock_with(f"git+file://{robots.folder}@main", old)
    assert take(robots.reference("main"), lock=lock).version == old
    assert take(robots.reference("main"), lock=lock, fresh=None).version == new


def test_one_run_sees_one_commit_of_a_branch(robots: Any, own_environment: dict[str, str]) -> None:
    run = Fetching()
    first = resolve(robots.reference("main"), relative_to=Path(), environment=own_environment, fetching=run)
    robots.commit(**{"arm/arm.xml": "<mujoco/>"})
    again = resolve(robots.reference("main"), relative_to=Path(), environment=own_environment, fetching=run)
    assert again.version == first.version


def test_a_missing_tag_names_those_that_exist(robots: Any, refused: Callable[..., SourceError]) -> None:
    error = refused(robots.reference("v11"))
    assert error.code == "source-revision"
    assert "tags that exist: v1" in error.notes
    assert error.help == f"write `{robots.reference('v1')}`"


def test_a_repository_without_the_file_names_its_models(robots: Any, refused: Callable[..., SourceError]) -> None:
    error = refused(robots.reference("v1", "arm/amr.xml"))
    assert error.code == "source-not-found"
    assert error.help == f"write `{robots.reference('v1')}`"


def test_a_repository_that_is_gone(tmp_path: Path, refused: Callable[..., SourceError]) -> None:
    error = refused(f"git+file://{tmp_path}/gone@v1#arm.xml")
    assert error.code == "source-fetch"
    assert any("git said" in note for note in error.notes)


def test_a_commit_that_was_thrown_away(robots: Any, refused: Callable[..., SourceError]) -> None:
    lock = lock_with(f"git+file://{robots.folder}@main", "1" * 40)
    error = refused(robots.reference("main"), lock=lock)
    assert error.code == "source-revision"
    assert "no longer has the commit" in error.message


def test_offline_is_what_was_fetched_last(
    robots: Any, take: Callable[..., Any], refused: Callable[..., SourceError]
) -> None:
    assert refused(robots.reference("main"), offline=True).code == "source-offline"
    first = take(robots.reference("main"))
    robots.git("commit", "--allow-empty", "-q", "-m", "more")
    assert take(robots.reference("main"), offline=True).path == first.path


def test_locked_asks_nobody(robots: Any, refused: Callable[..., SourceError]) -> None:
    assert refused(robots.reference("main"), locked=True).code == "lock-stale"


def test_a_lock_that_has_another_commit_than_the_reference_says(
    robots: Any, refused: Callable[..., SourceError]
) -> None:
    """As somebody may write by hand: the recipe would name one commit, and the model be made of another."""
    first = robots.git("rev-parse", "HEAD")
    second = robots.commit(**{"arm/arm.xml": "<mujoco/>"})
    reference = robots.reference(first)
    error = refused(reference, lock=lock_with(reference.partition("#")[0], second))
    assert error.code == "lock-invalid"
    assert f"has {second[:12]}…" in error.message


def test_the_bytes_are_those_of_the_commit(robots: Any, take: Callable[..., Any]) -> None:
    robots.commit(**{".gitattributes": "*.xml text eol=crlf ident\n", "arm/arm.xml": "<mujoco/>\n<!-- $Id$ -->\n"})
    assert take(robots.reference("main")).path.read_bytes() == b"<mujoco/>\n<!-- $Id$ -->\n"


def test_links_inside_become_what_they_lead_to(robots: Any, take: Callable[..., Any]) -> None:
    (robots.folder / "arm" / "same.xml").symlink_to("arm.xml")
    (robots.folder / "again.xml").symlink_to("arm/same.xml")
    (robots.folder / "copy").symlink_to("arm")
    (robots.folder / "deep").mkdir()
    (robots.folder / "deep" / "copy").symlink_to("../copy")
    robots.commit()
    wanted = (robots.folder / "arm" / "arm.xml").read_text()
    for name in ("arm/same.xml", "again.xml", "copy/arm.xml", "copy/same.xml", "deep/copy/arm.xml"):
        path = take(robots.reference("main", name)).path
        assert path.read_text() == wanted
        assert not path.is_symlink() and not path.parent.is_symlink()
    assert (path.parent / "mesh.obj").is_file()


def test_what_is_left_out_is_told(robots: Any, refused: Callable[..., SourceError]) -> None:
    (robots.folder / "arm" / "out.xml").symlink_to("/etc/hostname")
    (robots.folder / "arm" / "above.xml").symlink_to("../../../etc/hostname")
    (robots.folder / "arm" / "round.xml").symlink_to("round.xml")
    (robots.folder / "arm" / "up").symlink_to("..")
    (robots.folder / "gone").symlink_to("nowhere")
    robots.commit()
    robots.git("update-index", "--add", "--cacheinfo", f"160000,{'1' * 40},other")
    robots.git("commit", "-q", "-m", "a submodule")
    for name, why in {
        "arm/out.xml": "`arm/out.xml` is a link to `/etc/hostname`, which is not in the commit",
        "arm/above.xml": "a link to `../../../etc/hostname`, which is not in the commit",
        "arm/round.xml": "a link to `round.xml`, which is not in the commit",
        "arm/up/LICENSE.xml": "`arm/up` is a link to a folder that it is in",
        "gone/arm.xml": "`gone` is a link to `nowhere`, which is not in the commit",
        "other/arm.xml": "`other` is a submodule, which is not fetched",
    }.items():
        error = refused(robots.reference("main", name))
        assert error.code == "source-not-found"
        assert why in error.message
        assert "model files that exist" in error.notes[0]


def test_what_is_left_out_is_told_to_a_recipe_beside_it(robots: Any, own_environment: dict[str, str]) -> None:
    robots.commit(**{"arm/cell.yaml": "recipe: 1\nbase: ../other/arm.xml\n"})
    robots.git("update-index", "--add", "--cacheinfo", f"160000,{'1' * 40},other")
    robots.git("commit", "-q", "-m", "a submodule")
    fetching = Fetching()
    cell = resolve(
        robots.reference("main", "arm/cell.yaml"),
        relative_to=Path(),
        environment=own_environment,
        fetching=fetching,
    )
    with pytest.raises(SourceError, match="`other` of `git.*@main` is a submodule, which is not fetched"):
        resolve(
            "../other/arm.xml",
            relative_to=cell.path.parent,
            environment=own_environment,
            fetching=fetching,
        )


def test_the_repository_that_the_user_stands_in_is_not_asked(
    robots: Any, own_environment: dict[str, str], tmp_path: Path
) -> None:
    own_environment["GIT_DIR"] = str(tmp_path / "nowhere")
    source = resolve(robots.reference("v1"), relative_to=Path(), environment=own_environment)
    assert source.path.is_file()


def test_without_git_the_message_says_so(
    robots: Any, own_environment: dict[str, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SourceError, match="not installed"):
        resolve(robots.reference("v1"), relative_to=Path(), environment=own_environment)


def test_a_host_that_does_not_answer(own_environment: dict[str, str]) -> None:
    told: list[str] = []
    with pytest.raises(SourceError) as caught:
        resolve(
            "git+http://127.0.0.1:9/robots@v1#arm.xml",
            relative_to=Path(),
            environment=own_environment,
            fetching=Fetching(progress=told.append),
        )
    assert caught.value.code == "source-fetch"
    assert sum("trying again" in line for line in told) == 2


def test_a_host_whose_name_cannot_be_resolved_is_asked_for_once(own_environment: dict[str, str]) -> None:
    told: list[str] = []
    with pytest.raises(SourceError) as caught:
        resolve(
            "git+https://nobody.invalid/robots@v1#arm.xml",
            relative_to=Path(),
            environment=own_environment,
            fetching=Fetching(progress=told.append),
        )
    assert caught.value.code == "source-fetch"
    assert not any("trying again" in line for line in told)
