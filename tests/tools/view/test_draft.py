"""Every form of an orientation, written again as another pose."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random

import pytest
from mjcompose.base.rotation import Pose, euler_of, normalize, quat_from_euler
from mjcompose.plan.steps import AngleSettings
from mjcompose.tools.view.draft import DraftRefused, PoseDraft, RecipeDraft, name_text, short

FORMS = ("", "quat", "euler", "axisangle", "xyaxes", "zaxis")


def _drafted(text: str) -> RecipeDraft:
    return RecipeDraft.of("a.yaml", Path("a.yaml"), text.encode())


def _written(random: Random, form: str, angle: str | None) -> str:
    """A part with some numbers in a form, in one of the layouts that people write."""
    unit = random.choice(["deg", "rad"] if angle is None else ["", "deg", "rad"])
    angles = [f"{random.randint(-200, 200) / (50 if unit == 'rad' else 1):g}{unit}" for _ in range(3)]
    numbers = {
        "quat": [f"{random.uniform(-1, 1):.3f}" for _ in range(4)],
        "euler": angles,
        "axisangle": [*random.choice([["0", "0", "2"], ["1", "0.5", "-1"]]), angles[0]],
        "xyaxes": ["1", "0", "0", "0", "0.5", "0.5"],
        "zaxis": ["0", "0.2", "1"],
    }
    keys = {"pos": ["0.1", "0", "-1e-1"], **({form: numbers[form]} if form else {})}
    if random.random() < 0.4:
        del keys["pos"]
    layout = random.randrange(3)
    if layout == 0:
        inside = ", ".join(f"{key}: [{', '.join(each)}]" for key, each in keys.items())
        return f"  part: {{model: ./x.xml{', ' if inside else ''}{inside}}}  # flow\n"
    rows = "  part:  # block\n    model: ./x.xml\n"
    for key, each in keys.items():
        if layout == 1:
            rows += f"    {key}: [{', '.join(each)}]   # {key}\n"
        else:
            rows += f"    {key}:\n" + "".join(f"      - {number}   # number {at}\n" for at, number in enumerate(each))
    return rows


@pytest.mark.parametrize("form", FORMS)
def test_the_new_numbers_are_the_pose_and_the_rest_stays(form: str) -> None:
    random = Random(form)
    for _ in range(60):
        angle = random.choice([None, "degree", "radian"])
        sequence = random.choice(["xyz", "XYZ", "zyx", "zXy", "xyx", "ZYZ"])
        part = _written(random, form, angle)
        text = f"recipe: 1\nattach:\n{part}  last: {{model: ./x.xml}}  # stays\n"
        settings = AngleSettings(angle, sequence)
        draft = _drafted(text)
        quat = normalize([random.gauss(0, 1) for _ in range(4)])
        if random.random() < 0.3:  # a gimbal lock
            quat = quat_from_euler([random.choice([0, math.pi / 2, -math.pi / 2, math.pi]) for _ in range(3)], sequence)
        pose = Pose(tuple(random.uniform(-2, 2) for _ in range(3)), quat)  # type: ignore[arg-type]
        try:
            PoseDraft(draft, ("attach", "part"), settings).move(pose)
            result = draft.result().decode()
        except DraftRefused as refused:  # a list over several lines cannot get another length
            assert form == "zaxis" and "over several lines" in str(refused)
            continue
        found = PoseDraft(_drafted(result), ("attach", "part"), settings)
        assert math.dist(found.pose.pos, pose.pos) < 1e-5
        assert abs(sum(a * b for a, b in zip(found.pose.quat, pose.quat, strict=True))) > 1 - 1e-8, (text, result)
        if not form and pose.quat[0] ** 2 > 1 - 1e-9:
            assert found.form is None
            continue
        assert found.form == (form or "euler") or (form == "zaxis" and found.form == "quat" and draft.notes)
        comments, kept = (
            [line.partition("#")[2] for line in each.splitlines() if "#" in line] for each in (text, result)
        )
        assert comments == kept
        assert all(
            line in result for line in text.splitlines() if "stays" in line or ("model" in line and "part" not in line)
        )


def test_angles_stay_near_those_that_are_written() -> None:
    assert euler_of(quat_from_euler([3.5, 0.1, -3.4], "xyz"), "xyz", [3.5, 0.1, -3.4]) == pytest.approx(
        (3.5, 0.1, -3.4)
    )
    assert euler_of(quat_from_euler([0.4, math.pi / 2, 0], "xyz"), "xyz", [0.4, 1.5, 0]) == pytest.approx(
        (0.4, math.pi / 2, 0), abs=1e-6
    )
    assert euler_of((1, 0, 0, 0), "xxz") is None


def test_numbers_that_do_not_change_keep_their_text() -> None:
    draft = _drafted("recipe: 1\nattach: {a: {pos: [1e-1, 0.200, 3], euler: [90deg, 1.5708rad, 0]}}\n")
    offset = PoseDraft(draft, ("attach", "a"), AngleSettings(None))
    offset.move(Pose((0.1, 0.2, 4), offset.pose.quat))
    assert draft.result() == b"recipe: 1\nattach: {a: {pos: [1e-1, 0.200, 4], euler: [90deg, 1.5708rad, 0]}}\n"


def test_a_change_that_would_mean_something_else_is_refused() -> None:
    draft = _drafted("recipe: 1\nattach: {a: {pos: &p [0, 0, 1]}, b: {pos: *p}}\n")
    draft.numbers(("attach", "b", "pos"), ["0", "0", "2"])
    with pytest.raises(DraftRefused, match="without changing something else"):
        draft.result()
    text = "recipe: 1\nattach:\n  a:\n    edit: |\n      x\n\n      y\n"
    block = _drafted(text)
    block.write(("attach", "a", "pos"), "[0, 0, 1]")
    with pytest.raises(DraftRefused):
        block.result()


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_line_ends_and_the_mark_of_a_file_stay(mark: bytes, end: str) -> None:
    raw = mark + f"recipe: 1{end}attach:{end}  a: {{pos: [0, 0, 1]}}{end}".encode()
    draft = RecipeDraft.of("a.yaml", Path("a.yaml"), raw)
    draft.numbers(("attach", "a", "pos"), ["0", "0", "2"])
    draft.write(("keyframe", "k"), {"qpos": {"j": "1"}})
    added = f"keyframe:{end}  k:{end}    qpos:{end}      j: 1{end}".encode()
    assert draft.result() == raw.replace(b"1]", b"2]") + added


def test_names_and_numbers_as_text() -> None:
    assert [name_text(each) for each in ("arm/tip", "1", "true", "a: b", "x y")] == [
        "arm/tip",
        '"1"',
        '"true"',
        '"a: b"',
        "x y",
    ]
    assert [short(each, 3) for each in (0.1, -1e-9, 2.0, 1234.5678)] == ["0.1", "0", "2", "1234.568"]
    for name in ("", "a\nb", "\x1b[2J", "\u202e"):
        with pytest.raises(DraftRefused):
            name_text(name)
