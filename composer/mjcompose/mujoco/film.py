"""Pictures as PNG, GIF and MP4."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOR_TYPES = {3: 2, 4: 6}
_UP = 2


def png(picture: NDArray[Any]) -> bytes:
    """Return the PNG of an array of bytes, RGB `(height, width, 3)` or with opacity `(height, width, 4)`."""
    height, width, channels = picture.shape
    rows = np.zeros((height, 1 + channels * width), np.uint8)  # each row begins with its filter
    flat = picture.reshape(height, -1)
    rows[:, 1:] = flat
    rows[1:, 0] = _UP
    rows[1:, 1:] = flat[1:] - flat[:-1]
    header = struct.pack(">2I5B", width, height, 8, _COLOR_TYPES[channels], 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    number = struct.Struct(">I").pack
    packed = (number(len(data)) + kind + data + number(zlib.crc32(kind + data)) for kind, data in chunks)
    return b"".join((_SIGNATURE, *packed))


_COLORS = 256
_BITS = 8
_KEPT = 5  # bits of each channel that distinguish colors while the palette is computed


def gif(frames: Sequence[NDArray[Any]], seconds: float) -> bytes:
    """Return an endless GIF of RGB arrays `(height, width, 3)` of one size, each shown for `seconds`."""
    height, width, _ = frames[0].shape
    palette, nearest = _palette(frames)
    head = b"GIF89a" + struct.pack("<HHBBB", width, height, 0xF7, 0, 0)
    found = [head, palette.tobytes(), b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00"]
    hundredths = max(2, round(seconds * 100))
    for frame in frames:
        found.append(struct.pack("<BBBBHBB", 0x21, 0xF9, 4, 4, hundredths, 0, 0))
        found.append(struct.pack("<BHHHHB", 0x2C, 0, 0, width, height, 0))
        packed = _packed(nearest[_coarse(frame)].ravel().tobytes())
        blocks = (packed[at : at + 255] for at in range(0, len(packed), 255))
        found.append(bytes([_BITS]) + b"".join(bytes([len(each)]) + each for each in blocks) + b"\0")
    return b"".join([*found, b"\x3b"])


def _coarse(frame: NDArray[Any]) -> NDArray[Any]:
    short = (frame >> (8 - _KEPT)).astype(np.int32)
    found: NDArray[Any] = (short[..., 0] << 2 * _KEPT) | (short[..., 1] << _KEPT) | short[..., 2]
    return found


def _palette(frames: Sequence[NDArray[Any]]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return 256 RGB colors by median cut, and the number of the palette color for each coarse color."""
    size = 1 << 3 * _KEPT
    counts = np.zeros(size, np.int64)
    sums = np.zeros((size, 3))
    for frame in frames:
        at = _coarse(frame).ravel()
        counts += np.bincount(at, minlength=size)
        for channel in range(3):
            sums[:, channel] += np.bincount(at, weights=frame[..., channel].ravel(), minlength=size)
    used = np.flatnonzero(counts)
    means = sums[used] / counts[used, None]
    weights = counts[used]
    palette = np.zeros((_COLORS, 3), np.uint8)
    nearest = np.zeros(size, np.uint8)
    for number, box in enumerate(_cut(means, weights)):
        palette[number] = np.rint(np.average(means[box], axis=0, weights=weights[box]))
        nearest[used[box]] = number
    return palette, nearest


def _cut(colors: NDArray[Any], weights: NDArray[Any]) -> list[NDArray[Any]]:
    """Return at most 256 boxes of similar colors: halve the box with the largest error until there are enough."""
    boxes = [np.arange(len(colors))]
    errors = [_error(colors, weights, boxes[0])]
    while len(boxes) < _COLORS and max(errors) > 0:
        at = int(np.argmax(errors))
        box = boxes[at]
        channel = int(np.ptp(colors[boxes[at]], axis=0).argmax())
        box = box[np.argsort(colors[box, channel], kind="stable")]
        half = int(np.searchsorted(np.cumsum(weights[box]), weights[box].sum() / 2)) + 1
        half = min(half, len(box) - 1)
        boxes[at] = box[:half]
        errors[at] = _error(colors, weights, box[:half])
        boxes.append(box[half:])
        errors.append(_error(colors, weights, box[half:]))
    return boxes


def _error(colors: NDArray[Any], weights: NDArray[Any], box: NDArray[Any]) -> float:
    if len(box) < 2:
        return 0.0
    middle = np.average(colors[box], axis=0, weights=weights[box])
    return float((((colors[box] - middle) ** 2).sum(axis=1) * weights[box]).sum())


def _packed(pixels: bytes) -> bytes:
    """Compress with LZW, with codes of 9 to 12 bits."""
    clear = 1 << _BITS
    end = (1 << _BITS) + 1
    known: dict[tuple[int, int], int] = {}
    packed = bytearray()
    prefix = pixels[0]
    held = clear
    count = _BITS + 1
    bits = end + 1
    size = _BITS + 1
    for pixel in pixels[1:]:
        code = known.get((prefix, pixel))
        if code is not None:
            prefix = code
            continue
        held |= prefix << count
        count += size
        known[prefix, pixel] = bits
        prefix = pixel
        if bits == 1 << size and size < 12:
            size += 1
        bits += 1
        if bits > 4095:
            held |= clear << count
            count += size
            known.clear()
            bits = end + 1
            size = _BITS + 1
        while count >= 8:
            packed.append(held & 255)
            held >>= 8
            count -= 8
    held |= prefix << count
    count += size
    if bits == 1 << size and size < 12:
        size += 1
    held |= end << count
    count += size
    return bytes(packed) + held.to_bytes((count + 7) // 8, "little")


class NoEncoder(Exception):
    """PyAV cannot be imported."""


def encoder() -> Any:
    """Return PyAV. Raises `NoEncoder`."""
    try:
        return import_module("av")
    except ImportError as error:
        raise NoEncoder(str(error)) from error


def write_mp4(path: Path, frames: Sequence[NDArray[Any]], rate: int) -> None:
    """Write RGB arrays `(height, width, 3)` of one size; an odd row or column, which H.264 does not allow, is cut."""
    av = encoder()
    height, width, _ = frames[0].shape
    height = height - height % 2
    width = width - width % 2
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as film:
        track = film.add_stream("libx264", rate=Fraction(rate), options={"crf": "20"})
        track.width = width
        track.height = height
        track.pix_fmt = "yuv420p"
        for frame in frames:
            film.mux(track.encode(av.VideoFrame.from_ndarray(frame[:height, :width].copy(), format="rgb24")))
        film.mux(track.encode())
