"""Read one episode of a data set of LeRobot, version 3. Runs in MuJoCo's process.

Its layout: `meta/info.json` has the names of the motors, and `data/chunk-000/file-000.parquet` the numbers of several
episodes. `data_path` in the file with the names is not used: the layout is fixed, and a path could lead anywhere.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mjcompose.tools.identify.files import INFO, ReadingKeys, RecordedFile, damaged, opened, together
from mjcompose.tools.identify.parquet import arrow, batches, floats
from mjcompose.tools.identify.tables import RecordedTable, RecordingFault, Series, SizeLimits, check_count

STATE = "observation.state"
ACTION = "action"
_EPISODE = "episode_index"
_TIME = "timestamp"
_CODE = "recording-column"
_INFO_SIZE = 16 << 20
_CONVERTER = "python -m lerobot.datasets.v30.convert_dataset_v21_to_v30"
_ENDS = {"pos": "qpos", "vel": "qvel"}
"""The kinds of columns by the end of a motor's name."""


def read_dataset(folder: Path, files: Sequence[Path], keys: ReadingKeys, limits: SizeLimits) -> RecordedFile:
    """Return the states and actions of an episode. Raises RecordingFault."""
    pyarrow = arrow()
    with opened(folder / INFO, SizeLimits(min(_INFO_SIZE, limits.size), limits.numbers)) as (file, digest):
        info = _info(file.read())
    names = {feature: list(_names(info, feature)) for feature in (STATE, ACTION)}
    episode = _episode(info, keys)
    digests = [digest]
    rows: list[dict[str, Series]] = []
    for path in files:
        with opened(path, limits) as (file, digest), damaged(f"a data set of LeRobot: `{path.relative_to(folder)}`"):
            contents = pyarrow.parquet.ParquetFile(file)
            read = [*_rows_of(pyarrow, contents, episode, names, limits)]
            check_count(sum(each[_TIME].size + each[STATE].size + each[ACTION].size for each in (*rows, *read)), limits)
            if read:
                digests.append(digest)
                rows += read
    if not rows:
        message = f"it has no episode {episode}{_count_of(info)}"
        raise RecordingFault(_CODE, message, "write `recording: {episode: 0}` for the first one")
    times, states, actions = (np.concatenate([each[name] for each in rows]) for name in (_TIME, STATE, ACTION))
    columns = dict(zip(names[STATE], states.T.copy(), strict=True))
    columns |= dict(zip(names[ACTION], actions.T.copy(), strict=True))
    return RecordedFile(together(digests), RecordedTable(times, columns, timed=True))


def _info(text: bytes) -> Mapping[str, Any]:
    try:
        info: dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError):
        raise RecordingFault("recording-kind", f"`{INFO}` is not JSON") from None
    version = info.get("codebase_version") if isinstance(info, dict) else None
    if not isinstance(version, str) or not version.startswith("v3."):
        message = f"it is a data set of LeRobot {str(version)[:20]}; version 3 can be read"
        raise RecordingFault("recording-kind", message, f"convert it with `{_CONVERTER}`")
    return info


def _names(info: Mapping[str, Any], feature: str) -> Iterator[str]:
    """Yield the column of each number of a feature: `shoulder_pan.pos` of a state is `qpos shoulder_pan`."""
    features = info.get("features")
    about = features.get(feature) if isinstance(features, dict) else None
    names = about.get("names") if isinstance(about, dict) else None
    if isinstance(names, dict) and len(names) == 1:  # `{motors: [...]}`
        (names,) = names.values()
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        message = f"`{INFO}` has no names of `{feature}`"
        raise RecordingFault(_CODE, message, "`features` needs the names of the motors, in the order of the numbers")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise RecordingFault(_CODE, f"`{feature}` has two numbers `{twice}`", "give them different names")
    for name in names:
        stem, dot, end = name.partition(".")
        if dot and end not in _ENDS:
            yield f"{feature} {name}"
        else:
            yield f"{_ENDS[end or 'pos'] if feature == STATE else 'ctrl'} {stem}"


def _episode(info: Mapping[str, Any], keys: ReadingKeys) -> int:
    if keys.episode is not None:
        return keys.episode
    if info.get("total_episodes") == 1:
        return 0
    message = f"it has several episodes{_count_of(info)}"
    raise RecordingFault(_CODE, message, "choose one: `recording: {episode: 0}` is the first")


def _count_of(info: Mapping[str, Any]) -> str:
    count = info.get("total_episodes")
    return f": 0 to {count - 1}" if isinstance(count, int) and 0 < count < 1 << 32 else ""


def _rows_of(
    pyarrow: Any, contents: Any, episode: int, names: Mapping[str, Sequence[str]], limits: SizeLimits
) -> Iterator[dict[str, Series]]:
    """Yield the rows of an episode in a file, in pieces."""
    wanted = (_EPISODE, _TIME, STATE, ACTION)
    lacking = [name for name in wanted if name not in contents.schema_arrow.names]
    if lacking:
        raise RecordingFault(_CODE, f"its files have no column `{lacking[0]}`")
    groups = [index for index in range(contents.num_row_groups) if _may_have(contents, index, episode)]
    if not groups:
        return
    for batch in batches(contents, wanted, limits, groups):
        rows = batch.filter(pyarrow.compute.equal(batch.column(_EPISODE), episode))
        if rows.num_rows:
            numbers = {name: _matrix(pyarrow, rows.column(name), name, len(names[name])) for name in (STATE, ACTION)}
            yield {_TIME: floats(pyarrow, rows.column(_TIME)), **numbers}


def _may_have(contents: Any, group: int, episode: int) -> bool:
    """Whether a group of rows may have rows of an episode: some files have the smallest and the largest number."""
    metadata = contents.metadata.row_group(group)
    columns = (metadata.column(index) for index in range(metadata.num_columns))
    statistics: Any = next((column.statistics for column in columns if column.path_in_schema == _EPISODE), None)
    has_range = statistics is not None and statistics.has_min_max
    return not has_range or bool(statistics.min <= episode <= statistics.max)


def _matrix(pyarrow: Any, column: Any, name: str, width: int) -> Series:
    """Return the numbers of each row. Raises RecordingFault if a row has more or fewer than there are names."""
    if pyarrow.types.is_nested(column.type):
        numbers = floats(pyarrow, column.flatten())
        lengths = pyarrow.compute.list_value_length(column).to_numpy(zero_copy_only=False)
    else:
        numbers = floats(pyarrow, column)
        lengths = np.ones(len(column))
    wrong = lengths[lengths != width]
    if wrong.size:
        message = f"`{name}` has {wrong[0]:g} numbers in a row, and `{INFO}` has {width} names"
        raise RecordingFault("recording-value", message)
    return numbers.reshape(len(column), width)
