"""`build --sbom`: all parts of a bundle as CycloneDX 1.6, for programs that look for licenses and known files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mjcompose.base.version import __version__
from mjcompose.build.bundle.bundle import MANIFEST, OutputError, to_text
from mjcompose.build.bundle.manifest import Input, Manifest, from_json
from mjcompose.build.bundle.read import ReadError, read
from mjcompose.sources.context import Context


def render(manifest: Manifest, sha256: str) -> bytes:
    """Return the parts of a bundle with this hash; equal bundles have equal texts, without times and random numbers."""
    components = [_component(each, f"part-{number}") for number, each in enumerate(manifest.inputs)]
    model = {"type": "data", "bom-ref": "model", "name": manifest.name, "version": sha256}
    tool = {"type": "application", "name": "mjcompose", "version": __version__}
    return to_text({
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"tools": {"components": [tool]}, "component": model},
        "components": components,
        "dependencies": [{"ref": "model", "dependsOn": [each["bom-ref"] for each in components]}],
    })  # fmt: skip


def _component(part: Input, ref: str) -> dict[str, Any]:
    origin = part.origin
    pinned = origin is not None and (origin.commit or origin.sha256)
    properties = {"kind": part.kind, "reference": part.reference, "package": part.package}
    component: dict[str, Any] = {"type": "file", "bom-ref": ref, "name": part.path}
    if version := part.version or pinned:
        component["version"] = version
    component["hashes"] = [{"alg": "SHA-256", "content": part.sha256}]
    if part.license is not None:
        component["licenses"] = [{"expression": part.license}]
    component["properties"] = [
        {"name": f"mjcompose:{name}", "value": value} for name, value in properties.items() if value is not None
    ]
    return component


def write(file: Path, bundle: str, context: Context) -> None:
    """Write the parts of the bundle at a path; an error goes to the context's sink."""
    from mjcompose.build.bundle.staging import staged_file

    try:
        built = read(context.folder / bundle)
        text = render(from_json(built.files[MANIFEST]), built.sha256)
        with staged_file(context.folder / file, "--sbom") as stage:
            stage.write_bytes(text)
    except (OutputError, ReadError) as error:
        context.sink.add(error.diagnostic)
