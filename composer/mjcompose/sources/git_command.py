"""Running `git` without a terminal, and reading the files of a commit byte for byte."""

from __future__ import annotations

import math
import os
import re
import shlex
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import IO, Any, cast

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.processes import DEVNULL, PIPE, Process, program
from mjcompose.base.scratch import scratch
from mjcompose.sources.fetching import Silence, patience, waiting
from mjcompose.sources.reference import SourceError
from mjcompose.sources.web_archive import Unsafe, check, check_name

_TRIES = 3
_PAUSE = 0.5
_LOOK_AGAIN = 0.1
_MOST_SILENCE = 15.0
"""Seconds that git may take for its next words about a repository on this disk. A pipe in `.git` keeps it waiting."""
_MOST_OUTPUT = 64 * 1024**2
_MOST_WORDS = 64 * 1024
_PASSING = re.compile(
    r"temporary failure|timed out|timeout|connection (refused|reset|closed)|early eof"
    r"|rpc failed|unexpected disconnect|hung up unexpectedly|couldn't connect|failed to connect|error: 5\d\d"
    r"|operation too slow",
    re.IGNORECASE,
)
"""Failures that another try may overcome."""
_NO_NAME = re.compile("could not resolve host", re.IGNORECASE)
"""The network or the name does not exist: another try a second later would fail too."""
_ADVICE = re.compile(r"(hint|warning): |Please make sure you have the correct access|and the repository exists", re.I)


class GitFailure(Exception):
    """The command failed; `said` is its standard error."""

    def __init__(self, said: str) -> None:
        super().__init__(said)
        self.said = said


class GitSilence(GitFailure):
    """git did not answer in time."""


class Git(Struct):
    """Runs git with the settings of the user, and of no repository that somebody else may have written.

    Commands run in an empty folder. They see the repository that they name, which must be one that mjcompose made, or
    none. `objects` is a folder with the objects of another repository, which they read instead of the repository's
    own. `settings` are further settings of git. `limit` is the maximum time of one command in seconds.
    """

    environment: Mapping[str, str]
    progress: Callable[[str], None]
    limit: float = 1800.0
    objects: Path | None = None
    settings: tuple[tuple[str, str], ...] = ()

    def run(self, *arguments: str, folder: Path | None = None) -> bytes:
        """Run a command that contacts nobody, and return its standard output.

        Raises GitFailure, and SourceError if git is not installed.
        """
        with self.open(*arguments, folder=folder) as process:
            return _output_of(process)

    def create(self, folder: Path, kind: str = "sha1") -> None:
        """Make an empty repository with hashes of this kind. Raises as `run` does."""
        other_kind = [] if kind == "sha1" else [f"--object-format={kind}"]  # git before 2.29 does not know the option
        words = ["init", "-q", "--bare", "--template=", *other_kind, "--", str(folder)]
        self.run(*words)

    def around(self, near: Path, *arguments: str) -> str:
        """Return the answer of a command about the repository around a folder. Raises as `run` does.

        git reads the settings of that repository, which may come from anyone: only `rev-parse` and `config` run here,
        which start no program, and no object is fetched.
        """
        with self._process(("-C", str(near), *arguments), {}) as process:
            return _output_of(process).decode("utf-8", "surrogateescape").removesuffix("\n")

    def fetch(self, *arguments: str, folder: Path | None = None) -> bytes:
        """Run a command that contacts another machine, and retry it within one timeout if the network fails."""
        silence = Silence(patience(self.environment))
        for attempt in range(_TRIES):
            try:
                with waiting(self.progress, "for the repository"):
                    return self._contact(arguments, folder)
            except GitFailure as failure:
                passing = _PASSING.search(failure.said) and not _NO_NAME.search(failure.said)
                if attempt + 1 == _TRIES or not passing or silence.is_over:
                    raise
                last = failure.said.strip().splitlines()[-1:] or ["git failed"]
                self.progress(f"{last[0]}; trying again")
                time.sleep(_PAUSE * 2**attempt)
        raise AssertionError("there is at least one try")

    def _contact(self, arguments: tuple[str, ...], folder: Path | None) -> bytes:
        own = {**_place(folder), "GIT_ALLOW_PROTOCOL": _protocols(arguments)}
        if any(word.startswith("ssh://") for word in arguments):
            own |= self._impatient_ssh()
        with self._process(arguments, own, silence=math.inf) as process:
            return _output_of(process)

    @contextmanager
    def open(self, *arguments: str, folder: Path | None = None, asked: bool = False) -> Iterator[Any]:
        """Run a command that contacts nobody, and yield it for reading its output, and with `asked` for writing too.

        The command ends with the block. Raises GitFailure if it fails, and SourceError if git is not installed.
        """
        with self._process(arguments, _place(folder), asked=asked) as process:
            yield process

    @contextmanager
    def _process(
        self, arguments: tuple[str, ...], place: Mapping[str, str], *, asked: bool = False, silence: float | None = None
    ) -> Iterator[Any]:
        limits = in_force()
        own = self._variables(place)
        with (
            tempfile.TemporaryFile() as words,
            Process(
                [_git_of(own), "--no-pager", *self._options(), *arguments],
                memory=limits.git_memory,
                size=limits.source_size,
                stdin=PIPE if asked else DEVNULL,
                stdout=PIPE,
                stderr=words,
                env=own,
            ) as process,
        ):
            assert process.stdout is not None
            output = _Output(process.stdout)
            process.stdout = cast(IO[bytes], output)
            has_ended = threading.Event()
            reasons: list[str] = []

            def watch() -> None:
                most_silence = _MOST_SILENCE if silence is None else silence
                end = time.monotonic() + self.limit
                while not has_ended.wait(_LOOK_AGAIN):
                    if time.monotonic() > end:
                        reasons.append(f"git took longer than {self.limit:g} seconds")
                    elif output.silence > most_silence:
                        reasons.append(f"git has not answered for {most_silence:g} seconds")
                    else:
                        continue
                    process.end()
                    return

            threading.Thread(target=watch, daemon=True).start()
            try:
                yield process
                if process.stdin is not None:
                    process.stdin.close()
                status = process.wait()
            finally:
                has_ended.set()
                process.end()
            if reasons:
                raise GitSilence(reasons[0])
            if status:
                words.seek(0)
                said = words.read(_MOST_WORDS).decode("utf-8", "replace").strip()
                raise GitFailure(said or (f"git was ended by signal {-status}" if status < 0 else ""))

    def _options(self) -> list[str]:
        # With `fetch.unpackLimit`, all objects arrive in one file, whose size can be limited.
        return _options(
            {
                **_BOUNDS,
                **CONFINED,
                "http.lowSpeedLimit": "1",
                "http.lowSpeedTime": self._silence,
                "gc.auto": "0",
                "fetch.fsckObjects": "false",
                "fetch.unpackLimit": "1",
                **dict(self.settings),
            }
        )

    def _variables(self, place: Mapping[str, str]) -> dict[str, str]:
        own = {**os.environ, "GIT_ASKPASS": "", **self.environment}
        own = {
            name: value for name, value in own.items() if not name.startswith("GIT_") or _OF_THE_USER.fullmatch(name)
        }
        own |= {"GIT_TERMINAL_PROMPT": "0", "LC_ALL": "C", **NO_TRANSPORT, **NO_SYSTEM, **place}
        if self.objects is not None:
            own["GIT_OBJECT_DIRECTORY"] = str(self.objects)
        return own

    @property
    def _silence(self) -> str:
        return str(math.ceil(patience(self.environment)))  # git takes whole seconds

    def _impatient_ssh(self) -> dict[str, str]:
        """Return settings that end ssh after some seconds of silence, unless the user has another program."""
        own = self._variables({})
        command = own.get("GIT_SSH_COMMAND") or self._setting("core.sshCommand")
        if not command and own.get("GIT_SSH"):
            return {}
        command = command or "ssh"
        if not _OPENSSH.match(command):
            return {}
        limits = {"ConnectTimeout": self._silence, "ServerAliveInterval": self._silence, "ServerAliveCountMax": "1"}
        return {"GIT_SSH_COMMAND": " ".join([command, *(f"-o {name}={value}" for name, value in limits.items())])}

    def _setting(self, name: str) -> str:
        """Return a setting of the user, empty if there is none."""
        try:
            return self.run("config", "--get", name).decode("utf-8", "surrogateescape").strip()
        except GitFailure:
            return ""


class _Output:
    """The output of git, and the seconds that a reader has waited for its next bytes."""

    def __init__(self, pipe: Any) -> None:
        self._pipe = pipe
        self._begun = math.inf

    @property
    def silence(self) -> float:
        return max(0.0, time.monotonic() - self._begun)

    @contextmanager
    def _waiting(self) -> Iterator[Any]:
        self._begun = time.monotonic()
        try:
            yield self._pipe
        finally:
            self._begun = math.inf

    def read(self, size: int) -> bytes:
        with self._waiting() as pipe:
            return bytes(pipe.read(size))

    def read1(self, size: int) -> bytes:
        with self._waiting() as pipe:
            return bytes(pipe.read1(size))

    def readline(self) -> bytes:
        with self._waiting() as pipe:
            return bytes(pipe.readline())

    def close(self) -> None:
        self._pipe.close()


def _output_of(process: Any) -> bytes:
    out: bytes = process.stdout.read(_MOST_OUTPUT + 1)
    if len(out) > _MOST_OUTPUT:
        raise GitFailure(f"git prints more than {_MOST_OUTPUT >> 20} MiB")
    return out


def _place(folder: Path | None) -> dict[str, str]:
    """Return the variable that names the repository: git looks for one around the current folder without it."""
    return {"GIT_DIR": os.devnull if folder is None else str(folder)}


def _git_of(variables: Mapping[str, str]) -> str:
    """Return the path of git. Raises SourceError if it is not installed."""
    git = program("git", variables)
    if git is None:
        message = "models in git repositories need the command `git`, which is not installed"
        raise SourceError("source-fetch", message, help="install git")
    return git


def serving() -> str:
    """Return the shell command that serves a local repository: git sends it none of the settings of its caller.

    That repository may be anybody's. A partial clone would fetch missing objects with a command of its own settings.
    """
    words = [*(f"{name}={value}" for name, value in NO_TRANSPORT.items()), "git", *_options({**_BOUNDS, **CONFINED})]
    return f"{shlex.join(words)} upload-pack"


_BOUNDS = {
    "core.bigFileThreshold": "8m",
    "core.deltaBaseCacheLimit": "16m",
    "pack.windowMemory": "64m",
    "pack.threads": "1",
}
"""Settings that keep git from loading large files into memory."""


def _options(settings: Mapping[str, str]) -> list[str]:
    return [word for name, value in settings.items() for word in ("-c", f"{name}={value}")]


CONFINED = {
    "core.hooksPath": os.devnull,
    "core.fsmonitor": "false",
    "core.attributesFile": os.devnull,
    "submodule.recurse": "false",
    "fetch.recurseSubmodules": "false",
}
"""Settings that keep git from running anything from a repository."""
NO_TRANSPORT = {"GIT_ALLOW_PROTOCOL": "none", "GIT_NO_LAZY_FETCH": "1"}
"""Variables with which git contacts nobody.

git before 2.45 does not know GIT_NO_LAZY_FETCH: for an object that is missing, it starts a fetch, which ends before any
program of the repository starts, because no transport is allowed.
"""
# The user's settings apply; the system's may come from somebody else. On Windows they are needed to trust servers.
NO_SYSTEM = {} if os.name == "nt" else {"GIT_CONFIG_NOSYSTEM": "1", "GIT_ATTR_NOSYSTEM": "1"}
_OF_THE_USER = re.compile(
    r"GIT_(ASKPASS|SSH|SSH_COMMAND|SSH_VARIANT|SSL_\w+|HTTP_\w+|PROXY_SSL_\w+|CURL_VERBOSE|TRACE\w*|EXEC_PATH"
    r"|CEILING_DIRECTORIES|DISCOVERY_ACROSS_FILESYSTEM|CONFIG_(GLOBAL|SYSTEM|COUNT|KEY_\d+|VALUE_\d+))"
)
"""The variables of git that say how the user logs in and connects; others describe a repository, as a hook sees it."""


def _protocols(arguments: tuple[str, ...]) -> str:
    """Return the transports that git may use, even if its settings redirect it. Programs (`ext::`) are never allowed.

    >>> _protocols(("ls-remote", "--", "http://localhost/robots"))
    'https:ssh:file:http'
    """
    return "https:ssh:file" + (":http" if any(word.startswith("http://") for word in arguments) else "")


_OPENSSH = re.compile(r"(\S*/)?ssh(\s|$)")
"""ssh uses the first of several equal options, so options in the user's command stay in force."""


@contextmanager
def objects_around(git: Git, near: Path) -> Iterator[tuple[Git, Path]]:
    """Yield a git that reads the objects of the repository around a folder, and an empty repository to run it in.

    git sees no settings of that repository, which may come from anyone. An object that a partial clone lacks is
    missing, because no setting says where to fetch it. Raises as `Git.run` does.
    """
    question = ("rev-parse", "--git-path", "objects", "--show-object-format")
    place, _, kind = git.around(near, *question).rpartition("\n")
    objects = os.path.join(near, place)
    with scratch("repository") as folder:
        git.create(folder, kind)
        yield replace(git, objects=Path(objects)), folder


def partial_from(git: Git, near: Path) -> str | None:
    """Return the remote that the repository around a folder lacks objects of, or None if it is not a partial clone."""
    question = ("config", "--local", "--type=bool", "--get-regexp", r"^remote\..*\.promisor$")
    try:
        found = git.around(near, *question)
    except GitFailure:
        return None
    names = (line.removeprefix("remote.").removesuffix(".promisor true") for line in found.splitlines())
    return next((name for name in names if _REMOTE.fullmatch(name)), None)


_REMOTE = re.compile(r"\w[\w./-]*", re.ASCII)
"""Names of remotes that a shell takes as one word."""


def words_of(failure: GitFailure) -> tuple[str, ...]:
    """Return git's error messages as notes, without the advice."""
    lines = [line.strip() for line in failure.said.splitlines() if line.strip()]
    said = [line for line in lines if not _ADVICE.match(line)] or lines
    return tuple(f"git said: {line}" for line in said[:3])


_LINK = "120000"
_MODULE = "160000"
_PIECE = 1024 * 1024
_PATH_MAX = 4096
_NOTHING = "a link to `{}`, which is not in the commit"


class _Blob(Struct):
    mode: str
    name: str
    hash: str
    size: int


Contents = Callable[[_Blob], Iterator[bytes]]


def write_tree(git: Git, repository: Path, commit: str, target: Path) -> dict[str, str]:
    """Write the files of a commit below `target`, an empty folder.

    Return the omitted paths, each with a description. A link to a file or folder of the same commit becomes a copy;
    other links and submodules are omitted. Raises SourceError for a tree that is too large or whose names lead outside
    the folder, GitFailure, and OSError.
    """
    packed = sum(map(_size_of, _with_borrowed(git.objects or repository / "objects")))
    try:
        blobs = list(_listed(git, repository, commit))
        left_out = {blob.name: "a submodule, which is not fetched" for blob in blobs if blob.mode == _MODULE}
        files = {blob.name: blob for blob in blobs if blob.mode not in (_MODULE, _LINK)}
        _check((blob for blob in blobs if blob.mode != _MODULE), packed)
        links = [blob for blob in blobs if blob.mode == _LINK and blob.size < _PATH_MAX]
        written = dict(files)
        with _contents(git, repository) as contents:
            _follow(links, contents, files, written=written, left_out=left_out)
            _check(written.values(), packed)
            for name, blob in written.items():
                path = target / name
                path.parent.mkdir(parents=True, exist_ok=True)
                with path.open("xb") as stream:
                    for piece in contents(blob):
                        stream.write(piece)
    except Unsafe as fault:
        message = f"the commit `{commit[:12]}` is refused: {fault}"
        raise SourceError("archive-refused", message, help=fault.help) from None
    return left_out


def _with_borrowed(objects: Path) -> Iterator[Path]:
    """Yield a folder of objects, and those from which it borrows objects: a clone may share those of another."""
    folders = [objects]
    for folder in folders:  # grows in the loop
        yield folder
        with suppress(OSError):
            lines = read_regular(folder / "info" / "alternates", _MOST_WORDS, is_source=False).splitlines()
            others = (Path(os.path.normpath(folder / os.fsdecode(line))) for line in lines if line)
            folders += [other for other in others if other not in folders]


_PARTS_OF_OBJECTS = ("pack", *(f"{number:02x}" for number in range(256)))


def _size_of(objects: Path) -> int:
    """Return the bytes of the files that git reads objects from in a folder."""
    size = 0
    for part in _PARTS_OF_OBJECTS:
        with suppress(OSError), os.scandir(objects / part) as entries:
            size += sum(entry.stat().st_size for entry in entries)
    return size


def _check(blobs: Iterable[_Blob], packed: int) -> None:
    known = list(blobs)
    check(len(known), sum(blob.size for blob in known), packed)
    for blob in known:
        check_name(blob.name)


def _follow(
    links: list[_Blob],
    contents: Contents,
    files: dict[str, _Blob],
    written: dict[str, _Blob],
    left_out: dict[str, str],
) -> None:
    targets = {link.name: b"".join(contents(link)).decode("utf-8", "surrogateescape") for link in links}
    real = {name: _real(name, targets) for name in targets}
    for name, leads_to in real.items():
        if leads_to is None:
            left_out[name] = _NOTHING.format(targets[name])
        elif leads_to in files:
            written[name] = files[leads_to]
        elif f"{name}/".startswith(f"{leads_to}/") or not leads_to:
            left_out[name] = "a link to a folder that it is in"
        else:
            inside = f"{leads_to}/"
            found = {each: each for each in files if each.startswith(inside)}
            found |= {each: to for each, to in real.items() if to in files and each.startswith(inside)}
            for each, to in found.items():
                written[f"{name}/{each.removeprefix(inside)}"] = files[to]
                check(len(written), 0)
            if not found:
                left_out[name] = _NOTHING.format(targets[name])


def _real(path: str, targets: Mapping[str, str], patience: int = 16) -> str | None:
    """Return the path with links resolved, or None if it is not a path of the commit. No I/O."""
    parts = path.split("/")
    done: list[str] = []
    for at, part in enumerate(parts, 1):
        if part in ("", "."):
            continue
        if part == "..":
            if not done:
                return None
            done.pop()
            continue
        target = targets.get("/".join([*done, part]))
        if target is None:
            done.append(part)
        elif target.startswith("/") or not patience:
            return None
        else:
            return _real("/".join([*done, target, *parts[at:]]), targets, patience - 1)
    return "/".join(done)


def _listed(git: Git, repository: Path, commit: str) -> Iterator[_Blob]:
    """Yield the files of a commit until there are too many: a tree may contain itself many times."""
    left = b""
    with git.open("ls-tree", "-r", "-z", "-l", "--full-tree", commit, folder=repository) as process:
        count = 0
        while piece := process.stdout.read1(_PIECE):
            *lines, left = (left + piece).split(b"\0")
            count += len(lines)
            check(count, 0)
            for line in lines:
                facts, name = line.split(b"\t", 1)
                mode, _, hash, size = facts.decode().split()
                shown = name.decode("utf-8", "surrogateescape")
                if size == "BAD":
                    raise GitFailure(f"the repository does not have the contents of `{shown}`")
                yield _Blob(mode, shown, hash, size=0 if size == "-" else int(size))


@contextmanager
def _contents(git: Git, repository: Path) -> Iterator[Contents]:
    """Yield a function that returns the bytes of a file piece by piece: memory never holds a whole file."""
    with git.open("cat-file", "--batch", folder=repository, asked=True) as process:

        def content(blob: _Blob) -> Iterator[bytes]:
            with suppress(BrokenPipeError):  # git has ended, which its output will show
                process.stdin.write(f"{blob.hash}\n".encode())
                process.stdin.flush()
            header = process.stdout.readline().split()
            left = int(header[2]) if len(header) == 3 else -1
            if left != blob.size:
                raise GitFailure(f"git has other bytes of `{blob.name}` than it said")
            while left:
                piece = process.stdout.read1(min(left, _PIECE))
                if not piece:
                    raise GitFailure(f"git broke off in `{blob.name}`")
                left -= len(piece)
                yield piece
            process.stdout.read(1)

        yield content
