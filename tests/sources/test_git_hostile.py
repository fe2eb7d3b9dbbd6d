"""A repository of a stranger runs nothing: no hook, filter, monitor, submodule or transport of its choice."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sides.revision import RevisionError, check_out
from mjcompose.sources import git_command, git_repository
from mjcompose.sources.fetching import Fetching, Lookup, quiet
from mjcompose.sources.git_command import Git, GitFailure
from mjcompose.sources.kinds import parse
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError
from mjcompose.sources.store import Store

MODEL = '<mujoco model="arm"><worldbody><body name="arm"><geom size="0.1"/></body></worldbody></mujoco>\n'
HOOKS = "post-checkout post-merge reference-transaction pre-auto-gc post-index-change upload-pack pre-receive".split()


def armed(robots: Any, trace: Path) -> Any:
    """The repository with everything in it that git could run; whatever runs leaves `trace`."""
    script = robots.folder / "run.sh"
    script.write_text(f"#!/bin/sh\necho ran >> {trace}\ncat\n")
    script.chmod(0o755)
    robots.commit(
        **{
            ".gitattributes": "*.xml filter=evil diff=evil\n*.obj filter=evil\n",
            ".gitmodules": f'[submodule "m"]\n\tpath = m\n\turl = ext::sh -c "touch {trace}"\n',
        }
    )
    hash = robots.git("rev-parse", "HEAD")
    robots.git("update-index", "--add", "--cacheinfo", f"160000,{hash},m")
    robots.git("commit", "-q", "-m", "a submodule")
    (robots.folder / ".git" / "hooks").mkdir(exist_ok=True)
    for name in HOOKS:
        hook = robots.folder / ".git" / "hooks" / name
        hook.write_text(f"#!/bin/sh\necho {name} >> {trace}\n")
        hook.chmod(0o755)
    for name, value in {
        "core.fsmonitor": script,
        "filter.evil.smudge": script,
        "filter.evil.clean": script,
        "filter.evil.required": "true",
        "diff.evil.textconv": script,
        "core.hooksPath": robots.folder / ".git" / "hooks",
        "uploadpack.packObjectsHook": script,
        "core.sshCommand": script,
        "core.alternateRefsCommand": script,
        "protocol.ext.allow": "always",
        "submodule.recurse": "true",
        "core.attributesFile": robots.folder / ".gitattributes",
    }.items():
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
    trace = tmp_path / "trace"
    into = tmp_path / "into"
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


posix = pytest.mark.skipif(os.name == "nt", reason="the scripts are for a shell")
COMMIT = "0" * 39 + "1"
URLS = ["ssh://x/y", "git://x/y", "{folder}", "ext::touch {trace}", "spy::x"]
"""Where a partial clone may fetch what it lacks."""


def received(folder: Path, trace: Path, url: str = "ssh://x/y") -> Path:
    """Arm the settings of a repository with everything that git could run for an address; return the folder."""
    run = f"touch {trace};:"
    (folder / "run.sh").write_text(f"#!/bin/sh\ntouch {trace}\n")
    (folder / "run.sh").chmod(0o755)
    (folder / "git-remote-spy").symlink_to("run.sh")
    (folder / "more").write_text(f'[core]\n\tsshCommand = "{run}"\n')
    place = url.format(folder=folder, trace=trace)
    for name, value in {
        "core.repositoryformatversion": "1",
        "extensions.partialClone": "origin",
        "remote.origin.promisor": "true",
        "remote.origin.url": place,
        "remote.origin.uploadpack": run,
        "core.sshCommand": run,
        "core.gitProxy": run,
        "credential.helper": f"!{run}",
        "core.fsmonitor": run,
        "core.alternateRefsCommand": run,
        "core.pager": run,
        "pager.rev-parse": run,
        "pager.ls-remote": run,
        "diff.external": run,
        "core.askPass": str(folder / "run.sh"),
        "protocol.allow": "always",
        "protocol.ext.allow": "always",
        "uploadpack.packObjectsHook": run,
        "include.path": str(folder / "more"),
        "core.hooksPath": str(folder),
        "alias.rev-parse": f"!{run}",
        "url.ssh://x/.insteadOf": "https://",
        "url.ssh://y/.insteadOf": "file://",
        "core.editor": run,
    }.items():
        subprocess.run(["git", "config", name, value], cwd=folder, check=True)
    return folder


def lose(robots: Any, name: str) -> None:
    """Remove an object of the repository, as if it had never been fetched."""
    hash = robots.git("rev-parse", name)
    (robots.folder / ".git" / "objects" / hash[:2] / hash[2:]).unlink()


@posix
@pytest.mark.parametrize("form", ["folder", "file", "variables"])
@pytest.mark.parametrize(
    "text",
    [
        "git+https://127.0.0.1:9/x@main#m.xml",
        f"git+https://127.0.0.1:9/x@{COMMIT}#m.xml",
        "git+ssh://git@127.0.0.1:9/x@main#m.xml",
        f"git+ssh://git@127.0.0.1:9/x@{COMMIT}#m.xml",
        "git+file:///nowhere/x@main#m.xml",
        "hf:lab/robots@main#m.xml",
    ],
)
def test_the_repository_around_a_recipe_runs_nothing(
    robots: Any, own_environment: dict[str, str], tmp_path: Path, text: str, form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A received folder: its settings, a `.git` that leads to them, and variables as a hook has them."""
    trace = tmp_path / "trace"
    folder = received(robots.folder, trace)
    monkeypatch.setenv("HF_ENDPOINT", "https://127.0.0.1:9")
    if form == "file":
        folder = tmp_path / "work"
        folder.mkdir()
        (folder / ".git").write_text(f"gitdir: {robots.folder}/.git\n")
    if form == "variables":
        monkeypatch.setenv("GIT_DIR", str(robots.folder / ".git"))
        monkeypatch.setenv("GIT_CONFIG_PARAMETERS", f"'core.sshcommand'='touch {trace};:'")
        monkeypatch.setenv("GIT_EXTERNAL_DIFF", f"touch {trace}")
        folder = tmp_path
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PATH", f".{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=folder, environment=own_environment, fetching=Fetching())
    assert not trace.exists(), trace
    assert caught.value.code == "source-fetch" and ".insteadOf" not in str(caught.value.notes)
    assert "transport 'ssh'" not in str(caught.value.notes)


@posix
@pytest.mark.parametrize("knows", [True, False], ids=["new git", "git before 2.45"])
@pytest.mark.parametrize("url", URLS)
@pytest.mark.parametrize("lost", ["HEAD:arm/arm.xml", "HEAD:arm", "HEAD"])
def test_a_revision_of_a_partial_clone_fetches_nothing(
    robots: Any, tmp_path: Path, lost: str, url: str, knows: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    trace = tmp_path / "trace"
    received(robots.folder, trace, url)
    lose(robots, lost)
    monkeypatch.setenv("PATH", f"{robots.folder}{os.pathsep}{os.environ['PATH']}")
    if not knows:
        monkeypatch.setitem(git_command.NO_TRANSPORT, "GIT_NO_LAZY_FETCH", "0")
    (tmp_path / "into").mkdir()
    with pytest.raises(RevisionError) as caught:
        check_out("HEAD", robots.folder / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert not trace.exists()
    if lost != "HEAD":  # without the commit, git says that there is no such revision
        help = caught.value.diagnostic.help
        assert help is not None and help.endswith(f"run `git -C {robots.folder} fetch --refetch --no-filter origin`")


@posix
@pytest.mark.parametrize("knows", [True, False], ids=["new git", "git before 2.45"])
@pytest.mark.parametrize("url", URLS)
@pytest.mark.parametrize("revision", ["main", "v1"])
def test_a_local_partial_clone_fetches_nothing(
    robots: Any,
    refused: Callable[..., SourceError],
    tmp_path: Path,
    url: str,
    revision: str,
    knows: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is served by a git of its own, with its settings."""
    trace = tmp_path / "trace"
    robots.git("tag", "-f", "-a", "-m", "one", "v1")
    received(robots.folder, trace, url)
    lose(robots, "HEAD:arm/arm.xml")
    lose(robots, "v1")
    monkeypatch.setenv("PATH", f"{robots.folder}{os.pathsep}{os.environ['PATH']}")
    if not knows:
        monkeypatch.setitem(git_command.NO_TRANSPORT, "GIT_NO_LAZY_FETCH", "0")
    error = refused(robots.reference(revision))
    assert error.code in ("source-fetch", "source-revision")
    assert not trace.exists()


@posix
@pytest.mark.parametrize(
    "command", [["diff", "HEAD:robot.yaml", "robot.yaml"], ["lint", "HEAD:robot.yaml"], ["check", "robot.yaml"]]
)
def test_commands_in_a_received_folder_run_nothing(robots: Any, tmp_path: Path, command: list[str]) -> None:
    trace = tmp_path / "trace"
    base = "arm/arm.xml" if command[0] != "check" else "git+https://127.0.0.1:9/x@main#m.xml"
    robots.commit(**{"robot.yaml": f"recipe: 1\nbase: {base}\n"})
    received(robots.folder, trace)
    lose(robots, "HEAD:arm/arm.xml")
    own = {**os.environ, "MJCOMPOSE_CACHE": str(tmp_path / "store"), "MJCOMPOSE_TIMEOUT": "2"}
    done = subprocess.run(
        [sys.executable, "-P", "-m", "mjcompose", *command], cwd=robots.folder, env=own, capture_output=True, text=True
    )
    assert done.returncode in (1, 2) and "error[" in done.stderr + done.stdout and "Traceback" not in done.stderr
    assert not trace.exists(), done.stderr


@posix
def test_a_partial_clone_is_complete_after_the_command_of_the_help(robots: Any, tmp_path: Path) -> None:
    robots.commit(**{"arm/arm.xml": MODEL.replace("0.1", "0.2")})
    robots.git("config", "uploadpack.allowFilter", "true")
    clone = tmp_path / "clone"
    place = f"file://{robots.folder}"
    subprocess.run(["git", "clone", "-q", "--filter=blob:none", "-o", "lab", place, clone], check=True)
    (tmp_path / "into").mkdir()
    with pytest.raises(RevisionError) as caught:
        check_out("HEAD~1", clone / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    command = str(caught.value.diagnostic.help).split("`")[1]
    assert command == f"git -C {clone} fetch --refetch --no-filter lab"
    subprocess.run(command.split(), check=True, capture_output=True)
    (tmp_path / "again").mkdir()
    _, path = check_out("HEAD~1", clone / "arm" / "arm.xml", tmp_path / "again", dict(os.environ))
    assert path.read_text() == MODEL


@posix
@pytest.mark.parametrize("name", ["x; touch y", "$(touch y)", "-x", "a`b`"])
def test_a_command_to_paste_has_no_name_that_a_shell_reads(robots: Any, name: str) -> None:
    robots.git("config", f"remote.{name}.promisor", "true")
    git = Git(dict(os.environ), quiet)
    assert git_command.partial_from(git, robots.folder) is None
    robots.git("config", "remote.lab.promisor", "yes")
    assert git_command.partial_from(git, robots.folder) == "lab"


@posix
def test_the_objects_of_a_work_tree_are_those_of_its_repository(robots: Any, tmp_path: Path) -> None:
    other = tmp_path / "other"
    robots.git("worktree", "add", "-q", str(other), "-b", "other")
    (tmp_path / "into").mkdir()
    _, path = check_out("HEAD", other / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert path.read_text() == MODEL


@posix
def test_a_repository_with_longer_hashes(tmp_path: Path) -> None:
    folder = tmp_path / "robots"
    subprocess.run(["git", "init", "-q", "--object-format=sha256", folder], check=True)
    (folder / "arm.xml").write_text(MODEL)
    own = ["git", "-C", str(folder), "-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run([*own, "add", "arm.xml"], check=True)
    subprocess.run([*own, "commit", "-q", "-m", "one"], check=True)
    (tmp_path / "into").mkdir()
    _, path = check_out("HEAD", folder / "arm.xml", tmp_path / "into", dict(os.environ))
    assert path.read_text() == MODEL


@posix
def test_the_program_is_found_by_absolute_folders_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trace = tmp_path / "trace"
    there = shutil.which("git")
    assert there is not None
    (tmp_path / "git").write_text(f"#!/bin/sh\ntouch {trace}\n")
    (tmp_path / "git").chmod(0o755)
    monkeypatch.chdir(tmp_path)
    for start in (".", "", str(Path("..", tmp_path.name))):
        path = f"{start}{os.pathsep}{os.path.dirname(there)}"
        assert Git({**os.environ, "PATH": path}, quiet).run("version").startswith(b"git version")
        with pytest.raises(SourceError, match="not installed"):
            Git({**os.environ, "PATH": start}, quiet).run("version")
    assert not trace.exists()


@posix
def test_the_ssh_of_the_user_is_kept(own_environment: dict[str, str], tmp_path: Path) -> None:
    """It may be in any of the settings of the user, and gets the timeout if it is OpenSSH."""
    (tmp_path / "ssh").write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/words\nexit 255\n')
    (tmp_path / "ssh").chmod(0o755)
    (tmp_path / "more").write_text(f"[core]\n\tsshCommand = {tmp_path}/ssh -F none\n")
    (tmp_path / "settings").write_text(f"[include]\n\tpath = {tmp_path}/more\n")
    environment = {**own_environment, "GIT_CONFIG_GLOBAL": str(tmp_path / "settings")}
    with pytest.raises(GitFailure):
        Git(environment, quiet).fetch("ls-remote", "--", "ssh://git@robots.example/x")
    words = (tmp_path / "words").read_text()
    assert words.startswith("-F none -o ConnectTimeout=2 ") and "git@robots.example" in words


@posix
@pytest.mark.parametrize("url", URLS)
def test_the_settings_of_a_received_repository_are_not_read_for_its_files(
    robots: Any, tmp_path: Path, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even where git may contact anybody."""
    trace = tmp_path / "trace"
    received(robots.folder, trace, url)
    lose(robots, "HEAD:arm/arm.xml")
    monkeypatch.setattr(git_command, "NO_TRANSPORT", {})
    (tmp_path / "into").mkdir()
    with pytest.raises(RevisionError):
        check_out("HEAD", robots.folder / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert not trace.exists()


@posix
@pytest.mark.parametrize("is_confined", [True, False])
def test_settings_that_the_user_cannot_loosen(
    own_environment: dict[str, str], tmp_path: Path, is_confined: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What git itself says that is in force, for a reference of the user and of a fetched recipe."""
    always = {
        "core.hooksPath": os.devnull,
        "core.fsmonitor": "false",
        "core.attributesFile": os.devnull,
        "submodule.recurse": "false",
        "fetch.recurseSubmodules": "false",
        "gc.auto": "0",
    }
    confined = {"http.followRedirects": "false", "transfer.bundleURI": "false", "fetch.uriProtocols": ""}
    settings = tmp_path / "settings"
    for name in (*always, *confined):
        subprocess.run(["git", "config", "--file", settings, name, "loose"], check=True)
    monkeypatch.setattr(git_repository, "is_private", lambda netloc: False)
    monkeypatch.setattr(
        git_repository, "addresses_of", lambda netloc: (ip_address("8.8.8.8"), ip_address("2606:4700::1"))
    )
    lookup = Lookup(
        tmp_path, {**own_environment, "GIT_CONFIG_GLOBAL": str(settings)}, Fetching(), is_confined=is_confined
    )
    reference = parse("git+https://Robots.example.org/x@v1#arm.xml")
    git = git_repository._Repository(reference, reference.id, Store.of(lookup.environment), lookup=lookup)._git
    for name, value in {
        **always,
        **{name: value if is_confined else "loose" for name, value in confined.items()},
    }.items():
        assert git.run("config", "--get", name).decode().strip() == value, name
    pinned = [value for name, value in git.settings if name == "http.curloptResolve"]
    assert pinned == (["robots.example.org:443:8.8.8.8,[2606:4700::1]"] if is_confined else [])


@posix
def test_objects_that_are_borrowed_from_another_repository(robots: Any, tmp_path: Path) -> None:
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "-q", "--shared", robots.folder, clone], check=True)
    (tmp_path / "into").mkdir()
    _, path = check_out("HEAD", clone / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert path.read_text() == MODEL


@posix
def test_a_clone_that_borrows_its_objects_is_no_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The size of a bomb is compared with all objects that git reads, wherever they lie."""
    monkeypatch.setattr("mjcompose.sources.web_archive.SMALL", 1000)
    lender = tmp_path / "lender"
    git = ["git", "-c", "user.name=x", "-c", "user.email=x@y", "-C", str(lender)]
    subprocess.run(["git", "init", "-q", lender], check=True)
    (lender / "arm.xml").write_text(MODEL)
    (lender / "noise.bin").write_bytes(os.urandom(100_000))
    subprocess.run([*git, "add", "."], check=True)
    subprocess.run([*git, "commit", "-qm", "one"], check=True)
    previous = lender
    for name in ("first", "second"):
        subprocess.run(["git", "clone", "-q", "--shared", previous, tmp_path / name], check=True)
        previous = tmp_path / name
        (tmp_path / f"{name}-files").mkdir()
        _, path = check_out("HEAD", previous / "arm.xml", tmp_path / f"{name}-files", dict(os.environ))
        assert path.read_text() == MODEL
    (lender / "noise.bin").write_bytes(bytes(1_000_000))
    subprocess.run([*git, "commit", "-qam", "two"], check=True)
    subprocess.run(["git", "-C", tmp_path / "first", "pull", "-q"], check=True)
    monkeypatch.setattr("mjcompose.sources.git_command._PARTS_OF_OBJECTS", ())
    (tmp_path / "bomb").mkdir()
    with pytest.raises(RevisionError, match="as only bombs do"):
        check_out("HEAD", tmp_path / "first" / "arm.xml", tmp_path / "bomb", dict(os.environ))


@posix
@pytest.mark.parametrize("name", ["config", "HEAD", "packed-refs", "objects", "info"])
def test_a_pipe_in_a_received_repository_keeps_nobody_waiting(
    robots: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(git_command, "_MOST_SILENCE", 1.0)
    settings = Path(robots.folder) / ".git"
    place = settings / name
    if name == "packed-refs":
        branch = (
            settings / subprocess.check_output(["git", "-C", robots.folder, "symbolic-ref", "HEAD"], text=True).strip()
        )
        branch.unlink()
    if name == "objects":
        blob = subprocess.check_output(["git", "-C", robots.folder, "rev-parse", "HEAD:arm/arm.xml"], text=True).strip()
        place = settings / "objects" / blob[:2] / blob[2:]
    if name == "info":  # of another repository, from which this one borrows
        other = tmp_path / "other" / "pack"
        other.mkdir(parents=True)
        (settings / "objects" / "info").mkdir(exist_ok=True)
        (settings / "objects" / "info" / "alternates").write_text(f"{other.parent}\n")
        blob = subprocess.check_output(["git", "-C", robots.folder, "rev-parse", "HEAD:arm/arm.xml"], text=True).strip()
        (settings / "objects" / blob[:2] / blob[2:]).unlink()
        place = other.parent / blob[:2] / blob[2:]
        place.parent.mkdir()
    place.unlink(missing_ok=True)
    os.mkfifo(place)
    (tmp_path / "into").mkdir()
    begun = time.monotonic()
    with pytest.raises(RevisionError, match="git has not answered for 1 seconds"):
        check_out("HEAD", Path(robots.folder) / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    assert time.monotonic() - begun < 20


@posix
@pytest.mark.parametrize("place", ["other", "/", "..", "arm"])
def test_a_repository_that_says_its_files_are_elsewhere(robots: Any, tmp_path: Path, place: str) -> None:
    """Files of the work tree would be read for those of the revision."""
    (tmp_path / "other").mkdir()
    folder = Path(robots.folder)
    to = {"other": tmp_path / "other", "arm": folder / "arm"}.get(place, place)
    subprocess.run(["git", "-C", folder, "config", "core.worktree", to], check=True)
    (folder / "arm" / "arm.xml").write_text(MODEL.replace("0.1", "0.2"))
    (tmp_path / "into").mkdir()
    try:
        _, path = check_out("HEAD", folder / "arm" / "arm.xml", tmp_path / "into", dict(os.environ))
    except RevisionError as error:
        assert "says that its files are in" in str(error)
    else:
        assert not path.exists() or path.read_text() == MODEL


@posix
def test_git_finds_no_repository_around_its_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder for temporary files may be in a repository."""
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    subprocess.run(["git", "-C", tmp_path, "config", "core.sshCommand", "theirs"], check=True)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("mjcompose.base.processes._emptied", {})
    with pytest.raises(GitFailure):
        Git(dict(os.environ), quiet).run("config", "--get", "core.sshCommand")


def test_git_gets_the_login_of_the_user_and_no_repository_from_the_environment(robots: Any) -> None:
    """As in a hook of git, whose variables describe the repository of the hook."""
    users = {"GIT_SSH_COMMAND": "ssh -4", "GIT_CONFIG_COUNT": "1", "GIT_CONFIG_KEY_0": "a.b", "GIT_CONFIG_VALUE_0": "c"}
    of_a_hook = {
        "GIT_DIR": ".git",
        "GIT_WORK_TREE": ".",
        "GIT_INDEX_FILE": "index",
        "GIT_OBJECT_DIRECTORY": "objects",
        "GIT_ALTERNATE_OBJECT_DIRECTORIES": "others",
        "GIT_COMMON_DIR": ".git",
        "GIT_NAMESPACE": "theirs",
        "GIT_CONFIG": "config",
        "GIT_CONFIG_PARAMETERS": "'core.sshCommand=theirs'",
        "GIT_TEMPLATE_DIR": "templates",
        "GIT_EXTERNAL_DIFF": "diff",
        "GIT_ATTR_SOURCE": "HEAD",
        "GIT_ALLOW_PROTOCOL": "ext",
        "GIT_PAGER": "pager",
    }
    variables = Git({**users, **of_a_hook}, quiet)._variables({})
    assert {name: variables.get(name) for name in users} == users
    assert not {name for name, value in of_a_hook.items() if variables.get(name) == value}


def test_the_templates_of_the_user_are_not_in_a_repository_of_ours(
    own_environment: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "templates" / "hooks").mkdir(parents=True)
    (tmp_path / "templates" / "hooks" / "post-checkout").write_text("#!/bin/sh\n")
    settings = tmp_path / "settings"
    settings.write_text(f"[init]\n\ttemplateDir = {(tmp_path / 'templates').as_posix()}\n")
    Git({**os.environ, **own_environment, "GIT_CONFIG_GLOBAL": str(settings)}, quiet).create(tmp_path / "repository")
    assert (tmp_path / "repository" / "objects").is_dir()
    assert not (tmp_path / "repository" / "hooks").exists()


def test_the_server_of_a_local_repository_gets_the_bounds_and_no_transport() -> None:
    words = shlex.split(git_command.serving())
    assert {f"{name}={value}" for name, value in git_command.NO_TRANSPORT.items()} <= set(words[: words.index("git")])
    options = set(words[words.index("git") :])
    for settings in (git_command._BOUNDS, git_command.CONFINED):
        assert {f"{name}={value}" for name, value in settings.items()} <= options
