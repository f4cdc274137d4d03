"""A codec for Zarr v3: turns chunks of numbers into bytes, lossless or within a bound.

    zarr.create_array(store, shape=…, chunks=…, dtype="float16",
                      serializer=gicodec.zarr.GicodecCodec(), compressors=None)
"""

from __future__ import annotations

import asyncio
import math
from dataclasses import dataclass

import numpy as np

try:
    from zarr.abc.codec import ArrayBytesCodec
    from zarr.core.common import parse_named_configuration
    from zarr.registry import register_codec
except ImportError as error:
    raise ImportError("gicodec.zarr needs zarr 3: pip install gicodec[zarr]") from error

from . import arrays


@dataclass(frozen=True)
class GicodecCodec(ArrayBytesCodec):
    """``level`` and ``max_error`` as in gicodec.encode()."""

    level: int | str | None = None
    max_error: float = 0
    is_fixed_size = False

    @classmethod
    def from_dict(cls, data):
        _, configuration = parse_named_configuration(data, "gicodec", require_configuration=False)
        return cls(**(configuration or {}))

    def to_dict(self) -> dict:
        return {"name": "gicodec",
                "configuration": {"level": self.level, "max_error": self.max_error}}

    async def _encode_single(self, chunk_array, chunk_spec):
        array = np.ascontiguousarray(chunk_array.as_numpy_array())
        array = array.astype(array.dtype.newbyteorder("="), copy=False)
        coded = await asyncio.to_thread(arrays.encode, array, self.level, max_error=self.max_error)
        return chunk_spec.prototype.buffer.from_bytes(coded)

    async def _decode_single(self, chunk_bytes, chunk_spec):
        type_of = getattr(chunk_spec.dtype, "to_native_dtype", lambda: np.dtype(chunk_spec.dtype))
        dtype = type_of().newbyteorder("=")
        expected = math.prod(chunk_spec.shape) * dtype.itemsize, dtype
        array = await asyncio.to_thread(arrays.decode, chunk_bytes.to_bytes(), expected=expected)
        return chunk_spec.prototype.nd_buffer.from_ndarray_like(array.reshape(chunk_spec.shape))

    def compute_encoded_size(self, input_byte_length: int, chunk_spec) -> int:
        raise NotImplementedError


register_codec("gicodec", GicodecCodec)
