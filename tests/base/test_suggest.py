from __future__ import annotations

import pytest
from hypothesis import given, settings, strategies as st
from mjcompose.base.suggest import _distance, closest, exists_note

NAMES = st.text("abc_/", max_size=7)


@pytest.mark.parametrize(
    ("written", "candidates", "meant"),
    [
        ("modle", ["name", "model", "mode"], "model"),  # two letters swapped
        ("fromepos", ["framequat", "framepos"], "framepos"),  # another letter
        ("framepo", ["framequat", "framepos"], "framepos"),  # one too few
        ("framepoos", ["framequat", "framepos"], "framepos"),  # one too many
        ("FramePos", ["framequat", "framepos"], "framepos"),  # case
        ("left-pad", ["left_pad", "left_pod"], "left_pad"),  # another joiner
        ("sensors", ["section", "sensor"], "sensor"),  # plural
        ("body", ["box", "bodies"], "bodies"),
        ("mesh", ["meshes", "mass"], "meshes"),
        ("left_pad", ["right_pad", "gripper/left_pad"], "gripper/left_pad"),  # prefix missing
        ("arm/left_pad", ["left_pad", "right_pad"], "left_pad"),  # prefix too much
        ("arm/left_pad", ["gripper/left_pad", "gripper/right_pad"], "gripper/left_pad"),  # another prefix
        ("lfet_pad", ["gripper/left_pad", "gripper/right_pad"], "gripper/left_pad"),  # both at once
        ("left_pad", ["left/gripper:left_pad"], "left/gripper:left_pad"),
        ("frame_pos", ["framepos"], "framepos"),
        ("Größe", ["größe"], "größe"),
    ],
)
def test_what_was_meant(written: str, candidates: list[str], meant: str) -> None:
    assert closest(written, candidates) == [meant]


@pytest.mark.parametrize("written", ["", "x", "zzzzzzzz", "camera"])
def test_nothing_near(written: str) -> None:
    assert closest(written, ["joint", "body", "geom", ""]) == ([""] if written == "" else [])


def test_likeliest_first_and_at_most_n() -> None:
    candidates = ["joint_3", "joint_11", "joint_1", "arm/joint_1", "JOINT_1"]
    assert closest("joint_1", candidates, 3) == ["joint_1", "JOINT_1", "arm/joint_1"]
    assert len(closest("joint_1", candidates, 10)) == 5
    assert closest("joint_1", candidates, 0) == []


def test_short_words_need_to_be_nearer() -> None:
    assert closest("pk", ["kp"]) == ["kp"]
    assert closest("ki", ["kp"]) == []
    assert closest("ab", ["cd"]) == []


def test_candidates_may_be_any_iterable_and_repeat() -> None:
    assert closest("nam", (name for name in ("name", "name")), 5) == ["name"]


@settings(deadline=None)
@given(NAMES, st.lists(NAMES, max_size=5), st.integers(0, 4))
def test_gives_candidates_only(written: str, candidates: list[str], n: int) -> None:
    found = closest(written, candidates, n)
    assert len(found) <= n
    assert set(found) <= set(candidates)
    assert len(set(found)) == len(found)
    if written in candidates and n:
        assert found[0] == written


@settings(deadline=None)
@given(NAMES, NAMES, st.integers(0, 3))
def test_distance_is_that_of_the_definition(a: str, b: str, limit: int) -> None:
    table = {(i, j): i + j for i in range(len(a) + 1) for j in range(len(b) + 1) if 0 in (i, j)}
    for i in range(1, len(a) + 1):
        for j in range(1, len(b) + 1):
            steps = [table[i - 1, j] + 1, table[i, j - 1] + 1, table[i - 1, j - 1] + (a[i - 1] != b[j - 1])]
            if i > 1 and j > 1 and a[i - 1] == b[j - 2] and a[i - 2] == b[j - 1]:
                steps.append(table[i - 2, j - 2] + 1)
            table[i, j] = min(steps)
    expected = table[len(a), len(b)]
    assert _distance(a, b, limit) == (expected if expected <= limit else None)


@pytest.mark.parametrize(
    ("kind", "plural"),
    [
        ("joint", "joints"),
        ("body", "bodies"),
        ("mesh", "meshes"),
        ("class", "classes"),
        ("key", "keys"),
        ("joints", "joints"),
        ("default class", "default classes"),
    ],
)
def test_kinds_in_the_plural(kind: str, plural: str) -> None:
    assert exists_note(kind, ["a", "b"]).message == f"{plural} that exist: a, b"
    assert exists_note(kind, []).message == f"there are no {plural}"


def test_long_lists_are_cut_and_counted() -> None:
    message = exists_note("joint", [f"j{i}" for i in range(12)]).message
    assert message == "joints that exist: j0, j1, j2, j3, j4, j5, j6, j7, … (12 in all)"


def test_nearest_names_survive_the_cut() -> None:
    names = [f"j{i}" for i in range(50)] + ["gripper/left_pad"]
    assert exists_note("joint", names, near="left_pad").message.startswith("joints that exist: gripper/left_pad, j0")


def test_names_that_could_be_misread_are_quoted() -> None:
    assert exists_note("joint", ["a b", "", "c"]).message == "joints that exist: `a b`, ``, c"


def test_one_question_is_answered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file may have one mistake fifty thousand times."""
    from mjcompose.base import suggest

    asked = []
    monkeypatch.setattr(suggest, "_score", lambda name, candidate: asked.append(candidate.text))
    for _ in range(3):
        suggest.closest("asked once", ["asked one", "asks once", "elbow"])
    assert asked == ["asked one", "asks once"]
