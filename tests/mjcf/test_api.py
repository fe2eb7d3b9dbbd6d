"""What `mjcompose.mjcf` promises its users: names, parameters, and an example in every docstring."""

from __future__ import annotations

import inspect

import pytest
from mjcompose import mjcf

SIGNATURES = {
    "from_xml_string": "xml_string assets base_dir",
    "from_path": "path",
    "from_file": "file_object",
    "from_zip": "path",
    "RootElement": "model",
    "RootElement.find": "tag name",
    "RootElement.find_all": "tag immediate_children_only",
    "RootElement.attach": "other",
    "RootElement.detach": "",
    "RootElement.compile_model": "",
    "RootElement.to_xml_string": "",
    "RootElement.include_copy": "other override",
    "Element.add": "tag",
    "Element.insert": "tag position",
    "Element.remove": "cascade",
    "Element.find": "tag name",
    "Element.find_all": "tag immediate_children_only",
    "Element.get": "attribute default",
    "Element.set_attributes": "",
    "Element.get_attributes": "",
    "Element.all_children": "",
    "Element.attach": "other",
    "Element.origin_of": "attribute",
    "get_attachment_frame": "element",
    "get_frame_freejoint": "frame",
    "get_frame_joints": "frame",
    "get_freejoint": "body",
    "commit_defaults": "root_or_element",
    "export_with_assets": "model out_dir model_filename",
    "export_with_assets_as_zip": "model zip_path model_filename",
    "Physics.from_mjcf_model": "root",
    "Physics.from_xml_string": "xml_string",
    "Physics.from_path": "path",
    "Physics.step": "n",
    "Physics.forward": "",
    "Physics.reset": "keyframe",
    "Physics.copy": "",
    "Physics.render": "height width camera",
    "Physics.bind": "",
}
PROPERTIES = {
    "RootElement": "assets parent_model root_model model",
    "Element": "tag parent root name full_identifier origin",
    "Asset": "contents bundle_path",
    "Physics": "model data time timestep",
}
SECTIONS = (
    "worldbody asset actuator sensor compiler option size visual statistic default extension custom contact "
    "equality tendon keyframe deformable"
)


def member(path: str) -> object:
    value: object = mjcf
    for name in path.split("."):
        value = getattr(value, name)
    return value


NOTHING_TO_SHOW = ("Element.tag", "Asset.contents", "Asset.source")


def documented() -> list[str]:
    """Everything of the tree that takes or gives something; physics has its examples with the class."""
    found = [name for name in mjcf.__all__ if inspect.isfunction(getattr(mjcf, name))]
    for owner in ("Element", "RootElement", "Asset"):
        members = vars(getattr(mjcf, owner)).items()
        shown = [name for name, value in members if isinstance(value, property) or inspect.isfunction(value)]
        found += [f"{owner}.{name}" for name in shown if not name.startswith("_")]
    return [path for path in found if path not in NOTHING_TO_SHOW]


@pytest.mark.parametrize(("path", "parameters"), SIGNATURES.items())
def test_parameters(path: str, parameters: str) -> None:
    known = [name for name in inspect.signature(member(path)).parameters if name != "self"]  # type: ignore[arg-type]
    assert known[: len(parameters.split())] == parameters.split()


def test_properties_and_sections() -> None:
    for owner, names in PROPERTIES.items():
        for name in names.split():
            assert isinstance(member(f"{owner}.{name}"), property), name
    root = mjcf.RootElement()
    assert [getattr(root, tag).tag for tag in SECTIONS.split()] == SECTIONS.split()


@pytest.mark.parametrize("path", documented())
def test_an_example_in_every_docstring(path: str) -> None:
    assert ">>>" in (inspect.getdoc(member(path)) or "")
