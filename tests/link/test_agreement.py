from __future__ import annotations

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest
from link.workshop import BASE, Linked, Piece, Workshop
from mjcompose.base.sink import Sink
from mjcompose.link.agreement import requested_settings, resolving_settings
from mjcompose.link.link import link
from mjcompose.link.linking import Linking, Part
from mjcompose.tree.parse import parse_text
from mjcompose.tree.unit import Unit


def options(inside: str) -> str:
    return f"<mujoco>{inside}</mujoco>"


def told(linked: Linked) -> list[tuple[str, str]]:
    return [(found.code, found.severity.value) for found in linked.sink.diagnostics]


SAME = [
    '<option timestep="0.002"/>',
    '<option timestep="2e-3" cone="pyramidal"/>',
    '<option gravity="0 0 -9.81"/>',
    '<option integrator="Euler"><flag contact="enable"/></option>',
    '<visual><map znear="0.01"/></visual>',
    '<option timestep=""/>',
    "<option/><visual/><statistic/>",
]


@pytest.mark.parametrize("shown", ["true", "false"])
def test_a_setting_whose_default_is_another_in_mujoco_3_11_is_written(workshop: Workshop, shown: str) -> None:
    part = f'<visual><global bvactive="{shown}"/></visual>'
    linked = workshop.link(BASE, options(part))
    assert f'bvactive="{shown}"' in linked.xml
    assert told(linked) == []


@pytest.mark.parametrize("written", SAME)
def test_what_mujoco_does_anyway_is_no_conflict(workshop: Workshop, written: str) -> None:
    linked = workshop.link(BASE, options(written))
    assert not linked.sink.diagnostics
    assert "<option" not in linked.xml


CONFLICTS = [
    ('<option timestep="0.01"/>', "option.timestep", "option: {timestep: 0.01}"),
    ('<option cone="elliptic"/>', "option.cone", "option: {cone: elliptic}"),
    ('<option gravity="0 0 0"/>', "option.gravity", "option: {gravity: [0, 0, 0]}"),
    ('<option><flag contact="disable"/></option>', "option.flag.contact", "option: {flag: {contact: disable}}"),
    ('<visual><global offwidth="800"/></visual>', "visual.global.offwidth", "visual: {global: {offwidth: 800}}"),
    ('<visual><rgba haze="1 0 0 1"/></visual>', "visual.rgba.haze", "visual: {rgba: {haze: [1, 0, 0, 1]}}"),
    ('<statistic extent="3"/>', "statistic.extent", "statistic: {extent: 3}"),
    ('<statistic center="0 0 1"/>', "statistic.center", "statistic: {center: [0, 0, 1]}"),
]


OTHERS = [
    '<option timestep="0.001"/>',
    '<option cone="pyramidal"/>',
    '<option gravity="0 0 -9.81"/>',
    '<option><flag contact="enable"/></option>',
    '<visual><global offwidth="640"/></visual>',
    '<visual><rgba haze="0 1 0 1"/></visual>',
    '<statistic extent="4"/>',
    '<statistic center="0 0 2"/>',
]
"""Another value of each, MuJoCo's default where there is one."""


@pytest.mark.parametrize(("written", "path", "settling"), CONFLICTS)
@pytest.mark.parametrize("conflict", ["error", "base", "mujoco"])
def test_what_all_parts_that_write_it_agree_on_is_taken(
    workshop: Workshop, written: str, path: str, settling: str, conflict: str
) -> None:
    pieces = [Piece(options(written), "a/"), Piece(BASE, "b/"), Piece(options(written), "c/")]
    linked = workshop.link(BASE, *pieces, conflict=conflict)
    assert not linked.sink.diagnostics
    (each,) = linked.linking.base.adopted
    assert (each.path.replace("/", "."), each.parts, each.is_written) == (path, ("a/", "c/"), True)
    assert f'{path.rpartition(".")[2]}="{each.value}"' in written and each.value in linked.xml
    linked.model()


@pytest.mark.parametrize(("first", "other"), list(zip([each[0] for each in CONFLICTS], OTHERS, strict=True)))
def test_parts_that_write_different_values_conflict(workshop: Workshop, first: str, other: str) -> None:
    for one, two in ((first, other), (other, first)):
        linked = workshop.link(BASE, Piece(options(one), "a/"), Piece(options(two), "b/"))
        fault = linked.fault
        assert fault.code == "option-conflict"
        assert fault.span is not None and fault.span.file == str(linked.paths[2])
        assert "`b/` needs" in fault.message and "`a/` has" in fault.message
        assert [note.span.file for note in fault.notes if note.span] == [str(linked.paths[1])]
        assert not linked.linking.base.adopted


def test_an_agreed_default_is_not_written_and_counts_in_the_recipe_around(workshop: Workshop) -> None:
    inner = workshop.link(BASE, options('<option cone="pyramidal"/>')).linking.flat()
    (each,) = inner.adopted
    assert (each.value, each.is_written) == ("pyramidal", False)
    assert [*requested_settings(inner)] == ["option/cone"]


@pytest.mark.parametrize(("written", "path", "settling"), CONFLICTS)
def test_what_a_part_asks_for_in_vain_is_reported(workshop: Workshop, written: str, path: str, settling: str) -> None:
    linked = workshop.link(options(OTHERS[CONFLICTS.index((written, path, settling))]), f"<mujoco>\n{written}</mujoco>")
    fault = linked.fault
    assert (fault.code, fault.span and fault.span.line) == ("option-conflict", 2)
    assert f"`{path}`" in fault.message
    assert settling in (fault.help or "")


@pytest.mark.parametrize(("written", "path", "settling"), CONFLICTS)
def test_what_the_recipe_settles_is_no_conflict(workshop: Workshop, written: str, path: str, settling: str) -> None:
    settled = frozenset({path.replace(".", "/")})
    assert not workshop.link(BASE, options(written), overridden_options=settled).sink.diagnostics


@pytest.mark.parametrize(("written", "path", "settling"), CONFLICTS)
def test_a_conflict_may_be_a_warning(workshop: Workshop, written: str, path: str, settling: str) -> None:
    base = options(OTHERS[CONFLICTS.index((written, path, settling))])
    linked = workshop.link(base, options(written), conflict="base")
    assert told(linked) == [("option-conflict", "warning")]
    assert written not in linked.xml


def test_of_parts_that_disagree_none_has_its_way_under_a_warning(workshop: Workshop) -> None:
    parts = [Piece(options(f'<option timestep="{step}"/>'), f"p{step}/") for step in (0.001, 0.002, 0.003)]
    linked = workshop.link(BASE, *parts, conflict="base")
    assert told(linked) == [("option-conflict", "warning")] * 2  # 0.002 is what MuJoCo does anyway
    assert linked.model().opt.timestep == 0.002


def test_a_default_gives_way_in_a_merge(workshop: Workshop) -> None:
    pieces = [Piece(options(f'<option cone="{cone}"/>'), f"{cone}/") for cone in ("pyramidal", "elliptic")]
    linked = workshop.link(BASE, *pieces, conflict="mujoco")
    assert told(linked) == [("option-conflict", "warning")]
    assert linked.model().opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


def test_both_places_are_told(workshop: Workshop) -> None:
    linked = workshop.link(
        options('\n<option cone="elliptic"/>'),
        Piece(options('<option cone="pyramidal"/>'), "a/"),
        Piece(options('<option cone="elliptic"/>'), "b/"),
        Piece(options('<option cone="pyramidal"/>'), "c/"),
    )
    fault = linked.fault
    assert fault.span is not None
    assert fault.span.file == str(linked.paths[1])
    places = [(note.span.file, note.span.line) for note in (*fault.notes, *fault.others) if note.span]
    assert places == [(str(linked.paths[0]), 2), (str(linked.paths[3]), 1)]


def test_all_settings_of_a_part_are_one_finding_with_one_help(workshop: Workshop) -> None:
    wanted = '<option cone="elliptic" impratio="10"/><visual><map znear="0.1"/></visual>'
    base = '<option impratio="5" cone="pyramidal"/><visual><map znear="0.2"/></visual>'
    linked = workshop.link(options(base), *(Piece(options(wanted), prefix) for prefix in ("a/", "b/", "c/")))
    fault = linked.fault
    assert [note.message.split(":")[0] for note in fault.notes] == [
        "`option.cone`",
        "`option.impratio`",
        "`visual.map.znear`",
    ]
    assert [other.message for other in fault.others] == ["`b/`", "`c/`"]
    sentence, *lines = str(fault.help).splitlines()
    assert "`drop: [option, visual]`" in sentence
    assert lines == ["option: {cone: elliptic, impratio: 10}", "visual: {map: {znear: 0.1}}"]


def test_a_merge_is_advised_only_where_it_would_settle_everything(workshop: Workshop) -> None:
    part = options('<option cone="pyramidal"/>')
    slow, fast = (options(f'<option timestep="{step}"/>') for step in (0.01, 0.001))
    assert "conflict: mujoco" in str(workshop.link(slow, fast).fault.help)
    assert "conflict: mujoco" not in str(workshop.link(options('<option cone="elliptic"/>'), part).fault.help)


MERGES = [
    ("timestep", "0.01", "0.004", "0.004"),
    ("timestep", "0.004", "1e-2", "0.004"),
    ("tolerance", "1e-6", "1e-10", "1e-10"),
    ("iterations", "50", "200", "200"),
    ("iterations", "200", "50", "200"),
    ("ls_iterations", "20", "70", "70"),
]


@pytest.mark.parametrize(("name", "base", "part", "expected"), MERGES)
def test_of_two_authored_values_the_safer_is_merged(
    workshop: Workshop, name: str, base: str, part: str, expected: str
) -> None:
    linked = workshop.link(
        options(f'<option {name}="{base}"/>'), options(f'<option {name}="{part}"/>'), conflict="mujoco"
    )
    assert told(linked) == [("option-conflict", "warning")]
    assert f'{name}="{expected}"' in linked.xml


def test_what_has_no_safer_value_is_an_error_in_a_merge_too(workshop: Workshop) -> None:
    linked = workshop.link(
        options('<option cone="elliptic"/>'), options('<option cone="pyramidal"/>'), conflict="mujoco"
    )
    assert told(linked) == [("option-conflict", "error")]


def test_merged_values_are_those_that_later_parts_meet(workshop: Workshop) -> None:
    linked = workshop.link(
        BASE,
        Piece(options('<option timestep="0.01"/>'), "a/"),
        Piece(options('<option timestep="0.005"/>'), "b/"),
        Piece(options('<option timestep="0.01"/>'), "c/"),
        conflict="mujoco",
    )
    assert len(linked.sink.diagnostics) == 3
    assert linked.model().opt.timestep == 0.005


def test_the_base_is_never_asked(workshop: Workshop) -> None:
    base = options('<option timestep="0.01"/><option cone="elliptic"/><visual><map znear=".1"/></visual>')
    linked = workshop.link(base, BASE)
    assert not linked.sink.diagnostics
    assert linked.model().opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


SIZES = [
    ("nuserdata", "3", "5", "5"),
    ("nuserdata", "7", "5", "7"),
    ("nconmax", "100", "200", "200"),
    ("njmax", "-1", "300", "300"),
    ("memory", "1M", "900K", "1M"),
    ("memory", "1M", "2m", "2m"),
    ("memory", "100", "1K", "1K"),
    ("nuser_geom", "3", "2", "3"),
    ("nuser_geom", "-1", "2", "2"),
]


@pytest.mark.parametrize(("name", "base", "part", "expected"), SIZES)
def test_of_two_sizes_the_larger_serves_both(
    workshop: Workshop, name: str, base: str, part: str, expected: str
) -> None:
    linked = workshop.link(options(f'<size {name}="{base}"/>'), options(f'<size {name}="{part}"/>'))
    assert f'{name}="{expected}"' in linked.xml
    linked.model()


def test_the_size_of_a_part_alone_counts(workshop: Workshop) -> None:
    linked = workshop.link(BASE, options('<size nuserdata="4" memory="3M" nuser_body="2"/>'))
    model = linked.model()
    assert (model.nuserdata, model.nuser_body, model.narena) == (4, 2, 3 * 2**20)


@pytest.mark.parametrize("older", ["njmax", "nstack"])
def test_memory_and_its_older_spellings_do_not_meet(workshop: Workshop, older: str) -> None:
    for base, part in (('memory="1M"', f'{older}="500"'), (f'{older}="500"', 'memory="1M"')):
        linked = workshop.link(options(f"<size {base}/>"), options(f"<size {part}/>"))
        assert told(linked) == [("option-conflict", "warning")]
        assert older not in linked.xml
        linked.model()


USERS = {
    "body": ('<body name="b" {}/>', "nuser_body"),
    "geom": ('<geom name="b" size="1" {}/>', "nuser_geom"),
    "site": ('<site name="b" {}/>', "nuser_site"),
    "camera": ('<camera name="b" {}/>', "nuser_cam"),
    "joint": ('<body name="b"><geom size="1"/><joint name="b" {}/></body>', "nuser_jnt"),
}


@pytest.mark.parametrize(("element", "size"), USERS.values(), ids=USERS.keys())
def test_user_data_of_all_parts_finds_room(workshop: Workshop, element: str, size: str) -> None:
    base = options(f'<size {size}="1"/><worldbody>{element.format(user("7"))}</worldbody>')
    part = options(f"<worldbody>{element.format(user('1 2 3'))}</worldbody>")
    model = workshop.link(base, part).check()
    assert getattr(model, size) == 3
    # The other way round nothing is written, and MuJoCo makes room itself.
    workshop.link(part, base).check()


def user(values: str) -> str:
    return f'user="{values}"'


@pytest.mark.parametrize("given", ["on the element", "by a class"])
def test_user_data_outside_the_body_tree_finds_room(workshop: Workshop, given: str) -> None:
    own = 'user="1 2 3 4"'
    default = f"<default><motor {own}/><tendon {own}/></default>" if given == "by a class" else ""
    own = own if not default else ""
    text = f"""<mujoco>{default}<worldbody><body name="b"><joint name="j"/><geom size="1"/></body></worldbody>
      <tendon><fixed name="t" {own}><joint joint="j" coef="1"/></fixed></tendon>
      <actuator><motor name="m" joint="j" {own}/></actuator>
      <sensor><jointpos name="s" joint="j" user="1 2 3 4"/></sensor></mujoco>"""
    sizes = '<mujoco><size nuser_tendon="1" nuser_actuator="2" nuser_sensor="0"/></mujoco>'
    model = workshop.link(sizes, text).check()
    assert (model.nuser_tendon, model.nuser_actuator, model.nuser_sensor) == (4, 4, 4)


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("option/timestep", "0.01", "option: {timestep: 0.01}"),
        ("option/flag/contact", "disable", "option: {flag: {contact: disable}}"),
        ("visual/rgba/haze", "1 0 0 1", "visual: {rgba: {haze: [1, 0, 0, 1]}}"),
    ],
)
def test_the_line_that_settles_a_conflict(path: str, value: str, line: str) -> None:
    assert line in resolving_settings({path: value}, ())


def test_a_model_alone_is_not_looked_at(workshop: Workshop) -> None:
    linked = workshop.link(options('<size memory="1M" nkey="3"/><option timestep="7"/>'))
    assert not linked.sink.diagnostics
    assert 'nkey="3"' in linked.xml


def test_one_line_settles_all_conflicts_of_a_section() -> None:
    wanted = {"visual/map/znear": "0.01", "visual/headlight/diffuse": "1 1 1", "visual/map/zfar": "9"}
    both = "map: {znear: 0.01, zfar: 9}, headlight: {diffuse: [1, 1, 1]}"
    assert resolving_settings(wanted, ()).endswith(f"`visual: {{{both}}}`")
    added = resolving_settings(wanted, {"visual/map/force"})
    assert "the recipe's `visual`" in added and added.endswith(f"`{both}`")


def test_of_several_sections_of_a_part_the_last_counts(workshop: Workshop) -> None:
    options = '<option timestep=".004"/><option timestep=".002"><flag contact="disable"/></option>'
    part = f'<mujoco>{options}<worldbody/><option><flag contact="enable"/></option></mujoco>'
    linked = workshop.link(BASE, part)
    assert linked.codes == []
    assert linked.model().opt.timestep == 0.002


BODY = '<worldbody><body><joint name="j" {}/><geom size="0.1"/></body></worldbody>{}'
HELD = "<tendon><fixed {}><joint joint='j' coef='1'/></fixed></tendon>"
MOVED = "<actuator><general joint='j' {}/></actuator>"


def unit(text: str, label: str) -> Unit:
    found = parse_text(f"<mujoco>{text}</mujoco>", Sink(), file=f"{label}.xml", directory=Path(), label=label)
    assert found is not None
    return found


def messages(part: str) -> list[str]:
    sink = Sink()
    link(Linking(unit("", "base"), [Part(unit(part, "part"), "p/")], sink))
    return [each.message for each in sink.errors]


@pytest.mark.parametrize(
    ("joint", "other", "is_refused"),
    [
        ('range="-1 1"', "", True),
        ('range="-1 1" limited="true"', "", False),
        ('range="-1 1" limited="false"', "", False),
        ('range="0 0"', "", False),
        ('type="free" range="-1 1"', "", False),
        ('type="free" actuatorfrcrange="-1 1"', "", False),
        ('type="ball" range="0 1"', "", True),
        ('type="ball" actuatorfrcrange="-1 1"', "", False),
        ('actuatorfrcrange="-1 1"', "", True),
        ("", HELD.format('range="0 1"'), True),
        ("", HELD.format('range="0 1" limited="true"'), False),
        ("", MOVED.format('ctrlrange="0 1"'), True),
        ("", MOVED.format('forcerange="0 1"'), True),
        ("", MOVED.format('dyntype="integrator" actrange="0 1"'), True),
        ("", MOVED.format('ctrlrange="0 1" ctrllimited="false"'), False),
        ("", '<default><joint range="-1 1"/></default>', True),
        ("", '<default><joint range="-1 1" limited="true"/></default>', False),
    ],
)
def test_a_part_is_refused_where_mujoco_refuses_it_alone(joint: str, other: str, is_refused: bool) -> None:
    text = f'<compiler autolimits="false"/>{BODY.format(joint, other)}'
    try:
        mujoco.MjModel.from_xml_string(f"<mujoco>{text}</mujoco>")
        refused_by_mujoco = False
    except ValueError:
        refused_by_mujoco = True
    assert refused_by_mujoco == is_refused
    assert bool(messages(text)) == is_refused
    assert messages(text.replace('"false"/>', '"true"/>', 1)) == []


pytestmark = pytest.mark.mujoco4("MuJoCo 3.12 has no `passthrough`")

ASKING = 'passthrough="textures"'
LOADING = ""
TEXTURES = {"file": 'file="t.png"', "built": 'builtin="flat" width="4" height="4"', "none": None}


def textured(setting: str, texture: str | None) -> str:
    asset = "" if texture is None else f'<texture name="t" type="2d" {texture}/>'
    return f"<mujoco><compiler {setting}/><asset>{asset}</asset><worldbody><body/></worldbody></mujoco>"


@pytest.fixture(scope="session")
def picture() -> bytes:
    """One pixel, as PNG."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    data = zlib.compress(b"\0\1\2\3")
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


@pytest.mark.parametrize("of_base", [(ASKING, "file"), (ASKING, "built"), (LOADING, "file"), (ASKING, "none")])
@pytest.mark.parametrize("of_part", [(ASKING, "file"), (ASKING, "built"), (LOADING, "file"), (LOADING, "none")])
def test_textures_stay_in_their_files_or_are_loaded_as_alone(
    workshop: Workshop, picture: bytes, of_base: tuple[str, str], of_part: tuple[str, str]
) -> None:
    base, part = (textured(setting, TEXTURES[kind]) for setting, kind in (of_base, of_part))
    linked = workshop.link(base, Piece(part, files={"t.png": picture}), files={"t.png": picture})
    if of_base[1] == of_part[1] == "file" and of_base[0] != of_part[0]:
        assert linked.fault.code == "compiler-setting"
        assert len(linked.fault.notes) == 1
    else:
        linked.check()


def test_a_model_of_one_unit_keeps_what_it_says(workshop: Workshop, picture: bytes) -> None:
    linked = workshop.link(textured(ASKING, 'file="t.png"'), files={"t.png": picture})
    assert np.array_equal(linked.alone(0).tex_data, linked.model().tex_data)
