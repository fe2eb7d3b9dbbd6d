"""The options of the build cache, and the cache of the current command."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from composer.cache.cache import Cache
    from composer.context import Context


def caching_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--no-cache` and `--why`; the command gets them as `no_cache` and `why`."""
    command = click.option(
        "--why", is_flag=True, help="Print why a model was built, or why it was taken from the cache."
    )(command)
    return no_cache_option(command)


def no_cache_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--no-cache`; the command gets it as `no_cache`."""
    return click.option(
        "--no-cache", is_flag=True, help="Do not read models from the build cache or store them in it."
    )(command)


@contextlib.contextmanager
def caching(context: Context, no_cache: bool) -> Iterator[Cache | None]:
    """Yield the user's build cache inside the block, or None if it is disabled or unusable."""
    cache = None if no_cache else _cache(context)
    try:
        yield cache
    finally:
        if cache is not None:
            cache.close()


def _cache(context: Context) -> Cache | None:
    from composer.cache.cache import opened_cache
    from composer.sources.error import SourceError
    from composer.sources.store import Store

    try:
        return opened_cache(Store.of(context.environment), context.sink)
    except SourceError as error:
        context.sink.warning(error.code, error.message, help=error.help)
        return None
