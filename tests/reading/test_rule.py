"""Modules read files of others through the door; those that open files by themselves are listed with the reason."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READS = {"read_bytes", "read_text"}
ALLOWED = {
    "bundle/folder.py": "what stands where the output is to be: the user names it",
    "bundle/listing.py": "an index that the user names; looks first whether it is an ordinary file",
    "bundle/mjb.py": "what MuJoCo has just written into a folder of ours",
    "bundle/remote.py": "what was just written into a folder of ours, and addresses that the user names",
    "bundle/replaced.py": "what stands where the output is to be",
    "bundle/shared.py": "what stands where the output is to be",
    "bundle/staging.py": "writes",
    "bundle/usd.py": "what the converter has just written into a folder of ours",
    "cache/environment.py": "the files of this package",
    "cache/files.py": "hashes of the same; looks first whether it is an ordinary file",
    "cache/run_table.py": "writes a table",
    "cli/choices.py": "`--set-file`: the user names it",
    "cli/fmt.py": "the recipe that the user names",
    "cli/locking.py": "the lock beside the recipe that the user names",
    "cli/new.py": "what stands where the project is to be",
    "cli/reporting.py": "shows the lines of files in which faults were found, which were read before",
    "cluster/probe.py": "the files of this package",
    "compose/locked_shapes.py": "results beside the recipe that the user names, which are written anew",
    "diagnostics/page.py": "the pages of this package",
    "diff/renders.py": "pictures of ours",
    "diff/revision.py": "what was checked out into a folder of ours",
    "diff/side.py": "the model that the user names, and lines of files that were read before",
    "engine/child.py": "the log of MuJoCo",
    "engine/session.py": "the log of MuJoCo",
    "engine/urdf.py": "the URDF itself, which passed",
    "fixing/fixed.py": "recipes that were read before",
    "formatting/order.py": "a table of this package",
    "grammar/grammar.py": "the grammar of this package",
    "grammar/history.py": "a table of this package",
    "loading/load.py": "the file that the user names",
    "migrate/dump.py": "writes",
    "migrate/markdown.py": "a page of this project",
    "pictures/video.py": "writes",
    "plan/read.py": "the recipe that the user names, or a reference that passed",
    "processes/confined.py": "its own standard output, and folders without their contents",
    "recipe/reference_page.py": "the examples of this package",
    "processes/worker.py": "its own standard output",
    "reading/regular.py": "the door",
    "recipe/motor_table.py": "a page of this project",
    "recipe/motors.py": "a table of this package",
    "scratch.py": "locks of folders of ours",
    "sources/blobs.py": "the store",
    "sources/descriptions.py": "the head of a repository that a package keeps",
    "sources/digest.py": "hashes of files that passed",
    "sources/download.py": "the store",
    "sources/git_command.py": "a process",
    "sources/git_tree.py": "writes to the store",
    "sources/lease.py": "the store",
    "sources/lock_file.py": "the lock beside the recipe that the user names",
    "sources/mujocos.py": "the store",
    "sources/spdx.py": "licences and models that passed",
    "sources/store.py": "the store",
    "sources/unpack.py": "an archive in the store",
    "starting/examples.py": "files of this package",
    "starting/project.py": "files of this package",
    "starting/write.py": "what stands where the project is to be",
    "targets/aim.py": "what MuJoCo's process has just written into a folder of ours",
    "targets/markdown.py": "a page of this project",
    "targets/reading.py": "what a program has just written into a folder of ours",
    "targets/readers/drake.py": "runs in an environment of its own, on a model in a folder of ours",
    **{
        f"targets/readers/{name}.py": "the same"
        for name in ("genesis", "newton", "pinocchio", "pybullet", "shared/mujoco_facts")
    },
    "targets/plain/files.py": "the bundle, in a folder of ours",
    "verify/world_table.py": "what MuJoCo's process has just written into a folder of ours",
    "verify/worlds.py": "writes",
    "worlds/table_file.py": "writes",
    "view/description.py": "what MuJoCo's process has just written into a folder of ours",
    "view/page.py": "files of this package",
    "view/server.py": "files of this package",
}

GIVEN_TO_MUJOCO = {
    "bundle/mjb.py": "a bundle, whose files all came through the door",
    "cli/doctor.py": "a model of this package",
    "compose/finished_model.py": "a model without files",
    "diff/side.py": "asks `all_admitted`",
    "importing/contrasting.py": "models that `recover` asks `all_admitted` of",
    "link/measure.py": "a folder of files that passed",
    "urdf/read.py": "asks `includes_admitted`, and converts with the door",
    "verify/compiles.py": "a bundle, whose files all came through the door",
    "verify/source_alone.py": "sources, which pass where they are read",
    "verify/subtree_reference.py": "the same",
}
"""Modules that have MuJoCo read a model, which opens by itself what that names."""


def opens_files(module: Path) -> list[str]:
    """What a module calls that opens files."""
    found = []
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Attribute) and node.attr in READS:
            found.append(node.attr)
        if isinstance(node, ast.Call):
            function = node.func
            name = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
            if name in ("open", "fdopen"):
                found.append(name)
    return found


def test_nobody_opens_files_beside_the_door() -> None:
    found = {
        path.relative_to(ROOT / "composer").as_posix(): calls
        for path in sorted((ROOT / "composer").rglob("*.py"))
        if (calls := opens_files(path))
    }
    unlisted = {path: calls for path, calls in found.items() if path not in ALLOWED}
    assert not unlisted, f"read these through `composer.reading`: {unlisted}"
    assert not ALLOWED.keys() - found.keys(), "these open nothing: take them from the list"


def test_no_path_is_resolved_by_pathlib() -> None:
    """Before Python 3.13 `Path.resolve` raises RuntimeError, no OSError, for a link that leads to itself."""
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / "composer").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
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
    for path in sorted((ROOT / "composer").rglob("*.py")):
        name = path.relative_to(ROOT / "composer").as_posix()
        text = path.read_text(encoding="utf-8")
        if name.startswith("engine/") or ("composer.engine" not in text and "import engine" not in text):
            continue
        tree = ast.parse(text)
        if any(isinstance(node, ast.Call) and ast.unparse(node.func) in calls for node in ast.walk(tree)):
            found.add(name)
    assert found == GIVEN_TO_MUJOCO.keys()


LOOKS = {"exists", "is_dir", "is_file"}
LOOKS_AT_ENTRIES = {
    "bundle/read.py": "reports what cannot be read, with the reason of the system",
    "cache/environment.py": "entries of a folder",
    "sources/suggest.py": "entries of a folder",
    "sources/unpack.py": "members of an archive",
}


def looks_at_paths(module: Path) -> list[str]:
    """What a module asks of paths with methods of `Path`, which raise OSError for a name that is too long."""
    return [
        node.func.attr
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in LOOKS
        and not (node.args or node.keywords)
    ]


def test_names_that_are_too_long_are_files_that_do_not_exist() -> None:
    found = {
        path.relative_to(ROOT / "composer").as_posix(): calls
        for path in sorted((ROOT / "composer").rglob("*.py"))
        if (calls := looks_at_paths(path))
    }
    unlisted = {path: calls for path, calls in found.items() if path not in LOOKS_AT_ENTRIES}
    assert not unlisted, f"ask `os.path.isfile`, `isdir` or `exists` instead: {unlisted}"
    assert not LOOKS_AT_ENTRIES.keys() - found.keys(), "these ask nothing: take them from the list"
