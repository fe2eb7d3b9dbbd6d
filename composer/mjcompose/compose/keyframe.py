"""Step: write the recipe's keys, from values by the names of joints, actuators and mocap bodies."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import field, replace
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.suggest import closest, did_you_mean, exists_note, renaming, unknown_name
from mjcompose.base.words import value_text
from mjcompose.compose.actuators import ControlUnits
from mjcompose.compose.elements import ElementBuilder, pose_number, turned
from mjcompose.compose.key_names import entries_by_name, is_glob_of
from mjcompose.compose.load import FINISHED, keep_finished
from mjcompose.language.keyframe import CTRL, FROM, JOINT, TIME, VECTORS, WAYS, Entry
from mjcompose.language.value import Single, no_angle
from mjcompose.link import numbers
from mjcompose.link.expansion import Copy, element_of
from mjcompose.link.key_layout import BLOCK, KeyLayout, Slot
from mjcompose.link.keyframes import part_keys
from mjcompose.link.linking import Linking, WrittenKey
from mjcompose.link.measure import without_void
from mjcompose.link.unit_keys import final_layout, keys_of
from mjcompose.mujoco import engine
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import WriteKeyframe
from mjcompose.sources.context import Context
from mjcompose.text.expression import Angle
from mjcompose.text.node import find, locate
from mjcompose.tree import journal
from mjcompose.tree.classes import through_frames
from mjcompose.tree.journal import because
from mjcompose.tree.names import may_be_generated, word
from mjcompose.tree.pattern import BadPattern, is_pattern
from mjcompose.tree.unit import KeySource, KeyValues, Number, numbers_of, taken, texts

_Holder = tuple[Node, Slot | None]
"""A joint, an actuator or a mocap body; the slot is None for an element that always has the same width."""
_JOINTS = ("joint", "freejoint")
_QUANTITIES = "a position, velocity or force"
_WITHOUT_ANGLES = ("slide", "ball", "free")  # the orientation of a ball is a quaternion
_LINEAR_NUMBERS = {"slide": 1, "free": 3}
"""How many numbers of a velocity come before those that are angular."""
_MEANT = {
    ("free", "qpos"): "position and quaternion, `[x, y, z, w, a, b, c]`",
    ("free", "qvel"): "linear and angular velocity, `[x, y, z, a, b, c]`",
    ("ball", "qpos"): "a quaternion, `[w, a, b, c]`",
    ("ball", "qvel"): "an angular velocity, `[a, b, c]`",
}


def write_keyframes(plan: Plan, linking: Linking, making: ElementBuilder) -> None:
    """Resolve the names in the keys of the recipe. The linker lays them out with the keys of the parts."""
    if not plan.keyframes or (layout := final_layout(linking)) is None:
        return
    own = [node for node in layout.actuators if not isinstance(node, Copy) and node.tag != "attach"]
    mocaps = [node for node in layout.mocaps if not isinstance(node, Copy) and node.tag == "body"]
    holders: dict[str, dict[str, _Holder]] = {
        "joint": _joints(layout),
        "actuator": {_name(node): (node, layout.actuators[node]) for node in own if _name(node)},
        "mocap body": {_name(node): (node, None) for node in mocaps if _name(node)},
    }
    unnamed = [node for node in own if not _name(node)]
    parts = frozenset(plan.part_names)
    types = {name: slot.kind for name, (_, slot) in holders["joint"].items() if slot is not None}
    in_doubt = making.sink.has_errors
    units = ControlUnits(linking, making.sink, types, in_doubt=in_doubt)
    for step in plan.keyframes:
        writer = _KeyWriter(
            step,
            linking,
            making,
            holders=holders,
            parts=parts,
            units=units,
            in_doubt=in_doubt,
            unnamed=unnamed,
            actuators=layout.actuators,
        )
        linking.keys.written.append(writer.key())


def _joints(layout: KeyLayout) -> dict[str, _Holder]:
    """Return the joints by name. An unnamed joint that is the only joint of its body has the name of the body."""
    named = {_name(element_of(joint)) for joint in layout.joints}
    found: dict[str, _Holder] = {}
    for joint, slot in layout.joints.items():
        if slot.kind == BLOCK or isinstance(joint, Copy):
            continue
        if not (name := _name(joint)):
            body = next(joint.iterancestors("body"))
            name = _name(body)
            if name in named or [each for each in through_frames(body) if each.tag in _JOINTS] != [joint]:
                continue
        found[name] = (joint, slot)
    return found


def _passed_on(key: KeyValues, span: Span, void: Collection[Node]) -> KeyValues:
    """Return the key with a mark on each number that the `from` entry at `span` passed on, unless it is `void`."""
    values = {
        vector: {holder: taken(row, span) for holder, row in columns.items()} for vector, columns in key.values.items()
    }
    without_void(values, void)
    return replace(key, values=values, time=None if key.time is None else taken([key.time], span)[0])


def _name(node: Node) -> str:
    return str(node.get("name") or "")


def _joint_of(actuator: Node) -> str | None:
    return actuator.get("joint") or actuator.get("jointinparent")


class _Claim(Struct):
    """An entry of a key for one element: numbers, or None for the control that holds the pose.

    `name` is the name of the element, or of the joint that a control goes by. `path` is the place of the entry below
    its vector, and ends in a name or a glob.
    """

    name: str
    holder: _Holder
    entry: Entry | None
    path: tuple[str, ...]

    @property
    def by_joint(self) -> bool:
        return len(self.path) > 1

    @property
    def is_glob(self) -> bool:
        return self.path[-1] != self.name

    def is_like(self, other: _Claim) -> bool:
        """Whether both write the same."""
        return self.entry == other.entry and self.by_joint == other.by_joint


def _driven_note(joints: Iterable[str]) -> Note:
    return Note(f"joints with an actuator: {', '.join(dict.fromkeys(joints)) or 'none'}")


class _KeyWriter(Struct, frozen=False):
    step: WriteKeyframe
    linking: Linking
    making: ElementBuilder
    holders: Mapping[str, Mapping[str, _Holder]]
    parts: frozenset[str]
    units: ControlUnits
    in_doubt: bool
    """Whether the model may lack elements because of earlier errors."""
    unnamed: Sequence[Node]
    actuators: Mapping[Any, Slot]
    values: dict[str, dict[Node, list[Number]]] = field(default_factory=dict)
    noted: WrittenKey = field(init=False)

    def key(self) -> KeyValues:
        recipe_key = self.step.key
        making = self.making
        linking = self.linking
        element = etree.Element("key")
        making.origins.own(element, self._written)
        time = None
        if recipe_key.time is not None:
            time = Number(numbers.text([recipe_key.time]), KeySource("entry", TIME, span=self._at(TIME)))
        key = KeyValues(recipe_key.name, time, element, file=making.file, origins=making.origins, values=self.values)
        sources = self._sources()
        elements = tuple(source.element for source in sources)
        void = frozenset(linking.keys.void_keys)
        self.noted = linking.keys.noted[element] = WrittenKey(elements, void)
        for source in sources:
            for vector, columns in source.values.items():
                self.values.setdefault(vector, {}).update(columns)
            if recipe_key.time is None and source.time is not None:
                self._take_time(key, source)
        if recipe_key.controls.hold is not None:
            for holder in self.actuators.items():
                self._hold(holder, ("hold",))
        for vector, entries in recipe_key.values.items():
            for claim in self._settled(vector, self._claims(vector, entries)):
                self._take(vector, claim)
        return key

    def _take(self, vector: str, claim: _Claim) -> None:
        """Write the numbers of an element, or reserve the control that holds the pose."""
        if claim.entry is None:
            self._hold(claim.holder, claim.path)
        elif claim.by_joint:
            self._place_at_joint(claim.name, claim.holder, claim.entry, path=claim.path)
        else:
            self._place(vector, claim.name, claim.holder, entry=claim.entry, path=claim.path)

    def _claims(self, vector: str, entries: Mapping[str, Entry]) -> list[_Claim]:
        """Return the claims of the entries of a vector. Report names that do not exist, and globs that fit none."""
        kind = VECTORS[vector]
        holders = self.holders[kind]
        if vector != CTRL:
            names = self._names(vector, (), entries, holders, kind)
            return [_Claim(name, holders[name], entries[entry], (entry,)) for name, entry in names]
        controls = self.step.key.controls
        by_actuator = {path[0]: None for path in controls.held if len(path) == 1} | dict(entries)
        by_joint = {path[1]: None for path in controls.held if len(path) > 1} | dict(controls.joints)
        names = self._names(vector, (), by_actuator, holders, kind)
        claims = [_Claim(name, holders[name], by_actuator[entry], (entry,)) for name, entry in names]
        own = (node for node in self.actuators if not isinstance(node, Copy))
        driven = dict.fromkeys(joint for node in own if (joint := _joint_of(node)))
        for joint, entry in self._names(vector, (JOINT,), by_joint, driven, "joint with an actuator"):
            if (actuator := self._of_joint(joint, (JOINT, entry))) is not None:
                claims.append(_Claim(joint, actuator, by_joint[entry], (JOINT, entry)))
        return claims

    def _names(
        self, vector: str, above: tuple[str, ...], written: Collection[str], names: Collection[str], kind: str
    ) -> Iterator[tuple[str, str]]:
        """Yield each name that entries set, with the entry. Report globs that fit none of the names of the kind.

        The entries are written at `above`, below the vector. A name that does not exist is reported, or yielded if
        another method reports it.
        """
        separator = self.linking.request.separator
        for entry in written:
            if not is_glob_of(entry, names):
                if entry in names or above:
                    yield entry, entry
                else:
                    self._unknown(vector, entry)
                continue
            try:
                fitting = list(entries_by_name([entry], names, separator))
            except BadPattern as error:
                self.making.sink.error("selector", str(error), self._at(vector, *above, entry, key=True))
                continue
            if not fitting and not self.in_doubt:
                message = f"`{entry}` in `{vector}` fits no {kind}"
                note = exists_note(kind, names, entry) if not above else _driven_note(names)
                span = self._at(vector, *above, entry, key=True)
                self.making.sink.error("selector", message, span, notes=(note,), subjects=(entry,))
            yield from ((name, entry) for name in fitting)

    def _settled(self, vector: str, claims: Sequence[_Claim]) -> list[_Claim]:
        """Return the claims that count: names win over globs. Report globs that say different things of an element."""
        named = {claim.holder[0] for claim in claims if not claim.is_glob}
        by_glob: dict[Node, _Claim] = {}
        reported: set[tuple[tuple[str, ...], tuple[str, ...]]] = set()
        for claim in claims:
            if not claim.is_glob or claim.holder[0] in named:
                continue
            other = by_glob.setdefault(claim.holder[0], claim)
            if not claim.is_like(other) and (other.path, claim.path) not in reported:
                reported.add((other.path, claim.path))
                self._two_globs(vector, other, claim)
        return [*by_glob.values(), *(claim for claim in claims if not claim.is_glob)]

    def _two_globs(self, vector: str, one: _Claim, other: _Claim) -> None:
        message = f"`{one.path[-1]}` and `{other.path[-1]}` both set `{vector}` of `{other.name}`"
        notes = (Note("the other entry", self._at(vector, *one.path, key=True)),)
        help = f"write `{other.name}` itself, which wins over globs"
        span = self._at(vector, *other.path, key=True)
        self.making.sink.error("name-clash", message, span, notes=notes, help=help, subjects=(other.name,))

    def _hold(self, holder: tuple[Any, Slot | None], path: tuple[str, ...]) -> None:
        """Reserve a control that holds the pose. Its value is known when the key is laid out."""
        actuator, slot = holder
        way = self.step.key.controls.hold or "positions"
        span = self._at(CTRL, *path)
        width = 1 if slot is None else slot.widths[0]
        source = KeySource("entry", CTRL, span=span, hold=way)
        self.values.setdefault(CTRL, {})[actuator] = [Number("0", source, at) for at in range(width)]
        self.noted.held[element_of(actuator)] = span

    def _of_joint(self, joint: str, path: tuple[str, ...]) -> _Holder | None:
        """Return the actuator that a joint name selects: the only one of the joint, or its only position servo.

        `path` is the place of the entry below `ctrl`.
        """
        own = [(node, slot) for node, slot in self.actuators.items() if not isinstance(node, Copy)]
        acting = [each for each in own if joint in (each[0].get("joint"), each[0].get("jointinparent"))]
        if len(acting) > 1:
            servos = [each for each in acting if self.units.is_position(each[0])]
            acting = servos if len(servos) == 1 else acting
        if len(acting) == 1:
            return acting[0]
        help: str | None
        if acting:
            named = [f"`{_name(node)}`" for node, _ in acting if _name(node)]
            message = f"{len(acting)} actuators act on the joint `{joint}`"
            notes = [Note(f"those with a name: {', '.join(named)}")] if named else []
            help = "write the name of the actuator: `ctrl: {ACTUATOR: …}`"
        else:
            driven = [str(end) for node, _ in own if (end := _joint_of(node))]
            exists = self.linking.names.find("joint", joint) is not None
            message = f"the joint `{joint}` has no actuator" if exists else f"the joint `{joint}` does not exist"
            notes = [_driven_note(driven)]
            help = did_you_mean(joint, driven) if not exists else "write the actuator by its name"
        span = self._at(CTRL, *path, key=True)
        self.making.sink.error("unknown-name", message, span, notes=notes, help=help, subjects=(joint,))
        return None

    def _written(self, attribute: str | None) -> Span:
        path = (*self.step.key.at, attribute or "")
        if attribute is None or find(self.making.document, path) is None:
            return self.step.span
        return locate(self.making.document, path)

    def _at(self, *path: str, key: bool = False) -> Span:
        return locate(self.making.document, (*self.step.key.at, *path), key=key)

    def _sources(self) -> list[KeyValues]:
        """Return the keys that `from` names. Keys of a part follow the keys of the part that contains it."""
        known = part_keys(self.linking)
        sources: list[tuple[int, KeyValues]] = []
        for part, name in self.step.key.sources.items():
            keys = known.get(part)
            span = self._at(FROM, part)
            key = keys.named(name) if keys is not None else None
            if keys is not None and key is not None:
                sources.append((keys.depth, _passed_on(key, span, self.linking.keys.void_keys)))
            elif part in self.parts:  # the plan reports other names
                names = keys.names if keys is not None else []
                message = f"`{part}` has no key `{name}`"
                written = f"{part}: {{}}"
                self.making.sink.add(
                    unknown_name("key", name, names, span=span, message=message, written=written, about=(part,))
                )
        return [key for _, key in sorted(sources, key=lambda each: each[0])]

    def _take_time(self, key: KeyValues, source: KeyValues) -> None:
        assert source.time is not None
        if key.time is None:
            key.time = source.time
        elif numbers.read(key.time.text) != numbers.read(source.time.text):
            times = f"{key.time.text} and {source.time.text}"
            message = f"the keys in `{FROM}` of `{key.name}` have different times: {times}"
            notes = (Note("the second time is here", source.span(TIME)),)
            help = f"write the time of the key: `{TIME}: {source.time.text}`"
            span = self._at(FROM, key=True)
            self.making.sink.error("keyframe-conflict", message, span, notes=notes, help=help, subjects=(key.name,))

    def _place(self, vector: str, name: str, holder: _Holder, entry: Entry, path: tuple[str, ...]) -> None:
        """Write the numbers of an entry. `path` is the place of the entry below its vector."""
        node, slot = holder
        if not self._has_width(vector, name, slot, entry=entry, path=path):
            return
        meant = self._meant(vector, name, node, slot=slot, width=len(entry))
        values = [
            pose_number(value) if words is None else self._angle(vector, value, words, path=path)
            for value, words in zip(entry, meant, strict=True)
        ]
        self._refuse_angles(vector, name, holder, entry=entry, meant=meant, path=path)
        self._write(vector, node, values, path=path)

    def _place_at_joint(self, joint: str, holder: _Holder, entry: Entry, path: tuple[str, ...]) -> None:
        """Write the controls of the actuator of a joint, from numbers on the joint's side of the gear."""
        node, slot = holder
        if self.units.are_unknown:
            self._place("ctrl", joint, holder, entry=entry, path=path)
            return
        if not self._has_width("ctrl", joint, slot, entry=entry, path=path):
            return
        scales = self.units.at_joint(node)
        if scales is None or len(scales) != len(entry):
            self._no_quantity(joint, node, path=path)
            return
        values = []
        for value, (scale, words) in zip(entry, scales, strict=True):
            if words is not None:
                words = f"`ctrl` of the joint `{joint}` is {words}"
                number = self._angle("ctrl", value, words, path=path)
            else:
                number = self._without_angle(joint, value, scale.quantity, path=path)
            values.append(scale.control(number))
        self._write("ctrl", node, values, path=path, joint=joint)

    def _write(
        self, vector: str, node: Node, values: list[float], path: tuple[str, ...], joint: str | None = None
    ) -> None:
        span = self._at(vector, *path)
        source = KeySource("entry", vector, span=span, joint=joint)
        self.noted.entries.setdefault(vector, {})[node] = (values, span)
        row = [Number(text, source, at) for at, text in enumerate(numbers.text(values).split())]
        self.values.setdefault(vector, {})[node] = row

    def _no_quantity(self, joint: str, actuator: Node, path: tuple[str, ...]) -> None:
        """Report an actuator whose control is nothing that the joint has."""
        name = _name(actuator)
        if name:
            called = f"the `{actuator.tag}` actuator `{name}`"
            message = f"the control of {called} is not {_QUANTITIES} of the joint `{joint}`"
            help = f"write the control itself, by the name of the actuator: `ctrl: {{{name}: …}}`"
        else:
            message = f"the control of the `{actuator.tag}` actuator of the joint `{joint}` is not {_QUANTITIES} of it"
            help = _naming([actuator], joint)
        self.making.sink.error("wrong-type", message, self._at(CTRL, *path), help=help, subjects=(joint,))

    def _without_angle(self, joint: str, value: Single, quantity: str, path: tuple[str, ...]) -> float:
        if isinstance(value, Angle):
            message = f"`ctrl` of the joint `{joint}` is a {quantity}, not an angle: `{value_text(value)}`"
            span = self._at(CTRL, *path)
            self.making.sink.error("wrong-type", message, span, help="write the number without `deg` or `rad`")
        return pose_number(value)

    def _has_width(self, vector: str, name: str, slot: Slot | None, entry: Entry, path: tuple[str, ...]) -> bool:
        """Return whether an entry has as many numbers as its joint, actuator or body. Report another count."""
        if slot is None:
            return True
        width = slot.widths[vector in ("qvel", "act")]
        if len(entry) != width:
            self._wrong_width(vector, name, slot, entry=entry, width=width, path=path)
            return False
        return True

    def _refuse_angles(
        self, vector: str, name: str, holder: _Holder, entry: Entry, meant: Sequence[str | None], path: tuple[str, ...]
    ) -> None:
        """Report an angle for a number that cannot be one: a position of a slide, the control of a motor."""
        node, slot = holder
        for place, (value, words) in enumerate(zip(entry, meant, strict=True)):
            if isinstance(value, Angle) and words is None and not self._may_turn(vector, node, slot, place):
                called = f"the {slot.kind if slot is not None else 'body'} `{name}`"
                fault = no_angle(f"`{vector}` of {called}", value, ())
                self.making.refuse_angle(fault, self._at(vector, *path))
                return

    def _may_turn(self, vector: str, node: Node, slot: Slot | None, place: int) -> bool:
        """Return whether a number of an entry may be an angle, or the rate of one, although the recipe need not say
        its unit.
        """
        if vector == "qpos":
            return slot is None or slot.kind not in _WITHOUT_ANGLES
        if vector == "qvel":
            return slot is None or place >= _LINEAR_NUMBERS.get(slot.kind, 0)
        return self.units.may_be_angles(node)

    def _meant(self, vector: str, name: str, node: Node, slot: Slot | None, width: int) -> Sequence[str | None]:
        """Return words for each number of an entry that is an angle, else None."""
        if slot is not None and slot.kind == "hinge":
            return [f"`{vector}` of the hinge `{name}` is an angle"]
        if vector not in ("ctrl", "act"):
            return [None] * width
        meant = self.units.of(node)
        words = meant.controls if vector == "ctrl" else [meant.activation]
        if len(words) != width:
            return [None] * width
        moves = f"`{vector}` of `{name}`, which moves the hinge `{_joint_of(node)}`, is"
        return [each and f"{moves} {each}" for each in words]

    def _angle(self, vector: str, value: Single, words: str, path: tuple[str, ...]) -> float:
        settings = self.making.angle_context.at((*self.step.key.at, vector, *path))
        if settings.angle is None and not isinstance(value, Angle) and value != 0:
            message = f"{words} and {value_text(value)} has no unit"
            number = value_text(value)
            help = f"write `{number}deg` or `{number}rad`, or `angle: degree` at the top of the recipe"
            self.making.sink.error("bare-angle", message, self._at(vector, *path), help=help)
        # Keys are in radians in any model: MuJoCo 4.0 takes `<key qpos="90"/>` of a hinge as 90 even with
        # `angle="degree"`.
        return turned(value, settings, radians=numbers.joint_radians)

    def _wrong_width(self, vector: str, name: str, slot: Slot, entry: Entry, width: int, path: tuple[str, ...]) -> None:
        kind = "actuator" if slot.kind == "actuator" else f"{slot.kind} joint"
        count = f"{width} number{'' if width == 1 else 's'}" if width else "no numbers"
        meant = _MEANT.get((slot.kind, vector))
        message = f"`{vector}` of the {kind} `{name}` has {count}, got {len(entry)}"
        help = f"write {meant}" if meant else "leave it out" if not width else None
        self.making.sink.error("wrong-length", message, self._at(vector, *path), help=help, subjects=(name,))

    def _unknown(self, vector: str, name: str) -> None:
        kind = VECTORS[vector]
        linking = self.linking
        sink = self.making.sink
        span = self._at(vector, name, key=True)
        names = list(self.holders[kind])
        declared = linking.names.find(kind, name)
        if declared is not None and declared.getroottree().getroot() is not linking.base.root:
            sink.suppress_about([name])  # it was lost with another fault
        if kind == "joint" and declared is None and may_be_generated(name, linking.base.root):
            reason = "MuJoCo may generate this joint, for example by a `<replicate>`"
            message = f"a key cannot set `{name}` in `{vector}`: {reason}"
            copies = "attach the part several times: `replicate` in `attach`"
            note = exists_note(kind, names, name)
            sink.error("not-supported", message, span, notes=(note,), help=copies, subjects=(name,))
            return
        near = closest(name, names)
        help = f"did you mean `{near[0]}`?" if near else None
        notes = [exists_note(kind, names, name)]
        others = [each for each in linking.names.kinds_of(name) if each != kind]
        if others and not near:
            notes.insert(0, Note(f"`{name}` is {word(others[0], article=True)}"))
            help = self._of_that(kind, others[0], name)
        elif kind == "joint" and "body" in others:
            help = self._of_that(kind, "body", name) or help
        if kind == "actuator" and self.unnamed:
            count = len(self.unnamed)
            have = "one actuator has" if count == 1 else f"{count} actuators have"
            notes.append(Note(f"{have} no name, and a key goes by names"))
            driven = [each for each in self.unnamed if name in (each.get("joint"), each.get("jointinparent"))]
            if driven and vector == "ctrl":
                # An actuator with a name may not be the right one.
                also = f"; {help}" if help else ""
                help = f"write it by its joint: `{vector}: {{joint: {{{name}: …}}}}`{also}"
            help = help or _naming(self.unnamed, name)
        message = f"the {kind} `{name}` to set `{vector}` of does not exist"
        fix = None if others else renaming(name, names)
        sink.error("unknown-name", message, span, notes=notes, help=help, subjects=(name,), fix=fix)

    def _of_that(self, kind: str, other: str, name: str) -> str | None:
        """Return advice on the joints of a body, or the actuators of a joint or another element, with the name."""
        holders = self.holders[kind].items()
        if kind == "joint" and other == "body":
            found = [joint for joint, (node, _) in holders if _name(next(node.iterancestors("body"))) == name]
        else:
            found = [holder for holder, (node, _) in holders if node.get(other) == name]
        if not found:
            return None
        named = " and ".join(f"`{each}`" for each in found)
        return f"{named} {'is the' if len(found) == 1 else 'are'} {kind}{'s' * (len(found) > 1)} of that {other}"


def _naming(actuators: Sequence[Node], name: str) -> str:
    """Return advice on naming the actuators, or only the actuators that act on the element with the name."""
    if not (ends := [(each, end) for each in actuators for end in _TRANSMISSIONS if each.get(end) == name]):
        common = [end for end in _TRANSMISSIONS if all(each.get(end) for each in actuators)]
        new = f"${{{common[0]}}}" if common else "a${index}"
        return f"""name them: `edit: [{{select: {{actuator: "**", where: {{name: ""}}}}, rename: "{new}"}}]`"""
    (actuator, end), *more = ends
    tag = actuator.tag if all(each.tag == actuator.tag for each, _ in more) else "actuator"
    new = f'"{name}_${{index}}"' if more else name
    which = "those that act on it have" if more else f"the `{tag}` that acts on it has"
    select = f'{tag}: "**", where: {{{end}: {name}, name: ""}}'
    return f"{which} no name; give one: `edit: [{{select: {{{select}}}, rename: {new}}}]`"


_TRANSMISSIONS = ("joint", "jointinparent", "tendon", "site", "body", "cranksite", "slidersite")


def hold_poses(
    plan: Plan,
    linking: Linking,
    making: ElementBuilder,
    context: Context,
    session: engine.Session | None,
    *,
    is_whole: bool = True,
) -> None:
    """Write the controls, and the activations of filters and integrators, of every key that holds its pose.

    Keys of nested recipes that balance forces are balanced again, because the forces follow from the whole model. Only
    if the model `is_whole`, it matters whether forces are left.
    """
    layout = linking.keys.final_layout
    if layout is None:
        return
    steps = {step.key.name: step for step in plan.keyframes}
    holders = [
        _PoseHolder(index, key, steps.get(str(key.get("name"))), layout, linking, making=making, is_whole=is_whole)
        for index, key in enumerate(keys_of(linking.base))
    ]
    holders = [each for each in holders if each.columns()]
    if not holders:
        return
    with nullcontext(session) if session else engine.Session() as own:
        if keep_finished(linking.flat(), context, own):
            for each in holders:
                each.hold(own)


class _PoseHolder(Struct):
    """The key with this `index`, which the `step` of this recipe writes, or None for a key of a part."""

    index: int
    key: Node
    step: WriteKeyframe | None
    layout: KeyLayout
    linking: Linking
    making: ElementBuilder
    is_whole: bool

    def span(self, *path: str) -> Span:
        assert self.step is not None
        return locate(self.making.document, (*self.step.key.at, CTRL, *path))

    def columns(self) -> dict[int, KeySource]:
        """Return the sources of the controls to compute, by address: of this recipe, and of nested ones by forces."""
        own = self._own_spans()
        row = dict(enumerate(number.source for number in self._numbers("ctrl")))
        return {at: source for at, source in row.items() if source.hold == "forces" or source.span in own}

    def _own_spans(self) -> dict[Span, tuple[str, ...]]:
        """Return the places of `hold` in this recipe, each with its path below `ctrl`."""
        if self.step is None:
            return {}
        controls = self.step.key.controls
        found = {self.span(*path): path for path in controls.held}
        return found if controls.hold is None else {self.span("hold"): ("hold",), **found}

    def _numbers(self, vector: str) -> list[Number]:
        return numbers_of(self.linking.base.origins.keys.get(self.key), self.key, vector)

    @property
    def name(self) -> str:
        return str(self.key.get("name") or "")

    def hold(self, session: engine.Session) -> None:
        from mjcompose.mujoco.controls import hold  # needs numpy, and few keys hold

        columns = self.columns()
        sink = self.making.sink
        question: dict[str, Any] = {
            "key": self.index,
            **{way: [at for at, source in columns.items() if source.hold == way] for way in WAYS},
        }
        answer = engine.call(session, hold, [FINISHED], argument=question)
        at = next(iter(columns.values())).span if self.step is None else self.span()
        if not answer.ok:
            sink.error("mujoco-crash", f"MuJoCo fails on the key `{self.name}`: {answer.error}", at)
            return
        if (left := answer.value["left"]) and self.is_whole:
            message = f"the actuators cannot hold the key `{self.name}`: they lack {left:.4g} N or N m"
            sink.warning("not-held", message, at)
        for vector in ("ctrl", "act"):
            self._write(vector, answer.value, columns)

    def _write(self, vector: str, answer: Mapping[str, Any], columns: Mapping[int, KeySource]) -> None:
        """Write the values of the holding actuators into the row of the key."""
        values: list[float | None] = answer[vector]
        zero = KeySource("zero", vector)
        row = self._numbers(vector) or [Number("0", zero, index) for index in range(len(values))]
        written = () if self.step is None else self.step.key.values.get(vector, {})
        names = [_name_of(actuator) for actuator in self.layout.actuators]
        given = entries_by_name(written, names, self.linking.request.separator)
        changed = False
        unknown: list[str] = []
        end = next_control = 0
        for actuator, slot in self.layout.actuators.items():
            start = end
            control = next_control
            end = end + slot.widths[vector == "act"]
            next_control = next_control + slot.widths[0]
            if (source := columns.get(control)) is None:
                continue
            name = _name_of(actuator)
            if vector == "ctrl" and (kind := answer["unlike"].get(str(control))):
                unknown += self._unlike(name, kind, source, is_unknown=control in answer["unknown"])
            if vector == "act" and name in given:  # the recipe's own activation counts
                continue
            for index, value in enumerate(values[start:end]):
                if value is not None:
                    held = KeySource("entry", vector, span=source.span, hold=source.hold)
                    row[start + index] = Number(numbers.text([value + 0.0]), held, index)
                    changed = True
        if changed:
            self._set(vector, row)
        if unknown:
            message = f"the control of {', '.join(unknown)} that holds the key `{self.name}` is unknown: it is 0"
            help = "write the control next to `hold`: `ctrl: {hold: positions, ACTUATOR: 0.3}`"
            self.making.sink.warning("not-held", message, self.span(), help=help)

    def _set(self, vector: str, row: list[Number]) -> None:
        base = self.linking.base
        place = base.origins.lasting_place(self.key, base.file, vector)
        journal.write(self.key, vector, " ".join(texts(row)), because("computed to hold the pose of the key", place))
        record = self.linking.base.origins.keys.get(self.key)
        if record is not None:
            record.numbers[vector] = row

    def _unlike(self, name: str, kind: str, source: KeySource, is_unknown: bool) -> Iterator[str]:
        """Report an actuator without a control that holds, if it is named. Yield one whose law only a plugin knows."""
        assert source.span is not None
        path = self._own_spans().get(source.span)
        if path is None:
            return
        if path == ("hold",):
            if is_unknown:
                yield f"`{name}` ({kind})" if name else f"{kind} without a name"
            return
        called = name if name and is_pattern(path[-1]) else path[-1]
        message = f"no control of `{called}` holds the pose of the key `{self.name}`: it is {kind}"
        help = "write its control, or `ctrl: {hold: forces}`, which balances the forces in that pose"
        self.making.sink.error("not-held", message, source.span, help=help, subjects=(called,))


def _name_of(actuator: Any) -> str:
    """Return the name of an actuator of a layout, which also has copies and actuators that MuJoCo makes."""
    return "" if isinstance(actuator, str) else str(getattr(actuator, "get", lambda _: "")("name") or "")
