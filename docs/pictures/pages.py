"""Takes the pictures of the page again, in light and dark, two pixels to a point.

`python docs/pictures/pages.py [NAME…]` takes the named pictures, or all of them: NAME.webp and NAME_dark.webp. It needs
Chromium, as the tests of the page do.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from chromium import started  # noqa: E402

MJCOMPOSE = [sys.executable, "-m", "mjcompose"]
POSE = "[0.5, -0.4, 1.5, 0.4, 1.1, 0.3]"
PAD = "mjcompose.world.model.scene.geom.name.indexOf('gripper/left_pad')"
CAN = "  can: {model: ./models/props/can.xml, pos: [0.2, -0.25, 0.75]}\n"
CHANGES = {
    "    pos: [0.15, 0, 0.75]\n": "    pos: [0.05, 0.2, 0.75]\n" + CAN,
    "sensor:": "edit:\n  - {select: {body: table/table}, scale: {mass: 1.5}}\n\nsensor:",
}
"""A moved cube, a new can and a heavier table."""


def selected(page: Any) -> None:
    page.evaluate(f"mjcompose.select({{kind: 'geom', index: {PAD}}}, true)")


def posed(page: Any) -> None:
    page.get_by_role("tab", name="Joints").click()
    page.evaluate(f"mjcompose.setQpos([...{POSE}, ...mjcompose.world.pose.qpos.slice(6)])")
    page.get_by_role("button", name="Copy this pose").click()


def plotted(page: Any) -> None:
    page.get_by_role("tab", name="Sensors").click()
    for name in ("gripper/force z", "grip_force", "arm/elbow"):
        page.locator(".meters label", has_text=name).first.locator("input").check()
    page.keyboard.press("Space")
    page.wait_for_function("mjcompose.server.data?.time > 0.3", timeout=60_000)
    page.evaluate("mjcompose.sliders.ctrl[6] = 200; mjcompose.server.pose()")
    page.wait_for_function("mjcompose.server.data?.time > 2", timeout=120_000)
    page.keyboard.press("Space")


def rewound(page: Any) -> None:
    page.keyboard.press("Space")
    page.wait_for_function("mjcompose.server.data?.time > 3", timeout=180_000)
    page.keyboard.press("Space")
    page.evaluate("mjcompose.server.back(mjcompose.server.data.time - 2)")


def informed(page: Any) -> None:
    index = "mjcompose.world.model.scene.joint.name.indexOf('arm/elbow')"
    page.evaluate(f"mjcompose.select({{kind: 'joint', index: {index}}}, true)")


def colored(page: Any) -> None:
    page.get_by_role("tab", name="Show").click()
    page.get_by_label("colors").select_option("part")
    page.get_by_label("transparent").check()
    page.get_by_label("centers of mass").check()
    page.evaluate("document.querySelector('.owner').scrollIntoView()")


def named(page: Any) -> None:
    page.get_by_role("tab", name="Show").click()
    page.get_by_label("names of joints").check()
    page.get_by_label("names of sites").check()


def main() -> None:
    wanted = sys.argv[1:]
    with tempfile.TemporaryDirectory() as home, started() as browser:
        folder = Path(home)
        shutil.copytree(ROOT / "recipes", folder / "recipes")
        recipe = folder / "recipes" / "demo.yaml"

        def take(name: str, address: str, act: Callable[[Any], None]) -> None:
            if wanted and name not in wanted:
                return
            for theme, ending in (("light", ""), ("dark", "_dark")):
                context = browser.new_context(
                    viewport={"width": 1080, "height": 660}, device_scale_factor=2, color_scheme=theme
                )
                page = context.new_page()
                page.goto(address)
                page.wait_for_selector("html[data-shown='1']", state="attached", timeout=60_000)
                act(page)
                page.wait_for_timeout(1500)
                page.evaluate("mjcompose.stage.sharp()")
                picture = ROOT / "docs" / "pictures" / f"{name}{ending}.webp"
                Image.open(BytesIO(page.screenshot())).convert("RGB").save(picture, quality=82, method=6)
                context.close()

        def made(*words: str) -> str:
            subprocess.run(
                [*MJCOMPOSE, *words, "--html", "page.html"], cwd=folder, check=False, stdout=subprocess.DEVNULL
            )
            return (folder / "page.html").as_uri()

        demo = made("view", "recipes/demo.yaml")
        take("view", demo, selected)
        take("view_keyframe", demo, posed)
        take("view_names", demo, named)
        take("view_bodies", demo, colored)
        take("view_physics", demo, informed)
        physics = made("view", "recipes/demo.yaml", "--physics")
        take("view_sensors", physics, plotted)
        take("view_time", physics, rewound)
        text = recipe.read_text()
        (folder / "recipes" / "before.yaml").write_text(text)
        served = subprocess.Popen(
            [*MJCOMPOSE, "view", "recipes/demo.yaml", "--no-open"], cwd=folder, stdout=subprocess.PIPE, text=True
        )
        assert served.stdout is not None
        address = next(word for line in served.stdout for word in line.split() if word.startswith("http"))

        def broken(page: Any) -> None:
            recipe.write_text(text.replace("site: arm/attachment_site", "site: arm/atachment_site"))
            page.locator(".fault").wait_for(timeout=30_000)
            page.wait_for_timeout(500)

        def mended(page: Any) -> None:
            broken(page)
            page.context.on("close", lambda _: recipe.write_text(text))

        take("view_fault", address, mended)
        served.terminate()
        served.wait()
        for old, new in CHANGES.items():
            text = text.replace(old, new)
        recipe.write_text(text)
        take("diff_page", made("diff", "recipes/before.yaml", "recipes/demo.yaml"), lambda page: None)


if __name__ == "__main__":
    main()
