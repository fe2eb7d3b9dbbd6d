"""The files of a git repository at a revision, which are fetched and kept in the store by their commit."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import hide
from mjcompose.base.files import read_regular
from mjcompose.base.limits import advice, in_force, written
from mjcompose.base.scratch import scratch
from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources.address import DEFAULT_PORTS, addresses_of, is_private, is_this_machine, take_apart
from mjcompose.sources.blobs import files_below, sha256_of
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand, source_in, unlocked
from mjcompose.sources.git_command import Git, GitFailure, serving, words_of, write_tree
from mjcompose.sources.reference import TO_TRUST, Origin, Reference, Source, SourceError, is_commit, outside_network
from mjcompose.sources.store import Store, StoreEntry
from mjcompose.sources.web_archive import Unsafe, check

_NO_ROOM = re.compile("No space left|quota exceeded", re.IGNORECASE)
_TOO_LARGE = re.compile("File too large|signal 25", re.IGNORECASE)
_NO_MEMORY = re.compile("out of memory|malloc failed|unable to create thread|mmap failed", re.IGNORECASE)
_REDIRECTED = re.compile(r"returned error: 30[12378]|maximum.* redirects", re.IGNORECASE)
_WITHOUT = "without "
"""In the notes of an entry, the prefix before the path of a file that was left out."""
_ABBREVIATED = re.compile(r"[0-9a-f]{7,39}")


def resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the file at a revision, whose commit the lock or the repository gives. Raises SourceError."""
    id = reference.id
    known = lookup.fetching.origins
    if id not in known:
        known[id] = _Repository(reference, id, Store.of(lookup.environment), lookup=lookup).origin()
    return source_in(known[id], reference)


class _Repository(Struct):
    reference: Reference
    id: str
    store: Store
    lookup: Lookup

    @property
    def fetching(self) -> Fetching:
        return self.lookup.fetching

    def origin(self) -> Origin:
        pinned = self.fetching.pin(self.id)
        if pinned is None and self.fetching.locked:
            raise unlocked(self.reference, self.fetching)
        revision = self.reference.revision
        written = revision if is_commit(revision) else None
        if written and pinned and written != pinned:
            message = f"`{self.reference.text}` names another commit than the lock, which has {pinned[:12]}…"
            help = "take the lock from version control, or remove it and run `mjcompose lock`"
            raise SourceError("lock-invalid", message, help=help)
        commit = pinned or written
        if commit is None:
            if self.fetching.offline:
                commit = self.store.recall(self.id).get("commit")
                if commit is None:
                    raise not_at_hand(self.reference)
            else:
                commit = self._asked()
        entry = self.store.get("git", commit) or self._fetched(commit, pinned is not None)
        without = ((name.removeprefix(_WITHOUT), why) for name, why in entry.about.items() if name.startswith(_WITHOUT))
        return Origin(
            self.id,
            self.reference.kind,
            entry.content,
            commit=commit,
            tree=entry.about["tree"],
            without=(*without,),
            stored=entry.files,
        )

    @property
    def _git(self) -> Git:
        settings = _settings_of_stranger(self.reference) if self.lookup.is_confined else ()
        return Git(self.lookup.environment, self.fetching.progress, settings=settings)

    def _asked(self) -> str:
        url = self.reference.name
        revision = self.reference.revision
        self.fetching.progress(f"looking up {revision} in {url}")
        try:
            listed = self._git.fetch("ls-remote", *_other_side(url), "--", url).decode("utf-8", "replace").splitlines()
        except GitFailure as failure:
            raise self._unreachable(failure) from None
        refs = {name: commit for commit, _, name in (line.partition("\t") for line in listed)}
        for name in (revision, f"refs/tags/{revision}", f"refs/heads/{revision}", f"refs/{revision}"):
            if name in refs:
                commit = refs.get(f"{name}^{{}}", refs[name])
                self.store.remember(self.id, {"commit": commit})
                return commit
        if not _ABBREVIATED.fullmatch(revision):
            raise self._no_revision(refs)
        with scratch("git") as folder:  # an abbreviated hash needs the whole history
            try:
                self._history(folder)
                question = ("rev-parse", "--verify", "-q", f"{revision}^{{commit}}")
                commit = self._git.run(*question, folder=folder).decode().strip()
            except GitFailure:
                raise self._no_revision(refs) from None
        self.store.remember(self.id, {"commit": commit})
        return commit

    def _fetched(self, commit: str, pinned: bool) -> StoreEntry:
        if self.fetching.offline:
            raise not_at_hand(self.reference)
        with self.store.lock(commit, self.fetching.progress):
            entry = self.store.get("git", commit)
            if entry is not None:  # another process has fetched it
                return entry
            about: dict[str, str] = {}
            return self.store.add(
                "git", commit, self.id, lambda target: self._fill(target, commit, pinned, about=about), about
            )

    def _fill(self, target: Path, commit: str, pinned: bool, about: dict[str, str]) -> None:
        """Write the files of the commit, from a clone next to them that a kill leaves in the store."""
        with tempfile.TemporaryDirectory(dir=target.parent) as folder:
            repository = Path(folder)
            self._get(commit, repository, pinned)
            about["tree"] = self._git.run("rev-parse", f"{commit}^{{tree}}", folder=repository).decode().strip()
            try:
                left_out = write_tree(self._git, repository, commit, target=target)
            except GitFailure as failure:
                raise self._unreachable(failure) from None
            replace_pointers(target, self.reference.name, self.store.folder / "partial", lookup=self.lookup)
            about |= {f"{_WITHOUT}{name}": why for name, why in left_out.items()}

    def _get(self, commit: str, repository: Path, pinned: bool) -> None:
        git = self._git
        url = self.reference.name
        self.fetching.progress(f"fetching {url} at {commit[:12]}")
        kind = "sha256" if len(commit) == 64 else "sha1"
        try:
            git.create(repository, kind)
            try:
                options = ("--depth=1", "--no-tags", *_other_side(url))
                git.fetch("fetch", "-q", *options, "--", url, commit, folder=repository)
            except GitFailure as failure:
                if any(each.search(failure.said) for each in (_NO_ROOM, _TOO_LARGE, _NO_MEMORY)):
                    raise
                self._history(repository)
            git.run("cat-file", "-e", f"{commit}^{{commit}}", folder=repository)
        except GitFailure as failure:
            if "Not a valid object" in failure.said or not failure.said:
                raise self._no_commit(commit, pinned) from None
            raise self._unreachable(failure) from None

    def _history(self, repository: Path) -> None:
        git = self._git
        url = self.reference.name
        git.create(repository)
        options = ("--no-tags", *_other_side(url))
        git.fetch("fetch", "-q", *options, "--", url, "+refs/*:refs/fetched/*", folder=repository)

    def _unreachable(self, failure: GitFailure) -> SourceError:
        if _NO_ROOM.search(failure.said) or (_TOO_LARGE.search(failure.said) and _files_are_small()):
            message = f"the store `{self.store.folder}` has no room for `{self.reference.name}`"
            help = "make room, or name another folder in `MJCOMPOSE_CACHE`"
            return SourceError("store-unusable", message, notes=words_of(failure), help=help)
        for found, limit in ((_TOO_LARGE, "source-size"), (_NO_MEMORY, "git-memory")):
            if found.search(failure.said):
                most = written(limit, getattr(in_force(), limit.replace("-", "_")))
                what = "is larger than" if limit == "source-size" else "needs more memory than"
                message = f"the repository `{self.reference.name}` is refused: it {what} {most}"
                return SourceError("archive-refused", message, notes=words_of(failure), help=advice(limit))
        help = "check that `git ls-remote` with that address works; with `--offline` mjcompose uses the store"
        if self.lookup.is_confined and _REDIRECTED.search(failure.said):
            help = "a fetched recipe may name no address that redirects: its author writes the last one, often with"
            help += " `.git` at the end"
        if "@" in self.reference.name.rpartition("/")[2]:
            help = "an `@` in the name of a branch or tag is written `%40`"
        message = f"the repository `{self.reference.name}` cannot be fetched"
        return SourceError("source-fetch", message, notes=words_of(failure), help=help)

    def _no_revision(self, refs: Mapping[str, str]) -> SourceError:
        wanted = self.reference.revision
        url = self.reference.name
        tags = [name[10:] for name in refs if name.startswith("refs/tags/") and not name.endswith("^{}")]
        heads = [name.removeprefix("refs/heads/") for name in refs if name.startswith("refs/heads/")]
        near = closest(wanted, [*tags, *heads])
        message = f"`{url}` has no branch, tag or commit `{wanted}`"
        notes = (exists_note("tag", tags, wanted).message, exists_note("branch", heads, wanted).message)
        before, _, path = self.reference.text.partition("#")
        help = f"write `{before.rpartition('@')[0]}@{_escaped(near[0])}#{path}`" if near else None
        return SourceError("source-revision", message, notes=notes, help=help)

    def _no_commit(self, commit: str, pinned: bool) -> SourceError:
        url = self.reference.name
        text = self.reference.text
        if not pinned:
            return SourceError("source-revision", f"`{url}` has no commit `{commit}`, in `{text}`")
        message = f"`{url}` no longer has the commit `{commit}` that the lock pins for `{text}`"
        notes = ("the branch or tag was moved and the old commit is gone",)
        help = f"look at its contents, then run `mjcompose lock {self.fetching.recipe} --upgrade-source {self.id}`"
        return SourceError("source-revision", message, notes=notes, help=help)


def _settings_of_stranger(reference: Reference) -> tuple[tuple[str, str], ...]:
    """Return the settings with which git contacts only the public server that a fetched recipe names.

    The addresses of its name are looked up once, checked, and given to git (2.37 and newer, over https). Redirects are
    off, because the server that they lead to was not checked. Raises SourceError for a server that is not public.
    """
    parts = take_apart(reference.name)
    if parts is None or is_private(parts.netloc):
        raise outside_network(reference.name)
    addresses = addresses_of(parts.netloc)
    if not addresses:
        message = f"the repository `{reference.name}` cannot be fetched: the name of its server cannot be resolved"
        note = "a fetched recipe may name no server whose address is unknown on this machine, not even through a proxy"
        raise SourceError("source-fetch", message, notes=(note,), help=f"check the network and the address; {TO_TRUST}")
    port = parts.port or DEFAULT_PORTS[parts.scheme]
    listed = ",".join(f"[{each}]" if each.version == 6 else str(each) for each in addresses)
    return (
        ("http.followRedirects", "false"),
        ("http.curloptResolve", f"{parts.hostname}:{port}:{listed}"),
        ("transfer.bundleURI", "false"),
        ("fetch.uriProtocols", ""),
    )


def _escaped(revision: str) -> str:
    """Return the name of a branch or tag as it is written in a reference."""
    return revision.replace("%", "%25").replace("@", "%40").replace("#", "%23")


def _files_are_small() -> bool:
    try:
        import resource
    except ImportError:
        return False
    soft = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return soft != resource.RLIM_INFINITY and soft < in_force().source_size


def _other_side(url: str) -> tuple[str, ...]:
    """Return the option for the git that serves a local repository, which has settings of its own."""
    return (f"--upload-pack={serving()}",) if url.startswith("file://") else ()


_POINTER = re.compile(
    rb"version https://git-lfs\.github\.com/spec/v1\n(?:ext-[^\n]*\n)*oid sha256:([0-9a-f]{64})\nsize (\d{1,18})\n"
)
_LARGEST = 1024
"""Pointers of Git LFS are smaller, in bytes."""
_TOGETHER = 100
_HEADER = re.compile(r"[A-Za-z0-9-]+")
_VALUE = re.compile(r"[\x20-\x7e]*")


class Pointer(Struct):
    sha256: str
    size: int


def pointers_in(folder: Path) -> Iterator[tuple[Path, Pointer]]:
    """Yield the files below a folder that are pointers, in no order. Raises OSError."""
    for _, path in files_below(folder):
        if path.stat().st_size <= _LARGEST:
            found = _POINTER.fullmatch(read_regular(path, is_source=False))
            if found is not None:
                yield path, Pointer(found[1].decode(), int(found[2]))


def replace_by_local(folder: Path, *objects: Path) -> None:
    """Replace pointers below `folder` by their files, if one of the folders of LFS has them. Raises OSError."""
    for path, pointer in pointers_in(folder):
        for stored in (each / pointer.sha256[:2] / pointer.sha256[2:4] / pointer.sha256 for each in objects):
            if os.path.isfile(stored) and not stored.is_symlink() and sha256_of(stored) == pointer.sha256:
                path.unlink()
                shutil.copyfile(stored, path)
                break


def replace_pointers(folder: Path, url: str, partial: Path, lookup: Lookup) -> None:
    """Replace pointers below `folder` by their files from the LFS of the repository at `url`.

    A file that the repository's LFS does not have remains a pointer, which is an error for the model that uses it.
    `partial` is the folder for downloads. Raises SourceError for network errors, for wrong bytes and for files beyond
    the limits; and OSError.
    """
    pointers = list(pointers_in(folder))
    try:
        check(len(pointers), sum(pointer.size for _, pointer in pointers))
    except Unsafe as fault:
        message = f"the files that Git LFS has of `{url}` are refused: {fault}"
        raise SourceError("archive-refused", message, help=fault.help) from None
    if not pointers:
        return
    if url.startswith("file://"):
        root = Path(url.removeprefix("file://"))
        replace_by_local(folder, root / ".git" / "lfs" / "objects", root / "lfs" / "objects")
    elif url.startswith(("https://", "http://")):
        _Server(url, partial, lookup).fill(pointers)
    else:
        lookup.fetching.progress(f"`{url}` has files in Git LFS, which mjcompose fetches over https only")


class _Server(Struct):
    url: str
    partial: Path
    lookup: Lookup

    def fill(self, pointers: list[tuple[Path, Pointer]]) -> None:
        wanted = {pointer.sha256: pointer for _, pointer in pointers}
        places: dict[str, list[Path]] = {sha256: [] for sha256 in wanted}
        for path, pointer in pointers:
            places[pointer.sha256].append(path)
        left = iter(wanted.values())
        while batch := list(islice(left, _TOGETHER)):
            for pointer, action in self._offered(batch):
                got = self._fetched(pointer, action)
                for path in places[pointer.sha256]:
                    path.unlink()
                    shutil.copyfile(got, path)
                got.unlink()

    def _offered(self, batch: list[Pointer]) -> Iterator[tuple[Pointer, Mapping[str, Any]]]:
        """Ask the batch API of LFS, and yield the files that it has, each with its download request."""
        from mjcompose.sources.download import post_json

        address = f"{self.url.rstrip('/').removesuffix('.git')}.git/info/lfs/objects/batch"
        objects = [{"oid": each.sha256, "size": each.size} for each in batch]
        question = {"operation": "download", "transfers": ["basic"], "hash_algo": "sha256", "objects": objects}
        status, answer = post_json(address, question, "application/vnd.git-lfs+json", lookup=self.lookup)
        if status != 200:
            self.lookup.fetching.progress(f"`{address}` does not offer files of Git LFS: it answered {status}")
            return
        known = {each.sha256: each for each in batch}
        listed = answer.get("objects") if isinstance(answer, dict) else None
        if isinstance(listed, list):
            for each in listed:
                actions = each.get("actions") if isinstance(each, dict) else None
                action = actions.get("download") if isinstance(actions, dict) else None
                if isinstance(action, dict) and (pointer := known.pop(str(each.get("oid")), None)) is not None:
                    yield pointer, action
        for sha256 in known:
            self.lookup.fetching.progress(f"Git LFS of `{self.url}` does not have the file {sha256[:12]}…")

    def _fetched(self, pointer: Pointer, action: Mapping[str, Any]) -> Path:
        from mjcompose.sources.download import Version, download, forget

        href = action.get("href")
        headers = action.get("header")
        parts = take_apart(href) if isinstance(href, str) else None
        is_open = parts is not None and parts.scheme == "http" and self.url.startswith("http:")
        if parts is None or not (parts.scheme == "https" or (is_open and is_this_machine(parts.netloc))):
            message = f"Git LFS of `{self.url}` names `{hide(str(href))}`, which is not an https address"
            raise SourceError("source-fetch", message)
        own = {
            name: value
            for name, value in (headers.items() if isinstance(headers, dict) else ())
            if isinstance(value, str) and _HEADER.fullmatch(name) and _VALUE.fullmatch(value)
        }
        self.partial.mkdir(parents=True, exist_ok=True)
        partial = self.partial / f"{pointer.sha256}.part"
        download(parts.geturl(), partial, Version(), lookup=self.lookup, headers=own)
        got = partial.stat().st_size
        if got != pointer.size or sha256_of(partial) != pointer.sha256:
            forget(partial)
            message = f"Git LFS of `{self.url}` has other bytes than the commit pins"
            raise SourceError("source-changed", message, notes=(f"sha256 {pointer.sha256} is pinned",))
        partial.with_suffix(".version").unlink(missing_ok=True)
        return partial
