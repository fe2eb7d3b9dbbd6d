from __future__ import annotations

import json

import pytest
from cli.shell import REPOSITORY, run


@pytest.mark.parametrize("arguments", [[], ["recipe"], ["manifest"]])
def test_schema_is_that_of_the_repository(arguments: list[str]) -> None:
    file = REPOSITORY / "schemas" / f"{(arguments or ['recipe'])[0]}.schema.json"
    if not file.exists():
        pytest.skip(f"{file.name} does not exist")
    result = run("schema", *arguments)
    assert result.exit_code == 0 and result.stderr == ""
    assert result.stdout == file.read_text(encoding="utf-8")
    assert json.loads(result.stdout)["$schema"].startswith("https://json-schema.org/")


def test_usage() -> None:
    assert run("schema", "model").exit_code == 2
