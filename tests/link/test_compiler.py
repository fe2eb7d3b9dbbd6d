from __future__ import annotations

from link.workshop import BASE, Workshop


def test_a_model_alone_keeps_everything_but_its_folders(workshop: Workshop) -> None:
    settings = (
        'fusestatic="true" discardvisual="true" autolimits="false" usethread="false" inertiafromgeom="true"'
        ' alignfree="true" angle="radian" eulerseq="zyx"'
    )
    model = f'<mujoco><compiler meshdir="m" texturedir="t" strippath="true" {settings}/><worldbody/></mujoco>'
    linked = workshop.link(model)
    compiler = linked.linking.base.root.find("compiler")
    kept = " ".join(f'{name}="{value}"' for name, value in compiler.items())
    assert kept == settings
    linked.check()


def test_several_compilers_become_one_and_the_last_word_counts(workshop: Workshop) -> None:
    model = """
    <mujoco><compiler angle="radian" eulerseq="zyx"/><worldbody><body name="b" euler="1 2 3"><geom size="1"/></body></worldbody>
      <compiler angle="degree"/><compiler><lengthrange inttotal="2"/></compiler></mujoco>"""
    alone = workshop.link(model)
    assert alone.xml.count("<compiler") == 1
    assert "inttotal" in alone.xml
    alone.check()
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


def test_settings_without_effect_are_dropped(workshop: Workshop) -> None:
    linked = workshop.link('<mujoco><compiler usethread="false" alignfree="false"/></mujoco>', BASE)
    assert dict(linked.linking.base.root.find("compiler").attrib) == {"angle": "degree"}


def test_the_compiler_stands_first(workshop: Workshop) -> None:
    linked = workshop.link(
        '<mujoco><worldbody/><option timestep=".01"/><compiler angle="radian"/></mujoco>', BASE
    )
    assert linked.linking.base.root[0].tag == "compiler"
