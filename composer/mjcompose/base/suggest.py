"""The wording of "X does not exist", with the existing names and the probable one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from os.path import commonprefix
from typing import NamedTuple

from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Span
from mjcompose.base.words import plural

_SHOWN = 8
_PREFIX = re.compile(r"[/:.]")
_CLEAR = 0.8  # nearly one typo


def closest(name: str, candidates: Iterable[str], n: int = 1) -> list[str]:
    """Return at most `n` candidates that `name` probably means, the likeliest first.

    Handles typos (a missing, extra or wrong character, or two swapped), case, `-` for `_`, plurals, synonyms
    (`SYNONYMS`), a missing or superfluous prefix, and a missing end. Empty if nothing is similar.

    >>> closest("left_pad", ["gripper/left_pad", "gripper/right_pad"])
    ['gripper/left_pad']
    >>> closest("Sensors", ["sensor", "section"])
    ['sensor']
    >>> closest("colors", ["material", "rgba"])
    ['rgba']
    """
    return [candidate for _, _, candidate in _ranked(name, tuple(dict.fromkeys(candidates)))[:n]]


def clearly_meant(name: str, candidates: Iterable[str]) -> str | None:
    """Return the candidate most similar to `name`, unless another one is nearly as similar.

    >>> clearly_meant("elbw", ["elbow", "wrist"]), clearly_meant("joint3", ["joint1", "joint2"])
    ('elbow', None)
    """
    ranked = _ranked(name, tuple(dict.fromkeys(candidates)))[:2]
    if not ranked or (len(ranked) == 2 and ranked[1][0] - ranked[0][0] < _CLEAR):
        return None
    return ranked[0][2]


class _Word(NamedTuple):
    """A name as it is compared, with the bits of its letters; `bare` is the name without its prefixes."""

    text: str
    folded: str
    singular: str
    bare: str
    letters: int
    bare_letters: int


def _split(name: str) -> _Word:
    folded = _folded(name)
    bare = _PREFIX.split(folded)[-1]
    return _Word(name, folded, _singular(folded), bare, _letters(folded), _letters(bare))


def _letters(name: str) -> int:
    letters = 0
    for letter in name:
        letters |= 1 << (ord(letter) % 128)
    return letters


@lru_cache(maxsize=16)
def _split_all(candidates: tuple[str, ...]) -> tuple[_Word, ...]:
    return tuple(map(_split, candidates))


@lru_cache(maxsize=256)
def _ranked(name: str, candidates: tuple[str, ...]) -> tuple[tuple[float, int, str], ...]:
    """Return the distance, position and name of each likely candidate; one mistake may occur thousands of times."""
    written = _split(name)
    scores = ((_score(written, known), position, known.text) for position, known in _possible(written, candidates))
    return tuple(sorted((score, position, candidate) for score, position, candidate in scores if score is not None))


def _possible(written: _Word, candidates: tuple[str, ...]) -> list[tuple[int, _Word]]:
    """Return the position and the words of the candidates that `_score` may accept.

    Each edit accounts for at most one letter that the other word lacks. This excludes most candidates without a call:
    a renamed prefix makes thousands of names wrong, and each of them is compared with thousands of names.
    """
    limit = _tolerance(written.folded)
    bare_limit = _tolerance(written.bare)
    meant = _meant(written)
    return [
        (position, known)
        for position, known in enumerate(_split_all(candidates))
        if (
            (written.letters & ~known.letters).bit_count() <= limit
            and (known.letters & ~written.letters).bit_count() <= limit
        )
        or (
            (written.bare_letters & ~known.bare_letters).bit_count() <= bare_limit
            and (known.bare_letters & ~written.bare_letters).bit_count() <= bare_limit
        )
        or known.singular == written.singular
        or known.folded in meant
        or known.folded.startswith(written.folded)
    ]


def _meant(written: _Word) -> list[str]:
    """Return the names for which the word is a synonym."""
    return SYNONYMS.get(written.singular, SYNONYMS.get(written.folded, []))


def renaming(name: str, candidates: Iterable[str]) -> Fix | None:
    """Return the fix of a misspelled name, or None if several candidates are possible.

    >>> renaming("senser", ["sensor", "section"])
    Fix(replacement='sensor', replaces='senser', span=None)
    >>> renaming("pad", ["left/pad", "right/pad"])
    """
    meant = clearly_meant(name, candidates)
    return None if meant is None else Fix(meant, name)


def without_constant(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic that proposes no constant for a value that a template computes.

    The value differs between models of a recipe, so a constant would make them equal.

    >>> span = Span("a.yaml", 1, 7, 1, 16, "${side}_elbw")
    >>> without_constant(Diagnostic("unknown-name", "no", span, fix=Fix("left_elbow", "left_elbw"))).help
    'change the template `${side}_elbw` or a value in it: here it must give `left_elbow`'
    """
    fix = diagnostic.fix
    span = diagnostic.span if fix is None or fix.span is None else fix.span
    template = None if span is None else span.template
    if template is None:
        return diagnostic
    shown = template if len(template) <= _LONGEST and "\n" not in template else "${…}"
    if diagnostic.code == "bare-angle":
        help = f"give the value of `{shown}` a unit, as in `10deg`, or set `angle` at the top of the recipe"
        return replace(diagnostic, fix=None, help=help)
    if fix is None:
        return diagnostic
    help = f"change the template `{shown}` or a value in it: here it must give `{fix.replacement}`"
    return replace(diagnostic, fix=None, help=help)


_LONGEST = 60


def advised(name: str, candidates: Iterable[str]) -> tuple[str | None, Fix | None]:
    """Return the help for a misspelled word, and its fix if only one candidate is possible.

    >>> advised("gem", ["geom", "site"])
    ('write `geom`', Fix(replacement='geom', replaces='gem', span=None))
    """
    known = list(candidates)
    near = closest(name, known)
    return (f"write `{near[0]}`", renaming(name, known)) if near else (None, None)


def did_you_mean(name: str, candidates: Iterable[str], written: str = "{}") -> str | None:
    """Return the help with the candidate most similar to a name, formatted with `written`; None if none is similar.

    >>> did_you_mean("senser", ["sensor", "section"], "type: {}")
    'did you mean `type: sensor`?'
    """
    near = closest(name, candidates)
    return f"did you mean `{written.replace('{}', near[0])}`?" if near else None


def exists_note(kind: str, candidates: Iterable[str], near: str | None = None) -> Note:
    """Return a note that lists the existing names, cut if it is long. With `near`, the most similar names come first.

    `kind` is a singular noun.

    >>> exists_note("body", ["base", "link1"]).message
    'bodies that exist: base, link1'
    >>> exists_note("joint", []).message
    'there are no joints'
    """
    names = list(dict.fromkeys(candidates))
    kinds = plural(kind)
    if not names:
        return Note(f"there are no {kinds}")
    if near is not None and len(names) > _SHOWN:
        names = list(dict.fromkeys([*closest(near, names, _SHOWN), *names]))
    listed = ", ".join(each if re.fullmatch(r"[^\s,`]+", each) else f"`{each}`" for each in names[:_SHOWN])
    if len(names) > _SHOWN:
        listed += f", … ({len(names)} in all)"
    return Note(f"{kinds} that exist: {listed}")


def _score(written: _Word, known: _Word) -> float | None:
    """Return how far a candidate is from the written name: 0 is equal; None is not similar."""
    score = _score_of_same_word(written, known)
    if score is not None:
        return score
    if len(written.folded) == len(known.folded) == 2:  # a different letter makes a different word
        return 1.0 if written.folded == known.folded[::-1] else None
    distance = _distance(written.folded, known.folded, _tolerance(written.folded))
    if distance is not None:
        return 1.0 + distance
    if _is_prefixed(written, known) and written.bare and known.bare:
        distance = _distance(written.bare, known.bare, _tolerance(written.bare))
        if distance is not None:
            return 1.5 + distance
    return 6.0 if len(written.folded) > 3 and known.folded.startswith(written.folded) else None


def _score_of_same_word(written: _Word, known: _Word) -> float | None:
    """Return the score of two spellings of a word, with or without a prefix; None if the words are different."""
    if written.text == known.text:
        return 0.0
    if written.folded == known.folded:
        return 0.1
    if written.singular == known.singular:
        return 0.2
    meant = _meant(written)
    if known.folded in meant:
        return 0.3 + 0.01 * meant.index(known.folded)
    if written.bare and _is_prefixed(written, known):
        shorter, longer = sorted((written.folded, known.folded), key=len)
        if longer.endswith(shorter) and longer[-len(shorter) - 1] in "/:.":
            return 0.3
        if written.bare == known.bare:
            return 0.5
    return None


def _is_prefixed(written: _Word, known: _Word) -> bool:
    return written.bare != written.folded or known.bare != known.folded


def _folded(name: str) -> str:
    return name.casefold().replace("-", "_").strip()


def _singular(word: str) -> str:
    if len(word) > 4 and word.endswith("ies"):
        return word[:-3] + "y"
    if len(word) > 4 and word.endswith(("ses", "xes", "shes", "ches")):
        return word[:-2]
    return word[:-1] if len(word) > 2 and word.endswith("s") and not word.endswith("ss") else word


def _tolerance(word: str) -> int:
    return 0 if len(word) < 2 else 1 if len(word) < 6 else 2 if len(word) < 9 else 3


def _distance(a: str, b: str, limit: int) -> int | None:
    """Return the number of edits from `a` to `b`, with swapped neighbors as one; None if more than `limit`."""
    if abs(len(a) - len(b)) > limit:
        return None
    # Common prefixes and suffixes cost nothing, and names of one model have long ones.
    head = len(commonprefix((a, b)))
    a = a[head:]
    b = b[head:]
    tail = len(commonprefix((a[::-1], b[::-1])))
    a = a[: len(a) - tail]
    b = b[: len(b) - tail]
    # Each edit accounts for at most one letter that the other word lacks: a cheap bound for most candidates.
    if len(set(a) - set(b)) > limit or len(set(b) - set(a)) > limit:
        return None
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, left in enumerate(a, 1):
        above = before
        before = row
        row = [i]
        for j, right in enumerate(b, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (left != right))
            if i > 1 and j > 1 and left == b[j - 2] and a[i - 2] == right:
                cost = min(cost, above[j - 2] + 1)
            row.append(cost)
        if min(row) > limit and (not before or min(before) > limit):
            return None
    return row[-1] if row[-1] <= limit else None


_BY_NAME: dict[str, str] = {
    # attributes of MJCF
    "rgba": "color color rgb diffuse_color tint alpha opacity transparency",
    "pos": "position translation xyz location origin offset coordinate",
    "quat": "rotation orientation quaternion rot",
    "euler": "rpy rotation orientation euler_angle rotate",
    "size": "radius diameter dimension dim extent half_size halfsize half_extent box_size",
    "type": "shape geometry kind primitive",
    "range": "limit joint_limit bound lower_limit upper_limit lower upper",
    "ctrlrange": "limit control_range control_limit ctrl_range range",
    "forcerange": "effort max_force maxforce force_limit max_torque torque_limit effort_limit",
    "actuatorfrcrange": "effort max_force maxforce force_limit max_torque torque_limit effort_limit",
    "file": "filename path uri url src mesh_file",
    "stiffness": "spring spring_constant spring_stiffness",
    "damping": "damper viscous_friction",
    "frictionloss": "friction dry_friction coulomb_friction",
    "armature": "rotor_inertia reflected_inertia",
    "mass": "weight",
    "diaginertia": "inertia moment_of_inertia",
    "fovy": "fov field_of_view",
    "gear": "gear_ratio transmission_ratio",
    "kp": "gain p_gain stiffness proportional_gain",
    "kv": "d_gain damping_gain derivative_gain",
    "timestep": "dt time_step step_size",
    "axis": "direction rotation_axis",
    "dir": "direction",
    "childclass": "default_class defaults",
    "class": "default_class defaults dclass",
    "contype": "collision collide collision_group",
    "name": "id identifier",
    # keys of a recipe
    "model": "file path xml source src url uri mjcf urdf",
    "body": "parent parent_body link",
    "site": "mount attach_to to on at parent_site",
    "mate": "child_site own_site",
    "with": "param parameter arg argument value",
    "drop": "remove exclude without omit ignore",
    "edit": "modify patch override change overlay",
    "attach": "part component attachment child",
    "keys": "keyframe",
    "base": "warning",
    "mujoco": "merge",
    "none": "weld welded",
    "extends": "extend inherit inherits parent import",
    "params": "variable parameter arg argument",
    "matrix": "sweep grid",
    "check": "test assert assertion verify expect",
    "keyframe": "key pose home",
    "randomize": "randomize randomization randomisation domain_randomization",
    "recipe": "version",
    "angle": "unit angle_unit",
    "replicate": "repeat copy",
    "freejoint": "free floating",
}
"""Other words for a name that exists here, in singular and with `_`. Several names may share a word."""

SYNONYMS: dict[str, list[str]] = {}
"""The names that a word may mean, in the order of the table."""
for _name, _words in _BY_NAME.items():
    for _word in _words.split():
        SYNONYMS.setdefault(_word, []).append(_name)


def unknown_name(
    kind: str,
    name: str,
    known: Iterable[str],
    span: Span | None = None,
    *,
    purpose: str = "",
    message: str | None = None,
    written: str = "{}",
    help: str | None = None,
    otherwise: str | None = None,
    notes: Iterable[Note] = (),
    about: Iterable[str] = (),
    fix: Fix | None = None,
) -> Diagnostic:
    """Return the diagnostic for a name that no `body` or other kind has; `known` are the names that exist.

    `purpose` continues the sentence, `message` replaces it. `written` is the format of the name in the file. `help`
    and `fix` replace the suggestion, `otherwise` is the help if no name is similar. `notes` follow the note with
    the existing names, and `about` are further subjects.

    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to", written="site: {}").help
    'did you mean `site: tip`?'
    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to").message
    'the site `tpi` to attach `a` to does not exist'
    """
    known = list(known)
    return Diagnostic(
        "unknown-name",
        message or f"the {kind} `{name}`{purpose} does not exist",
        span,
        notes=(exists_note(kind, known, name), *notes),
        help=help or did_you_mean(name, known, written) or otherwise,
        subjects=frozenset((name, *about)),
        fix=fix if help else renaming(name, known),
    )


def unknown_attribute(
    name: str,
    owner: str,
    known: Iterable[str],
    span: Span | None = None,
    *,
    help: str | None = None,
    otherwise: str | None = None,
    near: Iterable[str] = (),
) -> Diagnostic:
    """Return the diagnostic for an attribute that the kind `owner` lacks. `near` are further suggestions."""
    known = list(known)
    likely = [*known, *near]
    notes = (exists_note("attribute", known, name),) if known else ()
    fix = None if help else renaming(name, likely)
    help = help or did_you_mean(name, likely) or otherwise
    message = f"`{name}` is not an attribute of {owner}"
    return Diagnostic("unknown-attribute", message, span, notes=notes, help=help, fix=fix)
