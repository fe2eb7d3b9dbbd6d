from __future__ import annotations

import mujoco
import pytest
from link.workshop import BASE, Linked, Piece, Workshop

from composer.link.linking import Linking
from composer.link.submodel_options import submodel_options
from composer.link.written import SINGLETONS

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
    opt, vis = model.opt, model.vis
    return [
        opt.timestep, opt.iterations, opt.cone, opt.gravity.tolist(), opt.disableflags, opt.enableflags,
        vis.map.znear, vis.map.zfar, vis.global_.realtime, vis.headlight.ambient.tolist(), model.narena,
    ]  # fmt: skip


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
        "`part/` wants `option.cone` to be `elliptic`, the model has `pyramidal`",
    )
    assert found.fault.span is not None
    assert found.fault.span.line == 1
    assert linked(workshop, host(policy="warning"), '<option cone="elliptic"/>').codes == []


def test_models_below_models_count_where_they_are_merged(workshop: Workshop) -> None:
    inner = host(policy="merge").replace("sub.xml", "inner.xml").replace("<mujoco>", '<mujoco model="sub">')
    inner = inner.replace('body="s"', 'body="s"').replace('name="b"', 'name="s"').replace("<joint/>", "")
    files = {
        "sub.xml": inner.replace('prefix="q"', 'prefix="i"'),
        "inner.xml": sub('<option cone="elliptic"/>'),
    }
    base = "<mujoco><worldbody><body/></worldbody></mujoco>"
    found = workshop.link(host(), base, files=files)
    assert found.alone(0).opt.cone == found.model().opt.cone == 1


def test_a_model_of_one_unit_leaves_it_to_mujoco(workshop: Workshop) -> None:
    unit = workshop.unit(host(), {"sub.xml": sub(ASKED)})
    submodel_options(Linking(unit, [], None))  # type: ignore[arg-type]
    assert not list(unit.root.iterchildren(*SINGLETONS))
