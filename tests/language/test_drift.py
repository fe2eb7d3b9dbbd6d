"""The tool and the JSON Schema refuse the same recipes, except for a written list of what JSON Schema cannot say.

Each line of `WRONG` has one mistake. A comment behind it says why the schema accepts it.
"""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from language.validating import validate
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.language.expand import expand
from mjcompose.language.variation import Grid, TrustKeys, read
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, to_python

jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
ROOT = Path(__file__).parents[2]
REASONS = {
    "order": "it compares no two numbers",
    "twice": "it compares no two values in different places",
    "angle": "whether a bare angle has a unit depends on `angle` at the top",
    "tag": "the attributes of a tag are a table of the compiled model, of which editors get no copy for each tag",
    "infinite": "JSON has no infinities, and for its validators they are numbers",
    "glob": "it does not know the syntax of regular expressions",
}
"""What JSON Schema cannot say, or says only at a price."""
CHECKS = r"""
3
{}
{severity: error}
{severity: loud, unchanged: {}}
{expct: {attr: nu, equals: 1}}
{size: {nu: 1}}
{expect: }
{expect: 3}
{expect: []}
{expect: {}}
{expect: {attr: nu}}                                                              # twice
{expect: {attr: nuu, equals: 1}}                                                  # tag
{expect: {attr: "nu[0]", equals: 1}}                                              # tag
{expect: {attr: nu, equals: [1, 2]}}                                              # tag
{expect: {attr: 3, equals: 1}}
{expect: {attr: nu, equals: 1, range: [1, 2]}}
{expect: {attr: nu, equals: []}}
{expect: {attr: nu, equals: many}}
{expect: {attr: nu, equal: 1}}
{expect: {attr: nu, equals: 1, tol: -1}}
{expect: {attr: nu, range: [2, 1]}}                                               # order
{expect: {attr: nu, range: [1]}}
{expect: {attr: nu, range: 1}}
{expect: {attr: nu, range: [1, true]}}
{expect: {attr: nu, range: [1, 2], tol: 1}}
{expect: {attr: nu, equals: 1, count: 1}}
{expect: {select: {}}}
{expect: {select: [{site: a}]}}
{expect: {select: {sites: a}}}
{expect: {select: {site: a, body: b}}}
{expect: {select: {site: ""}}}
{expect: {select: {site: 3}}}
{expect: {select: {site: "{a"}}}
{expect: {select: {site: "/(/"}}}                                                 # glob
{expect: {select: {site: a, class: b}}}
{expect: {select: {site: a, in: b}}}
{expect: {select: {site: a, in: {bodi: b}}}}
{expect: {select: {key: a, in: {body: b}}}}                                       # tag
{expect: {select: {geom: a, where: {}}}}
{expect: {select: {geom: a, where: {type: bo}}}}                                  # tag
{expect: {select: {site: a}, count: -1}}
{expect: {select: {site: a}, count: 1.5}}
{expect: {select: {site: a}, count: [2, 1]}}                                      # order
{expect: {select: {site: a}, count: [1, 2, 3]}}
{expect: {select: {site: a}, equals: 1}}
{expect: {select: {joint: a}, attr: dmping, equals: 1}}                           # tag
{settles: home}
{settles: {keys: home}}
{settles: {key: ""}}
{settles: {seconds: 0}}
{settles: {seconds: 1s}}
{settles: {seconds: .inf}}                                                        # infinite
{settles: {max_speed: -1}}
{settles: {near: home}}
{settles: {near: {key: home}}}
{clearance: {min: 1km}}
{clearance: {min: true}}
{clearance: {max: 0.001}}
{clearance: {key: []}}
{clearance: {except: [a]}}
{clearance: {except: [[a]]}}
{clearance: {between: [a]}}
{clearance: {between: [a, []]}}
{clearance: {between: a}}
{reachable: {site: tcp}}
{reachable: {target: [0, 0, 0]}}
{reachable: {site: tcp, target: [0, 0]}}
{reachable: {site: tcp, target: [0, 0, a]}}
{reachable: {site: tcp, target: [0, 0, 0], tolerance: 0}}
{reachable: {site: tcp, target: [0, 0, 0], tolerance: -1mm}}
{unchanged: all}
{unchanged: {part: 3}}
{unchanged: {excpt: [gravcomp]}}
{unchanged: {except: gravcomp}}
{unchanged: {except: [gravcom]}}                                                  # tag
{budget: {}}
{budget: {key: home}}
{budget: {face: 1}}
{budget: {bytes: 20XB}}
{budget: {bytes: -1}}
{budget: {steps_per_second: 0}}
{targets: 3}
{targets: []}
{targets: [mjxx]}
{targets: [mjx, mjx]}
{targets: [isaac]}                                                                # twice
{targets: {read: false}}
{targets: {in: [mjx], read: maybe}}
{targets: {in: [mjx], losses: none}}
{lint: joint-unactuated}
{lint: {select: joint-unactuated}}
{lint: {select: []}}
{lint: {select: [joint-unactuatd]}}
{lint: {select: [shape-off-mesh]}}
{lint: {select: {joint-unactuated: true}}}
{lint: {select: {joint-unactuated: {joints: a}}}}
{lint: {select: {shape-off-mesh: {mesh: a}}}}
{lint: {select: {inertia-implausible: {density: [9, 1]}}}}                        # order
{lint: {select: {key-out-of-range: {margin: -1}}}}
{lint: {select: [joint-unactuated], except: [key-out-of-range]}}                  # twice
{lint: {select: [joint-unactuated], except: [joint-unactuated]}}                  # twice
{lint: {except: {joint-unactuated: 3}}}
"""
FIELDS = r"""
{attr: margin, uniform: [0, 1]}
{select: {geom: a}, attr: margin}
{select: {geom: a}, attr: margin, uniform: [1, 0]}                                # order
{select: {geom: a}, attr: margin, uniform: [1]}
{select: {geom: a}, attr: margin, uniform: 3}
{select: {geom: a}, attr: margin, unifrm: [0, 1]}
{select: {geom: a}, attr: margin, uniform: [0, 1], normal: {mean: 0, std: 1}}
{select: {geom: a}, attr: margin, normal: {mean: 0, std: -1}}
{select: {geom: a}, attr: margin, choice: []}
{select: {geom: a}, attr: margin, uniform: [0, 1], per: elements}
{param: 3, uniform: [0, 1]}
"""
PARTS = r"""
{}
3
{model: ""}
{modle: ./x.xml}
{model: ./x.xml, sites: a}
{model: ./x.xml, site: a, body: b}
{model: ./x.xml, site: 3}
{model: ./x.xml, joint: fre}
{model: ./x.xml, keys: all}
{model: ./x.xml, pos: [0, 0]}
{model: ./x.xml, quat: [1, 0, 0, 0], euler: [0, 0, 0]}
{model: ./x.xml, euler: [90, 0, 0]}                                               # angle
{model: ./x.xml, replicate: [{cout: 3}]}
{model: ./x.xml, mirror: {of: a}}
{model: ./x.xml, mirror: {of: a, across: w}}
{model: ./x.xml, mirror: {of: a, across: y}, mate: b}
{model: ./x.xml, replicate: [{count: 0}]}
{model: ./x.xml, replicate: [{scatter: {count: 2, over: {site: top}}}, {count: 2}]}
{model: ./x.xml, pos: [0, 0, 1], replicate: [{scatter: {count: 2, over: top, clearance: 1cm, settle: 2s}}]}
{model: ./x.xml, replicate: [{scatter: {count: 2, over: {}}}]}
{model: ./x.xml, replicate: [{scatter: {count: 2, over: top, settle: 1min}}]}
{model: ./x.xml, drop: light}
"""
EDITS = r"""
{set: {damping: 1}}
{select: {joint: a}}
{select: {jont: a}, set: {damping: 1}}
{select: {joint: a}, sett: {damping: 1}}
{select: {joint: a}, set: {dampin: 1}}
{select: {joint: a}, scale: {damping: big}}
{select: {joint: a}, expect: -1, set: {damping: 1}}
{select: {geom: a}, move: {}}
{select: {geom: a}, move: {to: 3}}
{select: {geom: a}, move: {to: {fram: b}}}
{select: {geom: a}, move: {to: b, pos: [1]}}
{select: {body: a}, inertia: {from: mesh, density: 0}}
{select: {body: a}, inertia: {from: meshes, density: 1}}
{select: {joint: a}, remove: yes}
"""
WRONG = {
    "check: {a: %s}": CHECKS,
    "randomize: {seed: 1, samples: 1, fields: {f: %s}}": FIELDS,
    "attach: {a: %s}": PARTS,
    "edit: [%s]": EDITS,
}
LINES = [
    (around % line.partition("  #")[0].strip(), line.partition("  # ")[2].strip())
    for around, lines in WRONG.items()
    for line in lines.strip().splitlines()
]


@cache
def validator() -> Any:
    text = (ROOT / "schemas" / "recipe.schema.json").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(json.loads(text))


def judged(text: str) -> tuple[list[Diagnostic], bool]:
    """What the tool says of a recipe, and whether the schema accepts it."""
    sink = Sink()
    node = load(text, "recipe.yaml", sink)
    assert isinstance(node, Mapping) and not sink.errors, text
    value = to_python(node)
    for key, form in (("trust", TrustKeys), ("matrix", Grid)):
        if key in node.entries:
            read(form, value[key], node, at=(key,), sink=sink)
    validate(expand(node, {}, sink, any=True).document, sink)
    return sink.errors, bool(validator().is_valid(value))


@pytest.mark.parametrize(("line", "reason"), LINES, ids=[line for line, _ in LINES])
def test_both_refuse_it(line: str, reason: str) -> None:
    errors, accepted = judged(f"recipe: 1\n{line}\n")
    assert len(errors) == 1, [each.message for each in errors]
    assert not reason or reason in REASONS
    assert accepted == bool(reason)


# By what the tool says: what the schema cannot.
UNSEEN = re.compile(
    "starts with .* which is more than|is above the second|is below its|has [0-9]+ numbers, got"  # order
    "|all its numbers are zero|no section and no element ``|has no expected value|no rule left|does not run|no check reads models|is one of `.*, got text"  # twice
    "|can read|could be excepted|which is not an attribute|is never `|cannot say `|expects one number"  # tag
    "|row `.*` of parameter `|a value of `default` of .* is missing"  # tables
    r"|cannot be negative, and field|`[a-z]+\[[0-9]\]` of `[a-z]+` expects a number, got a list"  # tag
)
# What the schema sees in some places alone: attributes in `set` and not in `where`, angles with `angle` at the top.
SOMETIMES = re.compile("is not an attribute of|is an angle without a unit|has no default and must be given")
ODD: tuple[Any, ...] = (True, -1, 0, 1.5, "", "a", [], {}, [1, 2], ["a", "b"], {"a": 1}, None)


def good(section: str) -> list[Any]:
    """A section of the examples of the reference, which have each of its keys."""
    texts = (ROOT / "docs" / "examples" / "keys" / f"{section}.yaml").read_text(encoding="utf-8").split("---\n")
    recipes = [to_python(load(text, "recipe.yaml", Sink())) for text in texts]  # type: ignore[arg-type]
    return [recipe[section] for recipe in recipes if section in recipe]


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in items:
        yield (*path, key)
        if isinstance(each, dict | list):
            yield from places(each, (*path, key))


def plain(value: Any) -> Any:
    """The value without `when`, which is settled before the forms read it."""
    if isinstance(value, list):
        return [plain(each) for each in value]
    return {key: plain(each) for key, each in value.items() if key != "when"} if isinstance(value, dict) else value


def mistaken(section: str, value: Any, chance: random.Random) -> dict[str, Any]:
    """A recipe with one entry, in which one thing is misspelt, missing, superfluous or of another kind."""
    if isinstance(value, list):
        value = [chance.choice(value)]
    elif section not in ("randomize", "matrix", "trust"):
        name = chance.choice([*value])
        value = {name: value[name]}
    made = {"recipe": 1, section: plain(value)}
    *above, last = chance.choice([*places(made[section], (section,))])
    around: Any = made
    for step in above:
        around = around[step]
    how = chance.random()
    if how < 0.3 and isinstance(around, dict):
        around[f"{last}x"] = around.pop(last)
    elif how < 0.5:
        del around[last]
    elif how < 0.6 and isinstance(around, dict):
        around["more"] = chance.choice(ODD)
    else:
        around[last] = copy.deepcopy(chance.choice(ODD))
    return made


SECTIONS = ("check", "attach", "params", "randomize", "edit", "keyframe", "add", "matrix", "trust")


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("seed", range(2))
def test_mutations_of_good_recipes_are_judged_alike(section: str, seed: int) -> None:
    chance = random.Random(seed)
    sections = good(section)
    refused = 0
    for _ in range(200):
        text = json.dumps(mistaken(section, chance.choice(sections), chance))
        if "${" in text and section != "matrix":
            continue
        errors, accepted = judged(text)
        said = [each.message for each in errors if not UNSEEN.search(each.message)]
        if any(SOMETIMES.search(each) for each in said):
            continue
        assert accepted == (not said), (text, [each.message for each in errors])
        refused += bool(said)
    assert refused > 50
