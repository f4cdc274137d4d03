"""Containers (.gic): new ones, from arrays."""

from __future__ import annotations

import os
import pathlib
import secrets

import numpy as np

from . import _interface as c
from ._library import Handle, byref, library, sized
from .codec import VolumeEncoder, borrowed
from .description import VolumeDesc


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
        self._stream, self._pieces = None, []
        if self._path is not None:
            if self._path.is_dir():
                raise IsADirectoryError(f"{self._path} is a folder: give the name of a file")
            if not overwrite and self._path.exists():
                raise FileExistsError(f"{self._path} exists: pass overwrite=True to replace it")
            if not self._path.parent.is_dir():
                raise FileNotFoundError(f"there is no folder {self._path.parent} for {self._path.name}")
        self._container = _Container(volumes, geometry or {}, metadata or {}, scene,
                                     options.get("max_error", 0))
        self._writer = _BytesWriter(self._container)
        self._encoders: dict[str, VolumeEncoder] = {}
        first = 0
        for name, volume in volumes.items():
            self._encoders[name] = VolumeEncoder(volume, first_texture=first, **options)
            first += len(volume.textures)
        if self._path is not None:
            self._work = self._path.with_name(f".{self._path.name}.{secrets.token_hex(4)}")
            self._stream = self._work.open("xb")
        self._drain()

    def add(self, frame: int, textures: dict, volume: str | None = None, blocks="changed") -> None:
        """Adds a frame of a volume; its name may be left out where there is one."""
        name = volume if volume is not None else next(iter(self._encoders))
        if name not in self._encoders:
            raise KeyError(f"there is no volume {name!r}: there are {', '.join(self._encoders)}")
        _check_frame(frame)
        for packet in self._encoders[name].encode(textures, blocks):
            self.add_packet(frame, packet)

    def add_packet(self, frame: int, packet: bytes) -> None:
        """Adds a packet as it is; its texture number names its texture."""
        _check_frame(frame)
        data = np.frombuffer(packet, np.uint8)
        library.writer_add(self._writer._handle, frame, data.ctypes.data, data.nbytes)
        self._drain()

    def close(self) -> None:
        """Ends the container, and gives the file its name."""
        if self._writer.is_closed:
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
        self._abandon()

    def _abandon(self) -> None:
        """Removes what has no name yet."""
        if self._stream is not None and not self._stream.closed:
            self._stream.close()
            self._work.unlink()

    def __del__(self) -> None:
        if hasattr(self, "_stream"):
            self._abandon()


def _check_frame(frame: int) -> None:
    if not 0 <= frame < 1 << 64 or frame != int(frame):
        raise ValueError(f"a frame is a whole number from 0 on, not {frame}")


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
