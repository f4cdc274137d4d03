"""The bytes of a file for the library, read when it asks for them."""

from __future__ import annotations

import contextlib
import ctypes
import os
import threading
import weakref

from . import _interface as c
from ._library import Error, sized

_READ = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,
                         ctypes.POINTER(ctypes.c_size_t))
_SEEK = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint64)
_SIZE = ctypes.CFUNCTYPE(ctypes.c_uint64, ctypes.c_void_p)


class FileSource:
    """A gicodec_source over a file that can seek. Several may share one file.

    Not mapped into memory: a file that shrinks while it is read would end the process.
    """

    def __init__(self, stream, turn: threading.Lock) -> None:
        self._stream, self._turn, self._position = stream, turn, 0
        self._failure: BaseException | None = None
        me = weakref.ref(self)  # so that an open file is not kept alive
        self._calls = (_READ(lambda _, into, wanted, got: me()._read(into, wanted, got)),
                       _SEEK(lambda _, offset: me()._seek(offset)), _SIZE(lambda _: me()._size()))
        read, seek, size = (ctypes.cast(call, ctypes.c_void_p) for call in self._calls)
        self.struct = sized(c.gicodec_source, read=read, seek=seek, size=size)

    @contextlib.contextmanager
    def errors(self):
        """Raises what went wrong in the file in place of the library's Error."""
        try:
            yield
        except Error as error:
            failure, self._failure = self._failure, None
            if failure is not None:
                raise failure from error
            raise

    def _read(self, into: int, wanted: int, got) -> int:
        try:
            memory = memoryview((ctypes.c_char * wanted).from_address(into)).cast("B")
            done = 0
            with self._turn:
                self._stream.seek(self._position)
                while done < wanted:
                    count = self._stream.readinto(memory[done:])
                    if not count:
                        break
                    done += count
            self._position += done
            got[0] = done
            return c.OK
        except BaseException as failure:  # nothing may pass through the library
            self._failure = failure
            return c.IO_FAILED

    def _seek(self, offset: int) -> int:
        self._position = offset
        return c.OK

    def _size(self) -> int:
        try:
            return os.fstat(self._stream.fileno()).st_size
        except BaseException as failure:
            self._failure = failure
            return 0
