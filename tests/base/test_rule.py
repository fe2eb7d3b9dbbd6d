"""Files are read by one reader and written by one writer; what opens files by itself is listed with the reason."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CALLS = {
    "read": {
        "read_bytes",
        "read_text",
        "ZipFile",
        "from_xml_path",
        "from_binary_path",
        "from_file",
        "from_zip",
        "imread",
        "file_digest",
        "fromfile",
        "genfromtxt",
        "loadtxt",
        "memmap",
    },
    "write": {
        "write_text",
        "write_bytes",
        "touch",
        "truncate",
        "copyfile",
        "copy2",
        "copytree",
        "copyfileobj",
        "link",
        "symlink",
        "symlink_to",
        "hardlink_to",
        "savez",
        "savez_compressed",
        "savetxt",
        "save",
        "tofile",
        "write_table",
        "ParquetWriter",
        "mj_saveModel",
        "mj_saveLastXML",
        "to_file",
        "to_zip",
        "mkstemp",
        "NamedTemporaryFile",
        "renames",
    },
}
OPENS = {"open", "fdopen", "ZipFile"}
MOVES = {"replace", "rename", "move", "copy"}
STAGES = {"staged_file", "staged_folder", "stage_beside"}

MODULE = "<module>"
"""What a module does when it is imported or run, beside its functions."""

READS_ITSELF = {
    "the door": """
        base/files.py:_opened base/files.py:open_regular base/files.py:read_argument""",
    "no contents: it asks for the right": "base/sandbox.py:_may_be_read",
    "a stream, or text, that is open or in memory": """
        bundle/listing.py:_rows_at bundle/read.py:_read_archive bundle/remote.py:manifest_at
        bundle/write.py:_manifest bundle/bundle.py:with_moment pipeline/cache/cache_key.py:_sha256
        sources/blobs.py:sha256_of sources/git_command.py:Git.run sources/git_command.py:_listed
        tools/identify/tables.py:read_npz tools/identify/tables.py:_npy_header tools/identify/files.py:opened
        sources/git_command.py:_contents sources/fetched.py:_download sources/web_archive.py:unpack sources/web_archive.py:_zip_members
        tools/worlds/worlds.py:read""",
    "files of this package or project": """
        pipeline/cache/cache_key.py:tool_version tools/cluster/client.py:versions base/codes.py:page
        text/key_order.py:<module> tree/grammar.py:read_data tree/history.py:spans
        language/datasheets.py:library
        language/reference_page.py:examples tools/new.py:_read tools/new.py:examples
        tools/new.py:_template tools/new.py:project targets/table.py:<module> targets/table.py:read_back
        tools/view/page.py:alone tools/view/page.py:_built tools/view/page.py:described
        tools/view/server.py:PageServer.__init__ tools/identify/page.py:_head""",
    "what MuJoCo's process, or another program, has just written into a folder of ours": """
        bundle/staging.py:write_mjb bundle/write.py:write_usd tools/diff/diff.py:render_views
        mujoco/child.py mujoco/engine.py:_last_words mujoco/engine.py:_load_arrays mujoco/environments.py:differences
        mujoco/environments.py:other_inertias
        tools/migrate/compare.py:_Side.of mujoco/dump.py:main tools/migrate/migrate.py:measured
        mujoco/pictures.py:sheet mujoco/playable.py:_replaced tools/view/page.py:_played
        targets/export.py:aimed targets/read_back.py:placed targets/export.py:export
        targets/plain.py:keep_files targets/plain.py:plain targets/read_back.py:read_back
        verify/draws.py:with_worlds verify/draws.py:compute_worlds verify/draws.py:compare_world
        cli/servers.py:_call tools/identify/identify.py:_progress.watch""",
    "what was checked, in a folder of ours, as MuJoCo's process opens it": """
        mujoco/convert.py:_read mujoco/playable.py:strip tools/worlds/load.py:_compiled tools/worlds/joint_text.py:CellText.__init__
        tools/worlds/joint_text.py:JointText._file tools/worlds/joint_text.py:JointText.write""",
    "the entry points of installed packages, as Python's own reader does": "base/extensions.py:_are_there",
    "runs in an environment of its own, on a model in a folder of ours": """
        targets/readers/mjx.py targets/readers/pybullet.py targets/readers/warp.py targets/readers/shared/facts.py""",
}
"""What opens files for reading by itself, and why; a whole module, or a function of it. That a user names a file is no
reason: it may be a pipe, a device or 10 GB."""

WRITES_ITSELF = {
    "the writer": "bundle/staging.py",
    "its argument is a stage of the writer": """
        cli/build_cells.py:RunTable._write_parquet tools/migrate/migrate.py:lay_out mjcf/parse.py:export_with_assets
        mujoco/pictures.py:_write mujoco/pictures.py:sheet mujoco/film.py:write_mp4
        tools/worlds/worlds.py:write_parquet tools/worlds/worlds.py:_write_npz""",
    "into memory": "urdf/converting.py:_look",
    "into a folder of ours": """
        cli/about.py:_mujoco compose/mesh_jobs.py:MeshWorkshop._make sides/operand.py:_recipe_of
        sides/revision.py:_beside_the_same mujoco/child.py
        mujoco/engine.py:Session._spawn link/measure.py:folder_of mujoco/pictures.py:pictures base/scratch.py
        targets/moves_alike.py:_in_mujoco mujoco/playable.py:_replaced mujoco/scene.py:Blobs.put mujoco/scene.py:describe targets/read_back.py:placed targets/export.py:_put
        targets/read_back.py:read_back urdf/read.py:UrdfReader._written verify/compile.py:_written
        verify/draws.py:with_worlds verify/draws.py:compute_worlds tools/view/live.py:_opened
        tools/worlds/of_sources.py:build_of_sources tools/worlds/joint_text.py:JointText.write
        tools/identify/work.py:_note""",
    "into a folder of ours, in an environment of its own": """
        mujoco/dump.py:main mujoco/dump.py:_marks targets/readers/shared/facts.py""",
    "the folder of a worker of a cluster, or a token beside the models": """
        tools/cluster/client.py:_token tools/cluster/uploads.py:lay_out tools/cluster/worker.py:_keep""",
    "the store": """
        sources/blobs.py:held sources/blobs.py:gate sources/blobs.py:hold
        sources/blobs.py:is_left sources/fetched.py:_write_archive sources/blobs.py:write_whole sources/download.py:_Download._write
        sources/git_command.py:write_tree sources/git_repository.py:replace_by_local
        sources/git_repository.py:_Server.fill sources/fetched.py:_Artifact._fill sources/store.py sources/web_archive.py:_write""",
    "the standard output of a process, and trials of what it may": """
        mujoco/child.py:main base/sandbox.py:main base/sandbox.py:probe base/guard.py:work""",
    "the folder of the programs that the user installs": "mujoco/programs.py:install mujoco/programs.py:_locked",
    "pages of this project, for `make schemas`": """
        targets/table.py:<module> language/reference_page.py:write""",
    "no file: it links models, or names elements": """
        bundle/write.py:write compose/compose.py:Composer._joined contrast/models.py:contrast
        mjcf/flat.py:link_checked targets/urdf.py:description""",
}
"""What opens files for writing, copies or moves them beside `bundle/staging.py`, and why."""

OF_THE_ENGINE = ("mujoco/convert.py", "mujoco/engine.py")
GIVEN_TO_MUJOCO = {
    "bundle/staging.py": "a bundle, whose files all came through the door",
    "cli/about.py": "a model of this package",
    "compose/load.py": "a model without files",
    "sides/side.py": "asks `all_admitted`",
    "tools/lint.py": "asks `all_admitted`",
    "tools/importing/recover.py": "models that `recover` asks `all_admitted` of",
    "link/measure.py": "a folder of files that passed",
    "urdf/read.py": "asks `includes_admitted`, and converts with the door",
    "verify/compile.py": "a bundle, whose files all came through the door",
    "verify/parts.py": "sources, which pass where they are read",
}
"""Modules that have MuJoCo read a model, which opens by itself what that names."""


@cache
def _tree(module: Path) -> ast.Module:
    return ast.parse(module.read_text(encoding="utf-8"))


def opened(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield each function that opens files, with how; what is done to a stage of the writer is not listed."""

    def walk(node: ast.AST, where: tuple[str, ...], stages: frozenset[str]) -> Iterator[tuple[str, str]]:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            where = (*where, node.name)
        if isinstance(node, ast.With):
            stages |= {
                each.optional_vars.id
                for each in node.items
                if isinstance(each.optional_vars, ast.Name)
                and isinstance(each.context_expr, ast.Call)
                and ast.unparse(each.context_expr.func) in STAGES
            }
        if isinstance(node, ast.Call) and (how := _how(node)) is not None:
            about = [node.func, *node.args[:1]]
            names = {each.id for part in about for each in ast.walk(part) if isinstance(each, ast.Name)}
            if how == "read" or not names & stages:
                yield ".".join(where) or MODULE, how
        for each in ast.iter_child_nodes(node):
            yield from walk(each, where, stages)

    return walk(tree, (), frozenset())


def _how(call: ast.Call) -> str | None:
    """Return whether a call reads or writes files; None if it does neither."""
    if not isinstance(call.func, ast.Name | ast.Attribute):
        return None
    of = ast.unparse(call.func.value) if isinstance(call.func, ast.Attribute) else ""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else call.func.id
    if name in OPENS:
        texts = [each.value for each in ast.walk(call) if isinstance(each, ast.Constant)]
        modes = [each for each in texts if isinstance(each, str) and each and set(each) <= set("rwaxbt+")]
        flags = {each.attr for each in ast.walk(call) if isinstance(each, ast.Attribute)}
        writes = any(set(each) & set("wax+") for each in modes)
        return "write" if writes or flags & {"O_WRONLY", "O_RDWR", "O_CREAT", "O_APPEND"} else "read"
    if name in MOVES and isinstance(call.func, ast.Attribute):
        # `replace` of a text has two arguments, and that of a dataclass names its fields.
        is_alone = len(call.args) == 1 and not (call.keywords or isinstance(call.args[0], ast.Starred))
        of_a_path = name in ("replace", "rename") and is_alone
        return "write" if of in ("os", "shutil") or of_a_path else None
    if (of, name) in (("np", "load"), ("numpy", "load"), ("etree", "parse"), ("Image", "open")):
        return "read"
    return next((how for how, names in CALLS.items() if name in names), None)


def test_the_collector_finds_every_form() -> None:
    """Those that earlier lists of whole modules excused, too."""
    text = """
def _read_binary(path):
    return path.read_bytes(), open(path).read(), Path(path).open("rb"), zipfile.ZipFile(path), np.load(path)
class C:
    def out(self, path):
        path.write_text("")
        open(path, "w"), path.open("ab"), os.open(path, os.O_RDWR), zipfile.ZipFile(path, "w")
        os.replace(path, path), shutil.copy(path, path), path.rename(path), picture.save(path), np.savez(path)
        with staged_file(path) as stage:
            stage.write_bytes(b""), np.save(stage, a), stage.open("w")
        text.replace("a", "b"), dataclasses.replace(path, a=1)
"""
    found = Counter(opened(ast.parse(text)))
    assert found == {("_read_binary", "read"): 5, ("C.out", "write"): 10}


@pytest.mark.parametrize(("how", "listed"), [("read", READS_ITSELF), ("write", WRITES_ITSELF)])
def test_nobody_opens_files_beside_the_reader_and_the_writer(how: str, listed: dict[str, str]) -> None:
    found = {
        (path.relative_to(ROOT / "composer" / "mjcompose").as_posix(), function)
        for path in sorted((ROOT / "composer" / "mjcompose").rglob("*.py"))
        for function, each in opened(_tree(path))
        if each == how
    }
    allowed = {each.partition(":")[::2] for places in listed.values() for each in places.split()}
    unlisted = {each for each in found if each not in allowed and (each[0], "") not in allowed}
    advice = {"read": "`mjcompose.base.files`", "write": "`mjcompose.bundle.staging`"}[how]
    assert not unlisted, f"{how} these through {advice}: {unlisted}"
    modules = {module for module, _ in found}
    over = {each for each in allowed if each not in found and (each[1] or each[0] not in modules)}
    assert not over, f"these {how} nothing: take them from the list"


def test_no_path_is_resolved_by_pathlib() -> None:
    """Before Python 3.13 `Path.resolve` raises RuntimeError, no OSError, for a link that leads to itself."""
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / "composer" / "mjcompose").rglob("*.py"))
        for node in ast.walk(_tree(path))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "resolve"
        and not (node.args or node.keywords)
        and ast.unparse(node.func.value) != "Path(__file__)"
    ]
    assert not found, f"write os.path.realpath: {found}"


def test_mujoco_is_given_what_passed() -> None:
    calls = {"engine.compile", "engine.measure", "engine.convert_urdf", "compile", "measure", "convert_urdf"}
    found = set()
    for path in sorted((ROOT / "composer" / "mjcompose").rglob("*.py")):
        name = path.relative_to(ROOT / "composer" / "mjcompose").as_posix()
        text = path.read_text(encoding="utf-8")
        if name in OF_THE_ENGINE or ("mjcompose.mujoco" not in text and "import engine" not in text):
            continue
        tree = ast.parse(text)
        if any(isinstance(node, ast.Call) and ast.unparse(node.func) in calls for node in ast.walk(tree)):
            found.add(name)
    assert found == GIVEN_TO_MUJOCO.keys()


LOOKS = {"exists", "is_dir", "is_file"}
LOOKS_AT_ENTRIES = {
    "bundle/read.py": "reports what cannot be read, with the reason of the system",
    "pipeline/cache/cache_key.py": "entries of a folder",
    "sources/fetching.py": "entries of a folder",
    "sources/web_archive.py": "members of an archive",
}


def looks_at_paths(module: Path) -> list[str]:
    """What a module asks of paths with methods of `Path`, which raise OSError for a name that is too long."""
    return [
        node.func.attr
        for node in ast.walk(_tree(module))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in LOOKS
        and not (node.args or node.keywords)
    ]


def test_names_that_are_too_long_are_files_that_do_not_exist() -> None:
    found = {
        path.relative_to(ROOT / "composer" / "mjcompose").as_posix(): calls
        for path in sorted((ROOT / "composer" / "mjcompose").rglob("*.py"))
        if (calls := looks_at_paths(path))
    }
    unlisted = {path: calls for path, calls in found.items() if path not in LOOKS_AT_ENTRIES}
    assert not unlisted, f"ask `os.path.isfile`, `isdir` or `exists` instead: {unlisted}"
    assert not LOOKS_AT_ENTRIES.keys() - found.keys(), "these ask nothing: take them from the list"
