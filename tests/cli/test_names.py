from __future__ import annotations

import json
from pathlib import Path

from cli.shell import run


def test_the_names_of_a_recipe_a_bundle_and_a_model(folder: Path) -> None:
    assert run("build", "cell.yaml", "-o", "cell/").exit_code == 0
    module = run("names", "cell.yaml", "--python")
    assert module.exit_code == 0 and module.stderr == "" and "SHOULDER = 0" in module.stdout
    assert run("names", "cell", "--python").stdout == module.stdout
    result = run("names", "cell.yaml", "--cpp", "-o", "made/cell.hpp")
    assert result.stdout == "wrote made/cell.hpp\n"
    assert "inline constexpr int shoulder = 0;" in (folder / "made/cell.hpp").read_text()
    assert [each["name"] for each in json.loads(run("names", "models/arm.xml", "--json").stdout)["joints"]] == [
        "shoulder"
    ]


def test_wrong_commands(folder: Path) -> None:
    for arguments, code, said in (
        (["cell.yaml"], 2, "one of --python, --cpp, --json and --lerobot"),
        (["cell.yaml", "--python", "--cpp"], 2, "one of --python, --cpp, --json and --lerobot"),
        (["nothing.yaml", "--json"], 2, "does not exist"),
        (["models/arm.xml", "--json", "--pick", "a"], 2, "has no cells"),
        (["cell.yaml", "--json", "-o", "cell.yaml"], 1, "cell.yaml"),
    ):
        before = (folder / "cell.yaml").read_bytes()
        result = run("names", *arguments)
        assert result.exit_code == code and said in result.stderr, arguments
        assert (folder / "cell.yaml").read_bytes() == before
