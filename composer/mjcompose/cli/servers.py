"""`lsp`, `mcp` and `plugin`: mjcompose for editors, for agents and for MuJoCo's plugins.

Each call of an agent runs a command in the folder of the server. It may read no other folder of the user.
"""

from __future__ import annotations

import json
import os
import re
from base64 import b64encode
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base import __version__
from mjcompose.base.processes import PIPE, Overrun, Process, WorkFolder, own_command
from mjcompose.base.scratch import scratch
from mjcompose.cli.options import formats
from mjcompose.cli.reporting import USAGE
from mjcompose.cli.run import PATH, Answer, Group, Run, command, flag, option

if TYPE_CHECKING:
    from mcp_types import CallToolResult


_MOST = 40_000
_MOST_BYTES = 64 << 20
_SECONDS = 3600.0
_INSTRUCTIONS = (
    "Compose MuJoCo models from YAML recipes. Write recipes with your own file tools. `reference` has the keys, `check`"
    " the errors with exact fixes, `tree` the names to attach to, `explain` the origin of a value or the page of an"
    " error code, and `render` shows the model."
)
_TEXT = {"type": "string"}
_RECIPE = {"type": "string", "description": "The path of a recipe or model, from the folder of the server."}
_MODEL = {"type": "string", "description": "A path as in `check`, or a reference such as menagerie:ur5e."}
_SET = {
    "type": "object",
    "additionalProperties": {"type": ["string", "number", "boolean"]},
    "description": "Values of parameters and variants, by name.",
}
_TOOLS: dict[str, tuple[str, dict[str, dict[str, Any]]]] = {
    "tree": (
        "Show parts, bodies, joints and places of a recipe or model: the names for `attach`, `edit` and `explain`.",
        {"recipe": _MODEL, "set": _SET, "depth": {"type": "integer", "minimum": 1, "description": "Levels of bodies."}},
    ),
    "plan": ("Show the steps of a build, without building.", {"recipe": _RECIPE, "set": _SET}),
    "check": (
        "Build a recipe in memory, compile it in MuJoCo and run its checks. Returns JSON lines, one for each error.",
        {"recipe": _RECIPE, "set": _SET},
    ),
    "fix": (
        "Show the exact fixes of a recipe's errors, or write them.",
        {"recipe": _RECIPE, "write": {"type": "boolean", "description": "Whether to write. Default: show."}},
    ),
    "explain": (
        "Show where an element or attribute comes from. Without a query, `recipe` is an error code to explain.",
        {"recipe": _RECIPE, "query": {**_TEXT, "description": "Such as `geom gripper/pad friction`."}, "set": _SET},
    ),
    "render": ("Draw a picture of a recipe or model.", {"recipe": _RECIPE, "set": _SET, "camera": _TEXT, "key": _TEXT}),
    "reference": (
        "Return the keys of one section of a recipe.",
        {"key": {**_TEXT, "description": "For example attach."}},
    ),
}
_CLOSED = {"type": "object", "additionalProperties": False}
_KINDS = {"string": str, "boolean": bool, "integer": int, "object": dict}


@command(
    Group,
    help="""Serve tools to AI agents: tree, plan, check, fix, explain, render and reference,
    over standard input and output.

    An agent starts it, in the folder of the recipes. Tools read no other folder, except installed packages and sources
    that were fetched before. They fetch nothing, and only `fix` with `write` changes files.

    It needs the extra `mcp`: pip install "mjcompose[mcp]".
    """,
)
def mcp(options: Group, run: Run) -> None:
    try:
        import anyio
        from mcp.server.lowlevel import Server
        from mcp.server.stdio import stdio_server
        from mcp_types import ListToolsResult, Tool, ToolAnnotations
    except ImportError as error:
        raise click.UsageError(
            "The tools for agents need `mjcompose[mcp]`, which is not installed: there is no Python package"
            f' `{error.name}`. Run `pip install "mjcompose[mcp]"`.'
        ) from None

    async def tools(*_: Any) -> ListToolsResult:
        return ListToolsResult(
            tools=[
                Tool(
                    name=name,
                    description=about,
                    input_schema={**_CLOSED, "properties": takes, "required": list(takes)[:1]},
                    annotations=ToolAnnotations(read_only_hint=name != "fix", open_world_hint=False),
                )
                for name, (about, takes) in _TOOLS.items()
            ]
        )

    async def serve() -> None:
        calls = partial(_call, Path.cwd())
        server = Server(
            "mjcompose",
            version=__version__,
            instructions=_INSTRUCTIONS,
            on_list_tools=tools,
            on_call_tool=lambda _, asked: calls(asked.name, asked.arguments or {}),
        )
        async with stdio_server() as (reading, writing):
            await server.run(reading, writing, server.create_initialization_options())

    anyio.run(serve)


async def _call(root: Path, name: str, given: Mapping[str, Any]) -> CallToolResult:
    """Return the answer of a tool; for an invalid call, a text with the reason."""
    from mcp_types import CallToolResult, ImageContent, TextContent

    wrong = _wrong(root, name, given)
    if wrong is not None:
        return CallToolResult(content=[TextContent(text=wrong)], is_error=True)
    if name == "reference":
        is_error, text = _reference(given["key"])
        return CallToolResult(content=[TextContent(text=text)], is_error=is_error)
    words = [f"--{each}={given[each]}" for each in ("depth", "camera", "key") if each in given]
    words += [
        f"--set={key}={json.dumps(value) if isinstance(value, bool) else value}"
        for key, value in given.get("set", {}).items()
    ]
    if name == "fix":
        words.append("--write" if given.get("write") else "--diff")
    if name in ("check", "fix"):
        words.append("--output-format=json")
    is_code = name == "explain" and "query" not in given
    if not is_code:
        words.append("--offline")
    rest = ["--", given["recipe"], *([given["query"]] if "query" in given else [])]
    if name != "render":
        code, text = await _run(root, [name, *words, *rest])
        return CallToolResult(content=[TextContent(text=text)], is_error=code > (name in ("check", "fix")))
    with scratch("picture") as folder:
        out = folder / "model.png"
        code, text = await _run(root, [name, *words, "-o", str(out), *rest])
        if code:
            return CallToolResult(content=[TextContent(text=text)], is_error=True)
        picture = ImageContent(data=b64encode(out.read_bytes()).decode(), mime_type="image/png")
    return CallToolResult(content=[picture])


def _wrong(root: Path, name: str, given: Mapping[str, Any]) -> str | None:
    """Return the reason that a call is invalid, or None; a path must lead into the folder of the server."""
    if name not in _TOOLS:
        return f"the tool `{name}` does not exist; tools: {', '.join(_TOOLS)}"
    takes = _TOOLS[name][1]
    needed = next(iter(takes))
    if needed not in given:
        return f"`{name}` needs `{needed}`"
    for key, value in given.items():
        if key not in takes:
            return f"`{name}` takes no `{key}`; it takes {', '.join(takes)}"
        kind = takes[key]["type"]
        if not isinstance(value, _KINDS[kind]) or (kind == "integer" and isinstance(value, bool)):
            return f"`{key}` is of type {kind}"
    recipe = str(given.get("recipe", ""))
    exists = os.path.exists(root / recipe)
    if name == "render" and not exists:  # the command would look for it in the history of git
        return f"`{recipe}` does not exist"
    is_reference = name == "tree" and not exists and re.match(r"[A-Za-z][\w+.-]+:", recipe) is not None
    real = os.path.realpath(root / recipe)
    if not is_reference and real != os.path.realpath(root) and Path(os.path.realpath(root)) not in Path(real).parents:
        return f"`{recipe}` is outside `{root}`, the folder of the server"
    return "standard input is the agent's" if recipe == "-" else None


def _reference(key: str) -> tuple[bool, str]:
    from mjcompose.language.reference_page import pages

    found = {file.removesuffix(".md"): text for file, text in pages().items()}
    page = found.get(re.split(r"[.\[]", key)[0])
    return (False, page) if page is not None else (True, f"`{key}` has no page; pages: {', '.join(found)}")


async def _run(root: Path, words: list[str]) -> tuple[int, str]:
    """Return the exit code and the output of the command; a call that the agent cancels ends it."""
    from anyio import to_thread

    environment = {**os.environ, "MJCOMPOSE_SERVED": os.path.realpath(root), "NO_COLOR": "1"}
    folder = WorkFolder(root, "the agent names recipes from the folder of its server")
    process = Process(own_command(*words), folder=folder, env=environment, stdout=PIPE, stderr=PIPE)
    try:
        finish = partial(process.finish, seconds=_SECONDS, most=_MOST_BYTES)
        out, errors = await to_thread.run_sync(finish, abandon_on_cancel=True)
    except Overrun as overrun:
        return USAGE, f"`mjcompose {words[0]}` was ended: {overrun}"
    finally:
        process.end()
    text = (out + errors).decode(errors="replace").strip() or "no errors"
    more = len(text) - _MOST
    return process.returncode, text if more <= 0 else f"{text[:_MOST]}\n… {more} more characters: request less"


_EXTRA = ("pygls", "lsprotocol", "cattrs", "attrs", "attr")


class LspOptions(Group):
    stdio: bool = flag(
        "--stdio",
        help="Use standard input and output. This is always the case; the option exists because many editors pass it.",
    )


@command(
    LspOptions,
    help="""Run the language server, which gives an editor errors, completion and more while you write a recipe.

    An editor starts it and uses the Language Server Protocol over standard input and output. docs/how-to/editors.md
    has the settings for each editor. The server completes names in the models, shows the element and its origin, jumps
    to its line, renames parts, and reports the same errors as `check`. It fetches nothing and writes nothing.

    It needs the extra `lsp`: pip install "mjcompose[lsp]".
    """,
)
def lsp(options: LspOptions, run: Run) -> None:
    try:
        from mjcompose.lsp.server import serve
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in _EXTRA:
            raise
        raise click.UsageError(
            "The language server needs `mjcompose[lsp]`, which is not installed: there is no Python package"
            f' `{error.name}`. Run `pip install "mjcompose[lsp]"`.'
        ) from None
    serve()


@click.group(
    help="""Let MuJoCo open recipes in every program that loads its plugins: C++ programs, Studio, ROS 2 control.

    Python programs need no plugin: use `mjcompose.spec(RECIPE)` or `mjcompose.mujoco_plugin.register()`.
    """
)
def plugin() -> None:
    pass


class PluginOptions(Group):
    mujoco: Path | None = option(
        "--mujoco", type=PATH, metavar="FOLDER", help="A MuJoCo release. Default: the package `mujoco` of this Python."
    )
    form: str = formats("text", "json")


@command(
    PluginOptions,
    within=plugin,
    help="""Compile the plugin and copy it to MuJoCo's plugin folder.

    It needs a C compiler and MuJoCo 4.0. It runs the mjcompose of this Python; MJCOMPOSE_PYTHON names another.
    """,
)
def install(options: PluginOptions, run: Run) -> Answer:
    from mjcompose.tools.open import decoder

    with run.stopping(USAGE):
        place = decoder.install(decoder.mujoco_folder(options.mujoco))
    return Answer(f"installed {place}", {"installed": str(place)}, is_outcome=True)


@command(PluginOptions, within=plugin, help="Remove the plugin from MuJoCo's plugin folder.")
def remove(options: PluginOptions, run: Run) -> Answer:
    from mjcompose.tools.open import decoder

    with run.stopping(USAGE):
        place = decoder.remove(decoder.mujoco_folder(options.mujoco))
    removed = None if place is None else str(place)
    return Answer(
        f"removed {removed}" if removed else "the plugin is not installed", {"removed": removed}, is_outcome=True
    )
