"""A folder of somebody else, full of files that programs run or obey: every command is typed there, and none of them acts.

Each planted file leaves a mark when it runs or is obeyed. The commands come from the command line itself, so a new one
needs a row here.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import stat
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import click
import mjcompose
import mujoco
import pytest
from cli.shell import REPOSITORY
from lsp.client import Editor
from mjcompose.cli.main import main

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the planted programs are scripts of a shell")

ARM = """<mujoco model="arm"><worldbody><body name="link"><joint name="hinge" range="-1 1"/><geom name="rod" size=".1"/>
<site name="flange"/></body></worldbody></mujoco>"""
TOOL = '<mujoco model="tool"><worldbody><body name="palm"><geom name="palm" size=".1"/></body></worldbody></mujoco>'
ROBOT = """recipe: 1
base: ./arm.xml
attach:
  tool: {model: ./tool.xml, site: flange}
check:
  moves: {moves_alike: {as: mujoco==3.12}}
  reads: {targets: [drake, pybullet]}
"""
CELL = ROBOT[: ROBOT.index("check:")]
FITTED = "recipe: 1\nbase: ./arm.xml\nidentify: {fields: {damping: {select: {joint: hinge}, attr: damping, range: [0, 2]}}}\n"
SWING = "time,qpos hinge\n" + "".join(f"{step / 50},{0.01 * math.cos(step / 10):.6f}\n" for step in range(60))
MATRIX = CELL + "params: {size: {default: 1}}\nmatrix: {axes: {size: [1, 2]}}\n"
XACRO = '<robot name="arm" xmlns:xacro="http://wiki.ros.org/xacro"><link name="base"/></robot>'

MODULES = """
venv pip ensurepip yaml json sitecustomize usercustomize click pydantic numpy mujoco lxml re typing subprocess runpy
webbrowser platform tempfile socket ssl random _mjcompose xacro pydrake pybullet distributed mcp anyio pygls lsprotocol
msgpack tornado PIL trimesh OpenGL glfw menagerie __future__ contextlib warnings types functools collections
""".split()
PROGRAMS = """
git uv pip pip3 ssh cc gcc c++ ld ldconfig python python3 sh bash env uname file sensible-browser www-browser xdg-open
firefox chromium google-chrome links elinks lynx w3m browser curl npm node conda
""".split()

ROWS: dict[str, list[tuple[str, ...]]] = {
    "build": [
        ("build", "cell.yaml", "-o", "out.zip"),
        ("build", "matrix.yaml", "--all", "-o", "cells/{name}/", "--jobs", "2"),
        ("build", "robot.yaml", "--no-cache", "-o", "robot.zip"),
        ("build", "from_git.yaml"),
        ("build", "from_web.yaml"),
        ("build", "template.yaml", "-o", "t.zip"),
        ("build", "cell.yaml", "--target", "urdf", "-o", "urdf/"),
    ],
    "check": [("check", "robot.yaml"), ("check", "cell.yaml"), ("check", "cell.yaml", "matrix.yaml", "--offline")],
    "lint": [("lint", "."), ("lint", "--fix", "arm.xml")],
    "plan": [("plan", "robot.yaml")],
    "list": [("list", "cells")],
    "rebuild": [("rebuild", "stamp.json", "cell.yaml", "-o", "again.zip")],
    "verify": [("verify", "out.zip")],
    "tree": [("tree", "robot.yaml"), ("tree", "arm.xml")],
    "explain": [("explain", "cell.yaml", "geom rod"), ("explain", "consumer-missing")],
    "diff": [
        ("diff", "HEAD:cell.yaml", "cell.yaml"),
        ("diff", "arm.xml", "tool.xml"),
        ("diff", "HEAD:arm.xml", "arm.xml"),
    ],
    "names": [("names", "cell.yaml", "--python", "-o", "names.py")],
    "view": [("view", "cell.yaml", "--html", "page.html"), ("view", "cell.yaml"), ("view", "HEAD:arm.xml")],
    "render": [("render", "arm.xml", "-o", "arm.png"), ("render", "HEAD:arm.xml", "-o", "old.png")],
    "new": [("new", "new.yaml"), ("new", "--project", "project")],
    "fix": [("fix", "robot.yaml"), ("fix", "cell.yaml", "--write")],
    "fmt": [("fmt", "."), ("fmt", "cell.yaml")],
    "identify": [
        ("identify", "fitted.yaml", "swing.csv", "-o", "robot_a.yaml"),
        ("identify", "fitted.yaml", "swing.csv", "--plan"),
        ("identify", "fitted.yaml", "swing.csv", "--report", "page.html"),
    ],
    "import": [("import", "arm.xml", "tool.xml", "-o", "imported.yaml")],
    "migrate": [("migrate", "arm.xml", "--from", "3.2", "--prove"), ("migrate", "arm.xml", "--from", "3.2")],
    "upgrade": [("upgrade", "arm.xml", "--from", "3.2")],
    "lock": [("lock", "cell.yaml"), ("lock", "from_git.yaml")],
    "cache info": [("cache", "info")],
    "cache prune": [("cache", "prune")],
    "cache verify": [("cache", "verify")],
    "doctor": [("doctor",)],
    "install": [("install",), ("install", "mujoco==3.12")],
    "uninstall": [("uninstall", "mujoco==3.12")],
    "plugin install": [("plugin", "install", "--mujoco", "../release"), ("plugin", "install", "--mujoco", ".")],
    "plugin remove": [("plugin", "remove", "--mujoco", "../release")],
    "lsp": [],
    "mcp": [],
    "schema": [("schema",)],
    "completion": [("completion", "bash")],
    "help": [("help", "build")],
    "version": [("version",)],
}
"""The lines that are typed for each command; `lsp` and `mcp` have tests of their own."""
QUICK = {"check", "version"}


def commands(group: click.Command, words: tuple[str, ...] = ()) -> Iterator[str]:
    if not isinstance(group, click.Group):
        yield " ".join(words)
        return
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        yield from commands(command, (*words, name))


def test_every_command_has_a_row() -> None:
    assert set(commands(main)) == ROWS.keys()


class Folder:
    """The folder of somebody else, with the marks that were left, and the requests to a server that it names."""

    def __init__(self, place: Path) -> None:
        self.path = place / "theirs"
        self.marks = place / "marks"
        self.place = place
        self.requests: list[str] = []
        for folder in (self.path, self.marks, place / "home"):
            folder.mkdir(parents=True)
        self.server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self._write_models()
        self._plant()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server.server_port}"

    def environment(self) -> dict[str, str]:
        own = {name: os.environ[name] for name in ("LANG", "MUJOCO_GL", "TMPDIR") if name in os.environ}
        binaries = os.path.dirname(sys.executable)
        return own | {
            "PATH": f":.:bin:.venv/bin:{binaries}:{os.environ['PATH']}:",
            "HOME": str(self.place / "home"),
            "MJCOMPOSE_CACHE": str(self.place / "cache"),
            "MJCOMPOSE_PROGRAMS": str(self.place / "programs"),
            "MJCOMPOSE_TIMEOUT": "5",
            "PIP_NO_INDEX": "1",
            "BROWSER": "browser",
            "DISPLAY": ":99",
        }

    def run(self, *words: str, more: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[bytes]:
        """Type a command, as a process of its own; one that does not end gets Ctrl-C."""
        program = os.path.join(os.path.dirname(sys.executable), "mjcompose")
        with subprocess.Popen(
            [program, *words],
            cwd=self.path,
            env={**self.environment(), **(more or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        ) as process:
            try:
                out, errors = process.communicate(timeout=8 if words[0] == "view" else 300)
            except subprocess.TimeoutExpired:
                process.terminate()
                out, errors = process.communicate()
        assert b"internal error" not in errors and b"Traceback" not in errors, errors.decode()
        return subprocess.CompletedProcess(words, process.returncode, out, errors)

    def install(self, *versions: str) -> None:
        """Pretend to install versions of MuJoCo for the user: each is the one of this Python."""
        (self.place / "programs").mkdir(mode=0o700, exist_ok=True)
        for version in versions:
            place = self.place / "programs" / f"mujoco-{version}"
            (place / "bin").mkdir(parents=True, exist_ok=True)
            (place / "bin" / "python").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
            (place / "bin" / "python").chmod(0o755)
            (place / ".ready").touch()

    def left(self) -> list[str]:
        """The marks of what ran, and the requests that the configuration of the folder made."""
        return sorted(path.name for path in self.marks.iterdir()) + self.requests

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        requests = self.requests

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                if self.path.startswith("/index") or "Authorization" in self.headers:
                    requests.append(self.path)
                self.send_error(404)

            def log_message(self, *_: object) -> None:
                pass

        return Handler

    def _write_models(self) -> None:
        texts = {
            "arm.xml": ARM,
            "tool.xml": TOOL,
            "robot.yaml": ROBOT,
            "cell.yaml": CELL,
            "matrix.yaml": MATRIX,
            "arm.urdf.xacro": XACRO,
            "template.yaml": "recipe: 1\nbase: ./arm.urdf.xacro\n",
            "from_git.yaml": f"recipe: 1\nbase: git+{self.address}/robots@v1#arm.xml\n",
            "from_web.yaml": f"recipe: 1\nbase: {self.address}/robots.zip#arm.xml\n",
            "stamp.json": "{}",
            "fitted.yaml": FITTED,
            "swing.csv": SWING,
        }
        for name, text in texts.items():
            (self.path / name).write_text(text)
        release = self.place / "release"
        (release / "bin" / "mujoco_plugin").mkdir(parents=True)
        (release / "include").symlink_to(Path(mujoco.__file__).parent / "include")

    def _plant(self) -> None:
        path = self.path
        for name in MODULES:
            (path / f"{name}.py").write_text(self._code(f"module-{name}"))
        (path / "mjcompose").mkdir()
        for name in ("__init__", "__main__", "cli"):
            (path / "mjcompose" / f"{name}.py").write_text(self._code(f"module-mjcompose-{name}"))
        for folder in (path, path / "bin", path / ".venv" / "bin"):
            folder.mkdir(parents=True, exist_ok=True)
            for name in PROGRAMS:
                self._script(folder / name, f"program-{name}")
        self._script(path / ".venv" / "bin" / "mjcompose", "program-mjcompose")
        for name in ("drake", "pybullet"):
            (path / "consumers" / name / "bin").mkdir(parents=True)
            self._script(path / "consumers" / name / "bin" / "python", f"consumer-{name}")
        index = f"{self.address}/index"
        (path / "uv.toml").write_text(f'[[index]]\nurl = "{index}"\ndefault = true\n')
        (path / "pyproject.toml").write_text(
            f'[project]\nname = "x"\nversion = "1"\n[[tool.uv.index]]\nurl = "{index}"\n'
        )
        (path / "pip.conf").write_text(f"[global]\nindex-url = {index}\n")
        (path / "pyvenv.cfg").write_text("home = .\n")
        (path / ".netrc").write_text("machine 127.0.0.1 login somebody password secret\n")
        self._git()

    def _git(self) -> None:
        """A repository whose settings run programs, with attributes that use them."""
        git = ["git", "-c", "user.name=x", "-c", "user.email=x@y", "-C", str(self.path)]
        subprocess.run([*git, "init", "-q"], check=True)
        subprocess.run([*git, "add", "arm.xml", "tool.xml", "cell.yaml"], check=True)
        subprocess.run([*git, "commit", "-qm", "x"], check=True)
        marks = {
            name: f"touch {self.marks / f'git-{name}'}; false"
            for name in (
                "fsmonitor",
                "ssh",
                "pager",
                "editor",
                "askpass",
                "helper",
                "filter",
                "diff",
                "alias",
                "gpg",
                "upload",
            )
        }
        settings = f"""
[core]
    fsmonitor = "{marks["fsmonitor"]}"
    sshCommand = "{marks["ssh"]}"
    pager = "{marks["pager"]}"
    editor = "{marks["editor"]}"
    askPass = "{marks["askpass"]}"
    hooksPath = hooks
    attributesFile = .gitattributes
[credential]
    helper = "!{marks["helper"]}"
[filter "mark"]
    clean = "{marks["filter"]}"
    smudge = "{marks["filter"]}"
    process = "{marks["filter"]}"
    required = true
[diff "mark"]
    textconv = "{marks["diff"]}"
    command = "{marks["diff"]}"
[diff]
    external = "{marks["diff"]}"
[alias]
    show = "!{marks["alias"]}"
    cat-file = "!{marks["alias"]}"
[gpg]
    program = "{marks["gpg"]}"
[url "ext::sh -c {self.marks / "git-upload"}"]
    insteadOf = {self.address}/robots
[http]
    proxy = {self.address}/index
"""
        with (self.path / ".git" / "config").open("a") as config:
            config.write(settings)
        (self.path / ".gitattributes").write_text("* filter=mark diff=mark\n")
        (self.path / "hooks").mkdir()
        for name in ("post-checkout", "reference-transaction", "post-index-change", "pre-auto-gc"):
            self._script(self.path / "hooks" / name, f"hook-{name}")

    def _code(self, name: str) -> str:
        return f"import posix; posix.close(posix.open({str(self.marks / name)!r}, posix.O_WRONLY | posix.O_CREAT))\n"

    def _script(self, path: Path, name: str) -> None:
        path.write_text(f"#!/bin/sh\n: > '{self.marks / name}'\nexit 1\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)


@pytest.fixture
def theirs(tmp_path: Path) -> Iterator[Folder]:
    folder = Folder(tmp_path)
    yield folder
    folder.server.shutdown()
    folder.server.server_close()


@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name, lines in ROWS.items() if lines],
)
def test_nothing_of_the_folder_runs(theirs: Folder, command: str) -> None:
    """Without a cache and other programs, and then with the cache that it left and with other versions of MuJoCo."""
    if command in ("list", "verify", "rebuild"):
        theirs.run("build", "matrix.yaml", "--all", "-o", "cells/{name}/")
        theirs.run("build", "cell.yaml", "-o", "out.zip")
        (theirs.path / "stamp.json").write_text(json.dumps(mjcompose.stamp(theirs.path / "out.zip")))
    for is_first in (True, False):
        if not is_first:
            theirs.install("3.12.0", "3.2.7")
        for words in ROWS[command]:
            done = theirs.run(*words)
            assert done.returncode in (0, 1, 2, 143), done.stderr.decode()
            assert theirs.left() == [], f"mjcompose {' '.join(words)}: {done.stderr.decode()}"


def test_the_marks_are_left_by_what_runs(theirs: Folder) -> None:
    """The test of the test: programs that look into their folder do what is planted there."""
    environment = theirs.environment()
    subprocess.run(
        [sys.executable, "-m", "json.tool"], cwd=theirs.path, env=environment, check=False, capture_output=True
    )
    subprocess.run(["git", "hash-object", "arm.xml"], cwd=theirs.path, check=False, capture_output=True)
    subprocess.run(
        ["/bin/sh", "-c", "uv --version"], cwd=theirs.path, env=environment, check=False, capture_output=True
    )
    with suppress(urllib.error.HTTPError):
        urllib.request.build_opener(urllib.request.ProxyHandler({})).open(f"{theirs.address}/index", timeout=20)
    assert {"module-contextlib", "git-filter", "program-uv", "/index"} <= set(theirs.left())


def test_what_runs_in_spite_of_it_is_what_the_user_says(theirs: Folder) -> None:
    """Consumers in a folder of the folder, by a relative path, are nobody's wish."""
    done = theirs.run("check", "robot.yaml", more={"MJCOMPOSE_CONSUMERS": "consumers"})
    assert theirs.left() == []
    assert b"`MJCOMPOSE_CONSUMERS` is `consumers`, which is not an absolute path" in done.stderr
    theirs.run("check", "robot.yaml", more={"MJCOMPOSE_CONSUMERS": str(theirs.path / "consumers")})
    assert theirs.left() == ["consumer-drake", "consumer-pybullet"]


def test_python_m_drops_the_folder_before_it_imports_anything(theirs: Folder) -> None:
    """Python itself has imported some modules of the folder before; these are not planted here."""
    for name in (
        "contextlib",
        "warnings",
        "types",
        "functools",
        "collections",
        "runpy",
        "sitecustomize",
        "usercustomize",
    ):
        (theirs.path / f"{name}.py").unlink()
    shutil.rmtree(theirs.path / "mjcompose")
    done = subprocess.run(
        [sys.executable, "-m", "mjcompose", "check", "cell.yaml"],
        cwd=theirs.path,
        env=theirs.environment(),
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode()
    assert theirs.left() == []


def test_relative_entries_of_pythonpath_are_ignored(theirs: Folder) -> None:
    """The exceptions are the modules that Python itself imports when it starts: `sitecustomize`, and the script of the command."""
    for name in ("sitecustomize", "usercustomize", "re"):
        (theirs.path / f"{name}.py").unlink()
    shutil.rmtree(theirs.path / "mjcompose")
    for name in MODULES:
        if name in sys.stdlib_module_names:
            (theirs.path / f"{name}.py").unlink(missing_ok=True)
    theirs.run("check", "cell.yaml", "--no-cache", more={"PYTHONPATH": f":.:{REPOSITORY}:theirs"})
    assert theirs.left() == []


def test_completion_in_the_shell(theirs: Folder) -> None:
    for shell in ("bash", "zsh", "fish"):
        line = "mjcompose check ce"
        more = {
            "_MJCOMPOSE_COMPLETE": f"{shell}_complete",
            "COMP_WORDS": line,
            "COMP_CWORD": "2" if shell != "fish" else "ce",
            "COMP_LINE": line,
            "COMP_POINT": str(len(line)),
        }
        theirs.run("check", "ce", more=more)
        theirs.run("check", more={"_MJCOMPOSE_COMPLETE": f"{shell}_source"})
    assert theirs.left() == []


@pytest.mark.slow
def test_the_language_server_and_its_commands(theirs: Folder) -> None:
    shutil.rmtree(theirs.path / "mjcompose")
    for name in (
        "contextlib",
        "warnings",
        "types",
        "functools",
        "collections",
        "runpy",
        "sitecustomize",
        "usercustomize",
    ):
        (theirs.path / f"{name}.py").unlink()
    with Editor(theirs.path, environment={**theirs.environment(), "PYTHONSAFEPATH": "1"}) as editor:
        editor.open("robot.yaml", ROBOT)
        for command in ("mjcompose.check", "mjcompose.build", "mjcompose.view"):
            arguments = [str(theirs.path / "robot.yaml")]
            said = editor.ask("workspace/executeCommand", {"command": command, "arguments": arguments})
            assert "consumer-missing" in said or said.startswith("http")
    assert theirs.left() == []


@pytest.mark.slow
def test_the_tools_of_agents(theirs: Folder) -> None:
    pytest.importorskip("mcp", reason="mjcompose[mcp] is not installed")
    program = os.path.join(os.path.dirname(sys.executable), "mjcompose")
    client = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}}
    calls = [("check", {"recipe": "robot.yaml"}), ("render", {"recipe": "arm.xml"}), ("tree", {"recipe": "cell.yaml"})]
    messages: list[dict[str, object]] = [
        {"id": 0, "method": "initialize", "params": client},
        {"method": "notifications/initialized"},
        *(
            {"id": number, "method": "tools/call", "params": {"name": name, "arguments": arguments}}
            for number, (name, arguments) in enumerate(calls, 1)
        ),
    ]
    with subprocess.Popen(
        [program, "mcp"],
        cwd=theirs.path,
        env=theirs.environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        assert server.stdin is not None and server.stdout is not None
        for message in messages:
            server.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        server.stdin.flush()
        answers = 0
        end = time.monotonic() + 120
        while answers <= len(calls) and time.monotonic() < end:
            answers += "id" in json.loads(server.stdout.readline())
        server.stdin.close()
        server.wait(20)
    assert theirs.left() == []


@pytest.mark.slow
def test_a_cluster_of_this_machine(theirs: Folder) -> None:
    pytest.importorskip("distributed", reason="mjcompose[cluster] is not installed")
    done = theirs.run("build", "matrix.yaml", "--all", "-o", "cells/{name}/", "--cluster", "local", "--jobs", "2")
    assert done.returncode == 0, done.stderr.decode()
    assert theirs.left() == []
