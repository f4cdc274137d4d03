"""Containers (.gic): their frames as arrays."""

from __future__ import annotations

import ctypes
from typing import Iterator

import numpy as np

from . import _interface as c
from . import picture
from ._library import Handle, byref, decoded, library, shown
from .codec import borrowed
from .description import TextureDesc, VolumeDesc
from .player import Contents

_MOST_PICTURES = 16


class Texture:
    """A texture of a container: a sequence of frames, each an array.

    ``texture[0]``, ``texture[-1]``, ``texture[2:5]`` (one array of several frames), ``len()``,
    iteration. Reading in order is fastest. Threads that read one texture take turns: open the file
    once for each thread.
    """

    def __init__(self, contents: Contents, number: int, name: str) -> None:
        self._contents, self._number, self.name = contents, number, name
        self.desc: TextureDesc = contents.desc(number)

    @property
    def format(self) -> str | None:
        """VkFormat's name."""
        return self.desc.format

    @property
    def shape(self) -> tuple[int, ...]:
        """Of a frame: [slice,] row, column, component."""
        return self.desc.shape

    @property
    def dtype(self) -> np.dtype:
        return self.desc.dtype

    @property
    def ndim(self) -> int:
        return len(self.shape)

    @property
    def size(self) -> int:
        """Numbers of a frame."""
        return int(np.prod(self.shape))

    @property
    def largest_error(self) -> float:
        """0: lossless; infinity: unknown."""
        return library.container_largest_error(self._contents.container, self._number)

    @property
    def metadata(self) -> dict[str, str]:
        return self._contents.metadata(c.METADATA_TEXTURE, self._number)

    @property
    def frames(self) -> list[int]:
        """The numbers of all frames of the file."""
        return self._contents.frames

    def __len__(self) -> int:
        return len(self.frames)

    def read(self, index: int = 0, out: np.ndarray | None = None) -> np.ndarray:
        """A frame by its place, negative ones from the end; into ``out`` if given."""
        view, out = self.desc.target(out)
        with self._contents.at(self._number, index) as player:
            library.player_read(player._handle, self._number, byref(view))
        return out

    def blocks(self, index: int = 0, *, guard_band: bool = False) -> np.ndarray:
        """A frame as blocks: [block, slice, row, column, component]."""
        view, out = self.desc.with_tiling("blocks").target(None)
        with self._contents.at(self._number, index, "blocks") as player:
            library.player_read(player._handle, self._number, byref(view))
        band = 0 if guard_band else self.desc.struct.guard_band
        return out[:, :, band:out.shape[2] - band, band:out.shape[3] - band] if band else out

    def changed(self, index: int = 0) -> np.ndarray:
        """Blocks that a frame may have changed, ascending; all where decoding began."""
        with self._contents.at(self._number, index) as player:
            return borrowed("player_changed", player._handle, self._number, dtype=np.uint32)

    def as_float(self, index: int = 0) -> np.ndarray:
        """A frame as float32, exact for all floats."""
        return self.desc.as_float(self.read(index))

    def __getitem__(self, index):
        if isinstance(index, slice):
            places = range(len(self))[index]
            return np.stack([self.read(place) for place in places]) if places else np.empty(
                (0, *self.shape), self.dtype)
        return self.read(index)

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self.read(place) for place in range(len(self)))

    __reduce_ex__ = Handle.__reduce_ex__

    def __repr__(self) -> str:
        x, y, z = self.desc.grid
        return (f"<Texture {self.name!r}: {len(self)} frames of {self.shape} {self.dtype}, "
                f"{self.format or 'custom'}, {x}×{y}×{z} blocks>")

    def _repr_html_(self) -> str:
        return picture.html(self, repr(self))


class Volume:
    """Textures of one kind over one or more grids or pools. ``volume["color"]`` is a texture."""

    def __init__(self, contents: Contents, number: int) -> None:
        self._contents, self._number = contents, number
        self.name = decoded(library.container_volume_name(contents.container, number))
        entry = contents.json["volumes"][number]
        self.kind = entry["kind"]
        first = entry["first_texture"]
        self.textures: dict[str, Texture] = {}
        for place in range(first, first + entry["textures"]):
            name = decoded(library.container_texture_name(contents.container, place))
            if "grid" in contents.json["textures"][place]:  # of a kind that the library knows
                self.textures[name] = Texture(contents, place, name)

    @property
    def geometry(self) -> dict | None:
        """Grid, origin, spacing and scroll; None if unknown."""
        return self._contents.json["volumes"][self._number].get("geometry")

    @property
    def metadata(self) -> dict[str, str]:
        return self._contents.metadata(c.METADATA_VOLUME, self._number)

    @property
    def desc(self) -> VolumeDesc:
        handle = ctypes.c_void_p()
        library.container_volume(self._contents.container, self._number, byref(handle))
        return VolumeDesc.adopt(handle.value)

    def __getitem__(self, name: str) -> Texture:
        if name not in self.textures:
            raise KeyError(f"the volume {self.name!r} has no texture {name!r}: it has "
                           f"{', '.join(self.textures)}")
        return self.textures[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.textures)

    def __len__(self) -> int:
        return len(self.textures)

    def __repr__(self) -> str:
        return f"<Volume {self.name!r} of {self.kind}: {', '.join(map(shown, self.textures))}>"


class File:
    """An open container: see open()."""

    def __init__(self, source, *, threads: int = 1, limits: dict | None = None) -> None:
        self._contents = Contents(source, threads, limits)
        self.frames: list[int] = self._contents.frames
        count = library.container_volumes(self._contents.container)
        self.volumes = [Volume(self._contents, place) for place in range(count)]

    @property
    def textures(self) -> dict[str, Texture]:
        """All textures by name; of several volumes "volume/texture"."""
        if len(self.volumes) == 1:
            return dict(self.volumes[0].textures)
        return {f"{volume.name}/{name}": texture for volume in self.volumes
                for name, texture in volume.textures.items()}

    @property
    def scene(self) -> str:
        return self.json()["scene"]["name"]

    @property
    def metadata(self) -> dict[str, str]:
        return self._contents.metadata(c.METADATA_CONTAINER, 0)

    @property
    def is_complete(self) -> bool:
        """False for a file that was cut off or is growing: ``frames`` has those that are whole."""
        return self._contents.is_complete

    def json(self) -> dict:
        """All descriptions."""
        return self._contents.json

    def __getitem__(self, name: str) -> Texture:
        textures = self.textures
        if name not in textures:
            raise KeyError(f"there is no texture {name!r}: the file has {', '.join(textures)}")
        return textures[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.textures)

    def __len__(self) -> int:
        return len(self.textures)

    def __contains__(self, name: object) -> bool:
        return name in self.textures

    def keys(self):
        return self.textures.keys()

    def values(self):
        return self.textures.values()

    def items(self):
        return self.textures.items()

    def close(self) -> None:
        """Frees the decoders. Arrays that were read stay."""
        self._contents.close()

    def __enter__(self) -> File:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    __reduce_ex__ = Handle.__reduce_ex__

    def __repr__(self) -> str:
        cut = "" if self._contents.is_closed or self.is_complete else ", cut off or growing"
        lines = [f"<File {self._contents.path or 'in memory'}: {len(self.frames)} frames{cut}"]
        lines += [f"  {shown(name)}: {texture.shape} {texture.dtype} {texture.format or 'custom'}"
                  for name, texture in self.textures.items()]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        textures = list(self.textures.items())
        more = len(textures) - _MOST_PICTURES
        return "".join(picture.html(texture, name) for name, texture in textures[:_MOST_PICTURES]) + (
            f"<p>and {more} more textures</p>" if more > 0 else "")


def open(source, *, threads: int = 1, limits: dict | None = None) -> File:
    """Opens a container: a path, bytes, or anything with read().

    ``limits`` bounds what a file may cost, by fields of gicodec_limits.
    """
    return File(source, threads=threads, limits=limits)
