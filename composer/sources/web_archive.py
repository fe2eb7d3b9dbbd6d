"""An archive on the web: asked for, fetched, and kept in the store by its sha256."""

from __future__ import annotations

from collections.abc import Mapping

from composer.dataclass import dataclass
from composer.sources.digest import differences, sha256_of
from composer.sources.error import SourceError
from composer.sources.fetched import not_at_hand, source_in, unlocked
from composer.sources.fetching import Fetching, Lookup
from composer.sources.origin import Origin
from composer.sources.reference import Reference
from composer.sources.source import Source
from composer.sources.store import Entry, Store, name_of


def resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the file in an archive. Raises SourceError.

    Archives that the lock or the reference pins come from the store, or else are fetched. For unpinned ones the
    server is asked again, and they are fetched if the server says that they have changed.
    """
    id, known = reference.id, lookup.fetching.origins
    if id not in known:
        store = Store.of(lookup.environment)
        entry = _Archive(
            reference,
            id,
            store,
            environment=lookup.environment,
            fetching=lookup.fetching,
            is_confined=lookup.is_confined,
        ).entry()
        known[id] = Origin(id, reference.kind, entry.content, sha256=entry.key, stored=entry.files)
    return source_in(known[id], reference)


@dataclass(frozen=True, slots=True)
class _Archive:
    reference: Reference
    id: str
    store: Store
    environment: Mapping[str, str]
    fetching: Fetching
    is_confined: bool

    def entry(self) -> Entry:
        written = self.reference.revision
        locked = self.fetching.pin(self.id)
        if written and locked and written != locked:
            raise SourceError(
                "lock-stale",
                f"`{self.reference.text}` says another sha256 than the lock, which has {locked[:12]}…",
                help=f"run `mjcompose update {self.fetching.recipe} {self.id}`",
            )
        if locked is None and self.fetching.locked:
            raise unlocked(self.reference, self.fetching)
        wanted = written or locked
        seen = self.store.recall(self.id)
        at_hand = wanted or seen.get("sha256") or ""
        entry = self.store.get("archive", at_hand) if at_hand else None
        if entry is not None and (wanted or self.fetching.offline):
            return entry
        if self.fetching.offline:
            raise not_at_hand(self.reference)
        with self.store.lock(name_of(self.id), self.fetching.progress), self.store.usable():
            # Another process may have fetched it in the meantime.
            if wanted and (entry := self.store.get("archive", wanted)) is not None:
                return entry
            return self._fetched(wanted, entry, seen)

    def _fetched(self, wanted: str | None, had: Entry | None, seen: Mapping[str, str]) -> Entry:
        # Slow to import, and only needed for downloads.
        from composer.sources.download import Version, download, forget
        from composer.sources.unpack import Unsafe, unpack

        partial = self.store.folder / "partial" / f"{name_of(self.id)}.part"
        partial.parent.mkdir(parents=True, exist_ok=True)
        url = self.reference.name
        self.fetching.progress(f"fetching {url}")
        known = Version(seen.get("etag", ""), seen.get("modified", "")) if had is not None else Version()
        version = download(
            url, partial, environment=self.environment, progress=self.fetching.progress, known=known,
            is_confined=self.is_confined,
        )  # fmt: skip
        if version is None:
            assert had is not None, "only what is at hand is asked about"
            return had
        try:
            sha256 = sha256_of(partial)
            entry = self.store.get("archive", sha256)
            if entry is None:
                with self.store.lock(sha256, self.fetching.progress):
                    entry = self.store.add(
                        "archive", sha256, self.id, lambda target: unpack(partial, target), {}
                    )
        except Unsafe as fault:
            forget(partial)
            if wanted and sha256 != wanted:
                raise self._changed(wanted, sha256, (f"what is there now is refused: {fault}",)) from None
            raise SourceError(
                "archive-refused", f"the archive `{url}` is refused: {fault}", help=fault.help
            ) from None
        forget(partial)
        if wanted and sha256 != wanted:
            before = self.fetching.known_files(self.id)
            there = {name: digest for name, digest in entry.files.items() if name in before}
            raise self._changed(wanted, sha256, differences(before, there))
        self.store.remember(self.id, {"sha256": sha256, "etag": version.etag, "modified": version.modified})
        return entry

    def _changed(self, wanted: str, sha256: str, changes: tuple[str, ...]) -> SourceError:
        pinned = "the reference" if self.reference.revision else "the lock"
        return SourceError(
            "source-changed",
            f"the archive `{self.reference.name}` is not the one that {pinned} pins",
            notes=(f"sha256 {wanted} is pinned, {sha256} is there", *changes[:8]),
            help=(
                "write the new sha256 if that is the archive that is wanted"
                if self.reference.revision
                else f"see what it holds now, then run `mjcompose update {self.fetching.recipe} {self.id}`"
            ),
        )
