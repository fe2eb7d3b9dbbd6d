"""`build --sbom`: the parts of a model as CycloneDX."""

from __future__ import annotations

import hashlib
import importlib.util
import json
from pathlib import Path
from typing import Any

import pytest
from cli.shell import run


def built(out: str, *words: str) -> dict[str, Any]:
    result = run("build", "cell.yaml", "-o", out, "--sbom", "o.cdx.json", *words)
    assert result.exit_code == 0, result.stderr
    found: dict[str, Any] = json.loads(Path("o.cdx.json").read_text())
    return found


def test_every_part_is_in_it_whether_built_or_known(folder: Path) -> None:
    first = built("o.zip")
    assert first == built("o.zip") == built("o/")
    assert (first["bomFormat"], first["specVersion"], first["metadata"]["component"]["name"]) == (
        "CycloneDX",
        "1.6",
        "cell",
    )
    parts = {each["name"]: each for each in first["components"]}
    for name in ("models/arm.xml", "models/tool.xml"):
        assert parts[name]["hashes"] == [
            {"alg": "SHA-256", "content": hashlib.sha256(Path(name).read_bytes()).hexdigest()}
        ]
        assert {"name": "mjcompose:kind", "value": "path"} in parts[name]["properties"]
    assert first["dependencies"] == [{"ref": "model", "dependsOn": [each["bom-ref"] for each in first["components"]]}]


def test_the_license_is_an_expression(folder: Path) -> None:
    arm = Path("models/arm.xml")
    arm.write_text(arm.read_text().replace("<mujoco", "<!-- SPDX-License-Identifier: MIT -->\n<mujoco", 1))
    (part,) = [each for each in built("o.zip")["components"] if each["name"] == "models/arm.xml"]
    assert part["licenses"] == [{"expression": "MIT"}]


@pytest.mark.parametrize("out", ["-", "o.xml", "o.mjb", "s3://lab/o.zip"])
def test_what_has_no_manifest_here(folder: Path, out: str) -> None:
    result = run("build", "cell.yaml", "-o", out, "--sbom", "o.cdx.json")
    assert result.exit_code == 2 and "--sbom is for one model" in result.stderr


def test_it_cannot_replace_an_input(folder: Path) -> None:
    before = Path("models/arm.xml").read_bytes()
    assert run("build", "cell.yaml", "-o", "o.zip", "--sbom", "models/arm.xml").exit_code == 1
    assert Path("models/arm.xml").read_bytes() == before


def test_it_fits_the_schema(folder: Path) -> None:
    package = importlib.util.find_spec("cyclonedx")
    if package is None or package.origin is None:
        pytest.skip("the package `cyclonedx-python-lib` has the schema")
    referencing = pytest.importorskip("referencing")
    jsonschema = pytest.importorskip("jsonschema")
    schemas = [json.loads(each.read_text()) for each in Path(package.origin).parent.glob("schema/_res/*.schema.json")]
    registry = referencing.Registry().with_resources(
        (each["$id"], referencing.Resource.from_contents(each)) for each in schemas
    )
    (schema,) = [each for each in schemas if each["$id"].endswith("bom-1.6.schema.json")]
    jsonschema.Draft7Validator(schema, registry=registry).validate(built("o.zip"))
