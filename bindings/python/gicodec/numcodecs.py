"""A codec for numcodecs and Zarr v2: arrays of numbers, lossless or within a bound.

    numcodecs.registry.get_codec({"id": "gicodec", "level": "strong"})
"""

from __future__ import annotations

import numpy as np

try:
    from numcodecs.abc import Codec
    from numcodecs.compat import ensure_ndarray_like, ndarray_copy
    from numcodecs.registry import register_codec
except ImportError as error:
    raise ImportError("gicodec.numcodecs needs numcodecs: pip install gicodec[zarr]") from error

from . import arrays


class Gicodec(Codec):
    """``level`` and ``max_error`` as in gicodec.encode()."""

    codec_id = "gicodec"

    def __init__(self, level: int | str | None = None, max_error: float = 0) -> None:
        self.level, self.max_error = level, max_error

    def encode(self, buf) -> bytes:
        array = np.asarray(ensure_ndarray_like(buf))
        if array.flags.f_contiguous:  # Zarr views the result as memory of the same order
            array = array.T
        return arrays.encode(array, self.level, max_error=self.max_error)

    def decode(self, buf, out=None):
        data = np.asarray(ensure_ndarray_like(buf)).view(np.uint8).tobytes()
        expected = None if out is None else (ensure_ndarray_like(out).nbytes, None)
        array = arrays.decode(data, expected=expected)
        return array if out is None else ndarray_copy(array, out)

    def get_config(self) -> dict:
        return {"id": self.codec_id, "level": self.level, "max_error": self.max_error}


register_codec(Gicodec)
