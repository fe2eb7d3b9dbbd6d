from __future__ import annotations

import time
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.limits import allow
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def errors(folder: Path, name: str) -> list[Diagnostic]:
    context = Context(folder=folder)
    assert build(ModelRequest(Path(name), verified=False), context) is None
    return context.sink.errors


def test_models_that_attach_one_another_twice(tmp_path: Path) -> None:
    (tmp_path / "m0.xml").write_text('<mujoco><worldbody><body name="b"><geom size=".1"/></body></worldbody></mujoco>')
    for level in range(1, 30):
        (tmp_path / f"m{level}.xml").write_text(
            f'<mujoco><asset><model name="m" file="m{level - 1}.xml"/></asset><worldbody><body name="b">'
            '<attach model="m" prefix="l"/><attach model="m" prefix="r"/></body></worldbody></mujoco>'
        )
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m29.xml\n")
    begun = time.monotonic()
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and "`<attach>` makes" in error.message
    assert error.span is not None and error.span.file == "m29.xml" and time.monotonic() - begun < 20


@pytest.mark.parametrize("key", ["extends", "base"])
def test_recipes_nested_too_deep(tmp_path: Path, key: str) -> None:
    for level in range(60):
        (tmp_path / f"r{level}.yaml").write_text(f"recipe: 1\n{key}: ./r{level + 1}.yaml\n")
    (tmp_path / "r60.yaml").write_text("recipe: 1\n")
    (error,) = errors(tmp_path, "r0.yaml")
    assert (error.code, error.help) == ("limit-exceeded", "to allow it, raise the limit: `--limit nesting=100`")


def test_recipes_that_use_one_another_twice(tmp_path: Path) -> None:
    for level in range(30):
        part = f"{{model: ./r{level + 1}.yaml}}"
        (tmp_path / f"r{level}.yaml").write_text(f"recipe: 1\nattach:\n  l: {part}\n  r: {part}\n")
    (tmp_path / "r30.yaml").write_text("recipe: 1\n")
    with allow(parts=200):  # each costs the planning of a recipe
        (error,) = errors(tmp_path, "r0.yaml")
    assert error.code == "limit-exceeded" and error.message == "more than 200 recipes are nested"


def test_files_that_include_one_another_too_deep(tmp_path: Path) -> None:
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m0.xml\n")
    for level in range(60):
        (tmp_path / f"m{level}.xml").write_text(f'<mujoco>\n<include file="m{level + 1}.xml"/></mujoco>')
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and error.span is not None and error.span.file == "m50.xml"


def test_the_parts_have_too_many_elements_together(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text("<mujoco><worldbody>" + '<geom size=".1"/>' * 98 + "</worldbody></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nattach:\n  m: {model: ./m.xml, replicate: [{count: 9}]}\n")
    with allow(elements=350):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.message == "the parts up to here have 401 elements; 350 are allowed"


def test_a_bundle_has_too_many_or_too_large_files(tmp_path: Path) -> None:
    names = [f"t{number}.png" for number in range(4)]
    for name in names:
        (tmp_path / name).write_bytes(b"x" * 1000 + name.encode())
    textures = "".join(f'<texture name="{name}" type="2d" file="{name}"/>' for name in names)
    (tmp_path / "m.xml").write_text(f"<mujoco><asset>\n{textures}</asset></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    with allow(output_size=3000):
        (error,) = errors(tmp_path, "r.yaml")
        assert "more than 3K in its files" in error.message and error.span is not None and error.span.line == 2
    with allow(output_files=4):
        (error,) = errors(tmp_path, "r.yaml")
        assert "more than 4 files" in error.message


def test_expressions_that_make_a_long_text(tmp_path: Path) -> None:
    (tmp_path / "r.yaml").write_text(
        f"recipe: 1\nparams: {{p: {'x' * 100}}}\ndescription: '{'${p}' * 101}'\nbase: ./m.xml\n"
    )
    error = errors(tmp_path, "r.yaml")[0]
    assert error.message == "expressions give 10100 characters; 10000 are allowed"
    assert error.span is not None and error.span.line == 3


def test_models_that_name_one_another_twice(tmp_path: Path) -> None:
    """Without an `<attach>`: 2^38 files in the bundle."""
    (tmp_path / "m0.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
    for level in range(1, 39):
        twice = "".join(f'<model name="{name}" file="m{level - 1}.xml"/>' for name in "ab")
        (tmp_path / f"m{level}.xml").write_text(f"<mujoco><asset>{twice}</asset></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m38.xml\n")
    with allow(submodels=100):
        found = errors(tmp_path, "r.yaml")
    assert {each.code for each in found} == {"limit-exceeded"} and len(found) <= 2
    assert found[0].message == "there are more than 100 models that models attach" and found[0].span is not None


def test_models_that_name_one_another_too_deep(tmp_path: Path) -> None:
    for level in range(300):
        (tmp_path / f"m{level}.xml").write_text(
            f'<mujoco><asset><model name="m" file="m{level + 1}.xml"/></asset>'
            '<worldbody><frame><attach model="m" prefix="a"/></frame></worldbody></mujoco>'
        )
    (tmp_path / "m300.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m0.xml\n")
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and error.span is not None and error.span.file == "m50.xml"


def test_recipes_nested_deeper_than_python_goes(tmp_path: Path) -> None:
    for level in range(500):
        (tmp_path / f"r{level}.yaml").write_text(f"recipe: 1\nbase: ./r{level + 1}.yaml\n")
    (tmp_path / "r500.yaml").write_text("recipe: 1\n")
    with allow(nesting=10_000):
        (error,) = errors(tmp_path, "r0.yaml")
    assert error.code == "not-supported" and "too deep" in error.message


def test_files_of_one_model_that_are_too_large_together(tmp_path: Path) -> None:
    include = "<mujocoinclude>" + " " * 600 + "</mujocoinclude>"
    for name in "ab":
        (tmp_path / f"{name}.xml").write_text(include)
    (tmp_path / "m.xml").write_text('<mujoco><include file="a.xml"/><include file="b.xml"/></mujoco>')
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    with allow(xml_size=1000):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and "together larger than" in error.message
    assert error.span is not None and error.span.column > 30


def test_parts_that_are_too_large_together(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text("<mujoco><!--" + "x" * 600 + "--><worldbody><body/></worldbody></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nattach:\n  a: {model: ./m.xml}\n  b: {model: ./m.xml}\n")
    with allow(xml_size=1000):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and "bytes of XML; 1000 are allowed" in error.message
    assert error.span is not None and error.span.line == 4
    with allow(xml_size=1000, elements=1000):  # the same number is not the same limit
        (error,) = errors(tmp_path, "r.yaml")
    assert error.help is not None and "xml-size" in error.help


@pytest.mark.parametrize(
    ("inside", "column"),
    [
        ('<asset><texture name="t" type="2d" builtin="flat" width="30000" height="30000"/></asset>', 66),
        ('<asset><texture name="t" type="cube" builtin="flat" width="9000"/></asset>', 68),
        ('<asset><hfield name="h" nrow="30000" ncol="30000" size="1 1 1 1"/></asset>', 39),
        ('<size nuserdata="1000000000"/>', 26),
        ('<size nkey="50001"/>', 21),
        (
            (
                '<compiler><lengthrange inttotal="1e9"/></compiler><worldbody><body><joint name="j"/><geom size=".1"/></body>'
                '</worldbody><actuator><muscle joint="j"/></actuator>'
            ),
            42,
        ),
        ('<size nuser_geom="100000000"/><worldbody><geom size=".1"/></worldbody>', 27),
    ],
)
def test_what_a_few_words_reserve(tmp_path: Path, inside: str, column: int) -> None:
    """MuJoCo took 7 GB, or minutes, for each of them."""
    (tmp_path / "m.xml").write_text(f"<mujoco>{inside}</mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and "numbers; a model may reserve 100000000" in error.message
    assert error.span is not None and error.span.column == column


def test_what_models_reserve_as_a_rule(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(
        '<mujoco><size nkey="9" nuserdata="100" memory="100M"/><asset>'
        '<texture name="t" type="2d" builtin="flat" width="2048" height="2048"/>'
        '<texture name="s" type="skybox" builtin="gradient" width="512" height="3072"/></asset></mujoco>'
    )
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=tmp_path)
    assert build(ModelRequest(Path("r.yaml"), verified=False), context) is not None


def png_head(width: int, height: int) -> bytes:
    """What a PNG file begins with."""
    return b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes(9)


@pytest.mark.parametrize(
    ("inside", "column"),
    [
        ('<texture name="t" type="2d" file="p.png"/>', 50),
        ('<texture name="t" type="cube" fileup="p.png"/>', 54),
        ('<hfield name="h" file="p.png" size="1 1 1 1"/>', 39),
    ],
)
def test_the_pixels_of_a_file(tmp_path: Path, inside: str, column: int) -> None:
    """A file of 3 MB unpacks to 5 GB."""
    (tmp_path / "p.png").write_bytes(png_head(10_001, 10_000))
    (tmp_path / "m.xml").write_text(f"<mujoco><asset>{inside}</asset></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and "reserves 100010000 numbers" in error.message
    assert error.span is not None and error.span.column == column
    with allow(reserved=100_010_000):
        assert build(ModelRequest(Path("r.yaml"), verified=False), Context(folder=tmp_path)) is not None


def test_an_element_of_too_many_attributes(tmp_path: Path) -> None:
    many = " ".join(f'a{number}=""' for number in range(1001))
    (tmp_path / "m.xml").write_text(f"<mujoco>\n<option {many}/></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "limit-exceeded" and error.message == "`<option>` has 1001 attributes; 1000 are allowed"
    assert error.span is not None and error.span.line == 2


def test_more_errors_than_are_looked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.base.sink import Sink, TooManyFaults

    sink = Sink()
    with allow(faults=3), pytest.raises(TooManyFaults, match="more than 3 errors; the first one is: 0"):
        for number in range(9):
            sink.error("bad-name", str(number))
    assert [each.message for each in sink.errors] == [
        "0",
        "1",
        "2",
        "3",
        "there are more than 3 errors; mjcompose stopped looking for others",
    ]


def test_one_mistake_a_thousand_times_on_one_line(tmp_path: Path) -> None:
    """Its places and what may be meant are looked for once: 50,000 of them took two minutes and more."""
    (tmp_path / "m.xml").write_text(
        "<mujoco><worldbody>" + '<geom size=".1" foo="1"/>' * 5000 + "</worldbody></mujoco>"
    )
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=tmp_path)
    begun = time.process_time()
    assert build(ModelRequest(Path("r.yaml")), context) is None
    assert [each.code for each in context.sink.errors] == ["unknown-attribute"]
    assert time.process_time() - begun < 20


def test_more_bodies_than_mujoco_reads_in_time(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text("<mujoco><worldbody>" + "<body/>" * 21 + "</worldbody></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    with allow(bodies=20):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.message == "the model has 21 bodies; 20 are allowed"
    assert error.help == "to allow it, raise the limit: `--limit bodies=21`"


@pytest.mark.parametrize("allowed", [3, 4])
def test_as_many_models_as_may_be_attached(tmp_path: Path, allowed: int) -> None:
    (tmp_path / "s.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
    models = "".join(f'<model name="{name}" file="s.xml"/>' for name in "abcd")
    (tmp_path / "m.xml").write_text(f"<mujoco><asset>{models}</asset></mujoco>")
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=tmp_path)
    with allow(submodels=allowed):
        assert (build(ModelRequest(Path("r.yaml"), verified=False), context) is None) == (allowed < 4)


def test_files_of_one_model_with_too_many_elements_together(tmp_path: Path) -> None:
    for name in "ab":
        (tmp_path / f"{name}.xml").write_text(f"<mujocoinclude>{'<option/>' * 6}</mujocoinclude>")
    (tmp_path / "m.xml").write_text('<mujoco><include file="a.xml"/><include file="b.xml"/></mujoco>')
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    with allow(elements=10):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.message == "the model has 13 elements; 10 are allowed"


def with_edits(folder: Path, edits: str, bodies: int = 100) -> list[Diagnostic]:
    inside = "".join(
        f'<body name="b{n}"><geom name="geom_with_a_rather_long_name_{n}" size=".1"/></body>' for n in range(bodies)
    )
    (folder / "m.xml").write_text(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    (folder / "r.yaml").write_text(f"recipe: 1\nbase: ./m.xml\nedit:\n{edits}")
    return errors(folder, "r.yaml")


def test_more_edits_of_more_elements_than_there_is_time_for(tmp_path: Path) -> None:
    begun = time.process_time()
    with allow(edits=1000):
        (error,) = with_edits(tmp_path, '- {select: {geom: "**"}, set: {rgba: [1, 1, 1, 1], group: 2}}\n' * 50)
    assert error.message == "the edits up to here cost as much as 1034 values; 1000 are allowed"
    assert error.span is not None and error.span.line == 8 and time.process_time() - begun < 2
    assert error.help == "to allow it, raise the limit: `--limit edits=2000`"


@pytest.mark.parametrize(
    ("edit", "line"),
    [
        ('- {select: {geom: "nothing*"}, optional: true, set: {group: 2}}\n', 8),
        ("- {select: {geom: '**', where: '${index < 0" + " + 0" * 50 + "}'}, optional: true, set: {group: 2}}\n", 4),
        ("- {select: {geom: '/(x+)+/'}, optional: true, set: {group: 2}}\n", 4),
    ],
    ids=["names", "conditions", "expressions"],
)
def test_what_is_looked_at_counts(tmp_path: Path, edit: str, line: int) -> None:
    with allow(edits=30):
        (error,) = with_edits(tmp_path, edit * 50)
    assert error.code == "limit-exceeded" and error.span is not None and error.span.line == line


def test_a_pattern_without_end_is_the_last_one(tmp_path: Path) -> None:
    begun = time.process_time()
    (error,) = with_edits(tmp_path, "- {select: {geom: '/(.|.)*[!?]/'}, optional: true, set: {group: 2}}\n" * 20)
    assert error.code == "selector" and "takes longer than 2 seconds" in error.message
    assert error.span is not None and error.span.line == 4 and time.process_time() - begun < 15


def test_selectors_in_one_another_are_looked_at_once(tmp_path: Path) -> None:
    """Each of 20 levels may be any of the 40 bodies around: as many ways as there are choices of 20 of 40."""
    (tmp_path / "m.xml").write_text(
        "<mujoco><worldbody>" + "<body>" * 40 + '<geom size=".1"/>' + "</body>" * 40 + "</worldbody></mujoco>"
    )
    select = "{body: nothing}"
    for _ in range(20):
        select = f'{{body: "**", in: {select}}}'
    (tmp_path / "r.yaml").write_text(
        f'recipe: 1\nbase: ./m.xml\nedit: [{{select: {{geom: "**", in: {select}}}, set: {{group: 2}}}}]\n'
    )
    begun = time.process_time()
    (error,) = errors(tmp_path, "r.yaml")
    assert error.code == "selector" and time.process_time() - begun < 5


def test_more_mistakes_in_a_recipe_than_are_looked_for(tmp_path: Path) -> None:
    """Each takes a search for what was meant: 300,000 took minutes."""
    from mjcompose.base.sink import TooManyFaults

    (tmp_path / "r.yaml").write_text("recipe: 1\n" + "".join(f"key{n}: 1\n" for n in range(20_000)))
    begun = time.process_time()
    with pytest.raises(TooManyFaults) as caught:
        errors(tmp_path, "r.yaml")
    assert len(caught.value.sink.errors) == 1002 and time.process_time() - begun < 8


@pytest.mark.parametrize("name", ["c.obj", "c.stl", "c.msh", "legacy.msh"])
def test_the_points_of_a_file(tmp_path: Path, name: str) -> None:
    """Each is a body."""
    (tmp_path / "c.obj").write_text("# points\n" + "v 0 0 0\n" * 300 + "vn 0 0 1\n" * 900)
    (tmp_path / "c.stl").write_bytes(bytes(84 + 50 * 600))
    (tmp_path / "c.msh").write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 300 1 300\n")
    (tmp_path / "legacy.msh").write_bytes((300).to_bytes(4, "little") + bytes(100))
    kind = "gmsh" if name == "c.msh" else "mesh"
    (tmp_path / "m.xml").write_text(
        f'<mujoco><worldbody>\n<flexcomp name="f" type="{kind}" file="{name}"/></worldbody></mujoco>'
    )
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    with allow(expansion=299):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.message == "`<flexcomp>` makes 300 elements; 299 are allowed"
    assert error.span is not None and (error.span.line, error.span.column) == (
        2,
        len(f'<flexcomp name="f" type="{kind}" file="x'),
    )
    with allow(expansion=300):
        assert build(ModelRequest(Path("r.yaml"), verified=False), Context(folder=tmp_path)) is not None


def test_more_samples_than_are_drawn(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text("<mujoco/>")
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./m.xml\nparams: {a: 1.0}\n"
        "randomize: {seed: 1, samples: 6, fields: {a: {param: a, uniform: [0, 1]}}}\n"
    )
    with allow(samples=5):
        (error,) = errors(tmp_path, "r.yaml")
    assert error.message == "`samples` is 6; 5 are allowed" and error.help is not None
    assert "--limit samples=6" in error.help and error.span is not None and error.span.line == 4
    with allow(samples=6):
        assert build(ModelRequest(Path("r.yaml"), verified=False), Context(folder=tmp_path)) is not None
