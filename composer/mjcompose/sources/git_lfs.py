"""Files that Git LFS keeps outside a repository: found on this machine or fetched, and checked by their sha256."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import hide
from mjcompose.base.files import read_regular
from mjcompose.sources.blobs import files_below, sha256_of
from mjcompose.sources.fetching import Lookup
from mjcompose.sources.reference import SourceError, is_this_machine, take_apart
from mjcompose.sources.web_archive import Unsafe, check

_POINTER = re.compile(
    rb"version https://git-lfs\.github\.com/spec/v1\n(?:ext-[^\n]*\n)*oid sha256:([0-9a-f]{64})\nsize (\d{1,18})\n"
)
_LARGEST = 1024
"""Pointers of Git LFS are smaller, in bytes."""
_TOGETHER = 100
_HEADER, _VALUE = re.compile(r"[A-Za-z0-9-]+"), re.compile(r"[\x20-\x7e]*")


@dataclass(frozen=True, slots=True)
class Pointer:
    """The sha256 and the size of a file that Git LFS keeps."""

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
    `partial` is the folder for downloads. Raises SourceError for a network that fails, for other bytes and for files
    beyond the limits, and OSError.
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


@dataclass(frozen=True, slots=True)
class _Server:
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
        """Ask the batch API of LFS, and yield the files that it has, each with how to download it."""
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
        for each in listed if isinstance(listed, list) else ():
            actions = each.get("actions") if isinstance(each, dict) else None
            action = actions.get("download") if isinstance(actions, dict) else None
            if isinstance(action, dict) and (pointer := known.pop(str(each.get("oid")), None)) is not None:
                yield pointer, action
        for sha256 in known:
            self.lookup.fetching.progress(f"Git LFS of `{self.url}` does not have the file {sha256[:12]}…")

    def _fetched(self, pointer: Pointer, action: Mapping[str, Any]) -> Path:
        from mjcompose.sources.download import download_object, forget

        href, headers = action.get("href"), action.get("header")
        parts = take_apart(href) if isinstance(href, str) else None
        is_open = parts is not None and parts.scheme == "http" and self.url.startswith("http:")
        if parts is None or not (parts.scheme == "https" or (is_open and is_this_machine(parts.netloc))):
            message = f"Git LFS of `{self.url}` names `{hide(str(href))}`, which is not an https address"
            raise SourceError("source-fetch", message)
        own = {
            name: value for name, value in (headers.items() if isinstance(headers, dict) else ())
            if isinstance(value, str) and _HEADER.fullmatch(name) and _VALUE.fullmatch(value)
        }  # fmt: skip
        self.partial.mkdir(parents=True, exist_ok=True)
        partial = self.partial / f"{pointer.sha256}.part"
        download_object(parts.geturl(), partial, own, lookup=self.lookup)
        got = partial.stat().st_size
        if got != pointer.size or sha256_of(partial) != pointer.sha256:
            forget(partial)
            message = f"Git LFS of `{self.url}` has other bytes than the commit pins"
            raise SourceError("source-changed", message, notes=(f"sha256 {pointer.sha256} is pinned",))
        partial.with_suffix(".version").unlink(missing_ok=True)
        return partial
