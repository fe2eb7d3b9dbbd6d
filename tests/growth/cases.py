"""Inputs of any size for each command: what grows, and the command that reads it.

A case writes its input of size `n` into the current folder, and returns the words of the command.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from cli.shell import run

Words = list[str]


class Case(NamedTuple):
    """A function that writes an input of a size, the smaller of the two sizes that are compared, and the exit code."""

    write: Callable[[int], Words]
    size: int
    exit_code: int


CASES: dict[str, Case] = {}
"""The cases by name: the command, and what grows after a colon."""

NOTHING_GROWS = {
    "cache": "the store is listed as the file system has it",
    "completion": "prints one line",
    "doctor": "reports this installation",
    "help": "prints a text",
    "identify": "simulates in MuJoCo, once more for each unknown; its readers are counted in tests/tools/identify",
    "install": "downloads a package",
    "lsp": "a server: `tests/lsp/test_glance.py` counts a keystroke",
    "mcp": "a server that calls the functions of other commands",
    "migrate": "see `fmt`: both rewrite a file in place; proving needs another MuJoCo",
    "new": "writes one recipe",
    "plugin": "installs one file",
    "rebuild": "builds",
    "render": "needs OpenGL; the pixels are most of its work",
    "schema": "prints a text",
    "uninstall": "removes a folder",
    "upgrade": "simulates in another MuJoCo",
    "version": "prints a line",
}
"""The commands without a case, each with the reason."""


def case(name: str, size: int, exit_code: int = 0) -> Callable[[Callable[[int], Words]], Callable[[int], Words]]:
    def register(write: Callable[[int], Words]) -> Callable[[int], Words]:
        CASES[name] = Case(write, size, exit_code)
        return write

    return register


PART = """\
<mujoco model="part">
  <worldbody>
    <body name="link">
      <joint name="j" axis="0 0 1"/>
      <geom name="g" type="box" size="0.02 0.02 0.02" contype="0" conaffinity="0"/>
      <site name="tip" pos="0 0 0.05"/>
    </body>
  </worldbody>
  <actuator><position name="a" joint="j" kp="1"/></actuator>
</mujoco>
"""


def _place(number: int) -> str:
    return f"{number % 50 * 0.1:.1f} {number // 50 * 0.1:.1f} 0"


def _bodies(count: int, inside: str = "") -> str:
    """Return bodies side by side; `#` in `inside` is the number of the body."""
    return "\n".join(
        f'<body name="b{number}" pos="{_place(number)}">{inside.replace("#", str(number))}'
        f'<geom name="g{number}" size="0.02" contype="0" conaffinity="0"/></body>'
        for number in range(count)
    )


def _model(bodies: str, sections: str = "") -> None:
    Path("base.xml").write_text(f'<mujoco model="m">\n<worldbody>\n{bodies}\n</worldbody>\n{sections}</mujoco>\n')


def _recipe(lines: Iterable[str], start: str = "recipe: 1\nbase: ./base.xml\n") -> None:
    Path("r.yaml").write_text(start + "".join(f"{line}\n" for line in lines))


_HINGE = '<joint name="j#" axis="0 0 1"/>'
_BUILD = ["build", "r.yaml", "--no-cache", "-q", "-o", "out.zip"]


def _parts(count: int) -> None:
    Path("part.xml").write_text(PART)
    parts = (
        f"  p{number}: {{model: ./part.xml, pos: [{_place(number).replace(' ', ', ')}]}}" for number in range(count)
    )
    _recipe(["attach:", *parts], start="recipe: 1\n")


@case("build: parts side by side", 30)
def parts(n: int) -> Words:
    _parts(n)
    return _BUILD


@case("build: parts for ROS", 150)
def parts_for_ros(n: int) -> Words:
    _parts(n)
    return ["build", "r.yaml", "--no-cache", "-q", "-o", "out/", "--target", "urdf"]


@case("build: parts in a chain", 40)
def chain(n: int) -> Words:
    Path("part.xml").write_text(PART)
    rest = (f"  p{number}: {{model: ./part.xml, site: p{number - 1}/tip}}" for number in range(1, n))
    _recipe(["attach:", "  p0: {model: ./part.xml}", *rest], start="recipe: 1\n")
    return [*_BUILD, "--no-compile"]


@case("build: edits of one name each", 40)
def edits(n: int) -> Words:
    _model(_bodies(n))
    _recipe(["edit:", *(f"  - {{select: {{geom: g{number}}}, set: {{group: 3}}}}" for number in range(n))])
    return [*_BUILD, "--no-compile"]


@case("build: edits of one glob each", 40)
def edits_globs(n: int) -> Words:
    _model(_bodies(n))
    _recipe(["edit:", *(f"  - {{select: {{geom: 'g{number}{{,x*}}'}}, set: {{group: 3}}}}" for number in range(n))])
    return [*_BUILD, "--no-compile"]


@case("build: edits of one end of names each", 40)
def edits_ends(n: int) -> Words:
    _model(_bodies(n).replace('name="g', 'name="x_g'))
    _recipe(["edit:", *(f"  - {{select: {{geom: '*_g{number}'}}, set: {{group: 3}}}}" for number in range(n))])
    return [*_BUILD, "--no-compile"]


@case("build: edits of one regular expression each", 40)
def edits_expressions(n: int) -> Words:
    _model(_bodies(n))
    _recipe(["edit:", *(f"  - {{select: {{geom: '/g{number}(x.*)?/'}}, set: {{group: 3}}}}" for number in range(n))])
    return [*_BUILD, "--no-compile", "--limit", "edits=10000000"]


@case("build: edits of one part each", 25)
def edits_parts(n: int) -> Words:
    _parts(n)
    rows = (f"  - {{select: {{geom: '**', part: p{number}}}, set: {{group: 3}}}}\n" for number in range(n))
    with Path("r.yaml").open("a") as recipe:
        recipe.write("edit:\n" + "".join(rows))
    return [*_BUILD, "--no-compile"]


@case("build: edits inside one body each", 40)
def edits_inside(n: int) -> Words:
    _model(_bodies(n))
    rows = (f"  - {{select: {{geom: '*', in: {{body: b{number}}}}}, set: {{group: 3}}}}" for number in range(n))
    _recipe(["edit:", *rows])
    return [*_BUILD, "--no-compile"]


@case("build: edits below one body each", 40)
def edits_below(n: int) -> Words:
    _model(_bodies(n))
    rows = (f"  - {{select: {{geom: '*', parent: {{body: b{number}}}}}, set: {{group: 3}}}}" for number in range(n))
    _recipe(["edit:", *rows])
    return [*_BUILD, "--no-compile"]


@case("build: elements added into the last one", 30)
def added(n: int) -> Words:
    _model('<body name="a"/>')
    rest = (f"  - {{to: a{number - 1}, body: {{name: a{number}}}}}" for number in range(1, n))
    _recipe(["add:", "  - {to: a, body: {name: a0}}", *rest])
    return [*_BUILD, "--no-compile"]


@case("build: actuators", 40)
def actuators(n: int) -> Words:
    _model(_bodies(n, _HINGE))
    _recipe(["actuator:", *(f"  m{number}: {{type: motor, joint: j{number}}}" for number in range(n))])
    return _BUILD


@case("build: axes of variants", 12)
def axes(n: int) -> Words:
    Path("part.xml").write_text(PART)
    rows = (f"  v{number}: {{a: {{}}, b: {{attach: {{p{number}: {{model: ./part.xml}}}}}}}}" for number in range(n))
    _recipe(["variants:", *rows], start="recipe: 1\n")
    return [*_BUILD, "--no-compile"]


@case("build: subtrees of one model", 30)
def subtrees(n: int) -> Words:
    motors = "".join(f'<motor name="m{number}" joint="j{number}"/>' for number in range(n))
    _model(_bodies(n, _HINGE), f"<actuator>{motors}</actuator>")
    rows = (f"  p{number}: {{model: ./base.xml, subtree: b{number}}}" for number in range(n))
    _recipe(["attach:", *rows], start="recipe: 1\n")
    return [*_BUILD, "--no-compile"]


@case("check: names that do not exist", 25, exit_code=1)
def unknown(n: int) -> Words:
    _model(_bodies(30, _HINGE))
    _recipe(["actuator:", *(f"  x{number}: {{type: motor, joint: jj{number}}}" for number in range(n))])
    return ["check", "r.yaml", "--limit", "faults=100000"]


@case("check: checks of one joint each", 40)
def checks(n: int) -> Words:
    _model(_bodies(n, _HINGE))
    rows = (
        f"  c{number}: {{expect: {{select: {{joint: j{number}}}, attr: axis, equals: [0, 0, 1]}}}}"
        for number in range(n)
    )
    _recipe(["check:", *rows])
    return ["check", "r.yaml", "--no-cache"]


@case("check: checks of one pattern each", 90)
def checks_of_patterns(n: int) -> Words:
    _model(_bodies(n, _HINGE).replace('name="j', 'name="x_j'))
    rows = (f"  c{number}: {{expect: {{select: {{joint: '*_j{number}'}}, count: 1}}}}" for number in range(n))
    _recipe(["check:", *rows])
    return ["check", "r.yaml", "--no-cache"]


@case("check: distances of all geoms from each other", 90)
def distances(n: int) -> Words:
    _model(_bodies(n, _HINGE))
    _recipe(["check:", "  apart: {clearance: {min: 1mm, between: ['g*', 'g*']}}"])
    return ["check", "r.yaml", "--no-cache"]


@case("lint: bodies that are fixed to the world", 60)
def static(n: int) -> Words:
    _model(_bodies(n))
    return ["lint", "base.xml", "-q", "--ignore", "no-license"]


@case("lint: bodies with joints and motors", 30)
def robots(n: int) -> Words:
    motors = "".join(f'<motor name="m{number}" joint="j{number}"/>' for number in range(n))
    _model(_bodies(n, _HINGE), f"<actuator>{motors}</actuator>")
    return ["lint", "base.xml", "-q", "--ignore", "no-license"]


@case("lint: fixes of motors without names", 30)
def unnamed(n: int) -> Words:
    motors = "\n".join(f'<motor joint="j{number}"/>' for number in range(n))
    _model(_bodies(n, _HINGE), f"<actuator>{motors}</actuator>")
    return ["lint", "base.xml", "--fix", "-q", "--ignore", "no-license"]


@case("plan: parts", 40)
def plan(n: int) -> Words:
    _parts(n)
    return ["plan", "r.yaml"]


@case("tree: parts", 40)
def tree(n: int) -> Words:
    _parts(n)
    return ["tree", "r.yaml"]


@case("explain: one joint of many parts", 30)
def explain(n: int) -> Words:
    _parts(n)
    return ["explain", "r.yaml", "p1/j"]


@case("lock: parts of files of their own", 20)
def lock(n: int) -> Words:
    for number in range(n):
        Path(f"part{number}.xml").write_text(PART)
    _recipe(["attach:", *(f"  p{number}: {{model: ./part{number}.xml}}" for number in range(n))], start="recipe: 1\n")
    return ["lock", "r.yaml"]


@case("fix: keys that are misspelt", 20, exit_code=1)
def fix(n: int) -> Words:
    _model(_bodies(n, _HINGE))
    _recipe(["actuator:", *(f"  x{number}: {{type: motor, joint: j{number}, geer: 2}}" for number in range(n))])
    return ["fix", "r.yaml"]


@case("fmt: a recipe in another order", 80)
def fmt_recipe(n: int) -> Words:
    _model(_bodies(1))
    _recipe(["edit:", *(f"  - {{set: {{group: {number % 6}}},\n     select: {{geom: g0}}}}" for number in range(n))])
    return ["fmt", "r.yaml"]


@case("fmt: a model that is commented out", 100)
def fmt_model(n: int) -> Words:
    _model("\n".join(f"<!-- <geom size='{number}'/> -->" for number in range(n)) + _bodies(1))
    return ["fmt", "base.xml"]


def _build(*words: str) -> None:
    result = run("build", "r.yaml", "--no-cache", "-q", *words)
    assert result.exit_code == 0, result.stderr


@case("verify: parts", 20)
def verify(n: int) -> Words:
    _parts(n)
    _build("-o", "out.zip")
    return ["verify", "out.zip", "--recipe", "r.yaml"]


@case("diff: bodies that moved", 30, exit_code=1)
def diff(n: int) -> Words:
    _model(_bodies(n))
    Path("other.xml").write_text(Path("base.xml").read_text().replace(' 0">', ' 0.5">'))
    return ["diff", "base.xml", "other.xml"]


@case("names: joints", 40)
def names(n: int) -> Words:
    _model(_bodies(n, _HINGE))
    return ["names", "base.xml", "--json", "-o", "names.json"]


@case("view: geoms", 30)
def view(n: int) -> Words:
    _model(_bodies(n))
    return ["view", "base.xml", "--html", "page.html", "-q"]


@case("list: models of a matrix", 10)
def listed(n: int) -> Words:
    _model(_bodies(1))
    values = ", ".join(f"{number + 1}" for number in range(n))
    _recipe(
        ["params: {m: 1}", f"matrix: {{axes: {{m: [{values}]}}}}", "edit: [{select: {geom: g0}, set: {gap: '${m}'}}]"]
    )
    _build("--all", "-o", "out/{name}/", "--jobs", "1")
    return ["list", "out"]


@case("import: a merged model of parts", 10)
def imported(n: int) -> Words:
    Path("part.xml").write_text(PART)
    _parts(n)
    _build("-o", "out")
    return ["import", "out/model.xml", "part.xml", "-o", "made.yaml"]
