"""What the MuJoCo that judged a model passes over is told by the version of that MuJoCo."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from composer.context import Context
from composer.engine import Session
from composer.stages import Request, build
from composer.verify import compile_report

# An attribute of MuJoCo 4.0, which older ones pass over inside a frame and refuse elsewhere.
NEW = '<mujoco><worldbody>{}<frame><body><geom size=".1" castshadow="false"/></body></frame></worldbody></mujoco>'


def told(folder: Path, monkeypatch: pytest.MonkeyPatch, version: str | None, model: str) -> list[str]:
    """Codes and messages that are reported where a MuJoCo of that version compiled the model."""
    verdict = SimpleNamespace(
        warnings=(), error=None, code=None, crash=None, compiled=SimpleNamespace(mujoco_version=version)
    )
    (folder / "m.xml").write_text(model)
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=folder)
    built = build(Request(Path("r.yaml"), verified=False), context)
    assert built is not None
    monkeypatch.setattr(compile_report, "verify", lambda *_, **__: verdict)
    judged = compile_report.judge(built.bundle, built.composed.model, context, session=cast(Session, None))
    assert judged is cast(Any, verdict.compiled)
    return [
        f"{each.severity.name}: {each.code}"
        for each in context.sink.sorted()
        if each.code != "licence-missing"
    ]


@pytest.mark.parametrize(
    ("version", "model", "said"),
    [
        ("4.0.0", NEW.format(""), []),
        ("3.12.0", NEW.format(""), ["WARNING: unknown-attribute"]),
        ("99.0.0", NEW.format("").replace("castshadow", "new_in_99"), []),
        (None, NEW.format(""), ["WARNING: unknown-attribute"]),
    ],
    ids=["has it", "has it not", "newer than the grammar", "nobody knows which"],
)
def test_an_attribute_inside_a_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str | None, model: str, said: list[str]
) -> None:
    assert told(tmp_path, monkeypatch, version, model) == said
