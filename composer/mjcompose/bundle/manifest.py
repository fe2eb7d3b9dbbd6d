"""The manifest: the sources of a bundle, its content, and the addresses in the compiled model.

It holds no time and no path of the machine it was made on, so the same input gives the same bytes.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints, ValidationError
from pydantic_core import PydanticCustomError

from mjcompose.base import __version__
from mjcompose.base.diagnostic import Note
from mjcompose.base.naming import odd_character
from mjcompose.base.report import with_rest
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import MANIFEST, Bundle, path_fault, to_text
from mjcompose.mujoco.arrays import BY_WORD

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from mjcompose.mujoco.index import CompiledIndex


def newer_format(error: ValueError) -> int | None:
    """Return the format version of a refused manifest if it is newer than ours, else None."""
    if isinstance(error, ValidationError):
        for each in error.errors():
            if each["loc"] == ("manifest",) and isinstance(each["input"], int) and each["input"] > FORMAT:
                return each["input"]
    return None


def in_words(fault: ErrorDetails, owner: str = "a manifest") -> str:
    place = "`" + "/".join(map(str, fault["loc"])) + "`"
    if fault["type"] == "json_invalid":
        return "it is not JSON: " + fault["msg"].removeprefix("Invalid JSON: ")
    if not fault["loc"]:
        return "it is not a mapping"
    if fault["type"] == "extra_forbidden":
        return f"{place} is not a key of {owner}"
    if fault["type"] == "missing":
        return f"{place} is missing"
    message = fault["msg"]
    return f"{place}: {message[:1].lower()}{message[1:]}"


FORMAT = 1
SCHEMA_ID = "https://json-schema.org/draft/2020-12/schema"


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


def _on_one_line(text: str) -> str:
    character = odd_character(text)
    if character is not None:
        raise PydanticCustomError("name", "a name cannot have {character} in it", {"character": character})
    return text


def _without_folder(text: str) -> str:
    if "/" in text or "\\" in text or text in ("", ".", ".."):
        raise PydanticCustomError("file_name", "it must be the name of a file, without a folder")
    return text


def _in_bundle(path: str) -> str:
    fault = path_fault(path)
    if fault is not None:
        raise PydanticCustomError("path", "`{path}` is not a path in a bundle: {fault}", {"path": path, "fault": fault})
    return path


_SHARED = re.compile(r"(?:\.\./){1,2}assets/(.+)", re.DOTALL)


def _in_bundle_or_shared(path: str) -> str:
    shared = _SHARED.fullmatch(path)
    _in_bundle(path if shared is None else shared[1])
    return path


Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
GitHash = Annotated[str, StringConstraints(pattern=r"^([0-9a-f]{40}|[0-9a-f]{64})$")]
Name = Annotated[str, StringConstraints(min_length=1), AfterValidator(_on_one_line)]
"""A name that a recipe gives, which fits on one line."""
FileName = Annotated[str, AfterValidator(_without_folder)]
_Path = Annotated[str, AfterValidator(_in_bundle)]
_PathOrShared = Annotated[str, AfterValidator(_in_bundle_or_shared)]


class RecipeFile(_Part):
    """The recipe of the build."""

    path: FileName = Field(description="The name of its file.")
    sha256: Sha256 = Field(description="The hash of the recipe file.")


class InputOrigin(_Part):
    """The repository, archive or package of an input."""

    id: str = Field(description="The model reference without the file in it.")
    commit: GitHash | None = Field(None, description="The commit, for a git repository.")
    tree: GitHash | None = Field(None, description="Git's hash of all files, for a git repository.")
    sha256: Sha256 | None = Field(None, description="The hash of an archive.")


def _list_kinds(schema: dict[str, Any]) -> None:
    from mjcompose.sources.kinds import KINDS  # reading a manifest does not need it

    schema["description"] = f"The kind of reference: {', '.join(kind.name for kind in KINDS)}."


class UrdfElements(_Part):
    """Elements of one kind in a URDF, and their result."""

    what: str = Field(description="The tag with its parent, such as `joint/limit`, and the attribute if there is one.")
    count: int = Field(ge=1, description="How many there are.")
    became: str | None = Field(None, description="Their form in the model; null for nothing.")
    why: str | None = Field(None, description="Why they are not in the model; null if they are.")
    origin: str = Field(description="The place of the first, as FILE:LINE.")


class Input(_Part):
    """One model file that the model was made from."""

    path: str = Field(description="Relative to the recipe, or to the package or repository it came from.")
    reference: str = Field(description="The model reference as the recipe writes it.")
    kind: str = Field(description="The kind of reference.", json_schema_extra=_list_kinds)
    sha256: Sha256
    origin: InputOrigin | None = Field(None, description="null for a file that is named by its path.")
    license: str | None = Field(None, description="As an SPDX expression; null when it is not known.")
    licenses: tuple[_Path, ...] = Field((), description="Its license files in this bundle, each stored once.")
    package: str | None = Field(None, description="The Python package it came from.")
    version: str | None = Field(None, description="The version of that package, or the commit.")
    urdf: tuple[UrdfElements, ...] = Field(
        (), description="The elements of a URDF, read or not; omitted for other models."
    )
    compiler: dict[str, str] = Field(
        {}, description="Settings of `<compiler>` that the recipe gives for the file; omitted if there are none."
    )


def _finite(value: dict[str, Any]) -> dict[str, Any]:
    """Check that JSON can represent the values: Python's JSON readers also accept `NaN`. Raises ValueError."""
    json.dumps(value, allow_nan=False)
    return value


class ManifestPart(_Part):
    """A part of the model: the place of its own world, and the changes that the recipe makes."""

    part: str = Field(description="Its name in the recipe; `base` is the model that the recipe starts from.")
    input: int = Field(ge=0, description="Which of the inputs it is, counted from 0.")
    prefix: str = Field(description="The prefix of its names, separator included.")
    body: str | None = Field(None, description="The body it is fixed to; null for the world.")
    pos: tuple[float, float, float] | None = Field((0, 0, 0), description="In that body, in meters; null if unknown.")
    quat: tuple[float, float, float, float] | None = Field((1, 0, 0, 0), description="Likewise.")
    keys: str | None = Field("", description="The prefix of its keyframes; null if they were omitted.")
    renamed: dict[str, dict[str, str]] = Field(
        {}, description="By kind: own names, and names in the model other than prefix and own name."
    )
    welded: bool = Field(False, description="Whether free joints at its root were removed.")
    stands: bool = Field(True, description="Whether it is fixed in the world.")
    changed: tuple[str, ...] = Field((), description="The arrays of mjModel that the recipe changes in it.")
    replaced_keys: tuple[str, ...] = Field(
        (), description="Names of keyframes that the recipe writes instead of its own."
    )
    obscure: str | None = Field(None, description="Why it cannot be compared with its source, if so.")
    subtree: str | None = Field(None, description="The body that was taken from its source, if not all.")


class AdoptedSetting(_Part):
    """A setting that neither the base nor the recipe writes, but on which all parts that write it agree."""

    setting: str = Field(description="Its path, such as `option.cone`.")
    value: str
    parts: tuple[str, ...] = Field(description="The prefixes of the parts that write it.")
    origin: str | None = Field(None, description="Where the first of them writes it, as FILE:LINE.")


class Read(_Part):
    """One file that was read: a recipe, a model, their includes, a mesh, a license."""

    path: str = Field(description="Relative to the recipe, or after the reference that it was fetched with.")
    sha256: Sha256


class File(_Part):
    """One file of the bundle; the manifest itself is not listed."""

    path: _PathOrShared
    sha256: Sha256
    size: int = Field(ge=0, description="In bytes.")


_VALUES = "Measured values, rounded to four digits, so they are the same on other machines."
_DRAWN = "The drawn number; angles in radians, or in the unit of a parameter."
_ORIGIN = Field(None, description="Its place, as FILE:LINE; null for a copy that MuJoCo makes.")
_PLACE = Field(None, description="Its place, as FILE:LINE.")
Range = tuple[float | None, float | None]
"""Lower and upper end; None for no limit."""


class IndexedJoint(_Part):
    """A joint and its entries in qpos and qvel."""

    name: str
    type: Literal["free", "ball", "slide", "hinge"]
    body: str
    qpos: int = Field(ge=0, description="Where its entries in qpos begin.")
    qpos_size: int = Field(ge=1)
    dof: int = Field(ge=0, description="Where its entries in qvel begin.")
    dof_size: int = Field(ge=1)
    unit: str | None = Field(None, description="Of qpos: rad, m or quaternion; null for a free joint.")
    velocity_unit: str | None = Field(None, description="Of qvel: rad/s or m/s; null for a free joint.")
    range: Range | None = Field(None, description="In its unit, or rad for a ball joint; null for no limit.")
    origin: str | None = _ORIGIN


class IndexedActuator(_Part):
    """An actuator and its entries in ctrl and act."""

    name: str
    type: str | None = Field(None, description="Its MJCF tag; null for a copy that MuJoCo makes.")
    ctrl: int = Field(ge=0, description="Where its entries in ctrl begin.")
    ctrl_size: int = Field(ge=0)
    act: int | None = Field(None, description="Where its entries in act begin; null without any.")
    act_size: int = Field(0, ge=0)
    unit: str | None = Field(
        None,
        description="Its control's unit: rad or m for a position, rad/s or m/s for a velocity, N m or N, 1 for an"
        " activation; null if a gear or a gain gives it another meaning.",
    )
    ranges: tuple[Range | None, ...] = Field(
        (), description="Ranges of the controls, in their unit; null for no limit."
    )
    act_range: Range | None = Field(None, description="The range of its activation; null if that is not limited.")
    force_range: Range | None = Field(
        None, description="The range of its force or torque; null if that is not limited."
    )
    origin: str | None = _ORIGIN


class IndexedSensor(_Part):
    """A sensor and its entries in sensordata."""

    name: str
    type: str = Field(description="Its MJCF tag.")
    address: int = Field(ge=0, description="Where its entries in sensordata begin.")
    size: int = Field(ge=0)
    unit: str | None = Field(None, description="null if the type does not decide it.")
    cutoff: float | None = Field(None, description="The greatest value, in its unit; null if nothing is cut off.")
    origin: str | None = _ORIGIN


class IndexedCamera(_Part):
    """A camera; its number is its index in the list."""

    name: str
    body: str
    fovy: float = Field(description="The vertical field of view.")
    unit: Literal["deg", "m"] = Field(description="Of fovy: degrees, or meters for an orthographic camera.")
    resolution: tuple[int, int] = Field(description="Width and height in pixels.")
    origin: str | None = _ORIGIN


class IndexedKeyframe(_Part):
    """A keyframe; its number is its index in the list."""

    name: str
    time: float = Field(description="In seconds.")
    origin: str | None = _ORIGIN


class ManifestIndex(_Part):
    """The elements in the order of the compiled model, by which simulators address them. Unnamed ones are ""."""

    joints: tuple[IndexedJoint, ...]
    actuators: tuple[IndexedActuator, ...]
    sensors: tuple[IndexedSensor, ...]
    cameras: tuple[IndexedCamera, ...]
    keyframes: tuple[IndexedKeyframe, ...]


class PassedCheck(_Part):
    """A check that the compiled model passed."""

    name: str = Field(description="Its name in the outermost recipe.")
    kind: str
    values: dict[str, float | int | bool | str | tuple[float, ...] | None] = Field({}, description=_VALUES)
    origin: str | None = _PLACE


class Draw(_Part):
    """A draw of `randomize` for an element or a parameter."""

    field: str = Field(description="The name of the field in the recipe.")
    element: str | None = Field(None, description="The element; null for a parameter.")
    attribute: str = Field(description="The attribute, or the parameter.")
    component: int = Field(0, ge=0, description="The index of the first number in the attribute.")
    operation: Literal["set", "scale", "offset"] = Field(
        description="Whether the number is the value, a factor, or added."
    )
    value: bool | int | float | str | tuple[bool | int | float | str, ...] = Field(description=_DRAWN)


class GeneratedShape(_Part):
    """Shapes that `collision` or `simplify` made of a mesh, and their distance from it."""

    mesh: str
    geom: str = Field("", description="The geom that no longer touches; empty for one without a name.")
    how: str = Field(description="The method with its settings.")
    shapes: tuple[str, ...] = Field((), description="The geoms that touch instead; empty for a simplified mesh.")
    hausdorff: float = Field(description="The greater of `beyond` and `short`.")
    beyond: float = Field(description="In meters: the largest distance of the shapes outside the mesh.")
    short: float = Field(description="In meters: the largest distance of the mesh outside the shapes.")
    uncovered: float | None = Field(description="The share of the mesh outside of them; null if simplified.")
    volume: float | None = Field(description="The volume of all shapes, divided by the mesh's; null for an open mesh.")
    samples: int = Field(ge=0, description="The number of points at which the distances were measured.")
    made_with: dict[str, str] = Field({}, description="The packages that made it, and their versions.")
    key: str = Field(description="The hash of all that it depends on.")
    origin: str | None = _PLACE


class UnsupportedFeature(_Part):
    """Elements that a target cannot express: omitted from its bundle, or written in another form."""

    feature: str
    tag: str
    why: str
    count: int = Field(ge=1)
    names: tuple[str, ...] = Field((), description="The names of the elements that have one.")


class TargetRecord(_Part):
    """The program that a bundle was written for."""

    name: str
    left_out: tuple[UnsupportedFeature, ...] = ()


class Manifest(_Part):
    """The sources of a bundle, its content, and the addresses in the compiled model."""

    manifest: Literal[1] = Field(default=1, description="The version of this format.")
    name: Name
    description: str | None = None
    model: _Path = Field(default="model.xml", description="The MJCF file among the files.")
    mjcompose: str = Field(default=__version__, description="The version of mjcompose that made the bundle.")
    mujoco: str | None = Field(description="The version of MuJoCo that verified it; null when none did.")
    grammar: str = Field(description="The version of MuJoCo whose MJCF the grammar describes.")
    extensions: dict[str, str] = Field(
        {}, description="Other packages that the recipe uses: versions. Omitted if none."
    )
    recipe: RecipeFile | None = Field(None, description="null for a model that Python composed.")
    separator: str = Field("/", description="Between a prefix and a name.")
    cell: Name | None = Field(None, description="The cell of the recipe's matrix; null for none.")
    variants: dict[str, str] = Field({}, description="The chosen value of every variant.")
    params: Annotated[dict[str, Any], AfterValidator(_finite)] = Field({}, description="The value of every parameter.")
    seed: int | None = Field(None, description="The seed of the draws; null without `randomize`.")
    sample: int | None = Field(None, ge=0, description="The sample's number; 0 is the nominal model.")
    draws: tuple[Draw, ...] = ()
    inputs: tuple[Input, ...] = ()
    parts: tuple[ManifestPart, ...] = ()
    adopted: tuple[AdoptedSetting, ...] = Field((), description="The settings that the model takes from its parts.")
    read: tuple[Read, ...] = Field((), description="Every file that the model was made from.")
    licenses: dict[str, tuple[str, ...]] = Field({}, description="The parts by license, or under `unknown`.")
    files: tuple[File, ...]
    merged: Mapping[str, Mapping[str, str]] = Field(
        {}, description="Assets by kind and name, each with the equal asset that copies of its part share instead."
    )
    deduplicated: bool = Field(
        False, description="Of `--dedup`: `merged` has equal assets of all parts; omitted without the option."
    )
    picture: FileName | None = Field(
        None, description="Of `--picture`: the picture next to the bundle; omitted if none."
    )
    target: TargetRecord | None = Field(
        default=None, description="Of `--target`: the program; omitted without the option."
    )
    union: int | None = Field(
        default=None, ge=2, description="The number of models in a union; omitted for other models."
    )
    made: tuple[GeneratedShape, ...] = Field((), description="The shapes made of meshes; omitted if none.")
    checks: tuple[PassedCheck, ...] = Field((), description="The checks that the model passed.")
    index: ManifestIndex | None = Field(None, description="null when the model was not verified.")
    warnings: tuple[str, ...] = ()


def files_of(bundle: Bundle) -> tuple[File, ...]:
    """Return the manifest's list of the bundle's files, without the manifest itself."""
    return tuple(
        File(path=path, sha256=bundle.digest(path), size=len(content))
        for path, content in bundle.files.items()
        if path != MANIFEST
    )


def to_json(manifest: Manifest) -> bytes:
    """Return the manifest as UTF-8 text: fields in the order of the schema, indented by two spaces, a final newline."""
    data = manifest.model_dump(mode="json")
    for name in ("deduplicated", "picture", "target", "union", "made", "extensions"):
        if not data[name]:
            del data[name]
    for each in data["inputs"]:
        for name in ("urdf", "compiler"):
            if not each[name]:
                del each[name]
    return to_text(data)


def with_read(manifest: bytes, recipe: str, hashes: Mapping[str, str]) -> bytes:
    """Return a manifest with new hashes of its recipe and of the files that were read, by their names in it."""
    data = json.loads(manifest)
    data["recipe"]["sha256"] = recipe
    for each in data["read"]:
        each["sha256"] = hashes.get(each["path"], each["sha256"])
    return to_text(data)


def from_json(text: bytes | str) -> Manifest:
    """Parse the manifest of a bundle. Raises pydantic's ValidationError, a ValueError."""
    return Manifest.model_validate_json(text)


def with_manifest(bundle: Bundle, manifest: Manifest) -> Bundle:
    return bundle.with_files({MANIFEST: to_json(manifest)})


def schema() -> str:
    """Return the JSON Schema of manifests, as the text of its file."""
    data = {"$schema": SCHEMA_ID, **Manifest.model_json_schema(mode="serialization")}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


Written = Mapping[tuple[str, int], tuple[str, str]]
"""Tag and FILE:LINE of elements by kind (`joint`, `actuator`, `sensor`, `camera`, `key`) and number."""


def _range(pair: tuple[float, float] | None) -> Range | None:
    """Return a range with None for infinite ends, which JSON cannot represent."""
    if pair is None or not any(map(math.isfinite, pair)):
        return None
    low, high = (end if math.isfinite(end) else None for end in pair)
    return low, high


_NAMES = {"qpos": "qpos_address", "dof": "dof_address", "ctrl": "ctrl_address"}
"""Fields that have other names in the index of a compiled model."""


def index_of(index: CompiledIndex, written: Written | None = None) -> ManifestIndex:
    """Return the manifest's index of a compiled model; `written` has the places of its elements."""
    known = written or {}

    def entries(of: type[_Part], kind: str, elements: Sequence[Any], **changed: Callable[[Any], Any]) -> Iterator[Any]:
        for number, element in enumerate(elements):
            tag, origin = known.get((kind, number), (None, None))
            values = {name: getattr(element, _NAMES.get(name, name), tag) for name in of.model_fields}
            values |= {name: change(element) for name, change in changed.items()}
            yield of(**{**values, "origin": origin})

    joints = entries(
        IndexedJoint,
        "joint",
        index.joints,
        unit=lambda joint: BY_WORD[joint.type].unit,
        velocity_unit=lambda joint: BY_WORD[joint.type].velocity_unit,
        range=lambda joint: _range(joint.range if joint.limited else None),
    )
    actuators = entries(
        IndexedActuator,
        "actuator",
        index.actuators,
        act=lambda each: each.act_address if each.act_size else None,
        ranges=lambda each: tuple(map(_range, each.ctrl_ranges)),
        act_range=lambda each: _range(each.act_range),
        force_range=lambda each: _range(each.force_range),
    )
    cutoff = {"cutoff": lambda sensor: None if sensor.cutoff == math.inf else sensor.cutoff}
    return ManifestIndex(
        joints=tuple(joints),
        actuators=tuple(actuators),
        sensors=tuple(entries(IndexedSensor, "sensor", index.sensors, **cutoff)),
        cameras=tuple(entries(IndexedCamera, "camera", index.cameras)),
        keyframes=tuple(entries(IndexedKeyframe, "key", index.keyframes)),
    )


def manifest_of(text: bytes | None, shown: str, sink: Sink) -> Manifest | None:
    """Return the manifest of a bundle, or None if it is missing or broken, which is reported."""
    if text is None:
        sink.error("bundle-manifest", f"`{shown}` has no `{MANIFEST}`: there is nothing to compare it with")
        return None
    try:
        return from_json(text)
    except ValueError as error:
        newer = newer_format(error)
        if newer is not None:
            written = f"was written by a newer mjcompose: its format is {newer}, this one knows {FORMAT}"
            sink.error("bundle-manifest", f"the manifest of `{shown}` {written}", help="update mjcompose")
            return None
        help = "a bundle of another version of mjcompose needs that version"
        errors = error.errors(include_url=False, include_context=False) if isinstance(error, ValidationError) else []
        notes = list(map(Note, with_rest([*map(in_words, errors)] or [str(error)])))
        sink.error("bundle-manifest", f"the manifest of `{shown}` cannot be read", notes=notes, help=help)
        return None


def check_files(bundle: Bundle, manifest: Manifest, shown: str, sink: Sink) -> None:
    listed = {file.path: file for file in manifest.files}
    if manifest.model != bundle.model:
        message = f"the manifest of `{shown}` names the model `{manifest.model}`, which is not in it"
        sink.error("bundle-manifest", message, help=f"the bundle has the model `{bundle.model}`")
    for license in dict.fromkeys(path for each in manifest.inputs for path in each.licenses):
        if license not in bundle.files:
            message = f"the manifest of `{shown}` names the license `{license}`, which is not in it"
            sink.error("bundle-manifest", message)
    for path, file in listed.items():
        if path not in bundle.files:
            sink.error("bundle-changed", f"`{path}` is not in `{shown}`, and its manifest lists it")
        elif bundle.digest(path) != file.sha256:
            expected = Note(f"expected sha256 {file.sha256}, {file.size} bytes")
            found = Note(f"found sha256 {bundle.digest(path)}, {len(bundle.files[path])} bytes")
            message = f"`{path}` in `{shown}` is not the file that its manifest lists"
            sink.error("bundle-changed", message, notes=[expected, found])
    for path in bundle.files:
        if path != MANIFEST and path not in listed:
            sink.error("bundle-changed", f"`{path}` is in `{shown}`, and its manifest does not list it")


def check_index(expected: ManifestIndex, actual: ManifestIndex, shown: str, sink: Sink) -> None:
    """Report differences in order, addresses and limits between the compiled model and its manifest."""
    for kind in ManifestIndex.model_fields:
        how_written = {"origin", "type"} if kind == "actuators" else {"origin"}
        said, found = (
            [each.model_dump_json(exclude=how_written) for each in getattr(index, kind)] for index in (expected, actual)
        )
        notes = [
            Note(f"{kind} {number}: expected {a}, found {b}")
            for number, (a, b) in enumerate(zip_longest(said, found, fillvalue="nothing"))
            if a != b
        ]
        if notes:
            message = f"the {kind} of the compiled `{shown}` are not the {kind} of its manifest"
            sink.error("bundle-manifest", message, notes=notes[:8])
