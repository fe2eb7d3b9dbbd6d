"""What grows: worlds, parts, free bodies, equal arms. Processor time, against MuJoCo doing the same.

`growth_parts.svg` and `growth_worlds.svg` in `docs/pictures`, which `docs/contributing/performance.md` shows, are its
plots.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from lxml import etree
from mjcompose import mjcf
from mjcompose.base.sink import Sink
from mjcompose.link.link import finish, link
from mjcompose.link.linking import AttachmentPlace, Linking, Part
from mjcompose.tree.parse import parse_text

from bench import peers
from bench.models import REPOSITORY
from bench.plot import plot
from bench.row import Row
from bench.timing import best_times, processor_time

_MODELS = REPOSITORY / "recipes" / "models"
_PICTURES = REPOSITORY / "docs" / "pictures"
_WORLDS = (10, 100, 1_000, 10_000, 100_000)
_PARTS = (10, 100, 1_000, 10_000)
_COPIES_OF_MJSPEC = 1_000
"""More take MjSpec minutes."""
_LINEAR = 1.25
_WORLD = 20.0
_ALL_WORLDS = 60.0
_ARMS = 10
_TO_MJSPEC = 1.3
_TO_LXML = 7.0
_LINKS = '"{upper_arm,elbow,forearm,wrist,flange}"'
_RECIPE = f"""recipe: 1
name: worlds
params: {{worlds: {{default: 10}}}}
base: {_MODELS}/arm6/arm6.xml
add:
  - to: flange
    body: {{name: payload, pos: [0, 0, 0.1], geom: {{name: payload, type: box, size: [0.04, 0.04, 0.04], mass: 1}}}}
randomize:
  seed: 11
  samples: "${{worlds}}"
  fields:
    payload: {{select: {{body: payload}}, attr: mass, uniform: [0.1, 3]}}
    place: {{select: {{body: payload}}, attr: pos, offset: {{normal: {{std: 0.01}}}}}}
    grip: {{select: {{geom: payload}}, attr: "friction[0]", uniform: [0.4, 1.2]}}
    links: {{select: {{body: {_LINKS}}}, attr: mass, scale: {{truncnormal: {{std: 0.05, min: 0.8, max: 1.2}}}}}}
    lengths: {{select: {{body: {_LINKS}}}, attr: pos, offset: {{normal: {{std: 0.001}}}}}}
    damping: {{select: {{joint: "**"}}, attr: damping, scale: {{loguniform: [0.7, 1.4]}}}}
    armature: {{select: {{joint: "**"}}, attr: armature, scale: {{loguniform: [0.7, 1.4]}}}}
    friction: {{select: {{joint: "**"}}, attr: frictionloss, offset: {{uniform: [0, 1]}}}}
    servo: {{select: {{actuator: "**"}}, attr: kp, scale: {{truncnormal: {{std: 0.1, min: 0.7, max: 1.3}}}}}}
"""
_NUMBERS = 49
_POST = """<mujoco model="post"><asset><material name="paint" rgba="1 0 0 1"/></asset>
  <default><geom size="0.02"/></default>
  <worldbody><body name="post"><geom name="post" material="paint"/><site name="top" pos="0 0 0.1"/></body></worldbody>
</mujoco>"""
_MJSPEC_ARMS = """
import mujoco, os, sys, zipfile
root = mujoco.MjSpec()
for number in range(int(sys.argv[2])):
    arm = mujoco.MjSpec.from_file(sys.argv[1])
    for key in list(arm.keys):
        arm.delete(key)
    root.attach(arm, prefix=f"arm{number}/", frame=root.worldbody.add_frame(pos=[number, 0, 0]))
model = root.compile()
mujoco.mj_forward(model, mujoco.MjData(model))
folder = os.path.join(os.path.dirname(sys.argv[1]), "assets")
with zipfile.ZipFile("mjspec.zip", "w", zipfile.ZIP_DEFLATED) as archive:
    archive.writestr("model.xml", root.to_xml())
    for name in sorted({os.path.basename(mesh.file) for mesh in root.meshes}):
        with open(os.path.join(folder, name), "rb") as asset:
            archive.writestr(name, asset.read())
"""


def rows() -> Iterator[Row]:
    yield from _worlds()
    yield from _parts()
    yield from _free_bodies()
    yield _read()
    yield _equal_arms()


def _worlds() -> Iterator[Row]:
    Path("worlds.yaml").write_text(_RECIPE)
    took = {count: _processor(lambda count=count: _build_worlds(count)) for count in _WORLDS}  # type: ignore[misc]
    whole = took[_WORLDS[-1]]
    ours = (whole - took[1_000]) / (_WORLDS[-1] - 1_000)
    theirs = _constants()
    said = f"{ours * 1e6:.0f} us against {theirs * 1e6:.0f} us of mj_resetData + mj_setConst on the same model;"
    said = f"{said} a draw of {_NUMBERS} numbers, the table and all files are ours alone"
    yield Row("a world of `--as worlds` / MuJoCo's constants", ours / theirs, _WORLD, said)
    note = f"{whole:.1f} of {_ALL_WORLDS:.0f} s; three worlds are built and compared"
    yield Row(f"{_WORLDS[-1]:,} worlds of {_NUMBERS} numbers", whole / _ALL_WORLDS, 1.0, note)
    series = {
        "mjcompose build --as worlds": took,
        "mj_resetData + mj_setConst": {count: theirs * count for count in _WORLDS},
    }
    title = f"Worlds with {_NUMBERS} drawn numbers: processor time"
    (_PICTURES / "growth_worlds.svg").write_text(plot(title, "worlds", "s", series))


def _build_worlds(count: int) -> None:
    words = "--as", "worlds", "--set", f"worlds={count}", "--limit", "edits=1000000", "-o", f"worlds-{count}/"
    _command("build", "worlds.yaml", *words)


def _constants() -> float:
    """Seconds in which MuJoCo computes the constants of the arm with its payload."""
    import mujoco

    model = mujoco.MjModel.from_xml_path("worlds-10/model.xml")
    data = mujoco.MjData(model)

    def often() -> None:
        for _ in range(1_000):
            mujoco.mj_resetData(model, data)
            mujoco.mj_setConst(model, data)

    return best_times({"it": often}, rounds=20, seconds=3, clock=time.process_time)["it"] / 1_000


def _parts() -> Iterator[Row]:
    post = Path("post.xml").absolute()
    post.write_text(_POST)
    took: dict[int, float] = {}
    for count in _PARTS:
        Path("parts.yaml").write_text(
            f"recipe: 1\nname: parts\nbase: {_MODELS}/scenes/floor.xml\n"
            f"attach: {{post: {{model: {post}, replicate: [{{count: {count}, offset: [0.1, 0, 0]}}]}}}}\n"
        )
        took[count] = _processor(lambda: _command("build", "parts.yaml", "--no-compile", "-o", "parts.xml"))
    start = took[_PARTS[0]]
    few = took[_PARTS[-2]] - took[_PARTS[0]]
    many = took[_PARTS[-1]] - took[_PARTS[0]]
    each = many / (_PARTS[-1] - _PARTS[0]) / (few / (_PARTS[-2] - _PARTS[0]))
    note = f"{took[_PARTS[-1]]:.1f} s, {start:.2f} s of it for the first {_PARTS[0]}; bodies with a geom and a class"
    yield Row(f"a part of {_PARTS[-1]:,} / a part of {_PARTS[-2]:,}", each, _LINEAR, note)
    series: dict[str, Mapping[int, float]] = {"mjcompose build --no-compile": took}
    if (mujoco := peers.mjspec()) is not None:
        with peers.quiet():
            series["MjSpec: attach, saved as written"] = {
                count: _once(lambda count=count: peers.mjspec_copies(mujoco, str(post), count, "spec.xml"))  # type: ignore[misc]
                for count in _PARTS
                if count <= _COPIES_OF_MJSPEC
            }
    (_PICTURES / "growth_parts.svg").write_text(plot("Copies of a part: processor time", "parts", "s", series))


def _free_bodies() -> Iterator[Row]:
    best = best_times(
        {"few": lambda: _linked(_loose(500)), "many": lambda: _linked(_loose(2_000))},
        rounds=10,
        seconds=6,
        clock=time.process_time,
    )
    note = f"{best['many'] * 1e3:.0f} ms for 2,000: parsed, linked, not written"
    yield Row("a free body of 2,000 / of 500, linked", best["many"] / best["few"] / 4, _LINEAR, note)


def _loose(count: int) -> str:
    bodies = (
        f'<body name="b{n}" pos="{n} 0 0"><freejoint name="f{n}"/><geom name="g{n}" size=".1"/></body>'
        for n in range(count)
    )
    return f"<mujoco><worldbody>{''.join(bodies)}</worldbody></mujoco>"


def _linked(text: str) -> None:
    sink = Sink()
    base, part = (
        parse_text(each.encode(), sink, file=name, directory=Path(), label=name)
        for name, each in (("base", "<mujoco><worldbody/></mujoco>"), ("part", text))
    )
    assert base is not None and part is not None
    linking = Linking(base, [Part(part, "p/", AttachmentPlace("world", None))], sink)
    link(linking)
    finish(linking)
    assert not sink.has_errors, sink.errors


def _read() -> Row:
    text = _loose(1_000)
    best = best_times(
        {"ours": lambda: mjcf.from_xml_string(text), "lxml": lambda: etree.fromstring(text)},
        rounds=60,
        seconds=4,
        clock=time.process_time,
    )
    note = f"{best['ours'] * 1e3:.1f} ms; lxml parses and checks nothing"
    return Row("mjcompose.mjcf: from_xml_string of 1,000 bodies / lxml", best["ours"] / best["lxml"], _TO_LXML, note)


def _equal_arms() -> Row:
    name = f"{_ARMS} equal arms with {20 * _ARMS} meshes / MjSpec, processor time"
    folder = os.environ.get("MENAGERIE_ROOT") or os.path.join(os.environ.get("MJCOMPOSE_CORPUS", ""), "models")
    arm = Path(folder, "universal_robots_ur5e", "ur5e.xml")
    if not arm.is_file():
        return Row(name, None, _TO_MJSPEC, "MENAGERIE_ROOT is not set")
    parts = "".join(f"  arm{n}: {{model: {arm}, pos: [{n}, 0, 0]}}\n" for n in range(_ARMS))
    Path("arms.yaml").write_text(f"recipe: 1\nname: arms\nbase: {_MODELS}/scenes/floor.xml\nattach:\n{parts}")
    best = best_times(
        {
            "ours": lambda: _command("build", "arms.yaml", "-o", "arms.zip"),
            "mjspec": lambda: _python("-c", _MJSPEC_ARMS, str(arm), str(_ARMS)),
        },
        rounds=5,
        seconds=20,
        clock=processor_time,
    )
    note = f"{best['ours']:.2f} s against {best['mjspec']:.2f} s: both attach, compile, step, and zip the assets"
    return Row(name, best["ours"] / best["mjspec"], _TO_MJSPEC, note)


def _processor(run: Callable[[], object]) -> float:
    """Seconds of the processes that it starts, the shorter of two runs."""
    return min(_spent(run) for _ in range(2))


def _spent(run: Callable[[], object]) -> float:
    before = processor_time()
    run()
    return processor_time() - before


def _once(run: Callable[[], object]) -> float:
    start = time.process_time()
    run()
    return time.process_time() - start


def _command(*words: str) -> None:
    _python("-m", "mjcompose", *words, "--no-cache", "-q")


def _python(*words: str) -> Any:
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
    return subprocess.run([sys.executable, *words], env=environment, check=True, capture_output=True)
