"""The command line: a list of words as JSON, in a folder with recipes, models and bundles."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

from click.testing import CliRunner
from fuzz.target import RECIPES, Seed, Target, Tools
from mjcompose.cli.main import _VERBS, main

_WORDS = (
    "arm_gripper.yaml",
    "cubes.yaml",
    "models/props/cube.xml",
    "missing.yaml",
    "out.zip",
    "out/",
    "out.mjz",
    "out.xml",
    "-",
    "",
    " ",
    "*",
    "é",
    "\udcff",
    "a b",
    "{name}.zip",
    "x=1",
    "x",
    "=",
    "geom *",
    "body arm#1",
    "width=0.13",
    "--",
    "--help",
    "-h",
    "-o",
    "--output-format",
    "json",
    "--output-format",
    "json",
    "github",
    "junit",
    "text",
    "--no-compile",
    "--no-cache",
    "--offline",
    "--locked",
    "--all",
    "--set",
    "--pick",
    "--sample",
    "-1",
    "999999999999999999999",
    "1e3",
    "nan",
    "--dedup",
    "--check",
    "--quiet",
    "--timeout",
    "0.5",
    "--memory",
    "1",
    "--jobs",
    "--watch-nothing",
    "--project",
    "sub/new.yaml",
    "new",
    "prune",
    "list",
    "clean",
)


_SERVING = {"view", "lsp"}
"""What runs until it is interrupted."""


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    for words in (
        ["build", "arm_gripper.yaml", "-o", "out.zip"],
        ["build", "cubes.yaml", "-o", "out/", "--no-compile"],
        ["check", "arm_gripper.yaml"],
        ["plan", "cubes.yaml"],
        ["explain", "arm_gripper.yaml", "geom *"],
        ["fmt", "cubes.yaml"],
        ["diff", "cubes.yaml", "arm_gripper.yaml"],
        ["verify", "out.zip"],
        ["lock", "cubes.yaml"],
        ["new", "sub/new.yaml"],
        ["import", "models/props/cube.xml"],
        ["cache", "list"],
        ["schema", "recipe"],
        ["doctor"],
        ["version"],
    ):
        yield Seed(json.dumps(words).encode())


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    words = json.loads(data)
    for _ in range(random.randint(1, 3)):
        at = random.randrange(len(words) + 1)
        words[at : at + random.randint(0, 1)] = [random.choice([*_WORDS, *sorted(_VERBS.keys() - _SERVING)])]
    return json.dumps(words).encode()


def check(path: Path, tools: Tools) -> str | None:
    before = Path.cwd()
    os.chdir(path.parent)
    try:
        result = CliRunner().invoke(main, json.loads(path.read_bytes()), prog_name="mjcompose")
    finally:
        os.chdir(before)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return None if result.exit_code in (0, 1, 2, 130) else f"exit-{result.exit_code}: {result.output[-300:]}"


TARGET = Target("command", ".json", _seeds, _mutate, check, RECIPES)
