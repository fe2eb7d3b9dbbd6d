"""Rules about elements that nothing uses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mjcompose.build.lint.rule import Edit, Finding, Found, Subject, rule

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


@rule("unused-class")
def unused_class(subject: Subject) -> Found:
    """A default class that no element uses.

    MuJoCo reads the class, and it changes nothing. Often its name is misspelled where it should be used, so the
    elements have other values than intended.

    ```xml
    <default>
      <default class="visual"><geom group="2"/></default>   <!-- never used -->
    </default>
    ```

    Use the class with `class` or `childclass`, or remove it. A class counts as used if a class inside it is.
    """
    used = set(subject.names.uses.get("default", ()))

    def is_used(section: Node) -> bool:
        return any(str(each.get("class")) in used for each in section.iter("default"))

    for element in subject.root.iterfind("default//default"):
        outer = element.getparent()
        is_inside = outer is not None and outer.getparent() is not subject.root and not is_used(outer)
        if element.get("class") and not is_used(element) and not is_inside:
            message = f"no element uses the class `{element.get('class')}`"
            yield Finding(element, message, "class", help="use it, or remove it", edit=Edit(removes=True))
