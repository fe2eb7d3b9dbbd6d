"""`build --depfile`: the inputs of a build, in the syntax of Make that Ninja and CMake read too."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from mjcompose.build.bundle.bundle import MANIFEST, MODEL, OutputError
from mjcompose.sources.context import Context


def render(outputs: Iterable[str], inputs: Iterable[str]) -> str:
    r"""Return a rule, and an empty rule for each input, by which Make goes on if the input is gone.

    An input with `%` has none, which would be a pattern.

    Raises OutputError for a name with a line break, which the syntax cannot have.

    >>> print(render(["out/model.zip"], ["/a b/c#1.xml", "/$x.yaml"]), end="")
    out/model.zip: \
      /a\ b/c\#1.xml \
      /$$x.yaml
    /a\ b/c\#1.xml:
    /$$x.yaml:
    """
    targets, needed = [_escaped(each) for each in outputs], [_escaped(each) for each in inputs]
    rule = " \\\n  ".join([f"{' '.join(targets)}:", *needed])
    return "".join(f"{line}\n" for line in (rule, *(f"{each}:" for each in needed if "%" not in each)))


def _escaped(path: str) -> str:
    if "\n" in path or "\r" in path:
        raise OutputError("output-kind", f"`{path}` has a line break, which a depfile cannot have", "rename it")
    path = path.replace(os.sep, "/") if os.sep != "/" else path
    return re.sub(r"(\\*)([ \t])", r"\1\1\\\2", path).replace("#", "\\#").replace("$", "$$")


def write(file: Path, outputs: Iterable[str], inputs: Iterable[Path], context: Context) -> None:
    """Write the file completely; an error goes to the context's sink. A folder is its model."""
    from mjcompose.build.bundle.staging import staged_file

    def named(output: str) -> str:
        if not output.endswith("/"):
            return output
        return output + (MODEL if os.path.isfile(context.folder / output / MODEL) else MANIFEST)

    needed = sorted({os.path.abspath(context.folder / each) for each in inputs})
    try:
        text = render(map(named, outputs), needed)
        with staged_file(context.folder / file, "--depfile") as stage:
            stage.write_bytes(os.fsencode(text))
    except OutputError as error:
        context.sink.add(error.diagnostic)
