"""A repository of a stranger runs nothing: no hook, filter, monitor, submodule or transport of its choice."""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching, quiet
from mjcompose.sources.git_command import Git, GitFailure
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError
from mjcompose.tools.diff.sides import check_out

MODEL = '<mujoco model="arm"><worldbody><body name="arm"><geom size="0.1"/></body></worldbody></mujoco>\n'
HOOKS = "post-checkout post-merge reference-transaction pre-auto-gc post-index-change upload-pack pre-receive".split()


def armed(robots: Any, trace: Path) -> Any:
    """The repository with everything in it that git could run; whatever runs leaves `trace`."""
    script = robots.folder / "run.sh"
    script.write_text(f"#!/bin/sh\necho ran >> {trace}\ncat\n")
    script.chmod(0o755)
    robots.commit(**{
        ".gitattributes": "*.xml filter=evil diff=evil\n*.obj filter=evil\n",
        ".gitmodules": f'[submodule "m"]\n\tpath = m\n\turl = ext::sh -c "touch {trace}"\n',
    })  # fmt: skip
    hash = robots.git("rev-parse", "HEAD")
    robots.git("update-index", "--add", "--cacheinfo", f"160000,{hash},m")
    robots.git("commit", "-q", "-m", "a submodule")
    (robots.folder / ".git" / "hooks").mkdir(exist_ok=True)
    for name in HOOKS:
        hook = robots.folder / ".git" / "hooks" / name
        hook.write_text(f"#!/bin/sh\necho {name} >> {trace}\n")
        hook.chmod(0o755)
    for name, value in {
        "core.fsmonitor": script, "filter.evil.smudge": script, "filter.evil.clean": script,
        "filter.evil.required": "true", "diff.evil.textconv": script, "core.hooksPath": robots.folder / ".git" / "hooks",
        "uploadpack.packObjectsHook": script, "core.sshCommand": script, "core.alternateRefsCommand": script,
        "protocol.ext.allow": "always", "submodule.recurse": "true", "core.attributesFile": robots.folder / ".gitattributes",
    }.items():  # fmt: skip
        robots.git("config", name, str(value))
    trace.unlink(missing_ok=True)
    return robots


@pytest.mark.skipif(os.name == "nt", reason="the scripts are for a shell")
def test_a_repository_that_is_fetched_runs_nothing(robots: Any, take: Callable[..., Any], tmp_path: Path) -> None:
    trace = tmp_path / "trace"
    source = take(armed(robots, trace).reference("main"))
    assert not trace.exists(), trace.read_text()
    assert source.path.read_text() == MODEL
    assert not (source.origin.root / "m").exists()
    assert dict(source.origin.without)["m"] == "a submodule, which is not fetched"


@pytest.mark.skipif(os.name == "nt", reason="the scripts are for a shell")
def test_a_revision_of_a_repository_runs_nothing(robots: Any, tmp_path: Path) -> None:
    """The repository may have come as a folder, with settings of its own in it."""
    trace, into = tmp_path / "trace", tmp_path / "into"
    into.mkdir()
    armed(robots, trace)
    _, path = check_out("HEAD", robots.folder / "arm" / "arm.xml", into, dict(os.environ))
    assert not trace.exists(), trace.read_text()
    assert path.read_text() == MODEL


def test_a_revision_has_what_lfs_has_here(robots: Any, tmp_path: Path) -> None:
    content = b"v 0 0 0\n" * 100
    digest = hashlib.sha256(content).hexdigest()
    pointer = f"version https://git-lfs.github.com/spec/v1\noid sha256:{digest}\nsize {len(content)}\n"
    robots.commit(**{"arm/mesh.obj": pointer, "arm/other.obj": pointer.replace(digest, "0" * 64)})
    stored = robots.folder / ".git" / "lfs" / "objects" / digest[:2] / digest[2:4] / digest
    stored.parent.mkdir(parents=True)
    stored.write_bytes(content)
    (tmp_path / "into").mkdir()
    _, path = check_out("HEAD", robots.folder / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert path.with_name("mesh.obj").read_bytes() == content
    assert path.with_name("other.obj").read_text() == pointer.replace(digest, "0" * 64)
    stored.write_bytes(b"other bytes")
    (tmp_path / "again").mkdir()
    _, path = check_out("HEAD", robots.folder / "arm" / "arm.xml", tmp_path / "again", dict(os.environ))
    assert path.with_name("mesh.obj").read_text() == pointer


def test_no_transport_that_is_a_program(robots: Any, own_environment: dict[str, str], tmp_path: Path) -> None:
    """Not even where the user's settings send git there."""
    trace = tmp_path / "trace"
    settings = tmp_path / "gitconfig"
    settings.write_text(
        f'[url "ext::sh -c touch% {trace}% "]\n\tinsteadOf = https://example.invalid/\n[protocol "ext"]\n\tallow = always\n'
    )
    environment = {**os.environ, **own_environment, "GIT_CONFIG_GLOBAL": str(settings), "GIT_ALLOW_PROTOCOL": "ext"}
    with pytest.raises(GitFailure, match="'ext' not allowed"):
        Git(environment, quiet).run("ls-remote", "--", "https://example.invalid/robots")
    with pytest.raises(SourceError):
        resolve("git+ext::sh -c touch@main#a.xml", relative_to=tmp_path, environment=environment, fetching=Fetching())
    assert not trace.exists()


def test_the_settings_of_the_machine_do_not_count(robots: Any, tmp_path: Path) -> None:
    settings = tmp_path / "system"
    settings.write_text("[alias]\n\tsystem = version\n")
    environment = {**os.environ, "GIT_CONFIG_SYSTEM": str(settings)}
    subprocess.run(["git", "system"], env=environment, check=True, capture_output=True)
    if os.name != "nt":
        with pytest.raises(GitFailure):
            Git(environment, quiet).run("system")
