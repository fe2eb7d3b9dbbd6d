"""Read joint states and commands of ROS 2 from MCAP, chunk by chunk. Runs in MuJoCo's process.

The size of a chunk is checked before it is unpacked, so a log of any length needs the memory of its largest chunk and
of the numbers that are read. Only messages of the two topics are decoded.
"""

from __future__ import annotations

import io
from array import array
from collections.abc import Iterator, Sequence
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np

from mjcompose.tools.identify.files import ReadingKeys, RecordedFile, damaged, not_installed, opened, together
from mjcompose.tools.identify.tables import RecordedTable, RecordingFault, SizeLimits, check_count, too_large

_KIND = "an MCAP file"
_LARGEST = 256 << 20
"""The most bytes of one record, also unpacked. Writers make chunks of some megabytes."""
_CODE = "recording-column"
_APART = 0.5
"""Seconds between stamps and the times of recording from which they are of two clocks."""
_SHOWN = 8


def read_mcap(paths: Sequence[Path], keys: ReadingKeys, limits: SizeLimits) -> RecordedFile:
    """Return the positions of the state topic and the commands of the command topic. Raises RecordingFault."""
    log = _Log(keys, limits)
    digests = []
    for path in paths:
        with opened(path, limits) as (file, digest), damaged(_KIND):
            log.read(file)
        digests.append(digest)
    return log.contents(together(digests))


class _Topic:
    """The numbers of one topic by name, with the two times of each message in nanoseconds."""

    def __init__(self, name: str, limits: SizeLimits) -> None:
        self.name = name
        self.limits = limits
        self.logged = array("q")
        self.stamped = array("q")
        self.columns: dict[str, array[float]] = {}

    def add(self, logged: int, stamped: int | None, names: Sequence[str], values: Sequence[float]) -> None:
        """Add a message; a name that it lacks has no number in this row."""
        if len(names) != len(values):
            message = f"a message of `{self.name}` has {len(names)} names and {len(values)} numbers"
            raise RecordingFault("recording-value", message)
        row = len(self.logged)
        for name, value in zip(names, values, strict=True):
            if name not in self.columns:
                check_count((row + 1) * (len(self.columns) + 1), self.limits)
                self.columns[name] = array("d", [np.nan]) * row
            column = self.columns[name]
            if len(column) > row:
                raise RecordingFault(_CODE, f"a message of `{self.name}` has `{name}` twice")
            column.append(value)
        for column in self.columns.values():
            if len(column) == row:
                column.append(np.nan)
        self.logged.append(logged)
        if stamped is not None:
            self.stamped.append(stamped)
        check_count(len(self.logged) * (len(self.columns) + 1), self.limits)

    @property
    def has_stamps(self) -> bool:
        return len(self.stamped) == len(self.logged)

    def times(self, clock: str) -> Any:
        return np.array(self.stamped if self.has_stamps and clock == "header" else self.logged, np.int64)


class _Log:
    """The messages of one or several files."""

    def __init__(self, keys: ReadingKeys, limits: SizeLimits) -> None:
        try:
            import lz4.frame
            import mcap.stream_reader
            import mcap_ros2.decoder
            import zstandard
        except ImportError as error:
            raise not_installed(str(error.name).partition(".")[0].replace("mcap_ros2", "mcap-ros2-support")) from None
        self._lz4 = lz4.frame
        self._zstd = zstandard
        self._reader = mcap.stream_reader
        self._factory = mcap_ros2.decoder.DecoderFactory
        self.keys = keys
        self.limits = limits
        self.unpacked = 0
        self.topics: dict[str, str] = {}
        self.state = _Topic(keys.state, limits)
        self.command = None if keys.command is None else _Topic(keys.command, limits)
        self._kind: str | None = None

    # ---------------------------------------------------------------------------------------------------------- file

    def read(self, file: BufferedReader) -> None:
        """Read all messages of a file."""
        decoder = self._factory()
        schemas: dict[int, Any] = {}
        channels: dict[int, Any] = {}
        for record in self._records(file):
            kind = type(record).__name__
            if kind == "Schema":
                schemas[record.id] = record
            elif kind == "Channel":
                channels[record.id] = record
                schema = schemas.get(record.schema_id)
                self.topics[record.topic] = "" if schema is None else schema.name
            elif kind == "Message":
                channel = channels[record.channel_id]
                if channel.topic in (self.keys.state, self.keys.command):
                    self._add(channel, schemas.get(channel.schema_id), decoder, record)

    def _records(self, file: BufferedReader) -> Iterator[Any]:
        size = file.seek(0, io.SEEK_END)
        file.seek(0)
        stream: Any = _UpToEnd(file, size)
        reader = self._reader.StreamReader(stream, emit_chunks=True, validate_crcs=True, record_size_limit=_LARGEST)
        for record in reader.records:
            if type(record).__name__ == "Chunk":
                yield from self._unpacked(record)
            else:
                yield record

    def _unpacked(self, chunk: Any) -> list[Any]:
        """Return the records of a chunk, of which no more is unpacked than it says."""
        self.unpacked += chunk.uncompressed_size
        if self.unpacked > self.limits.size:
            raise too_large("bytes", self.unpacked, self.limits)
        if chunk.uncompressed_size > _LARGEST:
            raise RecordingFault("recording-kind", f"it has a chunk of {chunk.uncompressed_size} bytes")
        most = chunk.uncompressed_size + 1
        if chunk.compression == "zstd":
            with self._zstd.ZstdDecompressor().stream_reader(chunk.data) as stream:
                chunk.data = stream.read(most)
        elif chunk.compression == "lz4":
            chunk.data = self._lz4.LZ4FrameDecompressor().decompress(chunk.data, max_length=most)
        elif chunk.compression:
            raise RecordingFault("recording-kind", f"its chunks are packed with `{chunk.compression[:20]}`")
        if len(chunk.data) != chunk.uncompressed_size:
            raise ValueError("a chunk has another size than it says")
        chunk.compression = ""
        records: list[Any] = self._reader.breakup_chunk(chunk, validate_crc=True)
        return records

    # ------------------------------------------------------------------------------------------------------ messages

    def _add(self, channel: Any, schema: Any, factory: Any, record: Any) -> None:
        topic = channel.topic
        decode = factory.decoder_for(channel.message_encoding, schema)
        if decode is None:
            encoding = f"{channel.message_encoding} with {schema.encoding if schema else 'no'} definitions"
            message = f"the messages of `{topic}` are in the encoding {encoding}, which cannot be read"
            raise RecordingFault("recording-kind", message, "record ROS 2 messages: `ros2 bag record -s mcap`")
        message = decode(record.data)
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        stamped = None
        if stamp is not None and (stamp.sec or stamp.nanosec):
            stamped = int(stamp.sec) * 10**9 + int(stamp.nanosec)
        if topic == self.keys.state:
            names, values = self._positions(message)
            if len(values):
                self.state.add(record.log_time, stamped, names, values)
        if topic == self.keys.command and self.command is not None:
            names, values = self._commands(message)
            self.command.add(record.log_time, stamped, names, values)

    def _positions(self, message: Any) -> tuple[Sequence[str], Sequence[float]]:
        """Return the names and positions of a message; both are empty if it has no positions."""
        feedback: Any = getattr(message, "feedback", None) or getattr(message, "actual", None)
        if hasattr(message, "name") and hasattr(message, "position"):
            return (message.name, message.position) if len(message.position) else ((), ())
        if hasattr(message, "joint_names") and hasattr(feedback, "positions"):
            return message.joint_names, feedback.positions
        raise self._no_joints(self.keys.state, "joint states")

    def _commands(self, message: Any) -> tuple[Sequence[str], Sequence[float]]:
        reference: Any = getattr(message, "reference", None) or getattr(message, "desired", None)
        if hasattr(message, "name") and hasattr(message, "position"):
            return message.name, getattr(message, self._field_of(message))
        if hasattr(message, "joint_names") and hasattr(reference, "positions"):
            return message.joint_names, reference.positions
        if not hasattr(message, "data"):
            raise self._no_joints(self.command.name if self.command else "", "commands")
        joints = self.keys.command_joints
        if not joints:
            help = "write `recording: {command_joints: […]}`, in the order of the controller"
            raise RecordingFault(_CODE, f"the commands of `{self.keys.command}` have no names", help)
        return joints, message.data

    def _field_of(self, message: Any) -> str:
        """Return the field with commands: the first message says whether they are positions, speeds or efforts."""
        if self._kind is None:
            fields = ("position", "velocity", "effort")
            self._kind = next((field for field in fields if len(getattr(message, field, ()))), "position")
        return self._kind

    def _no_joints(self, topic: str, what: str) -> RecordingFault:
        message = f"the messages of `{topic}` are {self.topics[topic]}, which are no {what}"
        return RecordingFault(_CODE, message, self._topics())

    # ------------------------------------------------------------------------------------------------------- contents

    def _topics(self) -> str:
        """Return the help that lists the topics with joint states and numbers first."""
        known = sorted(self.topics.items(), key=lambda each: (not each[1].endswith(("JointState", "Array")), each))
        shown = ", ".join(f"{topic} ({kind})" if kind else topic for topic, kind in known[:_SHOWN])
        more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
        return f"it has {shown or 'no topics'}{more}"

    def contents(self, digest: str) -> RecordedFile:
        """Return the tables. States before the first command are left out: their commands are not known."""
        self._check_topics()
        states = self.state.times(self.keys.clock)
        first = 0
        begin = int(states[0])
        commands = None
        advice = None
        if self.command is None:
            advice = f"write the topic of the commands, `recording: {{command: TOPIC}}`: {self._topics()}"
        else:
            self._check_clocks(self.command)
            times = self.command.times(self.keys.clock)
            first = int(np.searchsorted(np.maximum.accumulate(states), times[0]))
            if first >= len(states):
                message = f"`{self.command.name}` begins after the last message of `{self.state.name}`"
                raise RecordingFault("recording-time", message, "record both topics during the same motion")
            begin = int(states[first])
            columns = {f"ctrl {name}": np.array(column) for name, column in self.command.columns.items()}
            commands = RecordedTable((times - begin) * 1e-9, columns, timed=True, sparse=True)
        columns = {f"qpos {name}": np.array(column)[first:] for name, column in self.state.columns.items()}
        table = RecordedTable((states[first:] - begin) * 1e-9, columns, timed=True, sparse=True)
        return RecordedFile(digest, table, commands, advice)

    def _check_topics(self) -> None:
        for topic, key in ((self.state, "state"), (self.command, "command")):
            if topic is not None and len(topic.logged) < 2:
                count = len(topic.logged)
                message = f"it has no topic `{topic.name}`"
                if topic.name in self.topics:
                    message = f"it has {count} messages of `{topic.name}` with numbers"
                raise RecordingFault(_CODE, message, f"{self._topics()}: write `recording: {{{key}: TOPIC}}`")

    def _check_clocks(self, command: _Topic) -> None:
        """Refuse states with stamps of another clock than the recorder's, if commands have no stamps."""
        if self.keys.clock == "log" or command.has_stamps == self.state.has_stamps:
            return
        stamped = self.state if self.state.has_stamps else command
        difference = np.median(np.array(stamped.stamped, np.int64) - np.array(stamped.logged, np.int64)) * 1e-9
        if abs(difference) > _APART:
            message = (
                f"the stamps of `{stamped.name}` are {abs(difference):.6g} s away from the times of recording, and the"
                " other topic has no stamps"
            )
            help = "write `recording: {clock: log}` to use the times of recording for both topics"
            raise RecordingFault("recording-time", message, help)


class _UpToEnd:
    """A file that reserves no memory for more bytes than it has."""

    def __init__(self, file: BufferedReader, size: int) -> None:
        self._file = file
        self._left = size

    def read(self, count: int) -> bytes:
        data = self._file.read(min(count, self._left))
        self._left -= len(data)
        return data
