"""Encoders and decoders: textures in, packets out, and back."""

from __future__ import annotations

import ctypes
import weakref
from contextlib import contextmanager
from typing import Iterable

import numpy as np

from . import _interface as c
from ._library import Error, Handle, Host, address, byref, coded, library, limits_of, sized
from .description import TextureDesc, VolumeDesc, block_list


PRESETS = ("turbo", "fast", "strong")


def _options(host: Host, *, backend: str, preset: str | None, level: int, gop: int | None,
             max_error, chunk: int, texture_id: int = 0) -> c.gicodec_encoder_options:
    if gop is not None and not 0 <= gop < c.GOP_ON_REQUEST:
        raise ValueError(f"gop is 0, for keyframes on request, or a number of packets, not {gop}")
    if preset is not None and preset not in PRESETS:
        raise ValueError(f"there is no preset {preset!r}: {', '.join(PRESETS)} are")
    options = sized(c.gicodec_encoder_options, backend=coded(backend), level=level,
                    preset=coded(preset) if preset else None, chunk=chunk,
                    gop=c.GOP_ON_REQUEST if gop == 0 else gop or 0, texture_id=texture_id,
                    host=address(host.struct))
    if isinstance(max_error, (int, float)):
        options.max_error = max_error
    else:
        bounds = (ctypes.c_float * len(max_error))(*max_error)
        options.max_errors, options.max_error_count = address(bounds), len(bounds)
        options._bounds = bounds
    return options


@contextmanager
def _names(**settings):
    """Errors of what is created say its settings."""
    try:
        yield
    except Error as error:
        said = ", ".join(f"{name}={value!r}" for name, value in settings.items() if value)
        if error.status == c.UNKNOWN_BACKEND:
            said += "; the backends are native, raw, lz4 and zstd"
        if said and error.status in (c.UNKNOWN_BACKEND, c.INVALID_SETTINGS, c.INVALID_BOUND,
                                     c.INVALID_ARGUMENT):
            error.args = (f"{error}: {said}",)
        raise


def _selection(blocks) -> tuple[int, object, int]:
    """What the library takes for "changed", "all" or a list."""
    if isinstance(blocks, str):
        if blocks not in ("changed", "all"):
            raise ValueError(f'blocks are "changed", "all" or a list of numbers, not {blocks!r}')
        return {"changed": c.SELECT_CHANGED, "all": c.SELECT_ALL}[blocks], None, 0
    chosen = block_list(blocks)
    return c.SELECT_LIST, chosen, chosen.size


def _data(chosen):
    return chosen.ctypes.data if chosen is not None else None


def borrowed(call: str, *arguments, dtype) -> np.ndarray:
    """A copy of memory that a call points to."""
    count = ctypes.c_size_t()
    with arguments[0].turn:
        at = getattr(library, call)(*arguments, byref(count))
        if not at or count.value == 0:
            return np.zeros(0, dtype)
        size = count.value * np.dtype(dtype).itemsize
        return np.frombuffer(ctypes.string_at(at, size), dtype)


class _Borrowed:
    """Memory of a handle's as numpy takes it, not to be written."""

    def __init__(self, owner: Handle, at: int, desc: TextureDesc) -> None:
        self._owner = owner
        self.__array_interface__ = {"version": 3, "data": (at, True), "typestr": desc.dtype.str,
                                    "shape": desc.core_shape}


class Encoder(Handle):
    """Turns successive contents of one texture into packets; the first one is a keyframe.

    ``backend``: "native", "raw", "lz4" or "zstd". ``preset`` of native: "turbo", "fast" or
    "strong". ``gop``: a keyframe every so many packets, None for 30, 0 for none but the first.
    ``max_error``: 0 is lossless; below 1 relative (of what is below the smallest normal number, to
    that), else codes or representable values.
    """

    _destroy = "encoder_destroy"

    def __init__(self, desc: TextureDesc, *, backend: str = "native", preset: str | None = None,
                 level: int = 0, gop: int | None = None, max_error: float = 0, chunk: int = 0,
                 texture_id: int = 0, threads: int = 1, isa: str | None = None) -> None:
        host = Host(threads, isa)
        options = _options(host, backend=backend, preset=preset, level=level, gop=gop,
                           max_error=max_error, chunk=chunk, texture_id=texture_id)
        self.desc = desc
        with _names(backend=backend, preset=preset, level=level, max_error=max_error, chunk=chunk,
                    texture_id=texture_id, threads=threads, isa=isa):
            super().__init__("encoder_create", byref(desc.struct), byref(options))
        bound = library.encoder_bound(self._handle, desc.block_count)
        self._packet = np.empty(bound, np.uint8)

    def encode(self, texture, blocks="changed") -> bytes:
        """A packet of the blocks that changed, of "all", or of a list of block numbers."""
        view, keep = self.desc.view_of(texture)
        selection, chosen, count = _selection(blocks)
        size = ctypes.c_size_t()
        with self._handle.turn:
            library.encoder_encode(self._handle, byref(view), selection, _data(chosen), count,
                                   self._packet.ctypes.data, self._packet.nbytes, byref(size))
            return self._packet[:size.value].tobytes()

    def snapshot(self) -> bytes:
        """A keyframe of what decoders hold, for those that join late."""
        size = ctypes.c_size_t()
        with self._handle.turn:
            library.encoder_snapshot(self._handle, self._packet.ctypes.data, self._packet.nbytes,
                                     byref(size))
            return self._packet[:size.value].tobytes()

    def request_keyframe(self) -> None:
        """Makes the next packet a keyframe."""
        library.encoder_request_keyframe(self._handle)

    def set_preset(self, preset: str) -> None:
        library.encoder_set_preset(self._handle, coded(preset))

    def set_active(self, active) -> None:
        """Leaves out inactive blocks: a truth value for each; None: all are active."""
        mask = np.ascontiguousarray([] if active is None else active, np.uint8)
        library.encoder_set_active(self._handle, mask.ctypes.data, mask.size)

    def set_presence(self, presence) -> None:
        """Which records exist, for a texture with presence."""
        mask = np.ascontiguousarray(presence).view(np.uint8)
        library.encoder_set_presence(self._handle, mask.ctypes.data, mask.size)

    def read(self, out: np.ndarray | None = None) -> np.ndarray:
        """The texture as decoders hold it."""
        view, out = self.desc.target(out)
        library.encoder_read(self._handle, byref(view))
        return out

    @property
    def sequence(self) -> int:
        """Number of the last packet; 0 before the first."""
        return library.encoder_sequence(self._handle)


def _decoder_options(host: Host, limits, texture_id: int = 0) -> c.gicodec_decoder_options:
    options = sized(c.gicodec_decoder_options, host=address(host.struct), texture_id=texture_id)
    options._limits = limits_of(limits)
    options.limits = address(options._limits) if limits else None
    return options


class Decoder(Handle):
    """Turns packets back into the texture. A packet is applied completely or not at all.

    ``limits``: a dict of fields of gicodec_limits, e.g. {"max_texture_bytes": 1 << 20}.
    """

    _destroy = "decoder_destroy"

    def __init__(self, desc: TextureDesc, *, limits: dict | None = None, threads: int = 1,
                 isa: str | None = None) -> None:
        host = Host(threads, isa)
        options = _decoder_options(host, limits)
        self.desc = desc
        self._borrowed = weakref.WeakSet()
        with _names(threads=threads, isa=isa):
            super().__init__("decoder_create", byref(desc.struct), byref(options))

    def decode(self, packet, out: np.ndarray | None = None) -> None:
        """Applies a packet; with ``out`` also writes the blocks that it may have changed there."""
        data = np.frombuffer(packet, np.uint8)
        view = None
        if out is not None:
            view, out = self.desc.target(out)
        with self._handle.turn:
            self._check_borrowed()
            library.decoder_decode(self._handle, data.ctypes.data, data.nbytes,
                                   None if view is None else byref(view))

    def read(self, out: np.ndarray | None = None, blocks=None) -> np.ndarray:
        """The texture; with a list of blocks just these, into ``out``."""
        view, out = self.desc.target(out)
        chosen = None if blocks is None else block_list(blocks)
        library.decoder_read(self._handle, byref(view), _data(chosen),
                             0 if chosen is None else chosen.size)
        return out

    def records(self) -> np.ndarray:
        """All blocks without guard bands, [block, slice, row, column, component], not copied and
        read-only. While such an array is in use, decode() and close() raise a BufferError."""
        size = ctypes.c_size_t()
        with self._handle.turn:
            at = library.decoder_records(self._handle, byref(size))
            memory = _Borrowed(self, at, self.desc)
            self._borrowed.add(memory)
        return np.asarray(memory)

    def _check_borrowed(self) -> None:
        if len(self._borrowed) != 0:
            raise BufferError("an array of records() is in use: delete it, or copy it")

    def close(self) -> None:
        with self._handle.turn:
            self._check_borrowed()
            super().close()

    @property
    def changed(self) -> np.ndarray:
        """Blocks that the last packet may have changed, ascending."""
        return borrowed("decoder_changed", self._handle, dtype=np.uint32)

    @property
    def received(self) -> np.ndarray:
        """For each block, whether it was received."""
        return borrowed("decoder_received", self._handle, dtype=np.uint8) != 0

    @property
    def sequence(self) -> int:
        return library.decoder_sequence(self._handle)

    @property
    def state_hash(self) -> int:
        return library.decoder_state_hash(self._handle)


class VolumeEncoder(Handle):
    """Encodes all textures of a volume: one packet for each in every update."""

    _destroy = "volume_encoder_destroy"

    def __init__(self, volume: VolumeDesc, *, backend: str = "native", preset: str | None = None,
                 level: int = 0, gop: int | None = None, max_error=0, chunk: int = 0,
                 first_texture: int = 0, threads: int = 1, isa: str | None = None) -> None:
        host = Host(threads, isa)
        options = _options(host, backend=backend, preset=preset, level=level, gop=gop,
                           max_error=max_error, chunk=chunk, texture_id=first_texture)
        self.textures = volume.textures
        with _names(backend=backend, preset=preset, level=level, max_error=max_error, chunk=chunk,
                    first_texture=first_texture, threads=threads, isa=isa):
            super().__init__("volume_encoder_create", volume._handle, byref(options))

    def encode(self, textures: dict, blocks="changed") -> list[bytes]:
        """The packets of an update, in the order in which decoders must apply them."""
        views, keep = (c.gicodec_const_view * len(self.textures))(), []
        for name in self.textures:
            if name not in textures:
                raise KeyError(f"the volume has a texture {name!r}, which was not given")
        if others := set(textures) - set(self.textures):
            raise KeyError(f"the volume has no texture {sorted(map(str, others))[0]!r}: it has "
                           f"{', '.join(self.textures)}")
        for place, (name, desc) in enumerate(self.textures.items()):
            views[place], array = desc.view_of(textures[name], name)
            keep.append(array)
        selection, chosen, count = _selection(blocks)
        with self._handle.turn:
            library.volume_encoder_encode(self._handle, byref(views), len(views), selection,
                                          _data(chosen), count)
            return self._packets()

    def snapshot(self) -> list[bytes]:
        """Keyframes of what decoders hold."""
        with self._handle.turn:
            library.volume_encoder_snapshot(self._handle)
            return self._packets()

    def _packets(self) -> list[bytes]:
        count = library.volume_encoder_packets(self._handle)
        return [borrowed("volume_encoder_packet", self._handle, place, dtype=np.uint8).tobytes()
                for place in range(count)]

    def request_keyframe(self) -> None:
        library.volume_encoder_request_keyframe(self._handle)


class VolumeDecoder(Handle):
    """Decodes the packets of a VolumeEncoder."""

    _destroy = "volume_decoder_destroy"

    def __init__(self, volume: VolumeDesc, *, limits: dict | None = None, first_texture: int = 0,
                 threads: int = 1, isa: str | None = None) -> None:
        host = Host(threads, isa)
        options = _decoder_options(host, limits, first_texture)
        self.textures = volume.textures
        self._first, self._changed = first_texture, {}
        with _names(threads=threads, isa=isa, first_texture=first_texture):
            super().__init__("volume_decoder_create", volume._handle, byref(options))

    def decode(self, packets: Iterable[bytes]) -> None:
        """Applies the packets of an update, in their order."""
        self._changed = {}
        for packet in packets:
            data = np.frombuffer(packet, np.uint8)
            library.volume_decoder_decode(self._handle, data.ctypes.data, data.nbytes)
            place = peek(packet)["texture_id"] - self._first
            self._changed[place] = borrowed("volume_decoder_changed", self._handle, place,
                                            dtype=np.uint32)

    def read(self, name: str, out: np.ndarray | None = None) -> np.ndarray:
        place = list(self.textures).index(name)
        view, out = self.textures[name].target(out)
        library.volume_decoder_read(self._handle, place, byref(view), None, 0)
        return out

    def changed(self, name: str) -> np.ndarray:
        """Blocks of a texture that the last update may have changed, ascending."""
        return self._changed.get(list(self.textures).index(name), np.zeros(0, np.uint32))


def peek(packet) -> dict:
    """The head of a packet, without a decoder."""
    data = np.frombuffer(packet, np.uint8)
    info = sized(c.gicodec_packet_info)
    library.packet_peek(data.ctypes.data, data.nbytes, byref(info))
    found = {name: getattr(info, name) for name, _ in info._fields_ if name != "struct_size"}
    found["backend"] = (library.backend_name(info.backend) or b"").decode()
    return found
