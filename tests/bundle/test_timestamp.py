"""The time of the files in an archive, ours and those of others."""

from __future__ import annotations

import zipfile
from io import BytesIO

from composer.bundle.timestamp import with_moment

MOMENT = (2023, 11, 14, 22, 13, 20)


def test_an_archive_of_others_gets_the_time_and_stays_as_it_is() -> None:
    made = BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name in ("a.usdc", "Textures/ü.png"):
            info = zipfile.ZipInfo(name, (1999, 12, 31, 23, 59, 58))
            info.extra, info.comment = b"\x86\x19\x04\x00\0\0\0\0", b"a comment"
            archive.writestr(info, name.encode() * 50)
    changed = with_moment(made.getvalue(), MOMENT)
    assert len(changed) == len(made.getvalue())
    with zipfile.ZipFile(BytesIO(changed)) as archive:
        assert archive.testzip() is None
        assert [(info.filename, info.date_time) for info in archive.infolist()] == [
            ("a.usdc", MOMENT), ("Textures/ü.png", MOMENT),
        ]  # fmt: skip
    assert with_moment(changed, (1999, 12, 31, 23, 59, 58)) == made.getvalue()
