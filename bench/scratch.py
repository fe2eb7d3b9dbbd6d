"""The folder that benchmarks run in, so that nothing is left in the one where they were started."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import chdir, contextmanager


@contextmanager
def in_scratch_folder() -> Iterator[None]:
    """Run in a new folder, which is removed at the end. MuJoCo writes its log there, too."""
    with tempfile.TemporaryDirectory(prefix="mjcompose-bench-") as scratch, chdir(scratch):
        yield
