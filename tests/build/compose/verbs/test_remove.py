"""The verb `remove`, alone and with all that refers."""

from __future__ import annotations

from build.compose.arm import Case, changed


def test_what_is_referred_to_stays(radian: Case) -> None:
    assert radian.told("{select: {joint: elbow}, remove: true}") == ["38 still-referred-to"]
    for word in ("a2", "m1", "s1"):
        assert f"`{word}` refers to the joint `elbow`" in radian.said
    assert "remove: cascade" in radian.said


def test_a_cascade_takes_all_that_refers(radian: Case, own: bool) -> None:
    model = radian.edited("{select: {body: link2}, remove: cascade}", own)
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    gone = {each for each in changed(before, model) if each.startswith("-")}
    assert gone == {"-link2", "-tray", "-elbow", "-lower", "-tip", "-a2", "-m1", "-s1", "-s2"}
    assert {each for each in changed(before, model) if not each.startswith("-")} <= {
        "home qpos", "home qvel", "home ctrl", "other qpos", "other ctrl", "home act", "other qvel", "other act",
    }  # fmt: skip
