from __future__ import annotations

import zipfile
from pathlib import Path

from composer.bundle.archive import write_archive
from composer.bundle.bundle import Bundle
from composer.bundle.packing import Packed, PackedAhead, level_of, pack, unwrapped, wrapped

BUNDLE = Bundle(
    {"model.xml": b"<mujoco/>" * 99, "assets/a.stl": bytes(range(256)) * 40, "assets/a.png": b"png" * 99}
)


def test_a_zip_of_what_is_packed_is_as_python_makes_it(tmp_path: Path) -> None:
    write_archive(BUNDLE, tmp_path / "ours.zip", {})
    with zipfile.ZipFile(tmp_path / "theirs.zip", "w") as archive:
        for path in ("model.xml", "assets/a.png", "assets/a.stl"):
            info = zipfile.ZipInfo(path)
            info.create_system, info.external_attr = 3, 0o100644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED if level_of(path) else zipfile.ZIP_STORED
            archive.writestr(info, BUNDLE.files[path], compresslevel=level_of(path) or None)
    assert (tmp_path / "ours.zip").read_bytes() == (tmp_path / "theirs.zip").read_bytes()


def test_what_was_packed_before_is_copied(tmp_path: Path) -> None:
    kept: dict[str, Packed] = {path: pack(content, level_of(path)) for path, content in BUNDLE.files.items()}
    write_archive(BUNDLE, tmp_path / "now.zip", {})
    write_archive(BUNDLE, tmp_path / "kept.zip", {}, lambda bundle, path: kept[path])
    assert (tmp_path / "now.zip").read_bytes() == (tmp_path / "kept.zip").read_bytes()


def test_wrapping() -> None:
    packed = pack(b"abc" * 50, 6)
    assert unwrapped(wrapped(packed)) == packed


def test_files_are_packed_ahead_but_for_those_that_are_known_and_those_that_are_packed_already() -> None:
    known = Packed(1, 2, b"known")
    find = {BUNDLE.digest("assets/a.stl"): known}.get
    ahead = PackedAhead(BUNDLE, lambda digest, level: find(digest))
    text = BUNDLE.files["model.xml"]
    assert ahead.take(BUNDLE.digest("model.xml")) == (pack(text, level_of("model.xml")), True)
    assert ahead.take(BUNDLE.digest("assets/a.stl")) == (known, False)
    assert ahead.take(BUNDLE.digest("assets/a.png")) is None
    ahead.end()
    assert ahead.take(BUNDLE.digest("model.xml")) is None
