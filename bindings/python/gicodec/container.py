"""Containers (.gic): read their frames as arrays, write new ones."""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import pathlib
import secrets
from typing import Iterator

import numpy as np

from . import _interface as c
from . import picture
from ._library import Handle, Host, address, byref, decoded, error_of, library, limits_of, sized, text_of
from .codec import VolumeEncoder, borrowed
from .description import TextureDesc, VolumeDesc


class _Player(Handle):
    """Decodes one texture of a container, in one layout."""

    _destroy = "player_destroy"

    def __init__(self, file: File, texture: int | None, tiling: str | None = None) -> None:
        host = Host(file._threads)
        options = sized(c.gicodec_player_options, host=address(host.struct))
        limits = limits_of(file._limits)
        options.limits = address(limits) if limits else None
        super().__init__("player_open_memory", file._bytes.ctypes.data, file._bytes.nbytes,
                         byref(options))
        self._memory = file._bytes
        self.frame = None
        if texture is None:
            return
        wanted = (ctypes.c_uint32 * 1)(texture)
        library.player_select(self._handle, byref(wanted), 1)
        if tiling is not None:
            library.player_set_layout(self._handle, texture,
                                      byref(file._desc(texture).with_tiling(tiling).struct))

    def frames(self) -> list[int]:
        at, count = ctypes.c_void_p(), ctypes.c_size_t()
        status = library.status_of("player_frames", self._handle, byref(at), byref(count))
        if status == c.UNKNOWN_FRAME:
            raise error_of(c.CORRUPT, "the index of the frames")
        if status != c.OK:
            raise error_of(status)
        size = count.value * 8
        return np.frombuffer(ctypes.string_at(at.value, size), np.uint64).tolist() if size else []

    def go_to(self, frame: int, following: int | None) -> None:
        """Decodes a frame; ``following`` is the one that next() would give."""
        if frame == self.frame:
            return
        if frame != following:
            library.player_seek(self._handle, frame)
        self.frame = None
        library.player_next(self._handle)
        self.frame = frame


class Texture:
    """A texture of a container: a sequence of frames, each an array.

    ``texture[0]``, ``texture[-1]``, ``texture[2:5]`` (one array of several frames), ``len()``,
    iteration. Reading in order is fastest. Not for several threads at once.
    """

    def __init__(self, file: File, number: int, name: str, volume: Volume) -> None:
        self._file, self._number = file, number
        self.name, self.volume = name, volume
        self.desc = file._desc(number)
        self._players: dict[str | None, _Player] = {}

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
        player = self._at(index, None)
        view, out = self.desc.target(out)
        library.player_read(player._handle, self._number, byref(view))
        return out

    def blocks(self, index: int = 0, *, guard_band: bool = False) -> np.ndarray:
        """A frame as blocks: [block, slice, row, column, component]."""
        player = self._at(index, "blocks")
        view, out = self.desc.with_tiling("blocks").target(None)
        library.player_read(player._handle, self._number, byref(view))
        band = 0 if guard_band else self.desc.struct.guard_band
        return out[:, :, band:out.shape[2] - band, band:out.shape[3] - band] if band else out

    def changed(self, index: int = 0) -> np.ndarray:
        """Blocks that a frame may have changed, ascending; all where decoding began."""
        player = self._at(index, None)
        return borrowed("player_changed", player._handle, self._number, dtype=np.uint32)

    def as_float(self, index: int = 0) -> np.ndarray:
        """A frame as float32, exact for all floats."""
        return self.desc.as_float(self.read(index))

    def _at(self, index: int, tiling: str | None) -> _Player:
        frames = self.frames
        place = range(len(frames))[index]  # negative ones, and IndexError
        if tiling not in self._players:
            self._players[tiling] = _Player(self._file, self._number, tiling)
        player = self._players[tiling]
        before = -1 if player.frame is None else frames.index(player.frame)
        following = frames[before + 1] if before + 1 < len(frames) else None
        player.go_to(frames[place], following)
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
        self._path = None
        if isinstance(source, (str, os.PathLike)):
            self._path = os.fspath(source)
            with pathlib.Path(source).open("rb") as stream:
                size = os.fstat(stream.fileno()).st_size
                source = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) if size else b""
        elif hasattr(source, "read"):
            source = source.read()
        self._bytes = np.frombuffer(source, np.uint8)
        self._first = _Player(self, None)
        self._container = library.player_container(self._first._handle)
        self._json = json.loads(text_of("container_json", self._container))
        self.frames = self._first.frames()
        self.volumes = [Volume(self, place)
                        for place in range(library.container_volumes(self._container))]

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

    def json(self) -> dict:
        """All descriptions."""
        return self._json

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

    def close(self) -> None:
        """Frees the decoders. Arrays that were read stay."""
        for volume in self.volumes:
            for texture in volume.textures.values():
                for player in texture._players.values():
                    player.close()
        self._first.close()

    def __enter__(self) -> File:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __repr__(self) -> str:
        lines = [f"<File {self._path or 'in memory'}: {len(self.frames)} frames"]
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


class Writer:
    """Writes a container.

        with gicodec.Writer("x.gic", {"room": volume}) as writer:
            writer.add(0, {"color": array, "vis": array})

    The file appears under its name when the ``with`` block ends without an error; one of that name
    stays unless ``overwrite`` is true. ``None`` as path: ``getvalue()`` has the bytes. Options of
    VolumeEncoder may follow.
    """

    def __init__(self, path, volumes: dict[str, VolumeDesc], *, overwrite: bool = False,
                 geometry: dict | None = None, metadata: dict[str, str] | None = None,
                 scene: str = "", **options) -> None:
        self._path = None if path is None else pathlib.Path(path)
        self._overwrite = overwrite
        if self._path is not None and not overwrite and self._path.exists():
            raise FileExistsError(f"{self._path} exists: pass overwrite=True to replace it")
        self._container = _Container(volumes, geometry or {}, metadata or {}, scene,
                                     options.get("max_error", 0))
        self._writer = _BytesWriter(self._container)
        self._encoders: dict[str, VolumeEncoder] = {}
        first = 0
        for name, volume in volumes.items():
            self._encoders[name] = VolumeEncoder(volume, first_texture=first, **options)
            first += len(volume.textures)
        self._stream, self._pieces = None, []
        if self._path is not None:
            self._work = self._path.with_name(f".{self._path.name}.{secrets.token_hex(4)}")
            self._stream = self._work.open("xb")
        self._drain()

    def add(self, frame: int, textures: dict, volume: str | None = None, blocks="changed") -> None:
        """Adds a frame of a volume; its name may be left out where there is one."""
        name = volume if volume is not None else next(iter(self._encoders))
        for packet in self._encoders[name].encode(textures, blocks):
            self.add_packet(frame, packet)

    def add_packet(self, frame: int, packet: bytes) -> None:
        """Adds a packet as it is; its texture number names its texture."""
        data = np.frombuffer(packet, np.uint8)
        library.writer_add(self._writer._handle, frame, data.ctypes.data, data.nbytes)
        self._drain()

    def close(self) -> None:
        """Ends the container, and gives the file its name."""
        if self._writer._handle is None:
            return
        library.writer_finish(self._writer._handle)
        self._drain()
        self._end()
        if self._stream is None:
            return
        self._stream.close()
        if self._overwrite:
            os.replace(self._work, self._path)
            return
        try:
            os.link(self._work, self._path)  # unlike rename(), fails if somebody took the name
        finally:
            self._work.unlink()

    def getvalue(self) -> bytes:
        """The bytes of a Writer without a path."""
        return b"".join(self._pieces)

    def _drain(self) -> None:
        piece = borrowed("writer_bytes", self._writer._handle, dtype=np.uint8).tobytes()
        if self._stream is not None:
            self._stream.write(piece)
        else:
            self._pieces.append(piece)
        library.writer_take(self._writer._handle)

    def _end(self) -> None:
        for handle in (self._writer, self._container, *self._encoders.values()):
            handle.close()

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, kind, *_) -> None:
        if kind is None:
            self.close()
            return
        self._end()
        if self._stream is not None:
            self._stream.close()
            self._work.unlink()


class _Container(Handle):
    """The description that a Writer writes."""

    _destroy = "container_destroy"

    def __init__(self, volumes, geometry, metadata, scene, max_error) -> None:
        super().__init__("container_create")
        texture = 0
        for place, (name, volume) in enumerate(volumes.items()):
            library.container_add_volume(self._handle, name.encode(), volume._handle)
            if name in geometry:
                struct = sized(c.gicodec_geometry)
                for field, value in geometry[name].items():
                    getattr(struct, field)[:] = value
                library.container_set_geometry(self._handle, place, byref(struct))
            for number in range(len(volume.textures)):
                bound = max_error[number] if hasattr(max_error, "__getitem__") else max_error
                library.container_set_largest_error(self._handle, texture, bound)
                texture += 1
        for name, value in metadata.items():
            library.container_add_metadata(self._handle, c.METADATA_CONTAINER, 0, name.encode(),
                                           value.encode())
        library.container_set_scene(self._handle, scene.encode(), 0)


class _BytesWriter(Handle):
    _destroy = "writer_destroy"

    def __init__(self, container: _Container) -> None:
        super().__init__("writer_create", None, container._handle)
