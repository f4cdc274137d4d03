"""Containers (.gic): their frames as arrays."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import pathlib
import threading
from typing import Iterator

import numpy as np

from . import _interface as c
from . import picture
from ._library import (Error, Handle, Host, address, byref, decoded, error_of, library, limits_of,
                       sized, text_of)
from .codec import borrowed
from .description import TextureDesc, VolumeDesc
from .source import FileSource


def _unknown_version(head: bytes) -> str:
    major, minor, readable = ctypes.c_uint32(), ctypes.c_uint32(), ctypes.c_uint32()
    library.container_version(head, len(head), byref(major), byref(minor), byref(readable))
    return (f"the container has version {major.value}.{minor.value}, and gicodec "
            f"{decoded(library.version_text())} reads version {readable.value}: take a newer gicodec")


class _Player(Handle):
    """Decodes one texture of a container, in one layout."""

    _destroy = "player_destroy"
    _called = "file"

    def __init__(self, file: File, texture: int | None, tiling: str | None = None) -> None:
        host = Host(file._threads)
        options = sized(c.gicodec_player_options, host=address(host.struct))
        limits = limits_of(file._limits)
        options.limits = address(limits) if limits else None
        self._source = FileSource(file._stream, file._turn) if file._stream else None
        try:
            if self._source is None:
                super().__init__("player_open_memory", file._bytes.ctypes.data, file._bytes.nbytes,
                                 byref(options))
            else:
                with self._source.errors():
                    super().__init__("player_open", byref(self._source.struct), byref(options))
        except Error as error:
            if error.status == c.UNSUPPORTED_VERSION:
                error.args = (_unknown_version(file._head()),)
            if error.status == c.NOT_GICODEC:
                error.args = (f"{file._path or 'the input'} is no .gic file; KTX2, DDS, EXR and raw files "
                              "become one by the tool: gicodec encode -o x.gic FILE...",)
            raise
        self._memory = file._bytes
        self.place = -1  # of the frame that was decoded; -1: the first one is next
        if texture is None:
            return
        wanted = (ctypes.c_uint32 * 1)(texture)
        library.player_select(self._handle, byref(wanted), 1)
        if tiling is not None:
            library.player_set_layout(self._handle, texture,
                                      byref(file._desc(texture).with_tiling(tiling).struct))

    def _errors(self):
        return contextlib.nullcontext() if self._source is None else self._source.errors()

    def frames(self) -> list[int]:
        at, count = ctypes.c_void_p(), ctypes.c_size_t()
        with self._errors():
            status = library.status_of("player_frames", self._handle, byref(at), byref(count))
        if status == c.UNKNOWN_FRAME:
            raise error_of(c.CORRUPT, "the index of the frames")
        if status != c.OK:
            raise error_of(status)
        size = count.value * 8
        return np.frombuffer(ctypes.string_at(at.value, size), np.uint64).tolist() if size else []

    def go_to(self, place: int, frames: list[int]) -> None:
        """Decodes a frame by its place; the one behind the last is decoded without a seek."""
        if place == self.place:
            return
        with self._errors():
            if place != self.place + 1:
                library.player_seek(self._handle, frames[place])
            self.place = -2  # nowhere, until it is decoded
            library.player_next(self._handle)
        self.place = place


class Texture:
    """A texture of a container: a sequence of frames, each an array.

    ``texture[0]``, ``texture[-1]``, ``texture[2:5]`` (one array of several frames), ``len()``,
    iteration. Reading in order is fastest. Threads that read one texture take turns: open the file
    once for each thread.
    """

    def __init__(self, file: File, number: int, name: str, volume: Volume) -> None:
        self._file, self._number = file, number
        self.name, self.volume = name, volume
        self.desc = file._desc(number)
        self._players: dict[str | None, _Player] = {}
        self._turn = threading.Lock()

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
        return library.container_largest_error(self._file._container, self._number)

    @property
    def metadata(self) -> dict[str, str]:
        return self._file._metadata(c.METADATA_TEXTURE, self._number)

    @property
    def frames(self) -> list[int]:
        """The numbers of all frames of the file."""
        return self._file.frames

    def __len__(self) -> int:
        return len(self.frames)

    def read(self, index: int = 0, out: np.ndarray | None = None) -> np.ndarray:
        """A frame by its place, negative ones from the end; into ``out`` if given."""
        view, out = self.desc.target(out)
        with self._turn:
            library.player_read(self._at(index, None)._handle, self._number, byref(view))
        return out

    def blocks(self, index: int = 0, *, guard_band: bool = False) -> np.ndarray:
        """A frame as blocks: [block, slice, row, column, component]."""
        view, out = self.desc.with_tiling("blocks").target(None)
        with self._turn:
            library.player_read(self._at(index, "blocks")._handle, self._number, byref(view))
        band = 0 if guard_band else self.desc.struct.guard_band
        return out[:, :, band:out.shape[2] - band, band:out.shape[3] - band] if band else out

    def changed(self, index: int = 0) -> np.ndarray:
        """Blocks that a frame may have changed, ascending; all where decoding began."""
        with self._turn:
            return borrowed("player_changed", self._at(index, None)._handle, self._number,
                            dtype=np.uint32)

    def as_float(self, index: int = 0) -> np.ndarray:
        """A frame as float32, exact for all floats."""
        return self.desc.as_float(self.read(index))

    def _at(self, index: int, tiling: str | None) -> _Player:
        self._file._first._handle.check()
        frames = self.frames
        place = range(len(frames))[index]  # negative ones, and IndexError
        if tiling not in self._players:
            self._players[tiling] = _Player(self._file, self._number, tiling)
        player = self._players[tiling]
        player.go_to(place, frames)
        return player

    def __getitem__(self, index):
        if isinstance(index, slice):
            places = range(len(self))[index]
            return np.stack([self.read(place) for place in places]) if places else np.empty(
                (0, *self.shape), self.dtype)
        return self.read(index)

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self.read(place) for place in range(len(self)))

    def __repr__(self) -> str:
        x, y, z = self.desc.grid
        return (f"<Texture {self.name!r}: {len(self)} frames of {self.shape} {self.dtype}, "
                f"{self.format or 'custom'}, {x}×{y}×{z} blocks>")

    def _repr_html_(self) -> str:
        return picture.html(self, repr(self))


class Volume:
    """Textures of one kind over one or more grids or pools. ``volume["color"]`` is a texture."""

    def __init__(self, file: File, number: int) -> None:
        self._file, self._number = file, number
        self.name = decoded(library.container_volume_name(file._container, number))
        entry = file._json["volumes"][number]
        self.kind = entry["kind"]
        first = entry["first_texture"]
        self.textures: dict[str, Texture] = {}
        for place in range(first, first + entry["textures"]):
            name = decoded(library.container_texture_name(file._container, place))
            if "grid" in file._json["textures"][place]:  # of a kind that the library knows
                self.textures[name] = Texture(file, place, name, self)

    @property
    def geometry(self) -> dict | None:
        """Grid, origin, spacing and scroll; None if unknown."""
        return self._file._json["volumes"][self._number].get("geometry")

    @property
    def metadata(self) -> dict[str, str]:
        return self._file._metadata(c.METADATA_VOLUME, self._number)

    @property
    def desc(self) -> VolumeDesc:
        handle = ctypes.c_void_p()
        library.container_volume(self._file._container, self._number, byref(handle))
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
        return f"<Volume {self.name!r} of {self.kind}: {', '.join(self.textures)}>"


class File:
    """An open container: see open()."""

    def __init__(self, source, *, threads: int = 1, limits: dict | None = None) -> None:
        self._threads, self._limits = threads, limits
        self._path, self._stream, self._turn = None, None, threading.Lock()
        if isinstance(source, (str, os.PathLike)):
            self._path = os.fspath(source)
            self._stream = pathlib.Path(source).open("rb", buffering=0)
            if not self._stream.seekable():  # a pipe
                with self._stream:
                    source = self._stream.readall()
                self._stream = None
        elif hasattr(source, "read"):
            source = source.read()
        self._bytes = np.frombuffer(b"" if self._stream else source, np.uint8)
        try:
            self._first = _Player(self, None)
        except BaseException:
            if self._stream:
                self._stream.close()
            raise
        self._address = library.player_container(self._first._handle)
        self._json = json.loads(text_of("container_json", self._container))
        self.frames = self._first.frames()
        self.volumes = [Volume(self, place)
                        for place in range(library.container_volumes(self._container))]

    @property
    def _container(self) -> int:
        self._first._handle.check()
        return self._address

    @property
    def textures(self) -> dict[str, Texture]:
        """All textures by name; of several volumes "volume/texture"."""
        if len(self.volumes) == 1:
            return dict(self.volumes[0].textures)
        return {f"{volume.name}/{name}": texture for volume in self.volumes
                for name, texture in volume.textures.items()}

    @property
    def scene(self) -> str:
        return self._json["scene"]["name"]

    @property
    def metadata(self) -> dict[str, str]:
        return self._metadata(c.METADATA_CONTAINER, 0)

    @property
    def is_complete(self) -> bool:
        """False for a file that was cut off or is growing: ``frames`` has those that are whole."""
        return library.player_finished(self._first._handle) != 0

    def json(self) -> dict:
        """All descriptions."""
        return self._json

    def _head(self) -> bytes:
        if self._stream is None:
            return self._bytes[:16].tobytes()
        self._stream.seek(0)
        return self._stream.read(16)

    def _desc(self, texture: int) -> TextureDesc:
        struct = sized(c.gicodec_texture_desc)
        library.container_texture(self._container, texture, byref(struct), None)
        return TextureDesc(struct)

    def _metadata(self, of: int, index: int) -> dict[str, str]:
        count = library.container_metadata_count(self._container, of, index)
        return {decoded(library.container_metadata_name(self._container, of, index, pair)):
                decoded(library.container_metadata_value(self._container, of, index, pair, None))
                for pair in range(count)}

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
        for volume in self.volumes:
            for texture in volume.textures.values():
                for player in texture._players.values():
                    player.close()
        self._first.close()
        if self._stream is not None:
            self._stream.close()

    def __enter__(self) -> File:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    __reduce_ex__ = Handle.__reduce_ex__

    def __repr__(self) -> str:
        cut = "" if self._first.is_closed or self.is_complete else ", cut off or growing"
        lines = [f"<File {self._path or 'in memory'}: {len(self.frames)} frames{cut}"]
        lines += [f"  {name}: {texture.shape} {texture.dtype} {texture.format or 'custom'}"
                  for name, texture in self.textures.items()]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        return "".join(picture.html(texture, name) for name, texture in self.textures.items())


def open(source, *, threads: int = 1, limits: dict | None = None) -> File:
    """Opens a container: a path, bytes, or anything with read().

    ``limits`` bounds what a file may cost, by fields of gicodec_limits.
    """
    return File(source, threads=threads, limits=limits)
