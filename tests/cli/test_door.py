"""What a recipe, a model or a bundle of a stranger cannot do: read this machine. Each case of it did once."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from cli.shell import COVER, REPOSITORY, environment, run

SECRET = "SECRET"
ARM = (
    '<mujoco model="arm"><asset><mesh name="k" file="k.obj"/></asset>'
    '<worldbody><body name="b"><geom type="mesh" mesh="k"/></body></worldbody></mujoco>'
)
BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


def hostile(secret: Path) -> dict[str, str]:
    """The files of a repository that tries to read the folder `secret`."""
    up = "../" * 40 + str(secret)[1:]
    robot = f'<robot name="u">{{}}<link name="a">{MESH}</link></robot>'
    return {
        "edit.yaml": f"recipe: 1\nbase: ./arm.xml\nedit:\n  - {{select: {{mesh: k}}, set: {{file: {secret}/s.obj}}}}\n",
        "edit_up.yaml": f"recipe: 1\nbase: ./arm.xml\nedit:\n  - {{select: {{mesh: k}}, set: {{file: {up}/s.obj}}}}\n",
        "part.yaml": "recipe: 1\nattach:\n  k:\n    model: ./arm.xml\n    edit:\n"
        f"      - {{select: {{mesh: k}}, set: {{file: {secret}/s.obj}}}}\n",
        "texture.yaml": f"recipe: 1\nasset: {{texture: {{t: {{type: 2d, file: {secret}/s.png}}}}}}\n",
        "hfield.yaml": f"recipe: 1\nasset: {{hfield: {{h: {{file: {secret}/s.png, size: [1, 1, 1, 1]}}}}}}\n",
        "model.yaml": f"recipe: 1\nasset: {{model: {{m: {{file: {secret}/sub.xml}}}}}}\n",
        "flexcomp.yaml": 'recipe: 1\nadd:\n  - to: world\n    xml: \'<flexcomp name="f" type="mesh" dim="2"'
        f' file="{secret}/s.obj"/>\'\n',
        "parameter.yaml": f"recipe: 1\nparams: {{f: {secret}/s.obj}}\nasset: {{mesh: {{m: {{file: '${{f}}'}}}}}}\n",
        "absolute.yaml": f"recipe: 1\nbase: {secret}/sub.xml\n",
        "extends.yaml": f"recipe: 1\nextends: {secret}/own.yaml\n",
        "packages.yaml": f"recipe: 1\nbase: {{model: ./package.urdf, packages: {{secret: {secret}}}}}\n",
        "trust.yaml": f"recipe: 1\nbase: ./mesh.xml\ntrust: {{files: [{secret}], references: [{secret}]}}\n",
        "git_file.yaml": f"recipe: 1\nbase: 'git+file://{secret}/repository@main#m.xml'\n",
        "loopback.yaml": "recipe: 1\nbase: 'http://localhost:9/a.zip#x.xml'\n",
        "loopback_by_number.yaml": "recipe: 1\nbase: 'https://2130706433/a.zip#x.xml'\n",
        "loopback_in_octal.yaml": "recipe: 1\nbase: 'https://0177.0.0.1/a.zip#x.xml'\n",
        "loopback_translated.yaml": "recipe: 1\nbase: 'git+https://[64:ff9b::7f00:1]/a@main#x.xml'\n",
        "loopback_of_6to4.yaml": "recipe: 1\nbase: 'git+ssh://git@[2002:7f00:1::]/a@main#x.xml'\n",
        "loopback_as_login.yaml": "recipe: 1\nbase: 'https://127.0.0.1\\@example.org/a.zip#x.xml'\n",
        "private.yaml": "recipe: 1\nbase: 'https://10.0.0.1/a.zip#x.xml'\n",
        "private_git.yaml": "recipe: 1\nbase: 'git+ssh://git@192.168.1.1/a@main#x.xml'\n",
        "package_of_python.yaml": "recipe: 1\nbase: package:numpy/x.xml\n",
        "mesh.xml": ARM.replace("k.obj", f"{secret}/s.obj"),
        "mesh_up.xml": ARM.replace("k.obj", f"{up}/s.obj"),
        "meshdir.xml": ARM.replace("<asset>", f'<compiler meshdir="{secret}"/><asset>').replace("k.obj", "s.obj"),
        "pipe.xml": ARM.replace("k.obj", f"{secret}/pipe.obj"),
        "include.xml": f'<mujoco><include file="{secret}/include.xml"/></mujoco>',
        "attached.xml": f'<mujoco><asset><model name="m" file="{secret}/sub.xml"/></asset></mujoco>',
        "counted.xml": f'<mujoco><asset><model name="m" file="{secret}/sub.xml"/></asset>'
        '<worldbody><attach model="m" prefix="a"/></worldbody></mujoco>',
        "inner.xml": '<mujoco><asset><model name="m" file="mesh.xml"/></asset></mujoco>',
        "skin.xml": f'<mujoco><asset><skin name="s" file="{secret}/s.skn"/></asset></mujoco>',
        "meshdir.urdf": robot.format(f'<mujoco><compiler meshdir="{secret}"/></mujoco>', "s.obj"),
        "include.urdf": f'<robot name="u"><mujoco><include file="{secret}/include.xml"/></mujoco><link name="a">{BOX}</link></robot>',
        "mesh.urdf": robot.format("", f"{secret}/s.obj"),
        "package.urdf": robot.format("", "package://secret/s.obj"),
    }


NOT_OUTSIDE = {
    "dtd.xml": "xml-syntax",
    "entity.xml": "xml-syntax",
    "two_models.xml": "xml-syntax",
    "encoding.xml": "xml-syntax",
    "package.urdf": "asset-missing",
    "link.xml": "asset-missing",
    "loopback_as_login.yaml": "source-kind",
}
"""What is an error for another reason: the code of each."""


def unlike_xml(secret: Path) -> dict[str, str]:
    """Models that a reader of XML reads otherwise than MuJoCo does."""
    return {
        "dtd.xml": f'<!DOCTYPE mujoco SYSTEM "{secret}/s.dtd">\n<mujoco/>',
        "entity.xml": f'<!DOCTYPE mujoco [<!ENTITY % e SYSTEM "{secret}/s.dtd"> %e;]>\n<mujoco/>',
        "two_models.xml": f"<!DOCTYPE mujoco [ <!-- > {ARM.replace('k.obj', f'{secret}/s.obj')} <!-- --> ]><mujoco/>",
        "encoding.xml": '<?xml version="1.0" encoding="ISO-2022-JP"?><mujoco/>',
    }


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Path, Path]]:
    """A folder with secrets, a repository of a stranger, and a folder with a recipe of one's own."""
    top = tmp_path_factory.mktemp("machine")
    secret = top / "secret"
    robots = top / "robots"
    work = top / "work"
    for each in (secret, robots, work):
        each.mkdir()
    (secret / "s.obj").write_text(COVER + f"# {SECRET}\n")
    (secret / "s.png").write_text(SECRET)
    (secret / "s.skn").write_text(SECRET)
    (secret / "s.dtd").write_text(f'<!ENTITY {SECRET} "1">')
    (secret / "include.xml").write_text(
        f'<mujocoinclude><worldbody><body name="{SECRET}"/></worldbody></mujocoinclude>'
    )
    (secret / "sub.xml").write_text(f'<mujoco model="{SECRET}"><worldbody><body name="x"/></worldbody></mujoco>')
    (secret / "own.yaml").write_text("recipe: 1\nbase: ./sub.xml\n")
    if hasattr(os, "mkfifo"):
        os.mkfifo(secret / "pipe.obj")
    for name, text in {**hostile(secret), **unlike_xml(secret), "arm.xml": ARM, "k.obj": COVER}.items():
        (robots / name).write_text(text)
    (robots / "link.xml").write_text(ARM.replace("k.obj", "link.obj"))
    (robots / "link.obj").symlink_to(secret / "s.obj")
    git = ["git", "-c", "user.name=x", "-c", "user.email=x@example.org", "-C", str(robots)]
    for arguments in (["init", "-q", "-b", "main"], ["add", "-A"], ["commit", "-q", "-m", "one"]):
        subprocess.run([*git, *arguments], check=True)
    yield secret, robots, work


HOSTILE = [*hostile(Path("/x")), *unlike_xml(Path("/x")), "link.xml"]
RECIPE = {
    "base": "recipe: 1\nbase: '{}'\n",
    "attach": "recipe: 1\nattach: {{q: {{model: '{}'}}}}\n",
    "extends": "recipe: 1\nextends: '{}'\n",
}


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_fetched_reads_only_what_was_fetched(
    places: tuple[Path, Path, Path], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, robots, work = places
    monkeypatch.chdir(work)
    for way, recipe in RECIPE.items():
        if way == "extends" and not name.endswith(".yaml"):
            continue
        (work / "cell.yaml").write_text(recipe.format(f"git+file://{robots}@main#{name}"))
        result = run("build", "cell.yaml", "--no-compile", "-o", "out.zip")
        assert result.exit_code == 1, (way, result.stderr)
        assert f"error[{NOT_OUTSIDE.get(name, 'source-outside')}]" in result.stderr, (way, result.stderr)
        assert SECRET not in result.stderr and not (work / "out.zip").exists(), way


def test_the_error_is_at_the_place_that_names_the_file(
    places: tuple[Path, Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    secret, robots, work = places
    monkeypatch.chdir(work)
    (work / "cell.yaml").write_text(f"recipe: 1\nbase: 'git+file://{robots}@main#edit.yaml'\n")
    result = run("build", "cell.yaml", "--no-compile", "-o", "out.zip")
    first = result.stderr.splitlines()[0]
    assert first.partition("/content/")[2].startswith(
        f"edit.yaml:4:37: error[source-outside]: the file `{secret}/s.obj`"
    )
    assert "trust: {references:" in result.stderr


def test_what_the_own_recipe_trusts_is_read(places: tuple[Path, Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    secret, robots, work = places
    monkeypatch.chdir(work)
    for name in ("mesh.xml", "edit.yaml", "part.yaml", "mesh.urdf", "absolute.yaml"):
        recipe = f"recipe: 1\ntrust: {{references: [{secret}]}}\nbase: 'git+file://{robots}@main#{name}'\n"
        (work / "cell.yaml").write_text(recipe)
        result = run("build", "cell.yaml", "--no-compile", "-o", f"{name}.zip")
        assert result.exit_code == 0, (name, result.stderr)
    for reference, name in (("http://localhost:9", "loopback.yaml"), ("package:numpy", "package_of_python.yaml")):
        recipe = f"recipe: 1\ntrust: {{references: ['{reference}']}}\nbase: 'git+file://{robots}@main#{name}'\n"
        (work / "cell.yaml").write_text(recipe)
        result = run("build", "cell.yaml", "--no-compile", "--offline", "-o", "out.zip")
        assert "source-outside" not in result.stderr, (name, result.stderr)


def test_a_model_of_ones_own_reads_its_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot" / "mjcf").mkdir(parents=True)
    (tmp_path / "robot" / "meshes").mkdir()
    (tmp_path / "shared").mkdir()
    (tmp_path / "work").mkdir()
    (tmp_path / "robot" / "meshes" / "k.obj").write_text(COVER)
    (tmp_path / "shared" / "k.obj").write_text(COVER)
    (tmp_path / "robot" / "mjcf" / "near.xml").write_text(ARM.replace("k.obj", "../meshes/k.obj"))
    (tmp_path / "robot" / "mjcf" / "far.xml").write_text(ARM.replace("k.obj", "../../shared/k.obj"))
    monkeypatch.chdir(tmp_path / "work")

    def built(model: str, more: str = "") -> str:
        Path("cell.yaml").write_text(f"recipe: 1\n{more}base: ../robot/mjcf/{model}\n")
        return run("build", "cell.yaml", "--no-compile", "-o", "out.zip").stderr

    assert "error" not in built("near.xml")
    refused = built("far.xml")
    assert "far.xml:1:49: error[source-outside]" in refused, refused
    assert "write in the recipe `trust: {files: [../shared]}`" in refused
    assert "error" not in built("far.xml", "trust: {files: [../shared]}\n")
    (tmp_path / "pyproject.toml").touch()
    assert "error" not in built("far.xml")


def test_ones_own_recipe_names_any_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "work").mkdir()
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "k.obj").write_text(COVER)
    monkeypatch.chdir(tmp_path / "work")
    Path("cell.yaml").write_text("recipe: 1\nasset: {mesh: {m: {file: ../far/k.obj}}}\n")
    assert run("build", "cell.yaml", "--no-compile", "-o", "out.zip").exit_code == 0


def _bundle(path: Path, model: str) -> Path:
    manifest = {"files": [], "model": "model.xml"}
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("model.xml", model)
        archive.writestr("manifest.json", json.dumps(manifest))
    return path


BUNDLES = [
    "mesh.xml",
    "mesh_up.xml",
    "meshdir.xml",
    "include.xml",
    "attached.xml",
    "skin.xml",
    "pipe.xml",
    "two_models.xml",
]


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_reads_only_itself(
    places: tuple[Path, Path, Path], name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from mjcompose import mjcf

    secret, _, _ = places
    monkeypatch.chdir(tmp_path)
    model = {**hostile(secret), **unlike_xml(secret)}[name]
    code = NOT_OUTSIDE.get(name, "source-outside")
    _bundle(tmp_path / "evil.zip", model)
    (tmp_path / "evil").mkdir()
    (tmp_path / "evil" / "model.xml").write_text(model)
    for path in ("evil.zip", "evil"):
        result = run("verify", path)
        assert f"error[{code}]" in result.stderr and SECRET not in result.stderr, (path, result.stderr)
    result = run("diff", "evil.zip", "evil")
    assert f"error[{code}]" in result.stderr, result.stderr
    with pytest.raises(mjcf.MjcfError):
        mjcf.from_zip("evil.zip")


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", BUNDLES)
def test_a_model_that_is_imported_reads_its_project(
    places: tuple[Path, Path, Path], name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A pipe made it wait for as long as the limit of time is, and MuJoCo opened the rest."""
    secret, _, _ = places
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.chdir(work)
    Path("k.obj").write_text(COVER)
    Path("arm.xml").write_text(ARM)
    Path(name).write_text({**hostile(secret), **unlike_xml(secret)}[name])
    for words in ((name, "arm.xml"), ("arm.xml", name)):
        result = run("import", *words, "-o", "new.yaml")
        assert result.exit_code in (1, 2), result.stderr
        code = NOT_OUTSIDE.get(name, "source-outside")
        assert f"error[{code}]" in result.stderr and SECRET not in result.stderr, result.stderr
        assert not Path("new.yaml").exists()


def test_a_bundle_that_is_loaded_reads_only_itself(
    places: tuple[Path, Path, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Its manifest is right but for the hash of the model, and its model names a file that MuJoCo would take."""
    import mjcompose

    secret, robots, _ = places
    monkeypatch.chdir(tmp_path)
    Path("cell.yaml").write_text(f"recipe: 1\nbase: {robots}/arm.xml\n")
    assert run("build", "cell.yaml", "--no-compile", "-o", "out").exit_code == 0
    model = Path("out", "model.xml")
    text = model.read_text()
    with pytest.warns(mjcompose.BundleWarning):
        assert mjcompose.load("out", allow_changes=True).model.nmesh == 1
    model.write_text(text.replace("assets/arm/k.obj", f"{secret}/s.obj"))
    with pytest.raises(mjcompose.LoadError) as caught, pytest.warns(mjcompose.BundleWarning):
        mjcompose.load("out", allow_changes=True)
    assert [each.code for each in caught.value.diagnostics] == ["source-outside"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
@pytest.mark.parametrize("name", ["mesh.xml", "include.xml", "pipe.xml"])
def test_a_model_in_python_is_confined_to_its_project(
    places: tuple[Path, Path, Path], name: str, tmp_path: Path
) -> None:
    from mjcompose import mjcf

    secret, _, _ = places
    model = tmp_path / "robot" / name
    model.parent.mkdir()
    model.write_text(hostile(secret)[name])

    def exported(path: Path, confine_to: Sequence[Path]) -> None:
        mjcf.export_with_assets(mjcf.from_path(path, confine_to=confine_to), tmp_path / "out")

    for read in (exported, mjcf.Physics.from_path):
        with pytest.raises(mjcf.MjcfError) as caught:
            read(model, confine_to=[model.parent])
        (found,) = caught.value.diagnostics
        assert found.code == "source-outside"
        if name == "mesh.xml":
            assert f"confine_to=[…, '{secret}']" in (found.help or "")
            read(model, confine_to=[model.parent, secret])


AUDIT = """
    import json, os, sys
    secret, out = sys.argv[1], open(sys.argv[2], "w")

    def hook(event, arguments):
        if event in ("open", "os.open", "os.listdir", "os.scandir", "shutil.copyfile") and arguments:
            path = arguments[0]
            if isinstance(path, (str, bytes, os.PathLike)) and secret in os.path.realpath(os.fsdecode(path)):
                out.write(f"{event} {os.fsdecode(path)}\\n"); out.flush()

    sys.addaudithook(hook)
    from mjcompose.mujoco.engine import Session
    exchange = Session._exchange

    def noted(self, line, seconds):
        if secret in line:
            out.write(f"child {line}\\n"); out.flush()
        return exchange(self, line, seconds)

    Session._exchange = noted
    from mjcompose.cli.main import main
    for command in json.loads(sys.argv[3]):
        try:
            main(command, prog_name="mjcompose")
        except SystemExit:
            pass
"""


@pytest.mark.slow
@pytest.mark.timeout(280)
def test_nothing_outside_is_opened(places: tuple[Path, Path, Path], tmp_path: Path) -> None:
    """Neither by this process, as Python's own audit hook sees it, nor is it named to the process of MuJoCo."""
    secret, robots, _ = places
    work = tmp_path / "work"
    work.mkdir()
    models = {**hostile(secret), **unlike_xml(secret)}
    commands = []
    (work / "arm.xml").write_text(ARM)
    (work / "k.obj").write_text(COVER)
    for name in HOSTILE:
        (work / f"{name}.cell.yaml").write_text(f"recipe: 1\nbase: 'git+file://{robots}@main#{name}'\n")
        for command in (["build", "-o", "out.zip"], ["lock"], ["explain"], ["check"], ["plan"]):
            commands.append([command[0], f"{name}.cell.yaml", *command[1:]])
        if name.endswith(".xml") and name in models:
            _bundle(work / f"{name}.zip", models[name])
            (work / name).write_text(models[name])
            commands += [
                ["verify", f"{name}.zip"],
                ["diff", f"{name}.zip", name],
                ["explain", name],
                ["import", name, "arm.xml"],
            ]
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(AUDIT), str(secret), str(tmp_path / "log"), json.dumps(commands)],
        cwd=work,
        env=environment(MJCOMPOSE_CACHE=str(tmp_path / "store")),
        capture_output=True,
        text=True,
        timeout=270,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    opened = (tmp_path / "log").read_text()
    assert not opened, opened[:3000]
    assert SECRET not in done.stdout + done.stderr
    assert REPOSITORY.exists()
