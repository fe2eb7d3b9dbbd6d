"""A page of the docs, carried out: what it says to write is written, what it says to run is run.

A page is a list of blocks, in the order of the page:

- a block with a file name (```` ```yaml title="cell.yaml" ````) is written. Of YAML, a key at the top replaces that of the file, or
  comes after what is there;
- in a block of text, a line after `$ ` is run, and the lines below it stand in what it prints, in this order. `…` alone on a line stands
  for any lines;
- a picture shows the last picture that a command wrote; drawings (`.svg`) are left out.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from cli.shell import environment, run
from targets.environments import is_ready, python_of

_BLOCKS = re.compile(
    r'^```(?P<language>\w+)(?: title="(?P<file>[^"]+)")?\n(?P<text>.*?)^```|^!\[[^\]]*\]\((?P<picture>[^)]+\.png)\)',
    re.MULTILINE | re.DOTALL,
)
_SECTION = re.compile(r"\n(?=\w)")


_LACKS = re.compile(r"ModuleNotFoundError: No module named '(\w+)")
_INSTALLED = {"pydrake": "drake", "pinocchio": "pinocchio", "newton": "newton"}
"""The modules that `make test-targets` installs into environments of their own."""


class NotHere(Exception):
    """This machine lacks what a command needs."""


@dataclass
class Replay:
    """A page in a folder of its own, which is the working folder."""

    page: Path
    folder: Path
    written: Path | None = None
    lacking: set[str] = field(default_factory=set)
    """Modules without which programs of the page were not run."""
    pictures: dict[Path, bytes] = field(default_factory=dict)
    """The pictures of the page, each with what the command above it made."""

    def whole(self) -> None:
        text = self.page.read_text(encoding="utf-8")
        for package in re.findall(r"model: package:(\w+)/", text):
            if find_spec(package) is None:
                raise NotHere(f"{package} is not installed")
        for block in _BLOCKS.finditer(text):
            if block["picture"]:
                assert self.written is not None, f"no command made {block['picture']}"
                self.pictures[self.page.parent / block["picture"]] = self.written.read_bytes()
            elif block["file"]:
                self._write(self.folder / block["file"], block["text"], block["language"] == "yaml")
            elif block["language"] == "text":
                for command, shown in _commands(block["text"]):
                    fails = any("error[" in line for line in shown)
                    printed = self._run(shlex.split(command), fails)
                    if printed is not None:
                        self._compare(command, shown, printed)

    def _write(self, file: Path, text: str, is_yaml: bool) -> None:
        file.parent.mkdir(parents=True, exist_ok=True)
        if is_yaml and file.exists() and not text.startswith("recipe:"):
            text = _joined(_sections(file.read_text(encoding="utf-8")), _sections(text))
        file.write_text(text, encoding="utf-8")

    def _run(self, words: list[str], fails: bool) -> str | None:
        """What a command prints; None if it needs a module that is not installed."""
        program, *arguments = words
        if program == "python":
            return self._python(sys.executable, arguments)
        assert program == "mjcompose", f"pages show commands of mjcompose and python, not {program}"
        result = run(*arguments)
        if "no-rendering" in result.stderr:
            raise NotHere("there is no OpenGL")
        expected = {1} if fails else {0, 1} if {"diff", "lint"} & {*arguments} else {0}  # a difference is 1
        assert result.exit_code in expected, f"{words}: {result.stderr}"
        if found := re.search(r"^wrote (\S+\.png)", result.stdout, re.MULTILINE):
            self.written = self.folder / found[1]
        return result.stderr + result.stdout  # the order in a terminal, where warnings come first

    def _python(self, program: str, arguments: list[str]) -> str | None:
        made = subprocess.run(
            [program, *arguments],
            cwd=self.folder,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=400,
            check=False,
        )
        if lacks := _LACKS.search(made.stderr):
            other = _INSTALLED.get(lacks[1])
            if other is not None and is_ready(other) and program == sys.executable:
                return self._python(str(python_of(other)), arguments)
            self.lacking.add(lacks[1])
            return None
        assert made.returncode == 0, made.stderr
        return made.stdout

    def _compare(self, command: str, shown: list[str], printed: str) -> None:
        lines = iter(printed.splitlines())
        for line in shown:
            found = line == "…" or any(each.rstrip() == line.rstrip() for each in lines)
            assert found, f"`{command}` does not print `{line}` at its place; it prints:\n{printed}"


def _sections(text: str) -> dict[str, str]:
    """The text of each key at the top of a YAML file."""
    return {section.partition(":")[0]: section for section in _SECTION.split(text.strip())}


def _joined(old: dict[str, str], new: dict[str, str]) -> str:
    """The text of a file in which a reader replaces sections, or adds them at the end after an empty line."""
    for key, section in new.items():
        if key in old:
            old[key] = section.rstrip() + ("\n" if old[key].endswith("\n") else "")
        else:
            last = next(reversed(old))
            old[last] = f"{old[last].rstrip()}\n"
            old[key] = section.rstrip()
    return "\n".join(old.values()) + "\n"


def _commands(text: str) -> Iterator[tuple[str, list[str]]]:
    """The commands of a block, each with the lines shown below it."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *shown = part.splitlines()
        yield command, shown
