"""An open container: its bytes, its description, and players of its textures."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import pathlib
import threading

import numpy as np

from . import _interface as c
from ._library import (Error, Handle, Host, Pointer, ResourceError, address, byref, decoded,
                       error_of, library, limits_of, sized, text_of)
from .description import TextureDesc
from .source import FileSource

_MOST_PLAYERS = 16  # of a container
_MOST_BYTES = 4 << 30  # that they hold together, if limits say nothing


class Player(Handle):
    """Decodes one texture of a container, in one layout."""

    _destroy = "player_destroy"
    _called = "file"

    def __init__(self, contents: Contents, texture: int | None, tiling: str | None = None) -> None:
        host = Host(contents.threads)
        limits = limits_of({**contents.limits, "max_total_bytes": contents.room()})
        options = sized(c.gicodec_player_options, host=address(host.struct), limits=address(limits))
        self._source = FileSource(contents.stream, contents.reading) if contents.stream else None
        self._bytes = contents.bytes
        with self._errors():
            if self._source is None:
                super().__init__("player_open_memory", self._bytes.ctypes.data, self._bytes.nbytes,
                                 byref(options))
            else:
                super().__init__("player_open", byref(self._source.struct), byref(options))
        self.place = -1  # of the frame that was decoded; -1: the first one is next
        if texture is None:
            return
        wanted = (ctypes.c_uint32 * 1)(texture)
        library.player_select(self._handle, byref(wanted), 1)
        if tiling is not None:
            desc = contents.desc(texture).with_tiling(tiling)
            library.player_set_layout(self._handle, texture, byref(desc.struct))

    @property
    def memory(self) -> int:
        return library.player_memory(self._handle)

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

    def close(self) -> None:
        super().close()
        self._bytes = None

    def _errors(self):
        return contextlib.nullcontext() if self._source is None else self._source.errors()


class Contents:
    """What the objects of an open file share. Threads may use it at once."""

    def __init__(self, source, threads: int, limits: dict | None) -> None:
        self.threads, self.limits = threads, limits or {}
        limits_of(limits)  # ValueError, TypeError
        self.path, self.stream, self.bytes = None, None, None
        self.reading = threading.Lock()  # the stream
        self._first: Player | None = None
        self._players: dict[tuple, Player] = {}  # those that were used last come last
        self._turns: dict[int, threading.Lock] = {}
        self._opening = threading.Lock()
        self._take(source)
        try:
            self._first = self._opened(None)
            self.container = Pointer.part(library.player_container(self._first._handle), self._first._handle)
            self.json = json.loads(text_of("container_json", self.container))
            self.frames = self._first.frames()
        except BaseException:
            if self.stream is not None:
                self.stream.close()
            raise

    def _take(self, source) -> None:
        if isinstance(source, (str, os.PathLike)):
            self.path = os.fspath(source)
            self.stream = pathlib.Path(source).open("rb", buffering=0)
            if self.stream.seekable():
                return
            with self.stream as pipe:
                source, self.stream = pipe.readall(), None
        elif hasattr(source, "read"):
            source = source.read()
        self.bytes = np.frombuffer(source, np.uint8)

    def _opened(self, texture: int | None, tiling: str | None = None) -> Player:
        try:
            return Player(self, texture, tiling)
        except Error as error:
            if error.status == c.UNSUPPORTED_VERSION:
                error.args = (_unknown_version(self._head()),)
            if error.status == c.NOT_GICODEC:
                error.args = (f"{self.path or 'the input'} is no .gic file; KTX2, DDS, EXR and raw files "
                              "become one by the tool: gicodec encode -o x.gic FILE...",)
            raise self._with_cure(error)

    def _with_cure(self, error: Error) -> Error:
        if error.status == c.LIMIT_EXCEEDED and "limits=" not in str(error):
            most = self.limits.get("max_total_bytes") or _MOST_BYTES
            error.args = (f"{error}: limits={{'max_total_bytes': {4 * most}}} would allow more; "
                          "max_texture_bytes and max_work_bytes may be too small, too",)
        return error

    def _head(self) -> bytes:
        if self.stream is None:
            return self.bytes[:16].tobytes()
        self.stream.seek(0)
        return self.stream.read(16)

    def desc(self, texture: int) -> TextureDesc:
        struct = sized(c.gicodec_texture_desc)
        library.container_texture(self.container, texture, byref(struct), None)
        return TextureDesc(struct)

    def metadata(self, of: int, index: int) -> dict[str, str]:
        count = library.container_metadata_count(self.container, of, index)
        return {decoded(library.container_metadata_name(self.container, of, index, pair)):
                decoded(library.container_metadata_value(self.container, of, index, pair, None))
                for pair in range(count)}

    @property
    def is_complete(self) -> bool:
        return library.player_finished(self._first._handle) != 0

    @property
    def is_closed(self) -> bool:
        return self._first.is_closed

    def room(self) -> int:
        """Bytes that another player may take."""
        held = [self._first, *self._players.values()] if self._first else []
        most = self.limits.get("max_total_bytes") or _MOST_BYTES
        return max(most - sum(player.memory for player in held), 1)

    @contextlib.contextmanager
    def at(self, texture: int, index: int, tiling: str | None = None):
        """A texture's player at a frame by its place; it is the caller's until the block ends."""
        place = range(len(self.frames))[index]  # negative ones, and IndexError
        with self._turns.setdefault(texture, threading.Lock()):
            try:
                player = self._reached(texture, tiling, place)
            except ResourceError as error:  # of what the players of other textures hold?
                with self._opening:
                    if error.status != c.LIMIT_EXCEEDED or not self._close_idle(texture, 0):
                        raise
                player = self._reached(texture, tiling, place)
            yield player

    def _reached(self, texture: int, tiling: str | None, place: int) -> Player:
        player = self._player(texture, tiling)
        try:
            player.go_to(place, self.frames)
        except ResourceError as error:
            raise self._with_cure(error)
        return player

    def _player(self, texture: int, tiling: str | None) -> Player:
        with self._opening:
            self._first._handle.check()
            player = self._players.pop((texture, tiling), None)
            if player is None:
                self._close_idle(texture, _MOST_PLAYERS - 1)
                player = self._opened(texture, tiling)
            self._players[texture, tiling] = player
            return player

    def _close_idle(self, texture: int, keep: int) -> bool:
        """Closes players until so many are left, those first that were used longest ago; none that
        another thread uses. True if it closed one."""
        count = len(self._players)
        for key in list(self._players):
            if len(self._players) <= keep:
                break
            turn = self._turns[key[0]]
            if key[0] == texture or turn.acquire(blocking=False):
                self._players.pop(key).close()
                if key[0] != texture:
                    turn.release()
        return len(self._players) < count

    def close(self) -> None:
        with self._opening:
            for player in (*self._players.values(), self._first):
                player.close()
            self._players.clear()
            self.bytes = None
        if self.stream is not None:
            with self.reading:
                self.stream.close()


def _unknown_version(head: bytes) -> str:
    major, minor, readable = ctypes.c_uint32(), ctypes.c_uint32(), ctypes.c_uint32()
    library.container_version(head, len(head), byref(major), byref(minor), byref(readable))
    return (f"the container has version {major.value}.{minor.value}, and gicodec "
            f"{decoded(library.version_text())} reads version {readable.value}: take a newer gicodec")
