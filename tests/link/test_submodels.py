from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from link.workshop import BASE, Linked, Piece, Workshop, obj, placed
from mjcompose.base.sink import Sink
from mjcompose.link.agreement import SINGLETONS
from mjcompose.link.collect import collect
from mjcompose.link.link import finish, link
from mjcompose.link.linking import Linking, Part
from mjcompose.link.submodels import submodel_options
from mjcompose.tree.unit import Unit

pytestmark = pytest.mark.mujoco4("MuJoCo 3 has no `conflict`")


def sub(sections: str) -> str:
    return f'<mujoco model="sub">{sections}<worldbody><body name="s"><geom size=".1"/></body></worldbody></mujoco>'


def host(sections: str = "", policy: str = "merge") -> str:
    return f"""<mujoco><compiler conflict="{policy}"/>{sections}<asset><model file="sub.xml"/></asset>
      <worldbody><body name="b"><joint/><geom size=".1"/><attach model="sub" body="s" prefix="q"/></body></worldbody>
      </mujoco>"""


def linked(workshop: Workshop, part: str, of_sub: str, **options: object) -> Linked:
    return workshop.link(BASE, Piece(part, files={"sub.xml": sub(of_sub)}), **options)


def settings(model: mujoco.MjModel) -> list[object]:
    opt = model.opt
    vis = model.vis
    return [
        opt.timestep,
        opt.iterations,
        opt.cone,
        opt.gravity.tolist(),
        opt.disableflags,
        opt.enableflags,
        vis.map.znear,
        vis.map.zfar,
        vis.global_.realtime,
        vis.headlight.ambient.tolist(),
        model.narena,
    ]


ASKED = """<option timestep=".001" iterations="7" gravity="0 0 -1"><flag energy="enable" gravity="disable"/></option>
  <visual><map znear=".5" zfar="3"/><headlight ambient="1 0 0"/><global realtime=".5"/></visual>
  <size memory="17M"/>"""


@pytest.mark.parametrize(
    "own",
    [
        "",
        '<option timestep=".004" iterations="9" cone="elliptic"><flag contact="disable"/></option>',
        '<option timestep=".0005" iterations="3"><flag gravity="enable"/></option><size memory="18M"/>',
        '<visual><map znear=".3"/></visual>',
    ],
)
@pytest.mark.parametrize("policy", ["merge", "warning"])
def test_a_unit_has_the_options_that_it_has_alone(workshop: Workshop, own: str, policy: str) -> None:
    """As the base: nobody else has an opinion."""
    other = "<mujoco><worldbody><body/></worldbody></mujoco>"
    found = workshop.link(host(own, policy), other, files={"sub.xml": sub(ASKED)})
    assert settings(found.model()) == settings(found.alone(0))


def test_what_is_attached_to_a_part_is_a_wish_of_the_part(workshop: Workshop) -> None:
    part = Piece(host(), files={"sub.xml": sub('<option cone="elliptic"/>')})
    base = BASE.replace("<worldbody>", '<option cone="pyramidal"/><worldbody>')
    found = workshop.link(base, part)
    assert (found.fault.code, found.fault.message) == (
        "option-conflict",
        "`part/` needs `option.cone` to be `elliptic`, the model has `pyramidal`",
    )
    assert found.fault.span is not None
    assert found.fault.span.line == 1
    assert linked(workshop, host(policy="warning"), '<option cone="elliptic"/>').codes == []


def test_models_below_models_count_where_they_are_merged(workshop: Workshop) -> None:
    inner = host(policy="merge").replace("sub.xml", "inner.xml").replace("<mujoco>", '<mujoco model="sub">')
    inner = inner.replace('body="s"', 'body="s"').replace('name="b"', 'name="s"').replace("<joint/>", "")
    files = {"sub.xml": inner.replace('prefix="q"', 'prefix="i"'), "inner.xml": sub('<option cone="elliptic"/>')}
    base = "<mujoco><worldbody><body/></worldbody></mujoco>"
    found = workshop.link(host(), base, files=files)
    assert found.alone(0).opt.cone == found.model().opt.cone == 1


def test_a_model_of_one_unit_leaves_it_to_mujoco(workshop: Workshop) -> None:
    unit = workshop.unit(host(), {"sub.xml": sub(ASKED)})
    submodel_options(Linking(unit, [], None))  # type: ignore[arg-type]
    assert not list(unit.root.iterchildren(*SINGLETONS))


SUB = """
<mujoco model="sub"><compiler meshdir="m" angle="radian" eulerseq="zyx"/>
  <default><geom rgba="1 0 0 1"/></default>
  <asset><mesh file="a.obj"/><mesh name="second" file="../n/a.obj"/></asset>
  <worldbody><body name="arm" euler="1 .2 .3"><joint name="pivot" range="-1 1"/><geom type="mesh" mesh="a"/>
    <geom type="mesh" mesh="second"/></body></worldbody></mujoco>"""
SUB_FILES: dict[str, bytes | str] = {"s/sub.xml": SUB, "s/m/a.obj": obj(0.1), "s/n/a.obj": obj(0.2)}
HOLDER = """
<mujoco><asset><model name="sub" file="s/sub.xml"/></asset>
  <worldbody><body name="holder"><attach model="sub" body="arm" prefix="left/"/></body></worldbody>
  <actuator><motor joint="left/pivot"/></actuator></mujoco>"""


def test_a_sub_model_comes_with_its_files_and_means_the_same(workshop: Workshop) -> None:
    linked = workshop.link(BASE, Piece(HOLDER, "p/", files=SUB_FILES))
    linked.check()
    assert sorted(linked.bundled()) == [
        "assets/part/models/sub.xml",
        "assets/part/models/sub/a.obj",
        "assets/part/models/sub/n/a.obj",
    ]


def test_the_base_may_have_sub_models_too(workshop: Workshop) -> None:
    workshop.link(HOLDER, Piece(HOLDER, "p/", files=SUB_FILES), files=SUB_FILES).check()


def test_an_unnamed_sub_model_is_called_after_the_model_in_its_file(workshop: Workshop) -> None:
    holder = HOLDER.replace('name="sub" ', "")
    workshop.link(BASE, Piece(holder, "p/", files=SUB_FILES)).check()


def test_two_sub_models_of_one_name_stay_apart(workshop: Workshop) -> None:
    holder = """
    <mujoco><asset><model name="a" file="a/sub.xml"/><model name="b" file="b/sub.xml"/></asset><worldbody>
      <body name="h"><attach model="a" body="arm" prefix="a_"/><attach model="b" body="arm" prefix="b_"/></body>
    </worldbody></mujoco>"""
    other = SUB.replace("1 0 0 1", "0 1 0 1")
    content = {"a/sub.xml": SUB, "b/sub.xml": other, "a/m/a.obj": obj(0.1), "b/m/a.obj": obj(0.2)}
    content |= {"a/n/a.obj": obj(0.3), "b/n/a.obj": obj(0.4)}
    linked = workshop.link(BASE, Piece(holder, "p/", files=content))
    linked.check()
    assert len(linked.bundled()) == 6


def test_files_of_a_sub_model_that_would_meet_stay_apart(workshop: Workshop) -> None:
    sub = SUB.replace('meshdir="m"', "").replace("a.obj", "x/a.obj", 1).replace("../n/a.obj", "../x/a.obj")
    content = {"s/sub.xml": sub, "s/x/a.obj": obj(0.1), "x/a.obj": obj(0.2)}
    linked = workshop.link(BASE, Piece(HOLDER, "p/", files=content))
    linked.check()
    assert len(linked.bundled()) == 3


def test_sub_models_of_sub_models(workshop: Workshop) -> None:
    outer = """<mujoco model="outer"><asset><model name="sub" file="s/sub.xml"/></asset><worldbody>
      <body name="shoulder"><attach model="sub" body="arm" prefix="in_"/></body></worldbody></mujoco>"""
    holder = """<mujoco><asset><model name="outer" file="outer.xml"/></asset><worldbody>
      <body name="h"><attach model="outer" body="shoulder" prefix="out_"/></body></worldbody></mujoco>"""
    linked = workshop.link(BASE, Piece(holder, "p/", files={**SUB_FILES, "outer.xml": outer}))
    model = linked.check()
    assert model.joint(0).name == "p/out_in_pivot"


@pytest.mark.parametrize("content", [{}, {"s/sub.xml": "<mujoco>"}, {"s/sub.xml": "<robot/>"}])
def test_a_sub_model_that_cannot_be_read_is_told(workshop: Workshop, content: dict[str, bytes | str]) -> None:
    linked = workshop.link(BASE, Piece(HOLDER, "p/", files=content))
    assert linked.codes in (["file-not-found"], ["xml-syntax"], ["not-mjcf"])


def composed(linked: Linked) -> Unit:
    """A composition as a unit of its own, as a nested recipe gives one."""
    base = linked.linking.base
    uses = linked.linking.files
    known = {use.path: use.content if use.content is not None else Path(use.source) for use in uses}
    return Unit(base.root, base.file, base.directory, base.label, known, base.origins)


def test_sub_models_of_compositions_keep_their_files(workshop: Workshop) -> None:
    other = {**SUB_FILES, "s/sub.xml": SUB.replace("1 0 0 1", "0 1 0 1"), "s/m/a.obj": obj(0.7)}
    inner = [workshop.link(BASE, Piece(HOLDER, "p/", files=content)) for content in (SUB_FILES, other, SUB_FILES)]
    alone = inner[0].model()
    parts = [
        Part(composed(each), prefix, placed(pos=(x, 0.0, 0.0)))
        for each, prefix, x in zip(inner, ("a/", "b/", "c/"), (0.0, 1.0, 2.0), strict=True)
    ]
    outer = Linking(workshop.unit("<mujoco/>"), parts, Sink())
    assert link(outer)
    finish(outer)
    both = Linked(workshop, outer, [], [])
    model = both.model()
    assert model.nmesh == 3 * alone.nmesh
    assert model.geom_rgba[[0, 2, 4], :2].tolist() == [[1, 0], [0, 1], [1, 0]]
    assert len([path for path in both.bundled() if path.endswith("sub.xml")]) == 2
    assert collect(outer.base, outer.files, outer.sink) == both.bundled()


def test_sub_models_of_compositions_that_differ_in_a_mesh_alone_stay_apart(workshop: Workshop) -> None:
    parts = []
    alone = []
    for prefix, content in (("a/", SUB_FILES), ("b/", {**SUB_FILES, "s/m/a.obj": obj(0.7)})):
        inner = workshop.link(BASE, Piece(HOLDER, "p/", files=content))
        unit = composed(inner)
        unit.contents = inner.bundled()
        alone.append(inner.model().geom_rbound.tolist())
        parts.append(Part(unit, prefix, placed()))
    outer = Linking(workshop.unit("<mujoco/>"), parts, Sink())
    assert link(outer)
    finish(outer)
    model = Linked(workshop, outer, [], []).model()
    assert alone[0] != alone[1] and model.geom_rbound.tolist() == alone[0] + alone[1]


def test_what_is_attached_is_counted_through_the_door(tmp_path: Path) -> None:
    """Not even to count it is a file outside opened."""
    from mjcompose.base.access import Door
    from mjcompose.link.submodels import attached_size
    from mjcompose.tree.parse import parse_text

    (tmp_path / "own").mkdir()
    (tmp_path / "secret.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
    text = (
        f'<mujoco><asset><model name="m" file="{tmp_path}/secret.xml"/></asset>'
        '<worldbody><attach model="m" prefix="a"/></worldbody></mujoco>'
    )
    for roots, size in (([tmp_path / "own"], 0), ([tmp_path], 3)):
        unit = parse_text(text, Sink(), file="m.xml", directory=tmp_path / "own", label="m", door=Door.of(roots))
        assert unit is not None
        assert attached_size(unit)(next(unit.root.iter("attach"))).elements == size
