from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.codes import CODES
from mjcompose.base.sink import Sink
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import Lock, Locked, from_text, resolve, to_text
from mjcompose.sources.reference import Source, SourceError

LOCK = Lock(
    mjcompose="0.1.0",
    mujoco="4.0.0",
    sources={
        "git+https://host/robots@v1": Locked(
            kind="git",
            commit="1" * 40,
            tree="2" * 40,
            files={"arm.xml": "3" * 64},
            licenses=["LICENSE"],
            used_by=["base"],
        ),
        "./tool.xml": Locked(kind="path", files={"tool.xml": "4" * 64, "a.obj": "5" * 64}),
    },
)


def fault(text: str) -> tuple[int | None, str]:
    """The line of the one fault of a lock, and what is said of it."""
    sink = Sink()
    assert from_text(text, "cell.lock", sink) is None
    (error,) = sink.errors
    assert error.code == "lock-invalid"
    return (error.span.line if error.span else None), error.message


def test_a_lock_is_read_as_it_was_written() -> None:
    sink = Sink()
    assert from_text(to_text(LOCK), "cell.lock", sink) == LOCK
    assert sink.diagnostics == []
    assert to_text(LOCK).startswith('{\n  "lock": 1,\n')


def test_the_text_does_not_depend_on_the_order() -> None:
    turned = LOCK.model_copy(update={"sources": dict(reversed(LOCK.sources.items()))})
    assert to_text(turned) == to_text(LOCK)


def test_a_newer_lock_says_so() -> None:
    line, message = fault(to_text(LOCK).replace('"lock": 1', '"lock": 2'))
    assert line == 2
    assert "newer mjcompose" in message


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"commit": "1111', '"commit": "xyz', "`commit` is not a hash"),
        ('"arm.xml": "33', '"arm.xml": "3', "`arm.xml` is not a hash"),
        ('"kind": "git"', '"kind": "hg"', "`kind` has a wrong value"),
        ('"kind": "git",', '"kind": "git", "color": 1,', "`color` is not a key of a lock"),
        ('"mjcompose": "0.1.0",', "", "`mjcompose` is missing"),
        ('"lock": 1,', '"lock": true,', "`lock` has a wrong value"),
        ('"lock": 1,', '"lock": 1.0,', "`lock` has a wrong value"),
        ('"lock": 1,', "", "`lock` is missing"),
        ('"lock": 1,', '"lock": "one",', "`lock` has a wrong value"),
        ("}\n", "\n", "is not a lock"),
        ("{", "[", "is not a lock"),
    ],
)
def test_a_lock_edited_by_hand_has_one_fault_with_its_place(old: str, new: str, said: str) -> None:
    text = to_text(LOCK)
    edited = new.join(text.rsplit(old, 1)) if old == "}\n" else text.replace(old, new, 1)
    assert edited != text
    line, message = fault(edited)
    assert said in message
    assert line is not None


@pytest.mark.parametrize("text", ["", "null", "[]", json.dumps("text")])
def test_what_is_no_lock_at_all(text: str) -> None:
    assert "is not a lock" in fault(text)[1]


def test_the_marks_of_a_merge_are_told_at_their_line() -> None:
    sink = Sink()
    assert from_text('{\n  "lock": 1,\n<<<<<<< HEAD\n  "mujoco": "4"\n=======\n', "a.lock", sink) is None
    (told,) = sink.errors
    assert (told.code, told.span and told.span.line) == ("lock-invalid", 3)
    assert told.message == "`a.lock` contains the marks of a merge"
    assert told.help == "run `mjcompose lock`, which keeps the pins of both sides"


def merged(ours: str, theirs: str) -> str:
    """Two texts with the marks of a merge around all in which they differ, as git leaves them at worst."""
    return f"<<<<<<< HEAD\n{ours}=======\n{theirs}>>>>>>> theirs\n"


def test_a_lock_in_a_merge_is_what_both_sides_pin() -> None:
    def side(**sources: Locked) -> str:
        return to_text(Lock(mjcompose="1", mujoco="4", sources=sources))

    both = Locked(kind="git", commit="1" * 40, files={"a.xml": "a" * 64}, used_by=["a"])
    also = both.model_copy(update={"files": {"b.xml": "b" * 64}, "used_by": ["b"]})
    mine = Locked(kind="archive", sha256="2" * 64, files={})
    other = Locked(kind="archive", sha256="3" * 64, files={})
    local = Locked(kind="path", files={"c.xml": "c" * 64})
    changed = Locked(kind="path", files={"c.xml": "d" * 64})
    disputes: dict[str, tuple[str, str]] = {}
    text = merged(side(both=both, mine=mine, web=mine, own=local), side(both=also, other=other, web=other, own=changed))
    sink = Sink()
    lock = from_text(text, "a.lock", sink, disputes)
    assert lock is not None and not sink.diagnostics
    assert sorted(lock.sources) == ["both", "mine", "other", "own", "web"]
    assert lock.sources["both"].files == {"a.xml": "a" * 64, "b.xml": "b" * 64}
    assert lock.sources["both"].used_by == ["a", "b"]
    assert lock.sources["own"].files == {"c.xml": "c" * 64}
    assert disputes == {"web": ("2" * 64, "3" * 64)}


def test_a_merge_of_what_is_no_lock_is_told() -> None:
    sink = Sink()
    assert from_text(merged(to_text(LOCK), "{"), "a.lock", sink, {}) is None
    (told,) = sink.errors
    assert told.help == "run `mjcompose lock`, after you choose one side of the merge"


@pytest.mark.parametrize(
    "text", ["", "./no.xml", "package:none/a.xml", "menagerie:none", "http://127.0.0.1:9/a.zip#b.xml"]
)
def test_every_code_is_declared(tmp_path: Path, own_environment: dict[str, str], text: str) -> None:
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=tmp_path, environment=own_environment)
    assert caught.value.code in CODES
    assert str(caught.value) == caught.value.message


def test_the_room_is_light(repository: Path) -> None:
    heavy = ["mujoco", "numpy", "pydantic", "yaml", "lxml", "click", "mujoco_menagerie", "importlib.metadata"]
    # Without site: what the .pth files of an environment import is none of the room's doing.
    code = (
        f"import sys; sys.path.insert(0, {str(repository / 'composer')!r}); import mjcompose.sources; "
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    command = [sys.executable, "-I", "-S", "-c", code]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_a_path_in_what_was_fetched_belongs_to_it(robots: Any, own_environment: dict[str, str], tmp_path: Path) -> None:
    robots.commit(**{"arm/cell.yaml": "recipe: 1\n"})
    fetching = Fetching()

    def take(reference: str, folder: Path) -> Source:
        return resolve(reference, relative_to=folder, environment=own_environment, fetching=fetching)

    recipe = take(robots.reference("main", "arm/cell.yaml"), tmp_path)
    inside = take("./arm.xml", recipe.path.parent)
    assert inside.origin == recipe.origin and inside.version == recipe.version
    assert [path.name for path in inside.licenses] == ["LICENSE"]
    (tmp_path / "arm.xml").write_text("<mujoco/>")
    for outside in (take("./arm.xml", tmp_path), take(str(inside.path), tmp_path)):
        assert outside.origin is None


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"mjcompose": "1; rm -rf ~"}, "`mjcompose`"),
        ({"mujoco": "4.0\n::error::"}, "`mujoco`"),
        ({"extensions": {"a": "1 --index-url=http://example.org"}}, "`extensions` / `a`"),
        ({"extensions": {"a b": "1"}}, "`extensions` / `a b`"),
        ({"extensions": {"-r x": "1"}}, "`extensions`"),
        ({"sources": {"x": {"kind": "path\n", "files": {}}}}, "`sources` / `x` / `kind`"),
        ({"sources": {"x": {"kind": "path", "version": "1\n", "files": {}}}}, "`sources` / `x` / `version`"),
        ({"sources": {"x": {"kind": "path", "files": {"a": "b"}}}}, "`sources` / `x` / `files` / `a`"),
    ],
)
def test_each_field_that_messages_put_into_commands_has_a_form(change: dict[str, object], place: str) -> None:
    sink = Sink()
    text = json.dumps({"lock": 1, "mjcompose": "0.1.0", "mujoco": "4.0.0", "sources": {}, **change})
    assert from_text(text, "arm.lock", sink) is None
    [error] = sink.errors
    assert error.code == "lock-invalid" and place in error.message and error.span is not None
