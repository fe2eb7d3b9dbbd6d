from __future__ import annotations

from mjcompose.contrast.changes import AddressMove, FieldChange, SizeChange
from mjcompose.contrast.text import arrow, count, moved, relative, sentences, shown


def test_a_share_of_what_was() -> None:
    assert arrow(0.25, 0.3, "kg") == "0.25 kg → 0.3 kg (+20 %)"
    assert arrow((1.0, 2.0), (0.5, 1.0)) == "[1, 2] → [0.5, 1] (−50 %)"
    assert arrow(1.0, 20.0) == "1 → 20 (×20)"
    assert arrow((1.0, 2.0), (2.0, 2.0)) == "[1, 2] → [2, 2]"
    assert arrow(0.0, 1.0) == "0 → 1" and arrow(1.0, -1.0) == "1 → -1"
    assert arrow(3, 6) == "3 → 6"
    assert relative(True, False) is None and relative("a", "b") is None


def test_what_looks_the_same_is_told_in_full() -> None:
    other = 1.0 + 2**-30
    assert arrow(1.0, other) == f"1.0 → {other!r}"
    assert arrow((1.0, 1e-17), (2.0, 1e-17)) == "[1, 0] → [2, 0]"


def test_words_in_place_of_numbers() -> None:
    assert shown(True) == "yes" and shown(None) == "none" and shown((1.0, 0.5)) == "[1, 0.5]"
    note = "3 of 12 numbers differ, by up to 0.1"
    assert list(sentences([FieldChange("changed", "mesh", "cup", "mesh_vert", note=note)])) == [
        f"vertices of mesh `cup`: {note}"
    ]


def test_equal_changes_are_one_sentence() -> None:
    changes = [FieldChange("changed", "joint", name, "dof_damping", 1.0, 2.0, "hinge") for name in "abcdefg"]
    assert list(sentences(changes)) == [
        "damping of 7 joints `a`, `b`, `c`, `d`, `e`, … and 2 more: 1 N·m·s/rad → 2 N·m·s/rad (+100 %)"
    ]


def test_unnamed_things_on_one_body_name_it_once() -> None:
    changes = [FieldChange("added", "geom", f"#{number} of body `table`") for number in range(2)]
    assert list(sentences(changes)) == ["+ 2 geoms #0, #1 of body `table`"]


def test_a_renamed_part_is_one_sentence() -> None:
    renamed = [
        FieldChange("renamed", kind, f"hand/{name}", before=f"gripper/{name}", after=f"hand/{name}")
        for kind, name in (("body", "palm"), ("joint", "finger"))
    ]
    assert list(sentences(renamed)) == ["part `gripper/` is called `hand/`: 2 names"]
    alone = FieldChange("renamed", "body", "b", before="a", after="b")
    assert list(sentences([alone])) == ["body `a` is called `b`"]


def test_addresses_that_move_alike_are_one_line() -> None:
    moves = [AddressMove("qpos", "joint", name, at, at + 7) for at, name in enumerate("abc")]
    assert list(moved(moves)) == ["addresses of 3 joints `a`, `b`, `c` in qpos: 0…2 → 7…9 (+7)"]
    assert list(moved(moves[:1])) == ["address of joint `a` in qpos: 0 → 7"]


def test_counts() -> None:
    assert count(SizeChange("nq", 9, 16)) == "nq 9 → 16"
    assert count(SizeChange("body", 1, 2)) == "bodies 1 → 2"
    assert count(SizeChange("numeric", 1, 2)) == "numerics 1 → 2"
    assert count(SizeChange("total mass", 1.0, 1.5, "kg")) == "total mass 1 kg → 1.5 kg (+50 %)"
