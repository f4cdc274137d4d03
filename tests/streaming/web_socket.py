"""A WebSocket of the protocol, byte by byte, for peers that do what no client does."""
import os
import socket
import ssl
import struct

BINARY, TEXT, CONTINUATION, CLOSE, PING = 2, 1, 0, 8, 9
HELLO, SUBSCRIBE, GOODBYE, WELCOME, UPDATE = 1, 5, 6, 7, 8
REASONS = ["left", "version", "token", "full", "malformed", "too large", "flood", "out of order",
           "unknown volume", "silent", "stalled", "shutdown", "replaced", "dismissed",
           "exhausted", "unicast full"]
UPGRADE = ("GET {path} HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
           "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
           "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: gicodec\r\n{more}\r\n")


def connect(url, source="127.0.0.1"):
    """"wss://127.0.0.1:PORT" or "ws://127.0.0.1:PORT"; the certificate is not looked at."""
    kind, rest = url.split("://")
    host, port = rest.rsplit(":", 1)
    link = socket.create_connection((host, int(port)), timeout=60, source_address=(source, 0))
    if kind == "ws":
        return link
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context.wrap_socket(link)


class Peer:
    def __init__(self, url, path="/", more=""):
        self.link = connect(url)
        self.buffer = b""
        self.link.sendall(UPGRADE.format(path=path, more=more).encode())
        while b"\r\n\r\n" not in self.buffer:
            self.buffer += self.more()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if not head.startswith(b"HTTP/1.1 101"):
            raise ConnectionError(head.split(b"\r\n")[0].decode())

    def more(self):
        data = self.link.recv(65536)
        if not data:
            raise ConnectionError("closed")
        return data

    def take(self, size):
        while len(self.buffer) < size:
            self.buffer += self.more()
        out, self.buffer = self.buffer[:size], self.buffer[size:]
        return out

    def message(self):
        """The next message of the server's; control frames are passed over."""
        whole = b""
        while True:
            first, second = self.take(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack(">H", self.take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.take(8))[0]
            data = self.take(size)
            if first & 0x0F == CLOSE:
                raise ConnectionError("closed")
            if first & 0x08:
                continue
            whole += data
            if first & 0x80:
                return whole

    def goodbye(self):
        """Why the server ends the connection; None if it just does."""
        try:
            while True:
                message = self.message()
                if message[0] == GOODBYE:
                    return REASONS[message[1]]
        except OSError:
            return None

    def send(self, data):
        self.link.sendall(data)

    def say(self, message):
        self.send(frame(BINARY, message))


def frame(opcode, data, final=True, size=None):
    """`size`: what the frame claims to hold, if not what it does."""
    size = len(data) if size is None else size
    head = bytes([(0x80 if final else 0) | opcode])
    if size < 126:
        head += bytes([0x80 | size])
    elif size < 65536:
        head += bytes([0x80 | 126]) + struct.pack(">H", size)
    else:
        head += bytes([0x80 | 127]) + struct.pack(">Q", size)
    mask = os.urandom(4)
    pad = mask * (len(data) // 4 + 1)
    masked = (int.from_bytes(data, "little") ^
              int.from_bytes(pad[:len(data)], "little")).to_bytes(len(data), "little")
    return head + mask + masked


def hello(token=b""):
    return struct.pack("<BIBB16xBBBB", HELLO, 0x73636967, 1, 1, 0, 0, 0, len(token)) + token + b"\0\0"
