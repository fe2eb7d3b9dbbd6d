"""`--shard I/N`: one of N parts of the cells, so that N runs build all of them, each once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import TypeVar

from composer.dataclass import dataclass

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Shard:
    """The shard with this `number`, from 1, of `count` shards."""

    number: int
    count: int

    def of(self, items: Sequence[Item]) -> list[Item]:
        """Return every `count`-th item, because neighbours often take equally long.

        >>> Shard(1, 3).of("abcdefg"), Shard(3, 3).of("abcdefg"), Shard(3, 3).of("a")
        (['a', 'd', 'g'], ['c', 'f'], [])
        """
        return list(items[self.number - 1 :: self.count])

    def file(self, name: str) -> str:
        """Return the name of a file that each shard has separately.

        >>> Shard(1, 3).file("samples.csv")
        'samples-1-of-3.csv'
        """
        path = PurePosixPath(name)
        return f"{path.stem}-{self.number}-of-{self.count}{path.suffix}"
