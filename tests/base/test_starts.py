"""Every start of another program is in a table here: one module starts programs, and its callers name their folders."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from base.test_processes import end_of
from mjcompose.base import processes
from mjcompose.base.processes import DEVNULL, PIPE, Overrun, Process, WorkFolder, isolated, own_command, program
from mjcompose.base.runtime import without_current_folder

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "composer" / "mjcompose"
posix = pytest.mark.skipif(os.name != "posix", reason="needs a shell")

STARTERS = {
    "base/processes.py:<module>:subprocess": "the door itself",
    "base/processes.py:open_in_browser:webbrowser": "Windows starts the browser itself, and looks in no folder",
    "base/guard.py:end_with:fork": "the guard watches the parent of the program that it becomes",
    "base/guard.py:<module>:execvp": "the guard becomes the program, whose absolute path the door has found",
    "base/own_command.py:<module>:runpy": "the script that runs our own command, in this process",
    "targets/readers/shared/facts.py:<module>:runpy": "the script that runs a reader, in this process",
    "base/sandbox.py:probe.started:fork": "`doctor` tries whether a confined process can fork",
    "compose/edits.py:ModelEdits.in_doubt:fork": "a method of ours: it copies a sink",
    "cli/servers.py:mcp:anyio": "the loop of the server, which starts nothing",
    "cli/servers.py:_run:anyio": "threads, which start nothing",
    "tools/cluster/client.py:_local:LocalCluster": "Dask's workers: Python without the current folder, by the environment",
    "tools/cluster/client.py:_local:distributed": "the keys of the cluster",
    "tools/cluster/client.py:client_of:distributed": "the client of a cluster",
    "tools/cluster/client.py:connected:distributed": "the client of a cluster",
    "tools/cluster/client.py:Crew._take:distributed": "the client of a cluster",
    "tools/cluster/worker.py:make:distributed": "the worker asks for its address",
}
"""What starts programs beside the door or could, by file, function and way, and why it may."""

CALLS = {
    "base/processes.py:Helper.start": "the folder from which tasks name files",
    "base/processes.py:open_in_browser": None,
    "base/sandbox.py:call_confined": None,
    "cli/about.py:_git": None,
    "cli/servers.py:_run": "the folder of the agent",
    "lsp/protocol.py:Errands._start": "the folder of the editor",
    "mujoco/engine.py:Session._spawn": "a new folder of ours, for MuJoCo's log",
    "mujoco/environments.py:_run": "a folder of ours, for MuJoCo's log",
    "mujoco/programs.py:_install_with": None,
    "sources/git_command.py:Git._process": None,
    "sources/packages.py:_load": None,
    "targets/read_back.py:interpreter": None,
    "targets/read_back.py:read_back": "a folder of ours, for what the program writes",
    "tools/open/decoder.py:_compile": None,
}
"""Each call of the door, with the folder in which the program starts; None is an empty one."""

OTHER_LANGUAGES = {
    "composer/mjcompose/tools/open/decoder.c:posix_spawnp": "Python with -P, in the root folder",
    "editors/vscode/src/find.ts:node:child_process": "asks programs for their version, in the workspace that the user trusts",
    "editors/vscode/src/find.ts:execFile": "see above",
    "editors/vscode/src/server.ts:node:child_process": "the language server, in the workspace that the user trusts",
    "editors/vscode/src/server.ts:spawn": "see above",
    "editors/vscode/src/service.ts:node:child_process": "`mjcompose view`, in the workspace that the user trusts",
    "editors/vscode/src/service.ts:spawn": "see above",
    "editors/vscode/src/tasks.ts:ProcessExecution": "`build` and `check`, in the workspace that the user trusts",
    "editors/vscode/src/tasks.ts:executeTask": "see above",
}
"""What starts programs in C and TypeScript, and why it may."""

MODULES = {"subprocess", "multiprocessing", "pty", "webbrowser", "distributed", "anyio", "runpy", "pexpect"}
WAYS = re.compile(
    r"system|popen\d?|fork|forkpty|startfile|execfile|execv\w*|execl\w*|spawn[lv]\w*|posix_spawnp?|ProcessPoolExecutor"
    r"|LocalCluster|create_subprocess_\w+|subprocess_(exec|shell)|(open|run)_process|getoutput|getstatusoutput"
)
IN_WAYS = (
    "system",
    "popen",
    "fork",
    "startfile",
    "exec",
    "spawn",
    "ProcessPool",
    "LocalCluster",
    "subprocess",
    "_process",
    "getoutput",
    "getstatusoutput",
)
"""One of these is in each of the ways."""
DOORS = {"Process", "Helper"}
BY_NAME = {"import_module", "__import__", "find_spec", "getattr", "attrgetter", "methodcaller"}
IN_C = re.compile(r"\b(posix_spawnp?|v?fork|exec[lv]\w*|system|popen|clone3?)\s*\(")
IN_TYPESCRIPT = re.compile(
    r"(?<!\w)(node:child_process|child_process|spawn|spawnSync|(?<!\.)exec|execSync|execFile|execFileSync|fork|ProcessExecution"
    r"|ShellExecution|createTerminal|executeTask|openExternal|Worker)\b(?=[\"'(])"
)


def starts(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield each function that starts a program or could, with the way, and `door` for a call of the door."""

    def walk(node: ast.AST, where: tuple[str, ...]) -> Iterator[tuple[str, str]]:
        for child in ast.iter_child_nodes(node):
            inner = where
            if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                inner = (*where, child.name)
            for way in ways(child):
                yield ".".join(inner) or "<module>", way
            yield from walk(child, inner)

    return walk(tree, ())


def ways(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Import | ast.ImportFrom):
        origin = (node.module or "").split(".") if isinstance(node, ast.ImportFrom) else []
        names = [part for each in node.names for part in each.name.split(".")]
        yield from MODULES & {*origin[:1], *(names[:1] if not origin else ())}
        yield from (name for name in names if origin[:1] != ["mjcompose"] and WAYS.fullmatch(name))
    elif isinstance(node, ast.Attribute) and WAYS.fullmatch(node.attr):
        if ast.unparse(node.value) != "platform":
            yield node.attr
    elif isinstance(node, ast.Call):
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        if name in DOORS:
            yield "door"
        if name in BY_NAME:  # as in `import_module("subprocess")` and `getattr(os, "system")`
            words = [each.value for each in node.args if isinstance(each, ast.Constant) and isinstance(each.value, str)]
            yield from (word for word in words if word.split(".")[0] in MODULES or WAYS.fullmatch(word))


@cache
def found_in_package() -> frozenset[tuple[str, str, str]]:
    return frozenset(
        (path, function, way) for path, tree in trees(*MODULES, *DOORS, *IN_WAYS) for function, way in starts(tree)
    )


def trees(*words: str) -> Iterator[tuple[str, ast.Module]]:
    """Yield the modules whose text has one of these words."""
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if any(word in text for word in words):
            yield path.relative_to(PACKAGE).as_posix(), ast.parse(text)


def test_the_collector_finds_every_form() -> None:
    forms = [
        "import subprocess",
        "from subprocess import run",
        "import multiprocessing.pool",
        "from os import system as s",
        "import os as o; o.execv(a, b)",
        "os.posix_spawn(a, b, c)",
        "getattr(os, 'popen')",
        "os.spawnlp(a)",
        "importlib.import_module('subprocess')",
        "__import__('pty')",
        "asyncio.create_subprocess_exec(a)",
        "from concurrent.futures import ProcessPoolExecutor",
        "loop.subprocess_shell(a)",
        "anyio.run_process(a)",
        "os.forkpty()",
        "os.startfile(a)",
        "import webbrowser as w",
        "Process(a)",
        "processes.Process(a)",
    ]
    assert [form for form in forms if not list(starts(ast.parse(form)))] == []
    for form in ("import os", "platform.system()", "from concurrent.futures import ThreadPoolExecutor", "self.fork_of"):
        assert not list(starts(ast.parse(form))), form


def test_every_start_of_a_program_is_in_the_table() -> None:
    found = {f"{path}:{function}:{way}" for path, function, way in found_in_package() if way != "door"}
    unlisted = found - STARTERS.keys()
    assert not unlisted, f"start these with `mjcompose.base.processes.Process`: {unlisted}"
    assert not STARTERS.keys() - found, "these start nothing: take them from the table"


def test_every_call_of_the_door_is_in_the_table() -> None:
    found = {f"{path}:{function}" for path, function, way in found_in_package() if way == "door"}
    within = {"base/processes.py:Pool.__init__", "tools/cluster/worker.py:Station._helper"}  # as `Helper.start`
    assert found - within == CALLS.keys()
    with_folder = set()
    for path, tree in trees("WorkFolder("):
        for function, node in _functions(tree):
            calls = [each for each in ast.walk(node) if isinstance(each, ast.Call)]
            for call in calls:
                if ast.unparse(call.func) == "WorkFolder":
                    assert len(call.args) == 2 and isinstance(call.args[1], ast.Constant), "give the reason"
                    with_folder.add(f"{path}:{function}")
    assert with_folder == {call for call, folder in CALLS.items() if folder is not None}


def _functions(tree: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, node
        elif isinstance(node, ast.ClassDef):
            yield from ((f"{node.name}.{name}", each) for name, each in _functions(node))


def test_every_start_in_other_languages_is_in_the_table() -> None:
    sources = [
        path
        for folder in (ROOT / "composer", ROOT / "editors")
        for path in sorted(folder.rglob("*"))
        if path.suffix in (".c", ".h", ".cc", ".cpp", ".ts", ".mjs", ".js")
        and path.parent.parent.name != "view"  # pages of a browser, which can start nothing
        and not {"node_modules", "test", "dist", "out"} & set(path.relative_to(ROOT).parts)
    ]
    found = set()
    for path in sources:
        pattern = IN_C if path.suffix in (".c", ".h", ".cc", ".cpp") else IN_TYPESCRIPT
        code = re.sub(r"^\s*//.*$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        found |= {f"{path.relative_to(ROOT).as_posix()}:{way}" for way in pattern.findall(code)}
    assert found == OTHER_LANGUAGES.keys()


@posix
def test_a_program_starts_in_an_empty_folder_of_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    script = "pwd; ls -A; ls -ld . | cut -c1-10; cat"
    with Process(["sh", "-c", script], stdout=PIPE) as process:
        out, _ = process.finish(seconds=20, most=1000)
    folder, mode = out.decode().split()
    assert Path(folder) == processes.empty_folder() and mode == "dr-x------"
    with Process(["pwd"], stdout=PIPE, folder=WorkFolder(tmp_path, "this test")) as process:
        assert Path(process.finish(seconds=20, most=1000)[0].decode().strip()) == tmp_path
    with pytest.raises(TypeError, match="WorkFolder"):
        Process(["pwd"], cwd=tmp_path)


@posix
def test_a_folder_that_is_not_empty_any_more_is_replaced() -> None:
    folder = processes.empty_folder()
    assert processes.empty_folder() == folder
    folder.chmod(0o700)
    (folder / "json.py").touch()
    assert processes.empty_folder() != folder


ENDS = """
from mjcompose.base import processes
print(processes.empty_folder(), flush=True)
own = processes.empty_folder()
if os.fork() == 0:
    sys.exit(processes.empty_folder() == own)
assert os.wait()[1] == 0
assert processes.empty_folder() == own and os.path.isdir(own)
"""


@posix
def test_the_empty_folder_goes_with_its_process_and_not_with_a_fork() -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"import os, sys\n{ENDS}"], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() and not os.path.exists(Path(done.stdout.strip()).parent)


@posix
def test_a_temporary_folder_that_others_can_change_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "open"))
    monkeypatch.setattr(processes, "_emptied", {})
    with pytest.raises(OSError, match="is not trusted"):
        Process(["true"])


@posix
@pytest.mark.parametrize("path", ["", ".", ":", "bin", ":/usr/bin:/bin", "./bin:/usr/bin:/bin"])
def test_no_program_of_the_current_folder_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str) -> None:
    (tmp_path / "bin").mkdir()
    for name in ("bin/sh", "sh"):
        (tmp_path / name).write_text("#!/bin/sh\necho theirs\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.chdir(tmp_path)
    for folder in (None, WorkFolder(tmp_path, "this test")):
        with Process(
            ["sh", "-c", "echo ours; sh -c 'echo ours'"], env={"PATH": path}, stdout=PIPE, folder=folder
        ) as it:
            assert it.finish(seconds=20, most=100)[0] == b"ours\nours\n"
    for word in ("./sh", "bin/sh", ""):
        with pytest.raises(FileNotFoundError):
            Process([word])
    found = program("sh", {"PATH": path})
    assert found is None or found.startswith(("/usr/bin/", "/bin/"))


def test_search_paths_have_absolute_folders_alone() -> None:
    here = os.path.abspath(os.sep + "a")
    there = os.path.abspath(os.sep + "b")
    path = os.pathsep.join(["", here, ".", "c", there, ""])
    names = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH")
    clean = without_current_folder({**dict.fromkeys(names, path), "OTHER": path})
    assert clean == {**dict.fromkeys(names, f"{here}{os.pathsep}{there}"), "OTHER": path}


@posix
def test_output_has_a_limit_and_errors_keep_their_end() -> None:
    with Process(["sh", "-c", "yes"], stdout=PIPE) as process, pytest.raises(Overrun, match="more than 5000") as over:
        process.finish(seconds=20, most=5000)
    assert not over.value.is_late and process.poll() is not None
    script = "i=0; while [ $i -lt 20000 ]; do echo line $i >&2; i=$((i+1)); done; printf '%5000s' x"
    with Process(["sh", "-c", script], stdout=PIPE, stderr=PIPE) as process:
        out, errors = process.finish(seconds=60, most=5000)
    assert len(out) == 5000 and len(errors) <= 1 << 16 and errors.endswith(b"line 19999\n")


@posix
def test_time_has_a_limit_even_if_a_program_holds_the_pipe() -> None:
    with Process(["sleep", "60"], stdout=PIPE) as process, pytest.raises(Overrun, match=r"longer than 0\.3 s") as over:
        process.finish(seconds=0.3, most=5000)
    assert over.value.is_late and process.poll() is not None
    begun = time.monotonic()
    with Process(["sh", "-c", "sleep 60 & echo $!"], stdout=PIPE) as process:
        started = int(process.finish(seconds=20, most=100)[0])
    assert end_of([started]) < 5
    leaves = "import subprocess; subprocess.Popen(['sleep', '60'], start_new_session=True); print('done')"
    with Process(isolated(sys.executable, ["-c", leaves]), stdout=PIPE) as process:
        assert process.finish(seconds=20, most=100)[0] == b"done\n"
    assert time.monotonic() - begun < 40


@posix
def test_a_program_reads_no_terminal_and_gets_its_input_whole() -> None:
    reads = "from mjcompose.base.processes import Process\nwith Process(['cat']) as it: it.wait()"
    done = subprocess.run([sys.executable, "-c", reads], input=b"typed", capture_output=True, check=True)
    assert done.stdout == b""
    content = bytes(range(256)) * 4000
    with Process(["cat"], stdin=PIPE, stdout=PIPE) as process:
        assert process.finish(seconds=20, most=len(content), content=content)[0] == content
    with Process(["true"], stdin=PIPE, stdout=DEVNULL) as process:
        assert process.finish(seconds=20, most=0, content=content) == (b"", b"")


def test_our_own_command_has_the_modules_of_this_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("json", "runpy", "yaml", "mjcompose", "sitecustomize"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    monkeypatch.setattr(sys, "path", ["", ".", *sys.path])
    monkeypatch.chdir(tmp_path)
    folder = WorkFolder(tmp_path, "this test")
    with Process(
        own_command("--version"), stdout=PIPE, env={**os.environ, "PYTHONPATH": "."}, folder=folder
    ) as process:
        out, _ = process.finish(seconds=60, most=1000)
    assert out.startswith(b"mjcompose, version ") and process.returncode == 0
    assert not (tmp_path / "ran").exists()
    assert isolated("python", ["x"]) == ["python", "-I", "x"]


@posix
def test_the_browser_is_found_in_absolute_folders_and_starts_in_an_empty_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in ("theirs", "ours"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "browser").write_text(f"#!/bin/sh\npwd > {tmp_path}/{folder}.ran\n")
        (tmp_path / folder / "browser").chmod(0o755)
    (tmp_path / "theirs" / "webbrowser.py").write_text(f"open({str(tmp_path / 'module.ran')!r}, 'w')")
    monkeypatch.chdir(tmp_path / "theirs")
    monkeypatch.setenv("BROWSER", "browser")
    monkeypatch.setenv("PATH", f".:{tmp_path / 'ours'}:{os.environ['PATH']}")
    processes.open_in_browser("file:///nothing.html")
    assert (tmp_path / "ours.ran").read_text().strip() == str(processes.empty_folder())
    assert sorted(path.name for path in tmp_path.glob("*.ran")) == ["ours.ran"]


@posix
def test_a_file_that_is_no_program_is_passed_over(tmp_path: Path) -> None:
    for folder, mode in (("first", 0o644), ("second", 0o755)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "tool").touch()
        (tmp_path / folder / "tool").chmod(mode)
    path = f"{tmp_path / 'first'}:{tmp_path / 'second'}"
    assert program("tool", {"PATH": path}) == str(tmp_path / "second" / "tool")
    assert program("tool", {"PATH": str(tmp_path / "first")}) is None
