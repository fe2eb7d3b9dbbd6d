"""How long another machine may say nothing: a number, or an error that says so."""

from __future__ import annotations

from pathlib import Path

import pytest

from composer.sources import SourceError
from composer.sources.fetching import Fetching
from composer.sources.resolve import resolve


@pytest.mark.parametrize("written", ["inf", "1e300", "nan", "0", "-5", "30s", " "])
@pytest.mark.parametrize("reference", ["http://127.0.0.1:9/a.zip#a.xml", "git+http://127.0.0.1:9/a@v1#a.xml"])
def test_what_is_no_time_is_told(written: str, reference: str, own_environment: dict[str, str]) -> None:
    environment = {**own_environment, "MJCOMPOSE_TIMEOUT": written}
    with pytest.raises(SourceError, match="MJCOMPOSE_TIMEOUT") as caught:
        resolve(reference, relative_to=Path(), environment=environment, fetching=Fetching())
    assert caught.value.help == "write it as `30`"
