"""Containers (.gic): new ones, from arrays."""

from __future__ import annotations

import threading

import numpy as np

from . import _interface as c
from ._library import Handle, byref, coded, library, sized
from .codec import VolumeEncoder, borrowed
from .description import VolumeDesc
from .output import OutputFile


class Writer:
    """Writes a container.

        with gicodec.Writer("x.gic", {"room": volume}) as writer:
            writer.add(0, {"color": array, "vis": array})

    The file appears under its name when the ``with`` block ends without an error; until then it is
    x.gic.….partial beside it. A container of that name stays unless ``overwrite`` is true; anything
    else stays in any case. ``None`` as path: ``getvalue()`` has the bytes. Options of VolumeEncoder
    may follow. A failed call changes nothing: repeat it, or go on. Threads take turns.
    """

    def __init__(self, path, volumes: dict[str, VolumeDesc], *, overwrite: bool = False,
                 geometry: dict | None = None, metadata: dict[str, str] | None = None,
                 scene: str = "", **options) -> None:
        self._turn = threading.RLock()
        self._output = None if path is None else OutputFile(path, overwrite)
        self._pieces: list[bytes] = []
        self._ended = False
        self._container = _Container(volumes, geometry or {}, metadata or {}, scene,
                                     options.get("max_error", 0))
        self._writer = _BytesWriter(self._container)
        self._encoders: dict[str, VolumeEncoder] = {}
        first = 0
        for name, volume in volumes.items():
            self._encoders[name] = VolumeEncoder(volume, first_texture=first, **options)
            first += len(volume.textures)
        if self._output is not None:
            self._output.begin()
        self._drain()

    def add(self, frame: int, textures: dict, volume: str | None = None, blocks="changed") -> None:
        """Adds a frame of a volume; its name may be left out where there is one."""
        name = volume if volume is not None else next(iter(self._encoders))
        if name not in self._encoders:
            raise KeyError(f"there is no volume {name!r}: there are {', '.join(self._encoders)}")
        _check_frame(frame)
        encoder = self._encoders[name]
        with self._turn:
            try:
                for packet in encoder.encode(textures, blocks):
                    self.add_packet(frame, packet)
            except BaseException:
                if not encoder.is_closed:
                    encoder.request_keyframe()  # the file may lack what the encoder went on from
                raise

    def add_packet(self, frame: int, packet: bytes) -> None:
        """Adds a packet as it is; its texture number names its texture."""
        _check_frame(frame)
        data = np.frombuffer(packet, np.uint8)
        with self._turn:
            self._drain()  # what an earlier call could not write
            library.writer_add(self._writer._handle, frame, data.ctypes.data, data.nbytes)
            self._drain()

    def close(self) -> None:
        """Ends the container, and gives the file its name. After an error, e.g. of a full disk, the
        call may be repeated."""
        with self._turn:
            if self._writer.is_closed:
                return
            if not self._ended:
                library.writer_finish(self._writer._handle)
                self._ended = True
            self._drain()
            if self._output is not None:
                self._output.publish()
            self._end()

    def getvalue(self) -> bytes:
        """The bytes of a Writer without a path."""
        return b"".join(self._pieces)

    def _drain(self) -> None:
        piece = borrowed("writer_bytes", self._writer._handle, dtype=np.uint8).tobytes()
        if self._output is not None:
            self._output.write(piece)
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
        if self._output is not None:
            self._output.abandon()

    def __del__(self) -> None:
        if hasattr(self, "_output"):
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
            library.container_add_volume(self._handle, coded(name), volume._handle)
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
            library.container_add_metadata(self._handle, c.METADATA_CONTAINER, 0, coded(name),
                                           coded(value))
        library.container_set_scene(self._handle, coded(scene), 0)


class _BytesWriter(Handle):
    _destroy = "writer_destroy"

    def __init__(self, container: _Container) -> None:
        super().__init__("writer_create", None, container._handle)
