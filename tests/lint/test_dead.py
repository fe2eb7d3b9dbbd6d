from __future__ import annotations

from pathlib import Path

from lint.workshop import linted, mended
from mjcompose.mujoco.engine import Session

CLASSES = """\
<mujoco>
  <default>
    <default class="used">
      <default class="inner"/>
    </default>
    <default class="outer">
      <default class="lost">
        <geom rgba="1 0 0 1"/>
      </default>
    </default>
  </default>
  <worldbody>
    <geom class="inner" size="1"/>
  </worldbody>
</mujoco>
"""


def test_a_class_is_unused_unless_it_or_a_class_inside_it_is_used(tmp_path: Path, session: Session) -> None:
    found = linted(CLASSES, "unused-class", tmp_path, session)
    assert [(each.message, each.span.line) for each in found if each.span] == [("no element uses the class `outer`", 6)]
    assert "outer" not in mended(CLASSES, found)
    assert "lost" not in mended(CLASSES, found)
    assert mended(CLASSES, found).count("\n") == CLASSES.count("\n") - 5


def test_a_comment_ignores_a_finding(tmp_path: Path, session: Session) -> None:
    ignored = CLASSES.replace(
        '    <default class="outer">', '    <!-- mjcompose: ignore[unused-class] -->\n    <default class="outer">'
    )
    assert not linted(ignored, "unused-class", tmp_path, session)
    other = ignored.replace("unused-class", "other-rule")
    assert linted(other, "unused-class", tmp_path, session)
    whole = CLASSES.replace("<mujoco>", "<mujoco><!-- mjcompose: ignore-file[a-b, unused-class] -->")
    assert not linted(whole, "unused-class", tmp_path, session)
