"""The section `identify`: the numbers of a robot that `mjcompose identify` fits to recordings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import IT, Belongs, Model, OneOf
from mjcompose.language.forms.scalars import (
    LENGTHS,
    Checked,
    Count,
    Expects,
    Items,
    Measure,
    Name,
    Range,
    Scaled,
    Selects,
    Text,
    in_order,
)
from mjcompose.language.measured import COM, COUNTS, SHAPE, cannot_be_negative, in_si
from mjcompose.language.select import NARROWED
from mjcompose.text.expression import Angle
from mjcompose.tree.pattern import Selector

TIMES = {"ms": 1e-3, "s": 1.0}
UNITS = {"rad": 1.0, "mrad": 1e-3, "deg": 0.017453292519943295, "m": 1.0, "cm": 1e-2, "mm": 1e-3}
SPEEDS = {**UNITS, **{f"{unit}/s": factor for unit, factor in UNITS.items()}}
_ANGLES = ("rad", "mrad", "deg")
CLOCKS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_Unit = Literal["rad", "mrad", "deg", "m", "cm", "mm"]
_Time = Annotated[float, Scaled(TIMES, ge=0)]
_Times = Annotated[tuple[_Time, ...], Items(2, 2), Checked(in_order), Expects("a list of 2 times", "[0, 60ms]")]
_Number = Annotated[float | Angle, Measure()]
_Numbers = Annotated[tuple[_Number, ...], Items(2, 2), Checked(in_order), Expects("a list of 2 numbers", "[LOW, HIGH]")]


class RecordingUnits(Model):
    """The units of a recording; by default rad, m and s."""

    example: ClassVar = "{qpos: deg, ctrl: deg}"

    qpos: _Unit | None = None
    """the unit of positions: an angle is the unit of hinges, a length the unit of slides"""
    qvel: Literal["rad/s", "mrad/s", "deg/s", "m/s", "cm/s", "mm/s"] | None = None
    """the unit of speeds, of hinges or of slides"""
    ctrl: _Unit | None = None
    """the unit of commands of position and velocity servos, of hinges or of slides"""
    time: Literal["s", "ms", "us", "ns"] | None = None
    """the unit of the time"""

    @property
    def factors(self) -> dict[str, float]:
        """The factors that turn numbers of each kind of column into MuJoCo's units."""
        found = {"sensor": 1.0}
        for kind in type(self).model_fields:
            unit = getattr(self, kind)
            table = CLOCKS if kind == "time" else SPEEDS
            found[kind] = 1.0 if unit is None else table[unit]
        return found

    @property
    def dimensions(self) -> dict[str, str]:
        """The dimension of each kind of column with a written unit: `angle`, `length` or `time`.

        >>> RecordingUnits(qpos="deg", ctrl="mm", time="s").dimensions
        {'qpos': 'angle', 'ctrl': 'length', 'time': 'time'}
        """
        written = {kind: getattr(self, kind) for kind in type(self).model_fields}
        return {
            kind: "time" if kind == "time" else "angle" if unit.partition("/")[0] in _ANGLES else "length"
            for kind, unit in written.items()
            if unit is not None
        }


class RecordingKeys(Model):
    """How to read the columns of a recording."""

    rules: ClassVar = (
        Belongs("command_joints", to="command", help="write the topic: `command: /position_controller/commands`"),
    )
    example: ClassVar = "{units: {qpos: deg}}"

    units: RecordingUnits = Field(default_factory=lambda: RecordingUnits())
    """the units, if they are not rad, m, rad/s and s"""
    percent: Annotated[tuple[Text, ...], Items(1, unique=True), Expects("a list of joints", "[gripper]")] = ()
    """joints whose positions, speeds and commands are in percent of their range in the model, such as LeRobot's
    gripper"""
    sign: Annotated[dict[str, Literal[-1, 1]], Expects("a mapping from names to 1 or -1", "{elbow: -1}")] = Field({})
    """-1 for a joint that the recording counts the other way round, or for one column, `qpos elbow`; 1 if a direction
    is right but looks wrong"""
    names: Annotated[dict[str, Text], Expects("a mapping from names to names", "{joint_1: shoulder_pan}")] = Field({})
    """names in the recording, and the names in the model"""
    ignore: Annotated[tuple[Annotated[str, Name(glob=True)], ...], Items(1), Expects("a list of globs")] = ()
    """names in the recording to leave out, such as those that the model does not have"""
    hold: bool = False
    """actuators without recorded commands hold the control of the keyframe"""
    state: Annotated[Text, Expects("a topic", "/joint_states")] = "/joint_states"
    """MCAP: the topic with the positions of the joints"""
    command: Annotated[Text, Expects("a topic", "/position_controller/commands")] | None = None
    """MCAP: the topic with the commands"""
    command_joints: Annotated[
        tuple[Text, ...], Items(1, unique=True), Expects("a list of names", "[shoulder_pan, elbow]")
    ] = ()
    """MCAP: the joints or actuators of commands without names, in the order of the controller"""
    clock: Literal["header", "log"] = "header"
    """MCAP: `header` uses the stamps of messages that have one, `log` the time at which each message was recorded"""
    episode: Count | None = None
    """LeRobot: the episode of the data set"""


_STRETCH = 0.5 * math.log(2)
"""The largest logarithm of a stretch: moments of inertia to half of them and twice as large."""
_SHEAR = 0.3


class IdentifyField(Model):
    """One number of each selected element, and the range in which it may be."""

    rules: ClassVar = (
        Belongs("within", to="inertia", help="write `inertia: mass+com`"),
        OneOf(
            "attr",
            "inertia",
            "delay",
            "zero",
            lacks="does not say which number to fit",
            help="give the other a field of its own",
            advice="write for instance `attr: damping, range: [0, 20]`",
        ),
    )
    example: ClassVar = '{select: {joint: "arm/*"}, attr: damping, range: [0, 20]}'
    called: ClassVar = "field `{}` of `identify`"
    owned: ClassVar = "field `{}`"
    instead: ClassVar = {**NARROWED, "uniform": "range", "bounds": "range", "limits": "range"}

    select: Annotated[Selector, Selects()] = Field(examples=['{joint: "arm/*"}'])
    """the elements whose number is fitted"""
    attr: Annotated[str, Name(what="an attribute of MJCF")] | None = None
    """an attribute of MJCF, with an index for one number: `friction[0]`"""
    inertia: Literal["mass", "mass+com", "full"] | None = None
    """the mass of bodies, with the inertia in proportion; `mass+com` also fits the center of mass, `full` the shape of
    the inertia as well"""
    within: Annotated[float, Scaled(LENGTHS, gt=0)] | None = None
    """the largest distance of the center of mass from its place in the recipe, along each axis of the body: `10cm`"""
    delay: _Times | None = None
    """the least and the greatest delay of the commands of actuators"""
    zero: _Numbers | None = None
    """the least and the greatest reading of joints at the zero of the model"""
    range: _Numbers | None = None
    """the smallest and the greatest possible number"""
    scale: Range | None = None
    """the same, as factors of the recipe's number"""
    offset: _Numbers | None = None
    """the same, as distances from the recipe's number"""
    per: Literal["element", "part", "sample"] = "element"
    """a number for each element, one for each part, or one for all"""
    expect: Count | None = None
    """how many elements must be selected"""
    optional: bool = False
    """allows an empty selection"""

    @property
    def name(self) -> str:
        return str(self.at[-1])

    @property
    def attribute(self) -> str:
        """The word for the number in a file of measurements; for the inertia, the first one."""
        if self.attr is not None:
            return self.attr
        return "mass" if self.inertia is not None else "delay" if self.delay is not None else "zero"

    @property
    def bounds(self) -> tuple[Literal["range", "scale", "offset"], float, float]:
        """How the range is written, and its two numbers, in MuJoCo's units or as factors."""
        if self.scale is not None:
            return "scale", self.scale[0], self.scale[1]
        if self.offset is not None:
            return "offset", in_si(self.offset[0]), in_si(self.offset[1])
        if self.delay is not None:
            return "range", self.delay[0], self.delay[1]
        numbers = self.range or self.zero
        assert numbers is not None
        return "range", in_si(numbers[0]), in_si(numbers[1])

    @property
    def numbers(self) -> Iterator[tuple[str, tuple[Literal["range", "scale", "offset"], float, float]]]:
        """The word for each number that the field fits for an element, and its bounds."""
        yield self.attribute, self.bounds
        if self.within is not None:
            for axis in range(COUNTS[COM]):
                yield f"{COM}[{axis}]", ("range", -self.within, self.within)
        if self.inertia == "full":
            for index in range(COUNTS[SHAPE]):
                most = _STRETCH if index < 3 else _SHEAR
                yield f"{SHAPE}[{index}]", ("range", -most, most)

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        has_center = self.inertia in ("mass+com", "full")
        if has_center and self.within is None:
            message = f"{IT} fits the center of mass, and does not say how far it may be off"
            yield Fault("missing-key", message, ("inertia",), help="write for instance `within: 10cm`")
        elif self.within is not None and self.inertia is not None and not has_center:
            message = "`within` is about the center of mass, which `inertia: mass` does not fit"
            yield Fault("unknown-key", message, ("within",), key=True, help="write `inertia: mass+com`")
        written = [key for key in ("range", "scale", "offset") if getattr(self, key) is not None]
        low = 0.0 if self.range is None else in_si(self.range[0])
        if low < 0 and cannot_be_negative(self.attribute):
            message = f"`{self.attribute}` cannot be negative, and the range begins at {low:g}"
            yield Fault("out-of-range", message, ("range",), help="let it begin at 0 or above")
        has_own = self.delay is not None or self.zero is not None
        if has_own and written:
            message = f"`{self.attribute}` has its range already, so `{written[0]}` has no meaning"
            yield Fault("unknown-key", message, (written[0],), key=True, help=f"remove `{written[0]}`")
        elif not has_own and not written:
            help = "a number moves only within its range: `range: [0, 5]`, or `scale: [0.5, 2]` of the recipe's number"
            yield Fault("missing-key", f"{IT} has no `range`", key=True, help=help)
        elif len(written) > 1:
            message = f"{IT} has both `{written[0]}` and `{written[1]}`, of which only one is allowed"
            yield Fault("unknown-key", message, (written[1],), key=True, help=f"remove `{written[1]}`")


class Identify(Model):
    """The numbers that `mjcompose identify` fits to recordings of a robot."""

    owned: ClassVar = ""

    start: Annotated[str, Name("key")] | None = None
    """the keyframe for everything that is not recorded"""
    window: Annotated[float, Scaled(TIMES, gt=0)] | None = None
    """the length of the pieces in which recordings are compared; by default as long as an error of the start stays
    small"""
    recording: RecordingKeys = Field(default_factory=lambda: RecordingKeys.model_validate({}))
    """how to read the columns of the recordings"""
    fields: Annotated[
        dict[str, IdentifyField],
        Field(min_length=1),
        Expects("a mapping from names to what is fitted", f"{{damping: {IdentifyField.example}}}"),
    ]
    """the numbers by name, each with the elements and the range"""
