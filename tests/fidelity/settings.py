"""Real models with a compiler setting that they have not got: as the base of themselves, and as its part."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fidelity.corpus import Attachment, Composition, pairs

SETTINGS = (
    'settotalmass="7"',
    'balanceinertia="true"',
    'boundmass=".5"',
    'boundinertia=".01"',
    'fusestatic="true"',
    'discardvisual="true"',
    'alignfree="true"',
    'fitaabb="true"',
    'fusestatic="true" discardvisual="true" settotalmass="7" alignfree="true" fitaabb="true"',
)


def with_settings(corpus: Path, folder: Path, count: int) -> Iterator[Composition]:
    """The first models of the pairs with every setting, in both places. They are written below `folder`."""
    for number, model in enumerate(_models(corpus)[:count]):
        name = f"{model.parent.name}/{model.stem}"
        for setting in SETTINGS:
            label = "+".join(each.partition("=")[0] for each in setting.split())
            ruled = _ruled(model, setting, folder / f"{number}-{label}")
            for place, base, part in (("base", ruled, model), ("part", model, ruled)):
                hung = Attachment(part, "other/", pos=(2.0, 0.5, 0.25))
                yield Composition(f"{name} {label} of the {place}", base, (hung,), compared=False)


def _models(corpus: Path) -> list[Path]:
    found: dict[Path, None] = {}
    for pair in pairs(corpus):
        for path in (pair.parent, *(attachment.child for attachment in pair.attachments)):
            if path.suffix == ".xml" and not pair.refused:
                found[path] = None
    return list(found)


def _ruled(model: Path, setting: str, folder: Path) -> Path:
    """The model with one more `<compiler>`, whose word is the last; all that it may refer to stands around it."""
    home = folder / model.parent.name
    home.mkdir(parents=True)
    for source, target in ((model.parent.parent, folder), (model.parent, home)):
        for each in source.iterdir():
            if each not in (model, model.parent):
                (target / each.name).symlink_to(each)
    head, end, tail = model.read_text(encoding="utf-8").rpartition("</mujoco")
    ruled = home / model.name
    ruled.write_text(f"{head}<compiler {setting}/>{end}{tail}", encoding="utf-8")
    return ruled
