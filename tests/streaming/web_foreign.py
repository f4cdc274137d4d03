#!/usr/bin/env python3
"""web_foreign.py CERTIFICATE KEY PORT-FILE: a server of HTTP over TLS that is no gi-server."""
import http.server
import ssl
import sys

server = http.server.HTTPServer(("127.0.0.1", 0), http.server.BaseHTTPRequestHandler)
context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
context.load_cert_chain(sys.argv[1], sys.argv[2])
server.socket = context.wrap_socket(server.socket, server_side=True)
with open(sys.argv[3], "w") as file:
    file.write(f"{server.server_port}\n")
server.serve_forever()
