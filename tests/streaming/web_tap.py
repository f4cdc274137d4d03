#!/usr/bin/env python3
"""web_tap.py PORT-FILE TO-PORT CAPTURE [flip|replay|cut AT]: what is on the way of a connection.

Passes TCP connections on to 127.0.0.1:TO-PORT and writes all bytes of both directions to CAPTURE.
In the first connection the server's byte number AT has a bit flipped, or what comes with it is sent
twice, or the connection is cut there. Runs until killed."""
import socket
import sys
import threading

port_file, to_port, capture_path = sys.argv[1], int(sys.argv[2]), sys.argv[3]
harm, at = (sys.argv[4], int(sys.argv[5])) if len(sys.argv) > 4 else (None, 0)
capture = open(capture_path, "wb", buffering=0)
lock = threading.Lock()


def harmed(data, passed):
    """What becomes of the server's bytes; nothing ends the connection."""
    where = at - passed
    if not 0 <= where < len(data):
        return data
    if harm == "cut":
        return b""
    if harm == "replay":
        return data + data
    return data[:where] + bytes([data[where] ^ 0x10]) + data[where + 1:]


def carry(source, sink, harms):
    passed = 0
    try:
        while data := source.recv(65536):
            with lock:
                capture.write(data)
            out = harmed(data, passed) if harms else data
            passed += len(data)
            if not out:
                break
            sink.sendall(out)
    except OSError:
        pass
    for one in (source, sink):
        try:
            one.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


listener = socket.create_server(("127.0.0.1", 0))
with open(port_file, "w") as file:
    file.write(f"{listener.getsockname()[1]}\n")
first = True
while True:
    client, _ = listener.accept()
    server = socket.create_connection(("127.0.0.1", to_port))
    for one in (client, server):
        one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    threading.Thread(target=carry, args=(client, server, False), daemon=True).start()
    threading.Thread(target=carry, args=(server, client, first and harm is not None),
                     daemon=True).start()
    first = False
