"""Write the files of a commit byte for byte: no filters, attributes or line endings of this machine apply."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from composer.dataclass import dataclass
from composer.sources.digest import files_below
from composer.sources.error import SourceError
from composer.sources.git_command import Git, GitFailure
from composer.sources.unpack import Unsafe, check, check_name

_LINK, _MODULE = "120000", "160000"
_PIECE = 1024 * 1024
_PATH_MAX = 4096
_NOTHING = "a link to what is not in the commit, `{}`"


@dataclass(frozen=True, slots=True)
class _Blob:
    mode: str
    name: str
    hash: str
    size: int


Contents = Callable[[_Blob], Iterator[bytes]]


def write_tree(git: Git, repository: Path, commit: str, target: Path) -> dict[str, str]:
    """Write the files of a commit below `target`, an empty folder.

    Return the omitted paths, each with a description. A link to a file or folder of the same commit becomes a copy;
    other links and submodules are omitted. Raises SourceError for a tree that is too large or whose names lead out
    of the folder, GitFailure, and OSError.
    """
    packed = sum(path.stat().st_size for _, path in files_below(repository))
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
    """Put the targets of links into `written` under the names of the links, or the links into `left_out`."""
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
    """Return the path with links resolved, or None if it is not a path of the commit. No I/O.

    >>> _real("a/b/c.xml", {"a/b": "../d"})
    'd/c.xml'
    """
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
    """Yield the files of a commit until there are too many: a tree may contain itself many times over."""
    left = b""
    with git.open("ls-tree", "-r", "-z", "-l", "--full-tree", commit, folder=repository) as process:
        count = 0
        while piece := process.stdout.read1(_PIECE):
            *lines, left = (left + piece).split(b"\0")
            count += len(lines)
            check(count, 0)
            yield from map(_blob, lines)


def _blob(line: bytes) -> _Blob:
    facts, name = line.split(b"\t", 1)
    mode, _, hash, size = facts.decode().split()
    return _Blob(mode, name.decode("utf-8", "surrogateescape"), hash, size=0 if size == "-" else int(size))


@contextmanager
def _contents(git: Git, repository: Path) -> Iterator[Contents]:
    """Yield a function that returns the bytes of a file piece by piece, so that memory never holds a whole file."""
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
