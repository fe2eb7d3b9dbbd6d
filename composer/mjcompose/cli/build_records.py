"""`build --depfile` writes the inputs of a build for Make, Ninja and CMake, `--sbom` as CycloneDX 1.6."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from mjcompose.base import __version__
from mjcompose.bundle.bundle import MANIFEST, MODEL, OutputError, to_text
from mjcompose.bundle.manifest import Input, Manifest, from_json
from mjcompose.bundle.read import read
from mjcompose.bundle.staging import staged_file
from mjcompose.sources.context import Context


def render_depfile(outputs: Iterable[str], inputs: Iterable[str]) -> str:
    r"""Return a rule, and an empty rule for each input, so Make continues if the input is gone.

    An input with `%` has no rule, because it would be a pattern.

    Raises OutputError for a name with a line break, which the syntax cannot have.

    >>> print(render_depfile(["out/model.zip"], ["/a b/c#1.xml", "/$x.yaml"]), end="")
    out/model.zip: \
      /a\ b/c\#1.xml \
      /$$x.yaml
    /a\ b/c\#1.xml:
    /$$x.yaml:
    """
    targets = [_escaped(each) for each in outputs]
    needed = [_escaped(each) for each in inputs]
    rule = " \\\n  ".join([f"{' '.join(targets)}:", *needed])
    return "".join(f"{line}\n" for line in (rule, *(f"{each}:" for each in needed if "%" not in each)))


def _escaped(path: str) -> str:
    if "\n" in path or "\r" in path:
        raise OutputError("output-kind", f"`{path}` has a line break, which a depfile cannot have", "rename it")
    path = path.replace(os.sep, "/") if os.sep != "/" else path
    return re.sub(r"(\\*)([ \t])", r"\1\1\\\2", path).replace("#", "\\#").replace("$", "$$")


def write_depfile(file: Path, outputs: Iterable[str], inputs: Iterable[Path], context: Context) -> None:
    """Write the file completely. Report an error to the context. A folder is its model."""

    def named(output: str) -> str:
        if not output.endswith("/"):
            return output
        return output + (MODEL if os.path.isfile(context.folder / output / MODEL) else MANIFEST)

    needed = sorted({os.path.abspath(context.folder / each) for each in inputs})
    with context.sink:
        text = render_depfile(map(named, outputs), needed)
        with staged_file(context.folder / file, "--depfile") as stage:
            stage.write_bytes(os.fsencode(text))


def render_sbom(manifest: Manifest, sha256: str) -> bytes:
    """Return the parts of a bundle with this hash; equal bundles have equal texts, without times and random numbers."""
    components = [_component(each, f"part-{number}") for number, each in enumerate(manifest.inputs)]
    model = {"type": "data", "bom-ref": "model", "name": manifest.name, "version": sha256}
    tool = {"type": "application", "name": "mjcompose", "version": __version__}
    return to_text(
        {
            "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
            "bomFormat": "CycloneDX",
            "specVersion": "1.6",
            "version": 1,
            "metadata": {"tools": {"components": [tool]}, "component": model},
            "components": components,
            "dependencies": [{"ref": "model", "dependsOn": [each["bom-ref"] for each in components]}],
        }
    )


def _component(part: Input, ref: str) -> dict[str, Any]:
    origin = part.origin
    pinned = origin is not None and (origin.commit or origin.sha256)
    properties = {"kind": part.kind, "reference": part.reference, "package": part.package}
    component: dict[str, Any] = {"type": "file", "bom-ref": ref, "name": part.path}
    version = part.version or pinned
    if version:
        component["version"] = version
    component["hashes"] = [{"alg": "SHA-256", "content": part.sha256}]
    if part.license is not None:
        component["licenses"] = [{"expression": part.license}]
    component["properties"] = [
        {"name": f"mjcompose:{name}", "value": value} for name, value in properties.items() if value is not None
    ]
    return component


def write_sbom(file: Path, bundle: str, context: Context) -> None:
    with context.sink:
        built = read(context.folder / bundle)
        text = render_sbom(from_json(built.files[MANIFEST]), built.sha256)
        with staged_file(context.folder / file, "--sbom") as stage:
            stage.write_bytes(text)
