"""MuJoCo opens recipes. Each test runs a program, because a decoder stays registered as long as its process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

pytestmark = [pytest.mark.skipif(mujoco.mj_version() < 4000000, reason="decoders of MuJoCo 3 have other arguments")]
BASE = "<mujoco><worldbody><body name='table'><geom name='top' size='.1'/></body></worldbody></mujoco>"
START = "import mujoco, os, sys, threading, time\nfrom mjcompose import mujoco_plugin\nmujoco_plugin.register()\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "base.xml").write_text(BASE)
    (tmp_path / "cell.yaml").write_text("recipe: 1\nbase: ./base.xml\nedit: [{select: {geom: top}, set: {mass: 2}}]\n")
    return tmp_path


def run(folder: Path, program: str, **variables: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", START + program],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, **variables},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_spec_is_read_from_a_recipe(folder: Path) -> None:
    program = "print(mujoco.MjSpec.from_file('cell.yaml').compile().body('table').mass[0])"
    assert run(folder, program) == "2.0"


def test_plain_mjcf_attaches_a_recipe(folder: Path) -> None:
    (folder / "scene.xml").write_text(
        "<mujoco><asset><model name='cell' file='cell.yaml'/></asset><worldbody>"
        "<attach model='cell' prefix='a_'/><attach model='cell' prefix='b_'/></worldbody></mujoco>"
    )
    program = "m = mujoco.MjSpec.from_file('scene.xml').compile()\nprint(*(m.body(i).name for i in range(m.nbody)))"
    assert run(folder, program) == "world a_table b_table"


def test_an_error_is_that_of_mjcompose(folder: Path) -> None:
    (folder / "cell.yaml").write_text("recipe: 1\nbas: ./base.xml\n")
    program = "try: mujoco.MjSpec.from_file('cell.yaml')\nexcept ValueError as error: print(error)"
    text = run(folder, program)
    assert text.startswith("cell.yaml:2:1: error[unknown-key]: the recipe has no key `bas`") and "write `base`" in text


def test_a_long_error_is_shortened_by_whole_characters(folder: Path) -> None:
    lines = "".join(f"{chr(0x4E00 + number)}{chr(0x10000 + number)}: 1\n" for number in range(300))
    (folder / "cell.yaml").write_text(f"recipe: 1\nbase: ./base.xml\n{lines}")
    program = "try: mujoco.MjSpec.from_file('cell.yaml')\nexcept ValueError as error: print(ascii(str(error)[-1]))"
    assert run(folder, program) == r"'\u2026'"


def test_registering_twice_and_again_after_a_reload_is_harmless(folder: Path) -> None:
    program = """
import importlib
from mjcompose.tools.open import decoder
importlib.reload(decoder).register()
mujoco_plugin.register()
print(mujoco_plugin.is_registered(), mujoco.MjSpec.from_file("cell.yaml").compile().nbody)
"""
    assert run(folder, program) == "True 2"


def test_a_changed_part_is_read_again(folder: Path) -> None:
    program = """
first = mujoco.MjSpec.from_file("cell.yaml").compile().nbody
text = open("base.xml").read()
open("base.xml", "w").write(text.replace("</worldbody>", "<body name='more'/></worldbody>"))
print(first, mujoco.MjSpec.from_file("cell.yaml").compile().nbody)
"""
    assert run(folder, program) == "2 3"


def test_eight_threads_with_rebuilds(folder: Path) -> None:
    program = """
from concurrent.futures import ThreadPoolExecutor
def work(number):
    os.utime("cell.yaml")
    return mujoco.MjSpec.from_file("cell.yaml").compile().nbody
with ThreadPoolExecutor(8) as pool:
    print(set(pool.map(work, range(64))))
"""
    assert run(folder, program) == "{2}"


@pytest.mark.parametrize("count", [20, pytest.param(200, marks=pytest.mark.slow)])
def test_an_interrupt_is_a_keyboard_interrupt_and_no_crash(folder: Path, count: int) -> None:
    program = (
        f"count = {count}"
        """
import random, signal
draw, interrupts = random.Random(1), 0
for number in range(count):
    try:
        delay = draw.uniform(0, 0.02)
        threading.Thread(target=lambda: (time.sleep(delay), os.kill(os.getpid(), signal.SIGINT))).start()
        end = time.monotonic() + 10
        while time.monotonic() < end:
            try:
                os.utime("cell.yaml")
                mujoco.MjSpec.from_file("cell.yaml")
            except ValueError:
                time.sleep(1)
    except KeyboardInterrupt:
        interrupts += 1
print(interrupts)
"""
    )
    assert run(folder, program) == str(count)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs the memory of a process")
def test_a_thousand_rebuilds_need_no_more_memory(folder: Path) -> None:
    """Python and MuJoCo fill their pools first."""
    program = """
def resident():
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmRSS")) / 1024
for number in range(1400):
    if number == 400:
        before = resident()
    os.utime("cell.yaml")
    mujoco.MjSpec.from_file("cell.yaml")
print(resident() - before)
"""
    assert float(run(folder, program)) < 2


def test_a_file_of_a_robot_is_found_by_the_resolver_and_nothing_outside_of_it(
    folder: Path, menagerie_root: Path
) -> None:
    scene = (
        "<mujoco><asset><model name='arm' file='menagerie:universal_robots_ur5e/{}'/></asset>"
        "<worldbody><attach model='arm' prefix='a_'/></worldbody></mujoco>"
    )
    program = f"""
print(mujoco.MjSpec.from_string({scene.format("ur5e.xml")!r}).compile().nq)
try: mujoco.MjSpec.from_string({scene.format("../../secret.xml")!r})
except ValueError as error: print("refused")
"""
    assert run(folder, program, MENAGERIE_ROOT=str(menagerie_root)) == "6\nrefused"


def test_another_decoder_of_recipes_is_an_error_and_not_the_end_of_the_process(folder: Path) -> None:
    program = """
import ctypes
from mjcompose.tools.open import decoder
kept = mujoco._mjcompose; del mujoco._mjcompose
try: mujoco_plugin.register()
except Exception as error: print(error.diagnostics[0].message)
"""
    assert run(folder, program).startswith("another package already opens `.yaml` files")
