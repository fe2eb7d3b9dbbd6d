from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from cli.shell import environment, process, run
from click.testing import CliRunner
from mjcompose.base import __version__
from mjcompose.cli import main as main_module, reporting
from mjcompose.cli.main import main

VERBS = ("build", "check", "plan", "new", "schema")


def test_version_and_help() -> None:
    assert run("--version").stdout == f"mjcompose, version {__version__}\n"
    told = run("--help").stdout
    assert all(f"\n  {verb} " in told for verb in VERBS)
    assert run("-h").stdout == told


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help(verb: str) -> None:
    result = run(verb, "--help")
    assert result.exit_code == 0 and result.stdout.startswith(f"Usage: mjcompose {verb}")


def test_help_costs_nothing() -> None:
    """No heavy library is imported for `--help`, of the command and of every verb."""
    program = (
        "import sys\nfrom mjcompose.cli.main import main\n"
        f"for verb in [[], *([each] for each in {VERBS})]:\n"
        "    main([*verb, '--help'], standalone_mode=False)\n"
        "print(sorted({'mujoco', 'numpy', 'pydantic', 'lxml', 'yaml'} & set(sys.modules)), file=sys.stderr)\n"
    )
    told = subprocess.run(
        [sys.executable, "-c", program], env=environment(), capture_output=True, text=True, check=True
    )
    assert told.stderr.strip() == "[]"


def test_an_unknown_command(folder: Path) -> None:
    result = run("biuld", "cell.yaml")
    assert result.exit_code == 2 and "Did you mean `build`?" in result.stderr
    result = run("cell.yaml")
    assert result.exit_code == 2 and "Write `mjcompose build cell.yaml`." in result.stderr
    assert run("xyzzy").exit_code == 2
    assert run("--xyzzy").exit_code == 2


def test_a_bug_is_told_without_a_trace(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise KeyError("a thing\nnobody thought of")

    monkeypatch.setattr("mjcompose.cli.output.progress", broken)  # first: it imports the module, which takes the other
    monkeypatch.setattr(reporting, "progress", broken)
    result = CliRunner().invoke(main, ["build", "cell.yaml"])
    assert result.exit_code == 70
    assert "this is a bug in mjcompose: KeyError in" in result.output
    assert "Traceback" not in result.output
    monkeypatch.setenv("MJCOMPOSE_TRACEBACK", "1")
    assert isinstance(CliRunner().invoke(main, ["build", "cell.yaml"]).exception, KeyError)


def test_it_runs_as_a_module(folder: Path) -> None:
    result = process("plan", "cell.yaml")
    assert result.returncode == 0 and result.stdout.startswith(b"cell: the model of cell.yaml\n")
    assert result.stderr == b""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [["plan", "cell.yaml"], ["build", "cell.yaml", "--no-compile", "-o", "-"]])
def test_an_output_that_takes_nothing(folder: Path, arguments: list[str]) -> None:
    with open("/dev/full", "wb") as full:
        result = process(*arguments, capture_output=False, stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 1
    assert result.stderr == b"cannot continue: no space left on device\n"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
def test_outputs_that_are_closed(folder: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m mjcompose"
    for line, code in (
        (f"{command} check wrong.yaml 2>&-", 1),
        (f"{command} plan cell.yaml >&-", 0),
        (f"{command} build cell.yaml --no-compile -o - >&- 2>&-", 1),
        (f"{command} build cell.yaml --no-compile -o - | true", 0),
    ):
        result = subprocess.run(line, shell=True, env=environment(), capture_output=True, timeout=60, check=False)
        assert (result.returncode, result.stderr) == (code, b""), line


@pytest.mark.skipif(sys.platform == "win32", reason="a folder in use cannot be removed there")
def test_a_folder_that_is_gone(folder: Path) -> None:
    python = shlex.quote(sys.executable)
    line = f"mkdir gone && cd gone && rmdir ../gone && {python} -m mjcompose check ../cell.yaml"
    result = subprocess.run(
        line, shell=True, env=environment(), capture_output=True, text=True, timeout=60, check=False
    )
    assert (result.returncode, result.stderr) == (1, "cannot continue: no such file or directory\n")


@pytest.mark.parametrize("verb", list(main_module._VERBS))
def test_help_of_every_verb_is_text_for_people(verb: str) -> None:
    result = run(verb, "--help")
    assert result.exit_code == 0 and result.stdout.startswith("Usage: mjcompose " + verb)
    assert "\\b" not in result.stdout and "`None`" not in result.stdout


def test_version_and_help_as_commands() -> None:
    assert run("version").stdout == run("-V").stdout == run("--version").stdout
    assert run("help").stdout == run("--help").stdout
    assert run("help", "build").stdout == run("build", "--help").stdout
    assert run("help", "cache", "info").stdout == run("cache", "info", "--help").stdout
    assert run("help", "biuld").exit_code == 2 and "`build`" in run("help", "biuld").stderr
    assert run("help", "build", "x").exit_code == 2


@pytest.mark.parametrize(
    ("word", "command"), [("init", "new"), ("validate", "check"), ("format", "fmt"), ("show", "tree")]
)
def test_what_other_tools_call_it(word: str, command: str) -> None:
    result = run(word, "x")
    assert result.exit_code == 2 and f"Write `mjcompose {command}`" in result.stderr


def test_every_answer_names_a_command_that_exists() -> None:
    for words in main_module._CALLED.values():
        _, verb, *_ = words.split()
        assert verb in main_module._VERBS


def test_an_unknown_option(folder: Path) -> None:
    """Only one that may be meant is suggested; click by itself suggests `--why` for `--whale`."""
    result = run("build", "cell.yaml", "--whale")
    assert result.exit_code == 2 and result.stderr.endswith("No such option '--whale'.\n")
    assert "Did you mean '--why'?" in run("build", "cell.yaml", "--wy").stderr


@pytest.mark.parametrize(
    ("option", "instead"),
    [
        ("--json", "--output-format"),
        ("--variant", "--set"),
        ("--no-verify", "--no-compile"),
        ("--samples", "--sample-table"),
    ],
)
def test_an_option_of_another_tool_has_a_hint(option: str, instead: str) -> None:
    assert f"Did you mean '{instead}'?" in run("build", "cell.yaml", option).stderr


def test_options_are_listed_in_groups() -> None:
    told = run("render", "--help").stdout
    order = [
        "Options:",
        "--camera",
        "Model:",
        "--set ",
        "Limits:",
        "--timeout",
        "Sources:",
        "--locked",
        "Output:",
        "--quiet",
    ]
    assert [told.index(word) for word in order] == sorted(told.index(word) for word in order)
    told = run("--help").stdout
    order = ["Build:", "check ", "Look:", "view ", "Change:", "fmt ", "Sources:", "lock ", "Set up:", "doctor "]
    assert [told.index(word) for word in order] == sorted(told.index(word) for word in order)


def test_a_table_of_samples_needs_several_models() -> None:
    done = run("build", "cell.yaml", "--sample-table", "s.csv")
    assert done.exit_code == 2 and "--sample-table is for --all" in done.stderr


# What may be said to every command that does such a thing.
SAME = {
    "--output-format": {"identify", "install", "uninstall", "upgrade", "names", "lint", "list", "build", "rebuild", "check", "verify", "plan", "explain", "lock", "diff", "new", "fmt", "import", "doctor",
               "render", "view", "tree", "fix", "migrate"},
    "--quiet": {"identify", "install", "uninstall", "upgrade", "names", "lint", "list", "build", "rebuild", "check", "verify", "plan", "explain", "lock", "diff", "new", "fmt", "import",
                "render", "view", "tree", "fix", "migrate"},
    "--output": {"identify", "names", "build", "rebuild", "import", "render", "migrate"},
    "--pick": {"names", "build", "check", "plan", "explain", "diff", "render", "view", "tree"},
    "--sample": {"names", "build", "check", "plan", "explain", "diff", "render", "view", "tree"},
    "--all": {"build", "check", "render"},
    "--strict": {"build", "check", "verify", "migrate"},
    "--verbose": {"build", "check"},
    "--timeout": {"identify", "upgrade", "names", "lint", "build", "check", "verify", "diff", "import", "render", "view", "migrate"},
    "--limit": {"identify", "upgrade", "names", "lint", "build", "rebuild", "check", "verify", "plan", "explain", "lock", "diff", "import", "render", "view",
                "tree", "fix", "migrate"},
    "--set": {"identify", "names", "build", "check", "plan", "explain", "lock", "diff", "render", "view", "tree", "fix"},
}  # fmt: skip


@pytest.mark.parametrize("option", list(SAME))
def test_options_are_the_same_everywhere(option: str) -> None:
    told = {verb: run(verb, "--help").stdout for verb in main_module._VERBS}
    having = {verb for verb, help in told.items() if re.search(rf"{option}\b(?!-)", help.partition("Options:")[2])}
    assert having - {"diff"} == SAME[option] - {"diff"}
    assert "diff" in having or "diff" not in SAME[option]


@pytest.mark.parametrize(
    "words",
    [
        ("build", "gone.yaml"),
        ("build", "gone.yaml", "--all"),
        ("check", "gone.yaml"),
        ("check", "gone.yaml", "--all"),
        ("plan", "gone.yaml"),
        ("plan", "gone.yaml", "--pick", "a"),
        ("explain", "gone.yaml", "world"),
        ("explain", "gone.xml", "world"),
        ("lock", "gone.yaml"),
        ("verify", "gone.zip"),
        ("fmt", "gone.yaml"),
        ("import", "gone.xml", "models/tool.xml"),
        ("import", "calibration", "gone.yaml", "models/tool.xml", "-o", "robot.yaml"),
        ("diff", "gone.yaml", "cell.yaml"),
    ],
)
def test_a_file_that_does_not_exist_is_wrong_usage(folder: Path, words: tuple[str, ...]) -> None:
    result = run(*words)
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr, result.stderr


def test_quiet(folder: Path) -> None:
    for words in (
        ("build", "cell.yaml"),
        ("build", "cell.yaml", "--why"),
        ("check", "cell.yaml"),
        ("lock", "cell.yaml"),
        ("new", "new.yaml"),
    ):
        result = run(*words, "-q")
        assert (result.exit_code, result.stdout, result.stderr) == (0, "", ""), words
    assert "error[attach-place]" in run("check", "wrong.yaml", "--quiet").stderr
    assert run("build", "cell.yaml", "-q", "--output-format", "json").stdout.startswith("{")


def test_too_little_memory_is_reported_where_the_process_begins(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr("mjcompose.plan.read._text", none)
    result = run("plan", "cell.yaml")
    assert isinstance(result.exception, MemoryError) and not result.stderr


def test_mcp_without_its_extra_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("mcp", "mcp.server.lowlevel", "mcp.server.stdio", "mcp_types"):  # some may be imported already
        monkeypatch.setitem(sys.modules, name, None)
    result = run("mcp")
    assert result.exit_code == 2 and 'pip install "mjcompose[mcp]"' in result.stderr
