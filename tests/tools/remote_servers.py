"""Servers of files for the tests of gicodec over HTTP: nginx, and one with a fault for each path."""
import http.server
import os
import re
import shutil
import socket
import subprocess
import threading
import time


class Nginx:
    """nginx over a folder; log() has what it answered since the last call: status, range, bytes."""

    def __init__(self, folder, work):
        self.work = os.path.join(work, "nginx")
        os.makedirs(self.work)
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.log_path = os.path.join(self.work, "access.log")
        temporary = "\n".join(f"{kind}_temp_path {self.work}/{kind};" for kind in
                              ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(os.path.join(self.work, "nginx.conf"), "w") as conf:
            conf.write(f"""
                daemon off; master_process off; pid {self.work}/pid; error_log {self.work}/error.log;
                events {{}}
                http {{
                  {temporary}
                  log_format parts '$status $http_range $body_bytes_sent';
                  access_log {self.log_path} parts;
                  server {{ listen 127.0.0.1:{self.port}; root {folder}; }}
                }}""")
        self.process = subprocess.Popen([shutil.which("nginx") or "/usr/sbin/nginx", "-c",
                                         os.path.join(self.work, "nginx.conf"), "-p", self.work],
                                        stderr=subprocess.DEVNULL)
        for _ in range(200):
            try:
                socket.create_connection(("127.0.0.1", self.port)).close()
                break
            except OSError:
                time.sleep(0.05)
        self.seen = 0
        self.origin = f"http://127.0.0.1:{self.port}"

    def log(self):
        for _ in range(50):  # it writes when a request has ended
            with open(self.log_path) as file:
                lines = file.read().splitlines()
            if len(lines) > self.seen:
                break
            time.sleep(0.02)
        time.sleep(0.1)
        with open(self.log_path) as file:
            lines = file.read().splitlines()
        new, self.seen = lines[self.seen:], len(lines)
        fields = [re.fullmatch(r"(\d+) (?:bytes=)?(\S+) (\d+)", line).groups() for line in new]
        return [(int(status), part, int(size)) for status, part, size in fields]

    def close(self):
        self.process.terminate()
        self.process.wait()


class Faulty(http.server.ThreadingHTTPServer):
    """Sends `body` under /FAULT/x.gic with that fault; `requests` has path and headers of each."""

    daemon_threads = True

    def __init__(self, body):
        super().__init__(("127.0.0.1", 0), Handler)
        self.body, self.requests, self.counts = body, [], {}
        self.origin = f"http://127.0.0.1:{self.server_address[1]}"
        self.elsewhere = self.origin
        threading.Thread(target=self.serve_forever, daemon=True).start()


    def handle_error(self, *_):
        pass  # a client that leaves


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        server, body = self.server, self.server.body
        server.requests.append((self.path, dict(self.headers)))
        fault = self.path.split("/")[1]
        count = server.counts[fault] = server.counts.get(fault, 0) + 1
        mark = '"one"'
        if fault == "grows":  # with each request
            body = body[:len(body) // 2 + 70_001 * count]
            mark = f'"{len(body)}"'
            if self.headers.get("If-Range", mark) != mark:
                return self.answer(200, body, {"ETag": mark})
        asked = re.fullmatch(r"bytes=(\d*)-(\d*)", self.headers.get("Range", ""))
        first, last = 0, len(body) - 1
        if asked and asked[1]:
            first, last = int(asked[1]), min(int(asked[2]), last)
        elif asked:
            first = max(0, len(body) - int(asked[2]))
        part = body[first:last + 1]
        total, extra = len(body), {}
        if fault.isdigit():
            return self.answer(int(fault), b"no", {})
        if fault == "restless":  # grows with each request, and never has the file that was asked for
            if asked and not asked[1]:
                return self.answer(416, b"", {})
            if "If-Range" in self.headers:
                return self.answer(200, body, {})
            total, mark = total + count, f'"{count}"'
        if fault == "away" and 2 < count < 7:
            return self.answer(503, b"later", {})
        if fault == "redirect":
            return self.answer(302, b"", {"Location": f"{server.elsewhere}/sound/x.gic?{'k' * 9}"})
        if fault == "ring":
            return self.answer(302, b"", {"Location": self.path})
        if fault == "whole":
            return self.answer(200, body, {})
        if fault == "packed":
            extra["Content-Encoding"] = "gzip"
        if fault == "endless":
            self.send_response(200)
            self.end_headers()
            try:
                while True:
                    self.wfile.write(bytes(1 << 16))
            except OSError:
                self.close_connection = True
                return None
        if fault == "total" and count > 2:
            total += 1
        if fault == "mark" and count > 2:
            mark = '"two"'
        if fault == "changed" and count > 2:
            return self.answer(200, body, {"ETag": '"two"'})
        if fault == "place":
            first += 1
        if fault == "longer" and count > 2:
            part += bytes(1 << 20)
        if fault == "shorter" and count > 2:
            part = part[:-1]
        if fault == "other" and count > 2:
            part = bytes(len(part))
        extra |= {"Content-Range": f"bytes {first}-{last}/{total}", "ETag": mark}
        cut = fault == "cut" and count > 2 or fault == "once" and count == 3
        return self.answer(206, part, extra, cut)

    def answer(self, status, body, headers, cut=False):
        try:
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body[:len(body) // 2] if cut else body)
        except OSError:
            cut = True
        self.close_connection |= cut
