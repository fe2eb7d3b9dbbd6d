"""A new project works as it stands: its commands, its hooks and its GitHub action."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
DEFAULTS = {name: each["default"] for name, each in ACTION["inputs"].items()}


@pytest.fixture(scope="module")
def shell(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An environment in which `mjcompose` is this project's, and `gh` writes down what it is told."""
    tools = tmp_path_factory.mktemp("tools")
    scripts = {
        "mjcompose": f'exec "{sys.executable}" -m mjcompose "$@"',
        # asked for comments it gives the number in `gh.old`; what it is to write goes to `gh.log`
        "gh": f"""case "$*" in *--method*) printf '%s\\n' "$*" >> "{tools}/gh.log"; last="${{@: -1}}"
            cat "${{last#body=@}}" >> "{tools}/gh.log"; exit "${{GH_FAILS:-0}}";; *) cat "{tools}/gh.old" || true;; esac""",
    }
    for name, script in scripts.items():
        (tools / name).write_text(f"#!/bin/bash\n{script}\n", encoding="utf-8")
        (tools / name).chmod(0o755)
    known = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    for who in ("AUTHOR", "COMMITTER"):
        known |= {f"GIT_{who}_NAME": "a", f"GIT_{who}_EMAIL": "a@example.org"}
    path = f"{tools}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, **known, "PATH": path, "PYTHONPATH": str(ROOT), "TOOLS": str(tools)}


def sh(script: str, folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-eo", "pipefail", "-c", script],
        cwd=folder,
        env=environment,
        text=True,
        capture_output=True,
        timeout=300,
        check=False,
    )


@pytest.fixture
def project(tmp_path: Path, shell: dict[str, str]) -> Path:
    """A project in git, with a remote that is its own first state."""
    made = sh("mjcompose new --project 'my arms'", tmp_path, shell)
    assert made.returncode == 0, made.stderr
    folder = tmp_path / "my arms"
    commit = "git init --quiet -b main && git add -A && git commit --quiet -m first"
    clone = f"git clone --quiet --bare . '{tmp_path}/origin' && git remote add origin '{tmp_path}/origin'"
    assert sh(f"{commit} && {clone}", folder, shell).returncode == 0
    return folder


pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="the commands are of a POSIX shell"),
    pytest.mark.skipif(shutil.which("git") is None, reason="there is no git"),
]


@pytest.mark.slow
def test_the_commands_of_its_readme_run(project: Path, shell: dict[str, str]) -> None:
    (commands,) = re.findall(r"```sh\n(.*?)```", (project / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    ran = sh(commands.replace("pip install", ": pip install"), project, shell)
    assert ran.returncode == 0, ran.stderr
    assert (project / "build" / "my_arms.zip").is_file()
    assert "recipes/my_arms.yaml: ok, 1 check holds" in ran.stdout
    assert sh("git status --porcelain", project, shell).stdout == ""


@pytest.mark.slow
def test_its_hooks_have_nothing_to_say(project: Path, shell: dict[str, str]) -> None:
    (own,) = yaml.safe_load((project / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    for hook in [*own["hooks"], *yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))]:
        file = "models/pendulum/pendulum.xml" if "mjcf" in hook["id"] else "recipes/my_arms.yaml"
        assert re.search(hook["files"], file) and not re.search(hook["files"], f"a{Path(file).suffix}")
        ran = sh(f"{hook['entry']} {file}", project, shell)
        assert ran.returncode == 0, ran.stderr
    assert sh("git status --porcelain", project, shell).stdout == ""


def test_its_workflow_uses_inputs_that_the_action_has(project: Path) -> None:
    workflow = yaml.safe_load((project / ".github/workflows/models.yml").read_text(encoding="utf-8"))
    used = workflow["jobs"]["models"]["steps"][-1]
    assert used["with"].keys() <= ACTION["inputs"].keys()
    assert (project / used["uses"] / "action.yml").read_bytes() == (ROOT / "action.yml").read_bytes()
    requirement, mujoco = (project / "requirements.txt").read_text(encoding="utf-8").splitlines()
    assert requirement.startswith("mjcompose[menagerie]==") and mujoco.startswith("mujoco==")


def step(name: str, outputs: Mapping[str, str] = MappingProxyType({}), **given: str) -> tuple[str, dict[str, str]]:
    """The script of a step of the action, and its environment as GitHub would fill it in."""
    (found,) = [each for each in ACTION["runs"]["steps"] if each["name"] == name]
    context: dict[str, Any] = {f"inputs.{key}": value for key, value in {**DEFAULTS, **given}.items()}
    context |= {"github.base_ref": "main", "github.event.number": "7", "github.token": "t"}
    context |= outputs
    env = {
        key: re.sub(r"\$\{\{ (.*?) \}\}", lambda match: context[match[1]], value) for key, value in found["env"].items()
    }
    return found["run"], env


def test_the_action_checks_and_builds(project: Path, shell: dict[str, str]) -> None:
    for name in ("Check", "Build"):
        script, env = step(name, options="--locked")
        ran = sh(script, project, {**shell, **env})
        assert ran.returncode == 0, ran.stderr
    assert (project / "build" / "my_arms.zip").is_file()


@pytest.mark.slow
def test_the_action_builds_no_model_over_another(project: Path, shell: dict[str, str]) -> None:
    recipe = (project / "recipes" / "my_arms.yaml").read_text(encoding="utf-8")
    (project / "recipes" / "other.yaml").write_text(
        f"{recipe}  more: {{expect: {{attr: mass, range: [0, 9]}}}}\n", encoding="utf-8"
    )
    script, env = step("Build")
    ran = sh(script, project, {**shell, **env})
    assert ran.returncode == 1
    assert (
        "::error::two recipes make a model of one name, and one took the place of the other: build/my_arms.zip"
        in ran.stdout
    )


@pytest.mark.slow
def test_the_action_tells_what_is_wrong(project: Path, shell: dict[str, str]) -> None:
    recipe = project / "recipes" / "my_arms.yaml"
    recipe.write_text(recipe.read_text(encoding="utf-8").replace("pendulum/hinge", "pendulum/hing"), encoding="utf-8")
    script, env = step("Check")
    ran = sh(script, project, {**shell, **env})
    assert ran.returncode == 1 and ran.stdout.startswith("::error file=recipes/my_arms.yaml,line=")


@pytest.fixture
def diff(project: Path, shell: dict[str, str], tmp_path: Path) -> Callable[..., tuple[str, str, str]]:
    """Runs the step that compares: what it writes as a comment, in the summary, and as its output."""
    log = Path(shell["TOOLS"], "gh.log")
    old = Path(shell["TOOLS"], "gh.old")

    def diff(written: str = "", breaking: str = "false", **more: str) -> tuple[str, str, str]:
        script, env = step("Diff", breaking=breaking)
        for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY"):
            env[name] = str(tmp_path / name)
            (tmp_path / name).write_text("")
        log.write_text("")
        old.write_text(written)
        ran = sh(script, project, {**shell, **env, "GITHUB_REPOSITORY": "me/arms", **more})
        assert ran.returncode == 0, ran.stderr
        output = (tmp_path / "GITHUB_OUTPUT").read_text()
        outputs = dict(line.split("=", 1) for line in output.splitlines())
        known = {f"steps.diff.outputs.{key}": value for key, value in outputs.items()}
        for number in (1, 2, 3):
            uploaded = f"https://pages.example/{number}" if f"page{number}" in outputs else ""
            known[f"steps.page{number}.outputs.artifact-url"] = uploaded
        script, env = step("Comment", known)
        env["GITHUB_STEP_SUMMARY"] = str(tmp_path / "GITHUB_STEP_SUMMARY")
        said = sh(script, project, {**shell, **env, "GITHUB_REPOSITORY": "me/arms", **more})
        assert said.returncode == 0, said.stderr
        summary = (tmp_path / "GITHUB_STEP_SUMMARY").read_text(encoding="utf-8")
        return log.read_text(encoding="utf-8"), summary + said.stdout, output

    return diff


def change(project: Path) -> None:
    part = project / "models" / "pendulum" / "pendulum.xml"
    part.write_text(part.read_text(encoding="utf-8").replace('damping="0.1"', 'damping="0.3"'))


@pytest.mark.slow
def test_the_action_says_nothing_where_nothing_changes(diff: Callable[..., tuple[str, str, str]]) -> None:
    comment, summary, output = diff()
    assert (comment, summary) == ("", "") and output.startswith("changed=false\ncomment=")
    comment, _, _ = diff(written="99\n")
    assert comment.startswith("api --silent --method PATCH repos/me/arms/issues/comments/99 ")
    assert "no longer changes a model" in comment


@pytest.mark.slow
def test_the_action_comments_on_what_changes(project: Path, diff: Callable[..., tuple[str, str, str]]) -> None:
    change(project)
    recipes = project / "recipes"
    shutil.copy(recipes / "my_arms.yaml", recipes / "a new one.yaml")
    comment, summary, output = diff()
    assert "changed=true\n" in output
    assert comment.startswith("api --silent --method POST repos/me/arms/issues/7/comments --field body=@")
    assert "<!-- mjcompose -->\n## recipes/a new one.yaml\n\nThis recipe is new" in comment
    assert "damping" in comment and "0.3" in comment and summary in comment
    link = "[Look at both models in the browser](https://pages.example/1)"
    assert f"## recipes/my_arms.yaml\n\n{link}\n\n" in comment
    (page,) = re.findall(r"page\d=(.*)", output)
    assert page.endswith("/recipes_my_arms.html") and "<!doctype html>" in Path(page).read_text("utf-8")
    assert "--method PATCH repos/me/arms/issues/comments/99 " in diff(written="98\n99\n")[0]


@pytest.mark.slow
def test_the_action_tells_recipes_that_are_gone(
    project: Path, shell: dict[str, str], diff: Callable[..., tuple[str, str, str]]
) -> None:
    more = "mkdir recipes/deep && cp recipes/my_arms.yaml 'recipes/old one.yaml' && cp README.md recipes/deep/x.yaml"
    push = "git add -A && git commit -qm more && git push -q origin main"
    assert sh(f"{more} && {push} && git rm -q -r 'recipes/old one.yaml' recipes/deep", project, shell).returncode == 0
    comment, _, output = diff()
    assert "## recipes/old one.yaml\n\nThis recipe is gone." in comment and "deep" not in comment
    assert "changed=true\n" in output


@pytest.mark.slow
def test_of_a_fork_no_comment_can_be_written(project: Path, diff: Callable[..., tuple[str, str, str]]) -> None:
    change(project)
    _, said, output = diff(GH_FAILS="1")
    assert "damping" in said and "::warning::no comment could be written" in said
    assert "changed=true\n" in output


@pytest.mark.slow
def test_a_major_change_fails_a_pull_request(
    project: Path, shell: dict[str, str], diff: Callable[..., tuple[str, str, str]]
) -> None:
    part = project / "models" / "pendulum" / "pendulum.xml"
    before = part.read_text(encoding="utf-8")
    change(project)
    _, _, output = diff(breaking="true")
    assert "major=\n" in output  # a minor change
    part.write_text(before.replace("-90 90", "-80 90"), encoding="utf-8")
    comment, _, output = diff(breaking="true")
    assert "major=recipes/my_arms.yaml\n" in output and "range" in comment
    (last,) = [each for each in ACTION["runs"]["steps"] if each["name"] == "Breaking"]
    assert last is ACTION["runs"]["steps"][-1]
    assert last["if"] == "inputs.breaking == 'true' && steps.diff.outputs.major"
    script, env = step("Breaking", {"steps.diff.outputs.major": "recipes/my_arms.yaml"}, breaking="true")
    ran = sh(script, project, {**shell, **env})
    assert ran.returncode == 1 and ran.stdout.startswith("::error::") and "recipes/my_arms.yaml" in ran.stdout
    assert "major=recipes/my_arms.yaml\n" in diff(breaking="comment")[2]
    assert "major=\n" in diff()[2]


def test_nothing_is_overwritten(project: Path, shell: dict[str, str]) -> None:
    (project / "requirements.txt").write_text("numpy\n")
    (project / "README.md").unlink()
    (project / "README.md").symlink_to("nowhere")
    ran = sh("mjcompose new --project . && git diff --name-only", project, shell)
    assert ran.returncode == 0, ran.stderr
    lines = ran.stdout.splitlines()
    assert lines[-2:] == ["README.md", "requirements.txt"] and lines[-3].startswith("wrote 0 files to .; ")
    assert "kept recipes/my_arms.lock" in lines and "kept README.md" in lines and "kept .gitignore" in lines
    [told] = [line for line in lines if line.startswith("kept requirements.txt; the project's own would have")]
    assert "`mujoco==" in told and (project / "requirements.txt").read_text() == "numpy\n"


@pytest.mark.slow
def test_a_fresh_clone_keeps_what_it_has(tmp_path: Path, shell: dict[str, str]) -> None:
    has = {"README.md": b"# arms\r\n", "LICENSE": b"MIT \xff", ".gitignore": b"build/\n"}
    for name, content in has.items():
        (tmp_path / name).write_bytes(content)
    ran = sh("git init -q . && mjcompose new --project . && mjcompose check --locked recipes/*.yaml", tmp_path, shell)
    assert ran.returncode == 0, ran.stderr
    assert {name: (tmp_path / name).read_bytes() for name in has} == has
    told = ran.stdout.splitlines()
    assert told[0] == "kept .gitignore; the project's own would have: `/build/`, `.venv/`, `MUJOCO_LOG.TXT`"
    assert told[1] == "kept README.md" and told[2].startswith("wrote 9 files to .; build its model with: ")
    assert (tmp_path / ".github" / "workflows" / "models.yml").is_file()


@pytest.mark.parametrize(
    ("path", "content"),
    [
        ("recipes/robots.yaml", "recipe: 1\n"),
        ("recipes/robots.lock", "{}"),
        ("models/pendulum/pendulum.xml", "<mujoco/>"),
        ("recipes", "a file"),
        (".gitignore/x", "below a folder"),
    ],
)
def test_what_stands_in_the_way_of_the_project_is_an_error(
    tmp_path: Path, shell: dict[str, str], path: str, content: str
) -> None:
    folder = tmp_path / "robots"
    (folder / path).parent.mkdir(parents=True)
    (folder / path).write_text(content)
    ran = sh("mjcompose new --project robots", tmp_path, shell)
    assert ran.returncode == 1 and "error[output-unwritable]" in ran.stderr
    assert f"`robots/{path.removesuffix('/x')}` exists already" in ran.stderr
    assert [each for each in folder.rglob("*") if each.is_file()] == [folder / path]
    assert list(tmp_path.iterdir()) in ([folder], [folder, tmp_path / "tools"], [tmp_path / "tools", folder])


def test_a_folder_that_has_other_things_keeps_them(tmp_path: Path, shell: dict[str, str]) -> None:
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "own.xml").write_text("<mujoco/>")
    assert sh("mjcompose new --project .", tmp_path, shell).returncode == 0
    assert (tmp_path / "models" / "own.xml").read_text() == "<mujoco/>"
    assert (tmp_path / "README.md").is_file()


@pytest.mark.slow
def test_any_name_of_a_project(tmp_path: Path, shell: dict[str, str]) -> None:
    for name, model in {"MODEL of VERSION": "MODEL_of_VERSION", "äöü: x": "äöü_x"}.items():
        ran = sh(
            f"mjcompose new --project '{name}' && cd '{name}' && mjcompose check --locked recipes/*.yaml",
            tmp_path,
            shell,
        )
        assert ran.returncode == 0, ran.stderr
        assert (tmp_path / name / "README.md").read_text(encoding="utf-8").startswith(f"# {name}\n")
        assert (tmp_path / name / "recipes" / f"{model}.lock").is_file()


def test_it_must_be_told_where(tmp_path: Path, shell: dict[str, str]) -> None:
    ran = sh("mjcompose new --project", tmp_path, shell)
    assert ran.returncode == 2 and "mjcompose new --project robots" in ran.stderr
