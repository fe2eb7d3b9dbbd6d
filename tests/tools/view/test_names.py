"""Names in the picture of a page."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

pytestmark = pytest.mark.slow
BODIES = "".join(
    f'<body name="arm/link_{number}" pos="0 0 0.02"><joint name="arm/joint_{number}" axis="0 1 0"/>'
    f'<geom size="0.05"/><site name="arm/site_{number}" pos="0 0 0.01"/>'
    for number in range(8)
)
MODEL = f"""<mujoco><worldbody><geom name="floor" type="plane" size="2 2 1"/><geom name="wall" type="box" size="0.5 0.5 0.5" pos="0 -1 0"/>
<body name="cube" pos="0 0 0.099"><freejoint/><geom name="cube" type="box" size="0.1 0.1 0.1"/></body>
<body pos="0 0 0.5">{BODIES}{"</body>" * 8}</body></worldbody></mujoco>"""
BOXES = "Object.fromEntries(mjcompose.visible.labels.boxes)"


def boxes(page: Any) -> dict[str, Any]:
    page.evaluate("mjcompose.stage.sharp()")
    found: dict[str, Any] = page.evaluate(BOXES)
    return found


@pytest.fixture
def page(tmp_path: Path, open_page: Callable[..., Any]) -> Any:
    (tmp_path / "model.xml").write_text(MODEL)
    with Session() as session:
        return open_page(page_of("model.xml", tmp_path, session).as_uri())


def test_names_are_apart_and_in_front_of_everything(page: Any) -> None:
    assert page.locator("canvas.labels").is_hidden()
    page.keyboard.press("n")
    found = boxes(page)
    assert set(found) == {"body cube", *(f"body arm/link_{number}" for number in range(8))}
    page.keyboard.press("n")
    assert set(boxes(page)) == {f"joint arm/joint_{number}" for number in range(8)}
    page.get_by_role("tab", name="Show").click()
    for kind in ("bodies", "sites", "contacts"):
        page.get_by_label(f"names of {kind}").check()
    # From behind the wall, which hides the arm but not its names.
    page.evaluate("mjcompose.stage.lookFrom(mjcompose.stage.camera.position.clone().set(0, -1, 0.1).normalize())")
    found = boxes(page)
    assert len(found) == 27 and "contact floor – cube (4)" in found
    for (one, a), (other, b) in itertools.combinations(found.items(), 2):
        is_apart = (
            a["right"] <= b["left"] or b["right"] <= a["left"] or a["bottom"] <= b["top"] or b["bottom"] <= a["top"]
        )
        assert is_apart, (one, other)
    size = page.locator("main > canvas").first.bounding_box()
    assert all(box["left"] >= 0 and box["right"] <= size["width"] for box in found.values())
    blue = page.evaluate(
        "(() => { const c = document.querySelector('canvas.labels'), r = c.width / c.clientWidth,"
        " b = mjcompose.visible.labels.boxes.get('body cube');"
        " return c.getContext('2d').getImageData((b.left + 1) * r, (b.top + 5) * r, 1, 1).data[2]; })()"
    )
    assert blue > 200, "the rim of its name"


def test_names_stay_where_they_are_while_the_view_turns_a_little(page: Any) -> None:
    page.keyboard.press("n")
    before = boxes(page)
    page.evaluate("mjcompose.stage.camera.position.x += 0.001")
    after = boxes(page)
    jumps = [
        abs(before[name]["left"] - after[name]["left"]) + abs(before[name]["top"] - after[name]["top"])
        for name in before
    ]
    assert sorted(jumps)[len(jumps) // 2] < 3
