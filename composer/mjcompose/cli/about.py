"""`doctor`, `version`, `help` and `schema`: this installation and its documentation."""

from __future__ import annotations

import os
import platform
import tempfile
from collections.abc import Iterator
from dataclasses import asdict
from importlib import metadata

import click

from mjcompose.base import __version__
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import DiagnosticError
from mjcompose.base.processes import PIPE, Overrun, Process, program
from mjcompose.base.sandbox import call_confined
from mjcompose.base.scratch import scratch
from mjcompose.cli import completion
from mjcompose.cli.options import formats
from mjcompose.cli.reporting import FINDINGS
from mjcompose.cli.run import Answer, Group, Run, argument, command
from mjcompose.sources.blobs import blobs_in

_CORE = ("numpy", "pydantic", "lxml", "pyyaml", "click", "platformdirs", "filelock", "urllib3", "regex")
_ANSWERING = 60.0
_MOST_WORDS = 4096
_MODEL = "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"


class SetupFinding(Struct):
    """A finding; `fine` is None if something optional is missing."""

    what: str
    found: str
    fine: bool | None = True


class DoctorOptions(Group):
    form: str = formats("text", "json")


@command(
    DoctorOptions,
    help="""Check this installation, and show its features.

    The exit code is 1 if something that every build needs is missing.
    """,
)
def doctor(options: DoctorOptions, run: Run) -> Answer:
    findings = [
        *_installed(),
        *_mujoco(),
        *_programs(),
        _plugin(),
        _git(),
        _store(),
        _templates(),
        *_extras(),
        *_extensions(),
    ]
    width = max(len(each.what) for each in findings)
    mark = {True: "ok", None: "--", False: "!!"}
    return Answer(
        "\n".join(f"{mark[each.fine]}  {each.what:{width}}  {each.found}" for each in findings),
        [asdict(each) for each in findings],
        code=FINDINGS if any(each.fine is False for each in findings) else 0,
    )


def _installed() -> Iterator[SetupFinding]:
    yield SetupFinding("mjcompose", f"{__version__}, Python {platform.python_version()}, {platform.platform()}")
    others = sorted(set(metadata.packages_distributions().get("mjcompose", [])) - {"mjcompose"})
    if others:
        named = ", ".join(f"`{name}`" for name in others)
        yield SetupFinding("package mjcompose", f"{named} also install it: use a separate environment for each", False)
    for name in _CORE:
        version = _version(name)
        yield SetupFinding(name, version or "is not installed", version is not None)


def _mujoco() -> Iterator[SetupFinding]:
    """Yield MuJoCo's version and its renderer, both checked in a process of their own."""
    from mjcompose.mujoco.engine import Session, call, compile
    from mjcompose.mujoco.pictures import pictures

    with scratch("doctor") as folder, Session(rendering=True) as session:
        (folder / "model.xml").write_text(_MODEL, encoding="utf-8")
        compiled = compile(folder, keep="model", session=session)
        if not compiled.ok:
            yield SetupFinding("mujoco", compiled.error or str(compiled.crash), False)
            return
        yield SetupFinding("mujoco", str(compiled.mujoco_version))
        answer = call(session, pictures, ["model", "model"], argument=str(folder))
        reason = answer.value.get("no OpenGL") if answer.ok else answer.error or answer.crash
        reason = session.no_opengl or reason
    yield SetupFinding("OpenGL", f"none: {reason}" if reason else "renders", None if reason else True)


def _programs() -> Iterator[SetupFinding]:
    """Yield the MuJoCos of other versions, with the reason if one is not trusted."""
    from mjcompose.mujoco.programs import ProgramError, installed, python_in

    try:
        versions = installed(os.environ)
    except ProgramError as error:
        yield SetupFinding("programs", str(error), False)
        return
    for version in versions:
        try:
            yield SetupFinding(f"mujoco=={version}", str(python_in(version, os.environ)))
        except ProgramError as error:
            yield SetupFinding(f"mujoco=={version}", str(error), False)


def _plugin() -> SetupFinding:
    from mjcompose.tools.open.decoder import PluginError, library_in, mujoco_folder

    what = "plugin"
    try:
        place = library_in(mujoco_folder())
    except PluginError as error:
        return SetupFinding(what, str(error), None)
    if not os.path.isfile(place):
        return SetupFinding(
            what, "is not installed; it lets C++ programs open recipes: `mjcompose plugin install`", None
        )
    return SetupFinding(what, f"{place}: MuJoCo {_version('mujoco')} opens recipes, in Python and C++ programs")


def _git() -> SetupFinding:
    git = program("git", os.environ)
    if git is None:
        return SetupFinding("git", "is not installed: `git+…` references and `diff REV:path` need it", None)
    try:
        with Process([git, "--version"], stdout=PIPE) as process:
            out, _ = process.finish(seconds=_ANSWERING, most=_MOST_WORDS)
    except (OSError, Overrun) as error:
        return SetupFinding("git", f"`{git}` cannot be run: {error}", None)
    return SetupFinding("git", out.decode("utf-8", "replace").strip().removeprefix("git version "))


def _store() -> SetupFinding:
    from mjcompose.sources.reference import SourceError
    from mjcompose.sources.store import Store

    try:
        store = Store.of(os.environ)
    except SourceError as error:
        return SetupFinding("store", str(error), False)
    try:
        store.folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=store.folder).close()
    except OSError as error:
        reason = f"cannot be written: {(error.strerror or str(error)).lower()}; `MJCOMPOSE_CACHE` names another folder"
        return SetupFinding("store", f"{store.folder} {reason}", None)
    fetched, built = (sum(each.size for each in found) for found in (store.entries(), blobs_in(store.folder)))
    return SetupFinding("store", f"{store.folder}, {(fetched + built) / 1e6:.1f} MB")


def _templates() -> SetupFinding:
    """Return the confinement of the process that expands templates, as the process reports it."""
    with scratch("doctor") as folder:
        answer = call_confined("mjcompose.base.sandbox:probe", str(folder), (), seconds=60, memory=1 << 30)
    if not answer["ok"]:
        return SetupFinding("templates", f"cannot be expanded: {answer['error']}", False)
    ways = answer["confined"]
    can = [each for each, is_possible in answer["value"].items() if is_possible]
    by = f"confined by {', '.join(ways)}" if ways else "this system has no way to confine their process"
    return SetupFinding("templates", f"{by}; it can {' and '.join(can)}" if can else by, None if can else True)


def _extras() -> Iterator[SetupFinding]:
    from mjcompose.sources.kinds import KINDS
    from mjcompose.sources.reference import Library

    uses = {each: f"`{kind.forms[0].scheme}:` references" for kind in KINDS for each in kind.libraries}
    uses[Library("mujoco-usd-converter", "usd")] = "USD as an output"
    uses[Library("xacro", "xacro")] = "templates for xacro"
    uses[Library("trimesh", "mesh")] = "Collada, glTF and the materials of OBJ in URDF"
    uses[Library("pygls", "lsp")] = "editors, which start `mjcompose lsp`"
    uses[Library("mcp", "mcp")] = "AI agents, which start `mjcompose mcp`"
    for library, use in uses.items():
        version = _version(library.name)
        package = library.name if library.extra is None else f'"mjcompose[{library.extra}]"'
        missing = f"is not installed; it is for {use}: pip install {package}"
        yield SetupFinding(library.name, version or missing, True if version else None)


def _extensions() -> Iterator[SetupFinding]:
    """Yield the extensions of other packages. It loads each extension, to test whether it works."""
    from mjcompose.base.extensions import GROUPS, load, names

    for group, what in GROUPS.items():
        for word, owner in names(group).items():
            finding = SetupFinding(f"{what} `{word}`", owner)
            try:
                load(group, word)
            except DiagnosticError as error:
                finding = SetupFinding(finding.what, error.message, None)
            yield finding


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


class HelpOptions(Group):
    names: tuple[str, ...] = argument(metavar="[COMMAND]...", nargs=-1, shell_complete=completion.commands)


@command(HelpOptions, help="Print the help of COMMAND, or the list of commands.")
def help(options: HelpOptions, run: Run) -> Answer:
    context = click.get_current_context()
    about = context.find_root()
    for name in options.names:
        group = about.command
        if not isinstance(group, click.Group):
            raise click.UsageError(f"`{group.name}` has no commands of its own", context)
        found, command, _ = group.resolve_command(about, [name])
        assert command is not None
        about = click.Context(command, info_name=found, parent=about)
    return Answer(about.get_help())


@command(Group, help="Print the version. `mjcompose doctor` prints the versions of all dependencies.")
def version(options: Group, run: Run) -> Answer:
    return Answer(f"mjcompose, version {__version__}")


class SchemaOptions(Group):
    what: str = argument(type=click.Choice(["recipe", "manifest", "diagnostics", "reference"]), default="recipe")


@command(
    SchemaOptions,
    help="""Print a JSON Schema for editors and other tools, or the reference page of all keys.

    The schema is that of recipes, of the manifests in bundles, or of the lines of --output-format json.
    """,
)
def schema(options: SchemaOptions, run: Run) -> Answer:
    if options.what == "manifest":
        from mjcompose.bundle.manifest import schema as text
    elif options.what == "diagnostics":
        from mjcompose.base.report_data import schema_text as text
    elif options.what == "reference":
        from mjcompose.language.reference_page import page as text
    else:
        from mjcompose.language.schema import text
        from mjcompose.plan.read import load_all

        for error in load_all():
            click.echo(error.message, err=True)
    return Answer(text().removesuffix("\n"))
