from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.engine.request import Request
from composer.engine.session import Session
from composer.reading import owner
from composer.reading.owner import untrusted, untrusted_for_temporary
from composer.sources.error import SourceError
from composer.sources.store import Store

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no owner of this kind")


def test_ones_own_folder_is_trusted(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    assert untrusted(tmp_path) is None and untrusted_for_temporary(tmp_path) is None


def test_a_folder_that_everybody_writes_is_not(tmp_path: Path) -> None:
    tmp_path.chmod(0o777)
    assert untrusted(tmp_path) == "every user may write to it"
    assert untrusted_for_temporary(tmp_path) == "every user may remove what others have in it"
    tmp_path.chmod(0o1777)  # as /tmp is
    assert untrusted(tmp_path) == "every user may write to it"
    assert untrusted_for_temporary(tmp_path) is None


def test_the_folder_of_another_user_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(owner.os, "geteuid", lambda: os.stat(tmp_path).st_uid + 1)
    assert untrusted(tmp_path) == "it belongs to another user"


def test_the_store_of_another_user_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(owner.os, "geteuid", lambda: os.stat(tmp_path).st_uid + 1)
    with pytest.raises(SourceError) as caught:
        Store.of({"MJCOMPOSE_CACHE": str(tmp_path)})
    assert caught.value.code == "store-unusable"
    assert "is not trusted: it belongs to another user" in caught.value.message


@pytest.mark.own_children
def test_mujoco_does_not_work_in_a_folder_that_others_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o777)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    with Session() as session:
        answer, _ = session.ask(Request(tmp_path))
    assert answer["crash"] == "start" and "is not trusted" in answer["error"]
