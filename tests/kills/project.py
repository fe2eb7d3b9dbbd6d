"""A small project that comes in two editions, and every kind of output that is made of it."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

_ARM = """<mujoco model="arm"><asset><mesh name="cover" file="cover.obj"/></asset><worldbody><body name="base">
  <geom type="mesh" mesh="cover"/><body name="link" pos="0 0 {length}"><joint name="elbow"/><geom size=".1"/>
  <site name="flange"/></body></body></worldbody></mujoco>
"""
_TOOL = '<mujoco><worldbody><body name="palm"><geom name="pad" size=".02"/></body></worldbody></mujoco>\n'
_COVER = "v 0 0 0\nv {length} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
_RECIPE = """recipe: 1
name: cell
params: {{width: {{default: 0.1}}}}
base: ./arm.xml
attach:
  tool: {{model: "{tool}", site: flange}}
add:
  - {{to: world, site: {{name: mark, pos: ["${{width}}", 0, 0]}}}}
matrix: {{axes: {{width: [0.1, 0.2]}}, name: "${{name}}-${{width}}"}}
randomize:
  seed: 1
  samples: 2
  fields: {{size: {{select: {{geom: "tool/pad"}}, attr: "size[0]", uniform: [0.01, 0.02]}}}}
"""
EDITIONS = ("1", "2")


@dataclass(frozen=True, slots=True)
class Output:
    """A kind of output: the words of the command, and what it writes in the folder of the project."""

    name: str
    words: tuple[str, ...]
    writes: str
    """The file or folder that is whole or not there; of models side by side, a pattern of each."""


OUTPUTS = (
    Output("archive", ("build", "cell.yaml", "--pick", "width=0.1", "--sample", "0", "-o", "out/a.zip"), "out/a.zip"),
    Output("folder", ("build", "cell.yaml", "--pick", "width=0.1", "--sample", "0", "-o", "out/f/"), "out/f"),
    Output("mjz", ("build", "cell.yaml", "--pick", "width=0.1", "--sample", "0", "-o", "out/a.mjz"), "out/a.mjz"),
    Output("mjb", ("build", "cell.yaml", "--pick", "width=0.1", "--sample", "0", "-o", "out/a.mjb"), "out/a.mjb"),
    Output("text", ("build", "cell.yaml", "--pick", "width=0.1", "--sample", "0", "-o", "out/a.xml"), "out/a.xml"),
    Output("cells", ("build", "cell.yaml", "--all", "-o", "out/cells/{name}.zip"), "out/cells/*.zip"),
    Output("shared", ("build", "cell.yaml", "--all", "--shared-assets", "-o", "out/shared/{name}/"), "out/shared/*"),
    Output("lock", ("lock", "cell.yaml"), "cell.lock"),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Project:
    """The project in a folder; what it fetches comes from a git repository there, by its own store and TMPDIR."""

    folder: Path

    def make(self) -> None:
        for name in ("robots", "cell", "store", "tmp"):
            (self.folder / name).mkdir(parents=True)
        (self.folder / "robots" / "tool.xml").write_text(_TOOL)
        for words in (
            ["init", "-q", "-b", "main"],
            ["add", "--all"],
            ["-c", "user.name=A", "-c", "user.email=a@b", "-c", "commit.gpgsign=false", "commit", "-q", "-m", "one"],
            ["tag", "v1"],
        ):
            subprocess.run(["git", *words], cwd=self.folder / "robots", check=True, capture_output=True)
        self.edit("1")

    def edit(self, edition: str) -> None:
        """Write the sources of an edition."""
        cell = self.folder / "cell"
        (cell / "arm.xml").write_text(_ARM.format(length=edition))
        (cell / "cover.obj").write_text(_COVER.format(length=edition))
        (cell / "LICENSE").write_text("MIT License\n")
        tool = f"git+file://{self.folder / 'robots'}@v1#tool.xml"
        (cell / "cell.yaml").write_text(_RECIPE.format(tool=tool) + f"description: edition {edition}\n")

    @property
    def environment(self) -> dict[str, str]:
        path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
        own = {"MJCOMPOSE_CACHE": str(self.folder / "store"), "TMPDIR": str(self.folder / "tmp")}
        return {**os.environ, "PYTHONPATH": path, **own}

    def start(self, words: tuple[str, ...], **more: object) -> subprocess.Popen[bytes]:
        """The command, in a session of its own."""
        return subprocess.Popen(
            [sys.executable, "-m", "mjcompose", *words],
            cwd=self.folder / "cell",
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            **more,  # type: ignore[call-overload]
        )

    def run(self, words: tuple[str, ...]) -> tuple[int, str]:
        """The exit status of the command, and what it said."""
        process = self.start(words)
        said, _ = process.communicate(timeout=300)
        return process.returncode, said.decode(errors="replace")

    def written(self, output: Output) -> dict[str, str]:
        """What is there of an output, by path: the digest of each file, or of a folder with all that is in it."""
        return {
            path.relative_to(self.folder).as_posix(): digest(path)
            for path in sorted((self.folder / "cell").glob(output.writes))
            if not path.name.startswith(".")
        }

    def left_over(self) -> list[str]:
        """Temporary files and folders, beside outputs, in the store and where the system has them.

        Without those of builds that were killed before they had locked one: it holds nothing, and waits an hour.
        """
        store = self.folder / "store"
        hidden = [*(self.folder / "cell").rglob(".*.tmp-*"), *(self.folder / "cell").rglob(".*.old-*")]
        passing = [self.folder / "tmp", *(store / name for name in ("staging", "partial", "writing"))]
        found = [*hidden, *(each for path in passing if path.is_dir() for each in path.iterdir())]
        found += (each for each in (store / "leases").glob("*") if each.name != "gate")
        found += (each for each in (store / "seen").glob("*") if each.suffix != ".json")
        return sorted(str(each) for each in found if not _is_empty(each))


def _is_empty(path: Path) -> bool:
    """Whether nothing was written there before the kill."""
    if path.is_dir():
        return all(each.name == "new" for each in path.iterdir())
    return path.stat().st_size == 0


def digest(path: Path) -> str:
    """Of a file, or of a folder with the names and contents of all that is in it."""
    found = hashlib.sha256()
    files = [path] if path.is_file() else sorted(path.rglob("*"))
    for file in files:
        if file.is_file():
            found.update(file.relative_to(path.parent).as_posix().encode() + b"\0" + file.read_bytes())
    return found.hexdigest()


@dataclass(frozen=True, slots=True)
class Undisturbed:
    """What an output is when nobody disturbs the builds: the digests of each edition, and how many seconds they take at most."""

    digests: dict[str, dict[str, str]]
    seconds: float


def undisturbed(project: Project, output: Output) -> Undisturbed:
    words = (*output.words, "--no-cache") if output.words[0] == "build" else output.words
    digests = {}
    seconds = 0.0
    for edition in EDITIONS:
        project.edit(edition)
        start = time.monotonic()
        code, said = project.run(words)
        seconds = max(seconds, time.monotonic() - start)
        assert code == 0, said
        digests[edition] = project.written(output)
    return Undisturbed(digests, seconds)
