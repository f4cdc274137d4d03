"""A file that appears under its name once it is complete."""

from __future__ import annotations

import contextlib
import ctypes
import os
import pathlib
import secrets
import stat

from . import _interface as c
from ._library import byref, library


def _is_container(path: pathlib.Path) -> bool:
    with path.open("rb") as stream:
        head = stream.read(16)
    numbers = [byref(ctypes.c_uint32()) for _ in range(3)]
    return library.status_of("container_version", head, len(head), *numbers) == c.OK


class OutputFile:
    """Written under a name of its own, ….partial, and given its name at the end. It replaces nothing but
    a container, and that only if it may."""

    def __init__(self, path, overwrite: bool) -> None:
        self._path = pathlib.Path(os.path.realpath(path))  # what a link refers to
        self._overwrite = overwrite
        self._stream = None
        self._size = 0
        self._is_whole = False
        self.check()

    def check(self) -> None:
        path = self._path
        if path.is_dir():
            raise IsADirectoryError(f"{path} is a folder: give the name of a file")
        if not path.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {path.parent} for {path.name}")
        if not path.exists():
            return
        if not path.is_file():
            raise FileExistsError(f"{path} is no file but a device or pipe: write what getvalue() of a "
                                  "Writer without a path returns")
        if not self._overwrite:
            raise FileExistsError(f"{path} exists: pass overwrite=True to replace it")
        if path.stat().st_size and not _is_container(path):
            raise FileExistsError(f"{path} exists and is no container: remove it, or give another name")

    def begin(self) -> None:
        self._work = self._path.with_name(f"{self._path.name}.{secrets.token_hex(4)}.partial")
        self._stream = self._work.open("xb", buffering=0)
        if self._path.exists():
            self._work.chmod(stat.S_IMODE(self._path.stat().st_mode))

    def write(self, piece: bytes) -> None:
        """All or nothing."""
        rest = memoryview(piece)
        try:
            while rest:
                rest = rest[self._stream.write(rest):]
        except BaseException:
            self._stream.truncate(self._size)
            self._stream.seek(self._size)
            raise
        self._size += len(piece)

    def publish(self) -> None:
        """Gives it its name. After an error the file is whole, under the name that the error says."""
        os.fsync(self._stream.fileno())
        try:
            self.check()  # somebody may have taken the name
            if self._overwrite:
                os.replace(self._work, self._path)
            else:
                self._give_new_name()
        except OSError as error:
            self._is_whole = True
            raise type(error)(f"{error}: the finished container is {self._work}") from error
        self._stream.close()

    def _give_new_name(self) -> None:
        try:
            os.link(self._work, self._path)  # unlike rename(), fails if somebody took the name
        except FileExistsError:
            raise
        except OSError:  # a file system without links, as FAT
            os.rename(self._work, self._path)
        else:
            self._work.unlink()

    def abandon(self) -> None:
        """Removes a file that has not got its name."""
        if self._stream is not None and not self._stream.closed:
            with contextlib.suppress(OSError):
                self._stream.close()
            if not self._is_whole:
                self._work.unlink(missing_ok=True)
