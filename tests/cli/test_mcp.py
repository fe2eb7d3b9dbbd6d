"""`mjcompose mcp`: an agent that is scripted, over real standard input and output."""

from __future__ import annotations

import base64
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cli.shell import RECIPE, WRONG, environment, run

mcp = pytest.importorskip("mcp", reason="mjcompose[mcp] is not installed")
pytestmark = pytest.mark.slow


class Agent:
    """Plain lines of JSON-RPC, as any client of the protocol writes them."""

    def __init__(self, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "mjcompose", "mcp"],
            cwd=folder,
            env=environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf-8",
        )
        self.number = 0
        client = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}}
        self.server = self.ask("initialize", client)
        self.send({"method": "notifications/initialized"})

    def send(self, message: dict[str, Any]) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def ask(self, method: str, params: dict[str, Any]) -> dict[str, Any]:
        self.number += 1
        self.send({"id": self.number, "method": method, "params": params})
        assert self.process.stdout is not None
        while (answer := json.loads(self.process.stdout.readline())).get("id") != self.number:
            pass
        return answer["result"]

    def call(self, tool: str, **arguments: Any) -> tuple[bool, str]:
        """Whether a tool succeeded, and its text."""
        result = self.ask("tools/call", {"name": tool, "arguments": arguments})
        return not result.get("isError"), result["content"][0].get("text") or result["content"][0]["data"]

    def end(self) -> int:
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.close()
        code = self.process.wait(20)
        self.process.stdout.close()
        return code


@pytest.fixture
def agent(folder: Path) -> Iterator[Agent]:
    agent = Agent(folder)
    yield agent
    if agent.process.poll() is None:
        assert agent.end() == 0


def test_it_has_seven_tools_and_starts_quickly(folder: Path) -> None:
    before = os.times()
    agent = Agent(folder)
    tools = agent.ask("tools/list", {})["tools"]
    assert {each["name"] for each in tools} == {"tree", "plan", "check", "fix", "explain", "render", "reference"}
    assert [each["name"] for each in tools if not each["annotations"]["readOnlyHint"]] == ["fix"]
    assert agent.server["serverInfo"]["name"] == "mjcompose" and "`check`" in agent.server["instructions"]
    assert agent.end() == 0
    after = os.times()
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    assert spent < 1, spent


def test_an_agent_mends_a_recipe(agent: Agent, folder: Path) -> None:
    ok, text = agent.call("check", recipe="wrong.yaml")
    found = json.loads(text.splitlines()[0])
    assert ok and found["code"] == "attach-place" and found["span"]["line"] == 5
    assert agent.call("explain", recipe=found["code"])[1].startswith("attach-place")
    assert (
        "+  tool: {model: ./models/tool.xml, site: flange}"
        in json.loads(agent.call("fix", recipe="wrong.yaml")[1].splitlines()[0])["diff"]
    )
    assert (folder / "wrong.yaml").read_text() == WRONG
    assert agent.call("fix", recipe="wrong.yaml", write=True)[0]
    assert (folder / "wrong.yaml").read_text() == RECIPE
    assert agent.call("check", recipe="wrong.yaml") == (True, "no errors")
    assert "tool  models/tool.xml" in agent.call("tree", recipe="wrong.yaml", depth=1)[1]
    assert "attach tool/" in agent.call("plan", recipe="cell.yaml")[1]
    assert "cell.yaml:7" in agent.call("explain", recipe="cell.yaml", query="sensor angle")[1]
    assert agent.call("reference", key="attach.site")[1].startswith("# `attach`")
    assert "pages: index, trust" in agent.call("reference", key="attatch")[1]


def test_values_are_those_of_the_call(agent: Agent, folder: Path) -> None:
    (folder / "cell.yaml").write_text(
        f"{RECIPE}params: {{size: 0.1}}\nadd:\n  - {{to: link, site: {{name: s, pos: ['${{size}}', 0, 0]}}}}\n"
    )
    assert agent.call("check", recipe="cell.yaml", set={"size": 0.2}) == (True, "no errors")
    ok, text = agent.call("check", recipe="cell.yaml", set={"sise": 0.2})
    assert ok and json.loads(text)["code"] == "unknown-name"


def test_a_picture(agent: Agent, folder: Path) -> None:
    ok, data = agent.call("render", recipe="cell.yaml")
    if not ok:
        assert "error[no-rendering]" in data
        pytest.skip("no OpenGL")
    assert base64.b64decode(data).startswith(b"\x89PNG")
    assert not (folder / "build").exists()


def test_it_sees_nothing_outside_of_its_folder(agent: Agent, folder: Path) -> None:
    secret = folder.parent / "secret.yaml"
    model = folder.parent / "secret.xml"
    secret.write_text("hunter2: [\n")
    model.write_text('<mujoco><worldbody><body name="hunter2"/></worldbody></mujoco>')
    for words in (
        ["init", "-q"],
        ["add", "secret.yaml"],
        ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "a"],
    ):
        subprocess.run(["git", *words], cwd=folder.parent, check=True)  # a project may read all of itself
    (folder / "link.yaml").symlink_to(secret)
    (folder / "link.xml").symlink_to(model)
    recipes = {
        "base": "base: ../secret.xml",
        "absolute": f"base: {model}",
        "linked": "base: ./link.xml",
        "extends": "extends: ../secret.yaml",
        "trusts": "trust: {files: [..], references: ['*']}\nbase: ./includes.xml",
        "adds": "base: ./models/arm.xml\nadd:\n  - {to: link, file: ../secret.xml}",
        "meshes": "base: ./meshes.xml",
    }
    (folder / "includes.xml").write_text('<mujoco><include file="../secret.xml"/></mujoco>')
    (folder / "meshes.xml").write_text('<mujoco><asset><mesh name="m" file="../secret.obj"/></asset></mujoco>')
    for name, text in recipes.items():
        (folder / f"{name}.yaml").write_text(f"recipe: 1\n{text}\n")
    paths = ["../secret.yaml", str(secret), "link.yaml", "models/../../secret.xml", "link.xml"]
    for path in (
        "HEAD:secret.yaml",
        "HEAD:../secret.yaml",
        "HEAD:./../secret.yaml",
        f"git+file://{folder.parent}@HEAD#secret.yaml",
    ):
        for tool in ("tree", "check", "render"):
            ok, text = agent.call(tool, recipe=path)
            assert "hunter2" not in text and (not ok or tool == "check"), (tool, path, text)
    for tool in ("tree", "plan", "check", "fix", "render", "explain"):
        for path in [*paths, *(f"{name}.yaml" for name in recipes)]:
            more = {"query": "body hunter2"} if tool == "explain" else {}
            ok, text = agent.call(tool, recipe=path, **more)
            assert "hunter2" not in text.replace("body hunter2", "").replace("`hunter2`", ""), (tool, path, text)
            assert not ok or tool in ("check", "fix", "plan"), (tool, path)
            assert path not in paths or "outside" in text, text
    assert "source-outside" in agent.call("check", recipe="base.yaml")[1]
    assert secret.read_text() == "hunter2: [\n"
    assert run("tree", "base.yaml").exit_code == 0  # for the user, who may name any file


def test_a_wrong_call_says_so(agent: Agent) -> None:
    calls: list[tuple[str, dict[str, Any], str]] = [
        ("build", {"recipe": "cell.yaml"}, "the tool `build` does not exist"),
        ("check", {}, "`check` needs `recipe`"),
        ("check", {"recipe": "cell.yaml", "out": "x"}, "takes no `out`"),
        ("tree", {"recipe": "cell.yaml", "depth": "1"}, "`depth` is of type integer"),
        ("tree", {"recipe": "--help"}, "--help"),
        ("tree", {"recipe": "-"}, "standard input"),
        ("check", {"recipe": "https://example.org/a.yaml"}, "error"),
    ]
    for tool, arguments, words in calls:
        ok, text = agent.call(tool, **arguments)
        assert words in text and (not ok or tool == "check"), text
    assert agent.call("check", recipe="cell.yaml")[0]
