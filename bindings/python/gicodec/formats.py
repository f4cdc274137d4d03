"""Formats as numpy knows them, and exact floats of those that it does not."""

from __future__ import annotations

import difflib

import numpy as np

from . import _interface as c
from ._library import coded, decoded, library

_KINDS = {c.COMPONENT_UNORM: "u", c.COMPONENT_SNORM: "i", c.COMPONENT_UINT: "u",
          c.COMPONENT_SFLOAT: "f", c.COMPONENT_OPAQUE: "u"}


def names() -> list[str]:
    """All formats, by VkFormat name without VK_FORMAT_."""
    return [decoded(library.format_name(library.format_at(place)))
            for place in range(library.format_count())]


def number(format: str | int) -> int:
    """VkFormat's number."""
    if isinstance(format, str):
        found = library.format_from_name(coded(format))
        if found == 0:
            near = difflib.get_close_matches(format.upper(), names(), 3, 0.4)
            raise ValueError(f"there is no format {format!r}: formats have the names of VkFormat, e.g. "
                             f"{', '.join(near or ['R16G16B16A16_SFLOAT'])}; gicodec.formats.names() lists them")
        return found
    if not isinstance(format, int):
        raise TypeError(f"a format is a name of VkFormat, e.g. 'R16G16B16A16_SFLOAT', not {format!r}")
    return format


class Components:
    """How the bits of a record are read. ``dtype`` and ``count``: of an array's last axis.

    Records of equal whole components are arrays of these; others are words (``packed``).
    """

    def __init__(self, desc) -> None:
        self.bytes = desc.record_bytes
        self.parts = [desc.components[i] for i in range(desc.component_count)]
        first = self.parts[0]
        even = first.bits in (8, 16, 32) and all(
            part.bits == first.bits and part.type == first.type and part.offset == i * first.bits
            for i, part in enumerate(self.parts)) and first.type in _KINDS
        kind = _KINDS.get(first.type, "u")
        self.packed = not even or (kind == "f" and first.bits == 8)
        if not self.packed:
            self.dtype, self.count = np.dtype(f"<{kind}{first.bits // 8}"), len(self.parts)
        elif self.bytes in (1, 2, 4, 8):
            self.dtype, self.count = np.dtype(f"<u{self.bytes}"), 1
        else:
            self.dtype, self.count = np.dtype("u1"), self.bytes

    @property
    def names(self) -> list[str]:
        return [part.name.decode() for part in self.parts]

    def as_float(self, array: np.ndarray) -> np.ndarray:
        """float32 of all components but a shared exponent, along a last axis.

        Exact for every float, also those under a shared exponent; normalised integers become the
        nearest float32.
        """
        words = np.ascontiguousarray(array).view(np.uint8)
        words = words.reshape(*array.shape[:-1], self.bytes)
        if any(part.type == c.COMPONENT_OPAQUE for part in self.parts):
            raise ValueError("this format holds compressed blocks, which have no components")
        if all(part.type == c.COMPONENT_EXPONENT for part in self.parts):
            raise ValueError("this record has no component but an exponent")
        exponent = [part for part in self.parts if part.type == c.COMPONENT_EXPONENT]
        scale = None
        if exponent:
            bits = self._bits(words, exponent[0]).astype(np.int32)
            scale = bits - (1 << (exponent[0].bits - 1)) + 1
        planes = [self._float(self._bits(words, part), part, scale)
                  for part in self.parts if part.type != c.COMPONENT_EXPONENT]
        return np.stack(planes, axis=-1)

    @staticmethod
    def _bits(words: np.ndarray, part) -> np.ndarray:
        """A component as unsigned numbers."""
        first, last = part.offset // 8, (part.offset + part.bits - 1) // 8
        number = np.zeros(words.shape[:-1], np.uint64)
        for place in range(last, first - 1, -1):
            number = number << np.uint64(8) | words[..., place]
        mask = np.uint64((1 << part.bits) - 1)
        return (number >> np.uint64(part.offset % 8) & mask).astype(np.uint32)

    @staticmethod
    def _float(bits: np.ndarray, part, scale: np.ndarray | None) -> np.ndarray:
        if part.type == c.COMPONENT_UNORM:
            return (bits / float((1 << part.bits) - 1)).astype(np.float32)
        if part.type == c.COMPONENT_SNORM:
            shift = np.uint32(32 - part.bits)
            signed = (bits << shift).view(np.int32) >> np.int32(32 - part.bits)
            return np.maximum(signed / float((1 << (part.bits - 1)) - 1), -1).astype(np.float32)
        if part.type == c.COMPONENT_UFLOAT:
            if scale is not None:
                return np.ldexp(bits.astype(np.float32), scale - part.bits)
            if part.bits > 15:
                raise ValueError(f"there are no unsigned floats of {part.bits} bits")
            return (bits << np.uint32(15 - part.bits)).astype(np.uint16).view(np.float16).astype(
                np.float32)
        if part.type == c.COMPONENT_SFLOAT:
            if part.bits == 16:
                return bits.astype(np.uint16).view(np.float16).astype(np.float32)
            return bits.view(np.float32)
        return bits.astype(np.float32)
