#!/usr/bin/env python3
"""web_redirect.py PORT-FILE HOST:PORT [CERTIFICATE KEY]: answers each request with another redirect to there.

Over TLS with a certificate. Prints the requests, and whatever it is sent after its answer."""
import itertools
import socket
import ssl
import sys

port_file, there = sys.argv[1:3]
context = None
if len(sys.argv) > 3:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*sys.argv[3:5])
scheme = "https" if context else "http"
places = [f"{scheme}://{there}/", f"//{there}/", "/elsewhere", f"{scheme}://{there}/\x1b[2J"]
answers = itertools.cycle(itertools.product((301, 302, 303, 307, 308), places))
listener = socket.create_server(("127.0.0.1", 0))
with open(port_file, "w") as file:
    file.write(f"{listener.getsockname()[1]}\n")
for code, place in answers:
    connection = listener.accept()[0]
    try:
        if context:
            connection = context.wrap_socket(connection, server_side=True)
        request = b""
        while b"\r\n\r\n" not in request:
            part = connection.recv(4096)
            if not part:
                break
            request += part
        print(code, place.encode(), request, flush=True)
        connection.sendall(
            f"HTTP/1.1 {code} Elsewhere\r\nLocation: {place}\r\nContent-Length: 0\r\n\r\n".encode())
        while part := connection.recv(4096):
            print("more:", part, flush=True)
    except OSError as error:
        print(error, flush=True)
    connection.close()
