"""Verb `collision`: replace meshes in collisions by convex shapes that are made of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.language.form import EXCLUSIVE, Schema, kind_of, or_template, reference, shown, unknown_key
from mjcompose.language.verbs.values import Selected, Verb, read_mapping

FITS = ("box", "sphere", "capsule", "cylinder", "best")
EXAMPLE = "{hull: {}}"
_EXAMPLES = {"count": 16, "faces": 500}


@dataclass(frozen=True, slots=True)
class Setting:
    """A number of a method: its default (None for no limit), and its least value."""

    about: str
    default: float | None
    least: float
    most: float = 1e9
    whole: bool = True


@dataclass(frozen=True, slots=True)
class Method:
    """A way to make shapes. `settings` is empty for `fit`, whose value is a word."""

    about: str
    settings: Mapping[str, Setting]
    needed: tuple[str, ...] = ()


_SEED = Setting("of what is chosen at random (default: 0)", 0, 0)
METHODS: dict[str, Method] = {
    "hull": Method(
        "the convex hull",
        {"vertices": Setting("the most vertices (default: no limit)", None, 4, most=10_000)},
    ),
    "fit": Method("one primitive around the mesh; `best` is the one of the least volume", {}),
    "decompose": Method(
        "convex pieces, by CoACD",
        {
            "parts": Setting("the most pieces (default: no limit)", None, 1, most=1000),
            "threshold": Setting(
                "how concave a piece may stay, by CoACD's measure (default: 0.05)",
                0.05,
                0.01,
                most=1,
                whole=False,
            ),
            "vertices": Setting("the most vertices of a piece (default: 256)", 256, 4, most=10_000),
            "seed": _SEED,
        },
    ),
    "spheres": Method(
        "balls that cover the surface",
        {"count": Setting("how many", None, 1, most=1000), "seed": _SEED},
        needed=("count",),
    ),
}


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("collision", value, EXAMPLE, selected=selected)
    if given is None:
        return {}
    if selected.kinds and any(kind.path != "geom" for kind in selected.kinds):
        message = f"`collision` is for geoms, and `{selected.tag}` is not one"
        selected.add(Fault("wrong-type", message, selected.at, help="select the geoms of the meshes"))
        return {}
    unknown = [name for name in given if name not in METHODS]
    for name in unknown:
        help, fix = advised(name, METHODS)
        note = exists_note("method", METHODS, name)
        message = f"`{name}` is not a way to make collision shapes"
        selected.add(
            Fault("unknown-key", message, (*selected.at, name), key=True, notes=(note,), help=help, fix=fix)
        )
    method, *others = [name for name in given if name in METHODS] or [""]
    if others:
        message = f"`collision` has both `{method}` and `{others[0]}`, of which only one may stand"
        selected.add(Fault(EXCLUSIVE, message, (*selected.at, others[0]), key=True))
    if unknown or others or not method:
        return {}
    at = (*selected.at, method)
    if method == "fit":
        return (
            {} if (word := _word(given[method], at, selected)) is None else {"method": method, "wanted": word}
        )
    wanted = read_settings(given[method], method, METHODS[method], at=at, add=selected.add)
    return {} if wanted is None else {"method": method, "wanted": wanted}


def _word(value: Any, at: Path, selected: Selected) -> str | None:
    if value in FITS:
        return str(value)
    near = closest(value, FITS) if isinstance(value, str) else []
    selected.add(
        Fault(
            "wrong-keyword",
            f"`fit` is one of the primitives, got {kind_of(value)}",
            at,
            notes=(exists_note("primitive", FITS, str(value)),),
            help=f"write `fit: {near[0] if near else 'best'}`",
        )
    )
    return None


def read_settings(
    value: Any, name: str, method: Method, at: Path, add: Callable[[Fault], None]
) -> dict[str, Any] | None:
    """Return the settings of a method with their defaults, or None after a reported fault."""
    example = ", ".join(f"{key}: {_EXAMPLES[key]}" for key in method.needed)
    if not isinstance(value, dict):
        message = f"`{name}` expects a mapping, got {kind_of(value)}"
        add(Fault("wrong-type", message, at, help=f"write `{name}: {{{example}}}`"))
        return None
    right = True
    for key in value:
        if key not in method.settings:
            add(unknown_key(f"`{key}` is not a key of `{name}`", key, tuple(method.settings), at=(*at, key)))
            right = False
    for key in method.needed:
        if key not in value:
            message = f"`{name}` lacks `{key}`"
            add(Fault("missing-key", message, at, help=f"write `{name}: {{{example}}}`", lacks=key))
            right = False
    for key, setting in method.settings.items():
        if key in value and (fault := _number_fault(value[key], key, setting, at=(*at, key))) is not None:
            add(fault)
            right = False
    wanted = {key: value.get(key, setting.default) for key, setting in method.settings.items()}
    return wanted if right else None


def _number_fault(value: Any, name: str, setting: Setting, at: Path) -> Fault | None:
    kind = "a whole number" if setting.whole else "a number"
    types: tuple[type, ...] = (int,) if setting.whole else (int, float)
    if isinstance(value, bool) or not isinstance(value, types):
        return Fault("wrong-type", f"`{name}` expects {kind}, got {kind_of(value)}", at)
    assert isinstance(value, int | float)
    if not setting.least <= value <= setting.most:
        message = f"`{name}` is {shown(setting.least)} to {shown(setting.most)}, got {shown(value)}"
        return Fault("out-of-range", message, at)
    return None


def _words(value: Mapping[str, Any]) -> str:
    return f"collide with {in_words(value['method'], value['wanted'])}"


def in_words(method: str, wanted: Any) -> str:
    """Return a method and its settings as in plans and manifests.

    >>> in_words("decompose", {"parts": 8, "threshold": 0.05, "vertices": None, "seed": 1})
    'decompose (parts 8, threshold 0.05, seed 1)'
    """
    if isinstance(wanted, str):
        return f"{method} {wanted}"
    written = [f"{name} {shown(value)}" for name, value in wanted.items() if value is not None]
    return f"{method} ({', '.join(written)})" if written else method


def settings_schema(method: Method) -> Schema:
    properties = {
        name: {
            **reference("integer" if setting.whole else "number"),
            "minimum": setting.least,
            "maximum": setting.most,
            "description": setting.about,
        }
        for name, setting in method.settings.items()
    }
    schema: Schema = {
        "type": "object",
        "description": method.about,
        "properties": properties,
        "additionalProperties": False,
    }
    return {**schema, "required": [*method.needed]} if method.needed else schema


def _schema() -> Schema:
    properties = {
        name: settings_schema(method)
        if method.settings
        else or_template({"enum": [*FITS], "description": method.about})
        for name, method in METHODS.items()
    }
    return {
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "minProperties": 1,
        "maxProperties": 1,
    }


VERB = Verb(
    "collision",
    "convex shapes for what it touches with, made of its mesh",
    _read,
    words=_words,
    changes=None,
    schema=_schema,
)
