"""Streaming: a server and a client without a transport. Messages are bytes."""

from __future__ import annotations

import ctypes
from typing import Iterator

import numpy as np

from . import _interface as c
from ._library import (Handle, Host, address, byref, coded, decoded, error_of, library, limits_of,
                       shown, sized)
from .codec import borrowed
from .description import VolumeDesc, block_list

_DELIVERIES = ("unicast", "shared")
_EVENTS = ("joined", "resumed", "viewpoint", "subscribed", "dropped", "expired")


def _fields(struct) -> dict:
    return {name: getattr(struct, name) for name, _ in struct._fields_ if name != "struct_size"}


class ClientVolume:
    """A volume that a client holds. Arrays are copies."""

    def __init__(self, client: Client, number: int, instance: int) -> None:
        self._client, self.number, self.instance = client, number, instance
        self.name = decoded(library.client_volume_name(client._handle, number))
        handle = ctypes.c_void_p()
        library.client_volume_desc(client._handle, number, byref(handle))
        self.desc = VolumeDesc.adopt(handle.value)
        self.textures = self.desc.textures

    def _place(self, name: str) -> int:
        return list(self.textures).index(name)

    def read(self, name: str, out: np.ndarray | None = None, after: int = 0) -> np.ndarray:
        """A texture; into ``out``, with ``after`` just the blocks that changed after that serial."""
        view, out = self.textures[name].target(out)
        library.client_read(self._client._handle, self.number, self._place(name), after, byref(view))
        return out

    def changed(self, name: str, after: int = 0) -> np.ndarray:
        """Blocks that were replaced after the update of that serial, ascending."""
        blocks, count = ctypes.c_void_p(), ctypes.c_size_t()
        with self._client._handle.turn:
            library.client_changed(self._client._handle, self.number, self._place(name), after,
                                   byref(blocks), byref(count))
            size = count.value * 4
            return np.frombuffer(ctypes.string_at(blocks.value, size) if size else b"", np.uint32)

    @property
    def geometry(self) -> dict:
        struct = sized(c.gicodec_geometry)
        library.client_geometry(self._client._handle, self.number, byref(struct))
        return {name: tuple(value) for name, value in _fields(struct).items()}

    def __repr__(self) -> str:
        return f"<ClientVolume {self.name!r}: {', '.join(map(shown, self.textures))}>"


class Client(Handle):
    """Takes messages of a server, holds the textures of its volumes.

    Send hello(), then give every message received to receive(), and send messages() after each
    call.
    """

    _destroy = "client_destroy"

    def __init__(self, *, delivery: str = "unicast", token: str = "", budget_blocks: int = 0,
                 budget_bytes: int = 0, limits: dict | None = None, threads: int = 1) -> None:
        host, bounds = Host(threads), limits_of(limits)
        options = sized(c.gicodec_client_options, delivery=_DELIVERIES.index(delivery),
                        token=coded(token), budget_blocks=budget_blocks, budget_bytes=budget_bytes,
                        host=address(host.struct), limits=address(bounds) if bounds else None)
        super().__init__("client_create", byref(options))

    def hello(self) -> bytes:
        """The message that opens a connection; after a lost one it asks to continue the session."""
        library.client_hello(self._handle)
        return next(self.messages())

    def receive(self, message) -> bool:
        """Takes a message; False after the server's goodbye. After an error close the connection."""
        data = np.frombuffer(message, np.uint8)
        status = library.status_of("client_receive", self._handle, data.ctypes.data, data.nbytes)
        if status not in (c.OK, c.END):
            raise error_of(status)
        return status == c.OK

    def messages(self) -> Iterator[bytes]:
        """Messages to send, oldest first."""
        while True:
            piece = borrowed("client_message", self._handle, dtype=np.uint8)
            if piece.size == 0:
                return
            yield piece.tobytes()

    def subscribe(self, volume: int, blocks, group: int = 0) -> None:
        """Chooses the blocks of a group: a truth value for each."""
        mask = np.ascontiguousarray(blocks, np.uint8)
        library.client_subscribe(self._handle, volume, group, mask.ctypes.data, mask.size)

    def set_viewpoint(self, eye, target, up=(0, 1, 0), fov_y: float = 60, aspect: float = 1,
                      time: float = 0) -> None:
        """A camera in world units, by which a server may choose blocks."""
        viewpoint = sized(c.gicodec_viewpoint, fov_y=fov_y, aspect=aspect, time=time)
        viewpoint.eye[:], viewpoint.target[:], viewpoint.up[:] = eye, target, up
        library.client_set_viewpoint(self._handle, byref(viewpoint))

    def disconnect(self) -> None:
        """Ends the session for good; send messages(), then close the connection."""
        library.client_disconnect(self._handle)

    @property
    def state(self) -> dict:
        """connected, consistent, serial, update, time, volumes, reason and what was received."""
        struct = sized(c.gicodec_client_state)
        library.client_get_state(self._handle, byref(struct))
        found = _fields(struct)
        found["reason"] = library.reason_text(struct.reason).decode()
        return found

    @property
    def volumes(self) -> list[ClientVolume]:
        found, number, instance = [], ctypes.c_uint32(), ctypes.c_uint64()
        for place in range(self.state["volumes"]):
            library.client_volume(self._handle, place, byref(number), byref(instance))
            found.append(ClientVolume(self, number.value, instance.value))
        return found


class Server(Handle):
    """Sends the textures of volumes to clients. ``now`` is in seconds on any steady clock."""

    _destroy = "server_destroy"

    def __init__(self, *, token: str = "", scene: str = "", preset: str | None = None,
                 threads: int = 1, **limits) -> None:
        host = Host(threads)
        options = sized(c.gicodec_server_options, token=coded(token), scene=coded(scene),
                        preset=coded(preset) if preset else None, host=address(host.struct),
                        **limits)
        self._volumes: dict[int, dict] = {}
        super().__init__("server_create", byref(options))

    def add_volume(self, name: str, volume: VolumeDesc, *, origin=(0, 0, 0),
                   spacing=(1, 1, 1)) -> int:
        """Adds a volume, also while clients are connected, and returns its number."""
        geometry = sized(c.gicodec_geometry)
        textures = volume.textures
        geometry.grid[:] = next(iter(textures.values())).grid
        geometry.origin[:], geometry.spacing[:] = origin, spacing
        number = ctypes.c_uint32()
        library.server_add_volume(self._handle, coded(name), volume._handle, byref(geometry),
                                  None, 0, byref(number))
        self._volumes[number.value] = textures
        return number.value

    def remove_volume(self, volume: int) -> None:
        library.server_remove_volume(self._handle, volume)
        self._volumes.pop(volume, None)

    def publish(self, volume: int, textures: dict, blocks=None) -> None:
        """Sets contents from the next update on; ``blocks``: all that may have changed."""
        names = list(self._volumes[volume])
        chosen = None if blocks is None else block_list(blocks)
        for name, texture in textures.items():
            view, keep = self._volumes[volume][name].view_of(texture, name)
            library.server_publish(self._handle, volume, names.index(name), byref(view),
                                   None if chosen is None else chosen.ctypes.data,
                                   0 if chosen is None else chosen.size)

    def connect(self, now: float, origin: str = "") -> int:
        """A new connection of the transport; returns its number."""
        number = ctypes.c_uint32()
        library.server_connect(self._handle, now, coded(origin), byref(number))
        return number.value

    def receive(self, connection: int, message, now: float) -> None:
        data = np.frombuffer(message, np.uint8)
        library.server_receive(self._handle, connection, data.ctypes.data, data.nbytes, now)

    def disconnect(self, connection: int, now: float) -> None:
        library.server_disconnect(self._handle, connection, now)

    def update(self, now: float, time: float) -> None:
        """Makes the next packets for all sessions. ``time``: of what is shown."""
        library.server_update(self._handle, now, time)

    def messages(self, connection: int) -> Iterator[bytes]:
        """Messages for a client, oldest first."""
        while True:
            piece = borrowed("server_message", self._handle, connection, dtype=np.uint8)
            if piece.size == 0:
                return
            yield piece.tobytes()

    def events(self) -> Iterator[dict]:
        """What happened since the last call: type, connection, client, reason."""
        event = sized(c.gicodec_event)
        while library.status_of("server_event", self._handle, byref(event)) == c.OK:
            found = _fields(event)
            found["type"] = _EVENTS[event.type]
            found["reason"] = library.reason_text(event.reason).decode()
            yield found
