"""Names from `dm_control.mjcf` that differ here, as hints for its users; see docs/dm_control.md."""

from __future__ import annotations

ATTRIBUTES = {
    "get_assets": "`assets`, a property, has the bytes of all files by name",
    "get_attribute_xml_string": "`repr(element)` shows attributes as they are written",
    "get_children": "children are attributes: `body.geom`",
    "get_init_stack": "`origin` is where an element came from, `origin_of(attribute)` an attribute",
    "is_removed": "using an element that was removed says so",
    "is_same_as": "compare what is printed: `str(a) == str(b)`",
    "namescope": "`root` is the model of an element, `find` and `enter_scope` look by name",
    "prefixed_identifier": "`full_identifier` is the name in the output",
    "resolve_references": "references are always resolved",
    "to_xml": "`str(element)` is its text, `root.to_xml_string()` the whole composition",
    "to_xml_string": "`str(element)` is its text, `root.to_xml_string()` the whole composition",
}
"""Members of its elements, and what to write instead."""

TAGS = {
    "attachment_frame": "`get_attachment_frame(model)` is the frame, `enter_scope(name)` the attached model",
    "attached_model": "`enter_scope(name)` is the attached model",
}
"""What its `find` knows besides tags."""
