"""The shared library beside this file, its calls, and their errors."""

from __future__ import annotations

import ctypes
import functools
import pathlib
import threading

from . import _interface as c

_NAMES = ("libgicodec.so", "libgicodec.dylib", "gicodec.dll")


class Error(Exception):
    """A call of the library failed.

    ``status`` is the number of <gicodec/status.h>, ``name`` its name, e.g. "checksum_mismatch".
    """

    def __init__(self, status: int, doing: str = "", why: str = ""):
        text = library.status_text(status).decode() + (f": {why}" if why else "")
        super().__init__(f"{doing}: {text}" if doing else text)
        self.status = status
        self.name = c.STATUS_NAMES.get(status, "unknown")

    def __reduce__(self):
        return _error_again, (type(self), self.status, self.args)


def _error_again(kind: type, status: int, arguments: tuple) -> Error:
    error = kind(status)
    error.args = arguments
    return error


class ArgumentError(Error, ValueError):
    """An argument was wrong (1xx)."""


class ResourceError(Error, MemoryError):
    """Memory or a limit is exhausted, or the call was cancelled (2xx)."""


class FormatError(Error, ValueError):
    """The bytes are damaged, cut off, or not of this format (3xx)."""


class MismatchError(Error, ValueError):
    """The bytes are sound but belong elsewhere (4xx)."""


class BackendError(Error, RuntimeError):
    """A codec, a source or a sink failed (5xx)."""


_CLASSES = {1: ArgumentError, 2: ResourceError, 3: FormatError, 4: MismatchError, 5: BackendError}


def error_of(status: int, doing: str = "", why: str = "") -> Error:
    """The exception for a status."""
    return _CLASSES.get(status // 100, Error)(status, doing, why)


def _load() -> ctypes.CDLL:
    folder = pathlib.Path(__file__).resolve().parent
    for name in _NAMES:
        if (folder / name).exists():
            return ctypes.CDLL(str(folder / name))
    raise ImportError(f"there is no {_NAMES[0]} in {folder}: install the package by pip, which "
                      "builds or brings it")


class Pointer(int):
    """The address of what a handle owns; threads take turns with it."""

    def __new__(cls, address: int, of: str):
        pointer = super().__new__(cls, address)
        pointer.turn, pointer.of, pointer.is_closed, pointer.owner = threading.RLock(), of, False, None
        return pointer

    @classmethod
    def part(cls, address: int, owner: Pointer) -> Pointer:
        """Of what lives as long as its owner: calls take the owner's turn."""
        pointer = cls(address, owner.of)
        pointer.turn, pointer.owner = owner.turn, owner
        return pointer

    def check(self) -> Pointer:
        if (self if self.owner is None else self.owner).is_closed:
            raise ArgumentError(c.INVALID_ARGUMENT, f"the {self.of} is closed")
        return self


class _Library:
    """Calls by their names without "gicodec_". A call whose status is not OK raises an Error.

    ctypes lets other threads run during a call; those that want the same handle wait.
    """

    def __init__(self) -> None:
        self._dll = _load()

    @functools.lru_cache(maxsize=None)
    def _function(self, name: str):
        function = getattr(self._dll, "gicodec_" + name)
        function.restype, function.argtypes = c.CALLS["gicodec_" + name]

        def in_turn(*arguments):
            if not arguments or not isinstance(arguments[0], Pointer):
                return function(*arguments)
            with arguments[0].turn:
                arguments[0].check()
                return function(*arguments)

        return in_turn

    def __getattr__(self, name: str):
        function = self._function(name)

        def checked(*arguments):
            status = function(*arguments)
            if status != c.OK:
                raise error_of(status)

        call = checked if "gicodec_" + name in c.FALLIBLE else function
        setattr(self, name, call)
        return call

    def with_problem(self, name: str, desc) -> None:
        """A call on a "texture_desc" or "volume_desc", whose Error names the field that is not valid."""
        status = self.status_of(name, desc)
        if status != c.OK:
            problem = name[:name.rindex("_")] + "_problem"
            raise error_of(status, why=decoded(getattr(self, problem)(desc)) or "")

    def status_of(self, name: str, *arguments) -> int:
        """The status of a call, also where it is no success."""
        return self._function(name)(*arguments)


library = _Library()


# ctypes cuts numbers that do not fit.
_RANGES = {ctypes.c_uint32: (0, 2**32 - 1), ctypes.c_uint64: (0, 2**64 - 1),
           ctypes.c_int32: (-2**31, 2**31 - 1)}


def sized(kind: type, **fields):
    """A struct of its own size; its fields by name."""
    types = dict(kind._fields_)
    for name, value in fields.items():
        if name not in types:
            raise TypeError(f"there is no {name!r}: {', '.join(list(types)[1:])} are")
        least, most = _RANGES.get(types[name], (None, None))
        if most is not None and not least <= value <= most:
            raise ValueError(f"{name} is {least} to {most}, not {value}")
    return kind(struct_size=ctypes.sizeof(kind), **fields)


# For arguments: it keeps alive what it refers to.
byref = ctypes.byref


def address(thing) -> int:
    """For a field of a struct: of a ctypes object that the caller keeps alive."""
    return ctypes.addressof(thing)


class Handle:
    """Owns a handle of the library and destroys it once."""

    _destroy = ""  # name of the call
    _called = ""  # in messages, if not by its class

    def __init__(self, create: str, *arguments) -> None:
        handle = ctypes.c_void_p()
        getattr(library, create)(*arguments, byref(handle))
        self._handle = Pointer(handle.value, self._called or type(self).__name__)

    @property
    def is_closed(self) -> bool:
        return self._handle.is_closed

    def close(self) -> None:
        """Frees what the library holds. Calls on a closed object are ArgumentErrors."""
        with self._handle.turn:
            if not self._handle.is_closed:
                getattr(library, self._destroy)(self._handle)
                self._handle.is_closed = True

    def __del__(self) -> None:
        if hasattr(self, "_handle"):
            self.close()

    def __reduce_ex__(self, protocol):
        raise TypeError(f"a {type(self).__name__} is neither copied nor pickled: make one in each process, "
                        "e.g. open the file there")

    def __enter__(self):
        return self

    def __exit__(self, *_) -> None:
        self.close()


def text_of(call: str, handle) -> str:
    """What a call writes into the caller's memory as text."""
    size = ctypes.c_size_t()
    status = library.status_of(call, handle, None, 0, byref(size))
    if status != c.BUFFER_TOO_SMALL:
        raise error_of(status)
    buffer = ctypes.create_string_buffer(size.value)
    getattr(library, call)(handle, byref(buffer), size.value, byref(size))
    return buffer.value.decode()


class Host:
    """Threads and an instruction set for a handle; must live as long as the create() call."""

    def __init__(self, threads: int = 1, isa: str | None = None) -> None:
        self.struct = sized(c.gicodec_host, threads=threads, isa=coded(isa) if isa else None)


def limits_of(limits: dict | None):
    """A gicodec_limits of keyword pairs; None for None."""
    return None if limits is None else sized(c.gicodec_limits, **limits)


def decoded(name: bytes | None) -> str | None:
    return None if name is None else name.decode()


def coded(text: str) -> bytes:
    """Text for the library, which ends at a zero."""
    data = text.encode()
    if 0 in data:
        raise ValueError(f"{text!r} has a zero in it")
    return data


def shown(name: str) -> str:
    """A name from a file or a server, safe for a terminal."""
    return "".join(one if one.isprintable() else repr(one)[1:-1] for one in name)
