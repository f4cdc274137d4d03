"""Descriptions of textures and volumes."""

from __future__ import annotations

import ctypes
import json
from typing import Iterable, Sequence

import numpy as np

from . import _interface as c
from . import formats
from ._library import (Handle, Pointer, byref, coded, decoded, error_of, library, shown, sized,
                       text_of)

TILINGS = ("atlas_xy_z", "atlas_xz_y", "atlas_x_yz", "slices_xz_y", "slices_xy_z", "blocks",
           "atlas_yz_x", "slices_yx_z")


class TextureDesc:
    """A texture of blocks: its format, grid and layout. A plain value.

    Made by ddgi_irradiance(), ddgi_visibility(), map_texture(), or read from a volume.
    """

    def __init__(self, struct: c.gicodec_texture_desc) -> None:
        library.with_problem("texture_desc_complete", byref(struct))
        self.struct = struct
        self.components = formats.Components(struct)
        info = sized(c.gicodec_texture_info)
        library.texture_desc_info(byref(struct), byref(info))
        self._info = info

    @property
    def format(self) -> str | None:
        """VkFormat's name; None for a record of the application's own."""
        return decoded(library.format_name(self.struct.format))

    @property
    def grid(self) -> tuple[int, int, int]:
        """Blocks along x, y, z."""
        return tuple(self.struct.grid)

    @property
    def tiling(self) -> str:
        return TILINGS[self.struct.tiling]

    @property
    def block_count(self) -> int:
        return self._info.blocks

    @property
    def nbytes(self) -> int:
        """Bytes of the whole texture in memory."""
        return self._info.texture_bytes

    @property
    def dtype(self) -> np.dtype:
        return self.components.dtype

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the whole texture: [slice,] row, column, component. Of an array of blocks: block,
        slice, row, column, component. Guard bands are included."""
        info = self._info
        width, height, slices = info.width, info.height, info.slices
        if self.tiling == "blocks":
            return (self.block_count, slices // self.block_count, height, width,
                    self.components.count)
        whole = (slices, height, width, self.components.count)
        return whole[1:] if slices == 1 else whole

    @property
    def core_shape(self) -> tuple[int, ...]:
        """Of all blocks without guard bands: block, slice, row, column, component."""
        x, y, z = self.struct.block
        return (self.block_count, z, y, x, self.components.count)

    def with_tiling(self, tiling: str) -> TextureDesc:
        """The same texture elsewhere in memory."""
        struct = c.gicodec_texture_desc.from_buffer_copy(self.struct)
        if tiling not in TILINGS:
            raise ValueError(f"there is no tiling {tiling!r}: {', '.join(TILINGS)} are")
        struct.tiling = TILINGS.index(tiling)
        struct.slots[:] = (0, 0, 0)
        struct.pad_before = struct.pad_after = 0
        return TextureDesc(struct)

    def empty(self) -> np.ndarray:
        """An array of zeros for the whole texture."""
        return np.zeros(self.shape, self.dtype)

    def as_float(self, array: np.ndarray) -> np.ndarray:
        """float32 of all components, see formats.Components.as_float()."""
        return self.components.as_float(array)

    def _check_fit(self, array: np.ndarray, name: str) -> None:
        """Raises an error unless it is an array of this shape and type, or just its words or bytes."""
        it = f"the texture{f' {name!r}' if name else ''}"
        if array.dtype == np.uint8 and array.ndim == 1:
            if array.nbytes != self.nbytes:
                raise ValueError(f"{it} has {self.nbytes} bytes, not {array.nbytes}")
            return
        words = array.dtype.kind in "iu" and array.dtype.isnative and array.dtype.itemsize == self.dtype.itemsize
        if array.dtype != self.dtype and not words:
            raise TypeError(f"{it} is an array of {self.dtype}, not of {array.dtype}: convert it, "
                            f"e.g. by numpy.asarray(array, numpy.{self.dtype})")
        if [side for side in array.shape if side != 1] != [side for side in self.shape if side != 1]:
            raise ValueError(f"{it} is an array of shape {self.shape}, not {array.shape}: [slice,] row, "
                             "column, component; descriptions have the width first")

    def view_of(self, array, name: str = "") -> tuple[c.gicodec_const_view, object]:
        """A view of the texture's array or bytes, and what must live as long."""
        if isinstance(array, (bytes, bytearray, memoryview)):
            array = np.frombuffer(array, np.uint8)
        array = np.ascontiguousarray(array)
        self._check_fit(array, name)
        view = sized(c.gicodec_const_view, bytes=array.ctypes.data, size=array.nbytes)
        return view, array

    def target(self, out: np.ndarray | None) -> tuple[c.gicodec_view, np.ndarray]:
        """A view to write to; ``out`` is an array of this shape and type, None for a new one."""
        if out is None:
            out = self.empty()
        if not isinstance(out, np.ndarray):
            raise TypeError(f"out is a numpy array, not {type(out).__name__}")
        if not out.flags.c_contiguous or not out.flags.writeable or out.nbytes < self.nbytes:
            raise ValueError(f"out must be a writeable C-contiguous array of {self.nbytes} bytes, "
                             f"e.g. of shape {self.shape} and dtype {self.dtype}")
        self._check_fit(out, "")
        return sized(c.gicodec_view, bytes=out.ctypes.data, size=out.nbytes), out

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TextureDesc) and bytes(self.struct) == bytes(other.struct)

    def __hash__(self) -> int:
        return hash(bytes(self.struct))

    def __repr__(self) -> str:
        x, y, z = self.struct.block
        nx, ny, nz = self.grid
        return (f"<TextureDesc {self.format or 'custom'}, {nx}×{ny}×{nz} blocks of {x}×{y}×{z}, "
                f"array {self.shape} {self.dtype}>")


def _made(call: str, *numbers: int) -> TextureDesc:
    struct = sized(c.gicodec_texture_desc)
    fit = all(isinstance(number, (int, np.integer)) and 0 <= number < 1 << 32 for number in numbers)
    status = library.status_of(call, *numbers, byref(struct)) if fit else c.INVALID_DESCRIPTION
    if status != c.OK:
        raise error_of(status, f"{call}{numbers[:-1]}",
                       "sizes are whole numbers from 1 on, at most 65535 blocks along an axis and 2^24 "
                       "in all, with 1 to 64 records along a side" if status == c.INVALID_DESCRIPTION else "")
    return TextureDesc(struct)


def _three(what: str, numbers: Sequence[int], least: int = 3) -> tuple:
    """Sides along x, y, z; 1 for those that are not given."""
    if not least <= len(numbers) <= 3:
        raise ValueError(f"{what} has {least if least == 3 else f'{least} or 3'} numbers (x, y, z), not {numbers!r}")
    return (*numbers, 1)[:3]


def ddgi_irradiance(grid: Sequence[int], format: str | int = "A2B10G10R10_UNORM_PACK32") -> TextureDesc:
    """A DDGI volume's colour: probes of 8×8 texels with a guard band, as one atlas."""
    return _made("ddgi_irradiance", *_three("a grid", grid), formats.number(format))


def ddgi_visibility(grid: Sequence[int], format: str | int = "R16G16_SFLOAT") -> TextureDesc:
    """A DDGI volume's visibility: probes of 16×16 texels with a guard band, as one atlas."""
    return _made("ddgi_visibility", *_three("a grid", grid), formats.number(format))


def map_texture(size: Sequence[int], format: str | int, block: Sequence[int] = (16, 16, 1)) -> TextureDesc:
    """A 2D map, array or 3D texture of width × height [× depth] records, cut into blocks.

    Arrays have the height first: that of a texture of size (200, 120) has the shape (120, 200, …).
    """
    return _made("map_texture", *_three("a size", size, 2), *_three("a block", block, 2),
                 formats.number(format))


class VolumeDesc(Handle):
    """The texture groups of a volume.

    ``VolumeDesc("probes", {"color": ddgi_irradiance((8, 4, 8))})`` makes one;
    ``VolumeDesc.of_layout("rtxgi", (8, 4, 8))`` makes an engine's.
    """

    _destroy = "volume_desc_destroy"

    def __init__(self, kind: str | int, textures: dict[str, TextureDesc] | None = None) -> None:
        super().__init__("volume_desc_create", kind_number(kind))
        for name, desc in (textures or {}).items():
            if not isinstance(desc, TextureDesc):
                raise TypeError(f"the texture {name!r} is described by a TextureDesc, e.g. of map_texture(), "
                                f"not by {type(desc).__name__}")
            library.volume_desc_add_texture(self._handle, coded(name), byref(desc.struct))
        if textures:
            library.with_problem("volume_desc_check", self._handle)

    @classmethod
    def adopt(cls, handle: int) -> VolumeDesc:
        """Owns a handle of the library."""
        volume = cls.__new__(cls)
        volume._handle = Pointer(handle, cls.__name__)
        return volume

    @classmethod
    def of_layout(cls, layout: str, grid: Sequence[int]) -> VolumeDesc:
        """The volume of an engine's layout; layouts() names them."""
        known = layouts()
        if layout not in known:
            raise ValueError(f"there is no layout {layout!r}: {', '.join(known)} are")
        handle = ctypes.c_void_p()
        library.volume_desc_from_layout(coded(layout), *grid, byref(handle))
        return cls.adopt(handle.value)

    @property
    def kind(self) -> str:
        return decoded(library.kind_name(library.volume_desc_kind(self._handle)))

    @property
    def textures(self) -> dict[str, TextureDesc]:
        """Descriptions by name, in order."""
        found = {}
        for place in range(library.volume_desc_textures(self._handle)):
            struct = sized(c.gicodec_texture_desc)
            library.volume_desc_texture(self._handle, place, byref(struct))
            name = decoded(library.volume_desc_texture_name(self._handle, place))
            found[name] = TextureDesc(struct)
        return found

    def json(self) -> dict:
        return json.loads(text_of("volume_desc_json", self._handle))

    def __repr__(self) -> str:
        names = ", ".join(map(shown, self.textures))
        return f"<VolumeDesc of {self.kind}: {names}>"


def kind_number(kind: str | int) -> int:
    if isinstance(kind, int):
        return kind
    known = {name: number for number in range(1, 256) if (name := decoded(library.kind_name(number)))}
    if kind not in known:
        raise ValueError(f"there is no kind {kind!r}: {', '.join(known)} are")
    return known[kind]


def layouts() -> dict[str, str]:
    """Engines' layouts, and a line about each."""
    return {decoded(library.layout_name(place)): decoded(library.layout_summary(place))
            for place in range(library.layout_count())}


def block_list(blocks: Iterable[int] | np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(blocks, np.uint32)
