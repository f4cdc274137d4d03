"""Pictures of textures for notebooks."""

from __future__ import annotations

import base64
import html as escape
import struct
import zlib

import numpy as np

MAX_SIDE = 1024
MAX_BYTES = 64 << 20  # larger textures are described alone


def png(pixels: np.ndarray) -> bytes:
    """A PNG file of [row, column, 3] bytes."""
    height, width, _ = pixels.shape

    def part(name: bytes, data: bytes) -> bytes:
        return (struct.pack(">I", len(data)) + name + data +
                struct.pack(">I", zlib.crc32(name + data)))

    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = pixels.reshape(height, 3 * width)
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + part(b"IDAT", zlib.compress(rows.tobytes(), 6)) + part(b"IEND", b""))


def pixels_of(desc, array: np.ndarray) -> np.ndarray:
    """[row, column, 3] bytes: values from 0 to the largest one, with sRGB's gamma."""
    colour = np.nan_to_num(desc.as_float(array), nan=0, posinf=0, neginf=0)
    colour = colour.reshape(-1, *colour.shape[-2:])  # slices below one another
    if colour.shape[-1] < 3:
        colour = np.repeat(colour[..., :1], 3, axis=-1)
    colour = np.clip(colour[..., :3], 0, None)
    most = float(np.percentile(colour, 99.5)) if colour.size else 0
    scaled = np.clip(colour / (most or 1), 0, 1) ** (1 / 2.2)
    rows, columns = (max(1, -(-side // MAX_SIDE)) for side in scaled.shape[:2])
    return (scaled[::rows, ::columns] * 255 + 0.5).astype(np.uint8)


def html(texture, caption: str) -> str:
    """A texture's first frame as an image, below its caption."""
    text = f"<p><code>{escape.escape(caption)}</code></p>"
    if len(texture) == 0 or texture.desc.nbytes > MAX_BYTES:
        return text
    try:
        data = png(pixels_of(texture.desc, texture.read(0)))
    except ValueError:  # compressed blocks
        return text
    return text + f'<img src="data:image/png;base64,{base64.b64encode(data).decode()}">'
