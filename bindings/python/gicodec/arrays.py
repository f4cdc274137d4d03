"""Plain arrays as bytes, and back."""

from __future__ import annotations

import json
import math

import numpy as np

from . import _interface as c
from ._library import error_of
from .codec import PRESETS
from .container import File
from .description import VolumeDesc, map_texture
from .writer import Writer

# An array's type as a format of one component; others are kept as unsigned integers of their size.
_FORMATS = {"float16": "R16_SFLOAT", "float32": "R32_SFLOAT", "uint8": "R8_UINT", "int8": "R8_UINT",
            "uint16": "R16_UINT", "int16": "R16_UINT", "uint32": "R32_UINT", "int32": "R32_UINT",
            "bool": "R8_UINT", "float64": "R32G32_UINT", "int64": "R32G32_UINT",
            "uint64": "R32G32_UINT"}
_COLOURS = {2: "R{0}G{0}", 3: "R{0}G{0}B{0}", 4: "R{0}G{0}B{0}A{0}"}
_BLOCKS = 65535  # along an axis
_MOST_AXES = 64  # as numpy
_BYTES = set("bBhHiIlLqQefd?c")  # of memory that may be written as bytes
_ROW = 4096  # most numbers in a row of an array that has one axis, or is longer than a texture may be
_SHORT = 1024


def _format_of(array: np.ndarray) -> tuple[str, bool]:
    """A format, and whether the last axis holds its components."""
    name = _FORMATS.get(array.dtype.name)
    if name is None:
        raise TypeError(f"arrays of {array.dtype} cannot be encoded: {', '.join(_FORMATS)} can; view others "
                        "as one of these, e.g. data.view('float32') or .view('uint8')")
    bits, kind = name[1:].split("_")[0], name.split("_")[1]
    if array.ndim >= 3 and array.shape[-1] in _COLOURS and "G" not in name:
        return _COLOURS[array.shape[-1]].format(bits) + "_" + kind, True
    return name, False


def _preset(level: int | str | None) -> str:
    """0 and 1: turbo; 2 to 5, or None: fast; from 6 on: strong."""
    if level is None or level in PRESETS:
        return level or "fast"
    if isinstance(level, str) or not 0 <= level <= 9:
        raise ValueError(f"level is 0 to 9 or one of {', '.join(PRESETS)}, not {level!r}")
    return PRESETS[0 if level < 2 else 1 if level < 6 else 2]


def _sides(shape: tuple[int, ...]) -> tuple[int, int, int]:
    """Width, height, depth: axes before the last two are joined."""
    rows = (1, 1, *shape)
    depth = 1
    for side in rows[:-2]:
        depth *= side
    return rows[-1], rows[-2], depth


def _block(sides: tuple[int, int, int]) -> tuple[int, ...]:
    most = (32, 32, 1) if sides[2] == 1 else (16, 16, 16)
    return tuple(min(pair) for pair in zip(sides, most))


def encode(data, level: int | str | None = None, *, max_error: float = 0, threads: int = 1,
           out=None) -> bytes:
    """Any array of numbers as the bytes of a container.

    ``level``: "turbo", "fast", "strong", or 0 to 9. ``max_error``: 0 is lossless; below 1 relative
    to each float (below the smallest normal number, to that), from 1 on in codes or representable
    values. ``out``: a writeable buffer for the result, of which the used part is returned.
    """
    if isinstance(data, np.ma.MaskedArray):
        raise TypeError("a masked array has two parts: encode data.filled(…), or .data and .mask each")
    array = np.asarray(data)
    dtype = array.dtype
    if dtype.byteorder == ">":
        array = array.astype(dtype.newbyteorder("<"))
    format, coloured = _format_of(array)
    if max_error and array.dtype.name not in ("float16", "float32", "uint8", "uint16", "uint32"):
        raise ValueError("max_error is for float16, float32 and unsigned integers of 8, 16 and 32 bits, "
                         f"not for {array.dtype}: convert the array, or leave max_error out")
    about = {"array": json.dumps({"dtype": dtype.str, "shape": list(array.shape)})}
    writer_volumes: dict[str, VolumeDesc] = {}
    sides = _sides(array.shape[:-1] if coloured else array.shape)
    texels = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    block = _block(sides)
    is_line = not coloured and max(sides) == array.size > _SHORT  # blocks of one row would be small
    if is_line or any(side > _BLOCKS * most for side, most in zip(sides, block)):
        row = min(_ROW, 32 * math.ceil(math.sqrt(array.size) / 32))
        format, sides = _FORMATS[array.dtype.name], (row, -(-array.size // row), 1)
        texels = np.pad(texels, (0, sides[0] * sides[1] * array.itemsize - texels.size))
        block = _block(sides)
    if array.size:
        writer_volumes["array"] = VolumeDesc("textures", {"array": map_texture(sides, format, block)})
    else:
        writer_volumes["array"] = VolumeDesc(
            "textures", {"array": map_texture((1, 1, 1), format, (1, 1, 1))})
    writer = Writer(None, writer_volumes, metadata=about, preset=_preset(level),
                    max_error=max_error, threads=threads, gop=0)
    with writer:
        if array.size:
            writer.add(0, {"array": texels}, blocks="all")
    coded = writer.getvalue()
    if out is None:
        return coded
    target = memoryview(out)
    if target.format.lstrip("@=<>!") not in _BYTES:
        raise TypeError(f"out is memory for bytes or numbers, not of format {target.format!r}")
    target = target.cast("B")
    if target.readonly or target.nbytes < len(coded):
        raise ValueError(f"out must be writeable and have {len(coded)} bytes")
    target[:len(coded)] = coded
    return target[:len(coded)]


def decode(data, *, out: np.ndarray | None = None, limits: dict | None = None,
           threads: int = 1, expected: tuple[int, np.dtype | None] | None = None) -> np.ndarray:
    """The array of encode(); into ``out``, an array of its shape and type, if given.

    ``expected``: its bytes, and its type if known, else a ValueError before anything is decoded. For
    bytes of strangers, give it or ``limits``.
    """
    if expected is not None and limits is None:
        usual = {"max_texture_bytes": 1 << 30, "max_packet_bytes": 1 << 30, "max_work_bytes": 2 << 30}
        limits = {name: max(most, 2 * expected[0]) for name, most in usual.items()}
        limits["max_total_bytes"] = max(4 << 30, 8 * expected[0])
    with File(data, threads=threads, limits=limits) as file:
        about = file.metadata.get("array")
        if about is None or "array" not in file:
            raise ValueError("these bytes hold no plain array: open them by gicodec.open()")
        try:
            described = json.loads(about)
            shape, dtype = tuple(described["shape"]), np.dtype(described["dtype"])
            whole = type(described["shape"]) is list and all(type(side) is int for side in shape)
            if len(shape) > _MOST_AXES or not whole:
                raise ValueError(f"shapes are of at most {_MOST_AXES} whole numbers")
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise ValueError("the description of the array is damaged") from error
        texture = file["array"]
        count = math.prod(shape)
        if expected is not None and (count * dtype.itemsize, expected[1] or dtype) != (expected[0], dtype):
            raise ValueError(f"the bytes hold {count} numbers of {dtype}, not {expected[0]} bytes"
                             f"{f' of {expected[1]}' if expected[1] else ''}")
        behind = texture.desc.nbytes - count * dtype.itemsize
        if dtype.name not in _FORMATS or min(shape, default=0) < 0 or (
                count and not 0 <= behind < _ROW * dtype.itemsize or behind % dtype.itemsize):
            raise ValueError("the description of the array does not fit its texture")
        if out is None:
            out = np.empty(shape, dtype)
        elif not isinstance(out, np.ndarray) or out.shape != shape or not out.flags.c_contiguous or (
                out.dtype.newbyteorder("=") != dtype.newbyteorder("=")):
            raise ValueError(f"out must be a C-contiguous array of shape {shape} and type {dtype}")
        if count and not file.frames:
            raise error_of(c.TRUNCATED, "the array itself is missing")
        if count and behind == 0 and out.dtype.byteorder != ">":
            texture.read(0, out.reshape(-1).view(np.uint8))
        elif count:
            texels = texture.read(0, np.empty(texture.desc.nbytes, np.uint8))
            out[...] = texels.view(dtype.newbyteorder("<"))[:count].reshape(shape)
        return out
