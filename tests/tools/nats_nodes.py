"""Servers of NATS with the configuration of packaging/nats, a client of a few lines, and a link that delays."""
import json
import os
import socket
import ssl
import subprocess
import threading
import time

PACKAGING = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../packaging/nats")
PASSWORDS = {"publisher": "secret-of-the-publisher", "viewer": "secret-of-viewers"}


def free_ports(count):
    """Below those that the system gives to connections."""
    ports, candidate = [], 21000 + os.getpid() % 5000
    while len(ports) < count:
        candidate += 1
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", candidate))
                ports.append(candidate)
            except OSError:
                pass
    return ports


class Node:
    """One of a cluster; `kill` and `start` it again."""

    def __init__(self, work, name, client, route, web, others, config="node.conf"):
        self.name, self.port, self.process = name, client, None
        self.config = config if os.path.isabs(config) else os.path.join(PACKAGING, config)
        self.log = os.path.join(work, f"{name}.log")
        self.environment = {
            **os.environ, "GI_NODE": name, "GI_LISTEN": f"127.0.0.1:{client}",
            "GI_WEB": f"127.0.0.1:{web}", "GI_CLUSTER": f"127.0.0.1:{route}",
            "GI_ROUTE_1": f"nats://127.0.0.1:{others[0]}", "GI_ROUTE_2": f"nats://127.0.0.1:{others[1]}",
            "GI_STORE": os.path.join(work, name), "GI_CERTIFICATE": os.path.join(work, "certs/server.pem"),
            "GI_KEY": os.path.join(work, "certs/server.key"),
            "GI_PUBLISHER_PASSWORD": PASSWORDS["publisher"], "GI_VIEWER_PASSWORD": PASSWORDS["viewer"]}

    @property
    def url(self):
        return f"tls://127.0.0.1:{self.port}"

    def start(self):
        with open(self.log, "a") as log:
            self.process = subprocess.Popen(["nats-server", "-c", self.config], env=self.environment,
                                            stdout=log, stderr=log)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def stop(self):
        if self.process and self.process.poll() is None:
            self.process.terminate()
            self.process.wait()


def make_cluster(work):
    """Three nodes that have started."""
    subprocess.run([os.path.join(PACKAGING, "certificates"), os.path.join(work, "certs"), "localhost",
                    "127.0.0.1"], check=True, capture_output=True)
    ports = free_ports(9)
    nodes = []
    for i in range(3):
        others = [ports[3 * j + 1] for j in range(3) if j != i]
        nodes.append(Node(work, f"node{i}", ports[3 * i], ports[3 * i + 1], ports[3 * i + 2], others))
        nodes[-1].start()
    return nodes


class Alone(Node):
    """A server without TLS and users, and with so many bytes of JetStream."""

    def __init__(self, work, memory):
        self.name, self.process = "alone", None
        self.port = free_ports(1)[0]
        self.config = os.path.join(work, "alone.conf")
        self.log = os.path.join(work, "alone.log")
        self.environment = dict(os.environ)
        with open(self.config, "w") as file:
            file.write(f'listen: "127.0.0.1:{self.port}"\n'
                       f'jetstream {{ store_dir: "{work}/alone", max_memory_store: {memory}, max_file_store: 1MB }}\n')

    @property
    def url(self):
        return f"nats://127.0.0.1:{self.port}"


class Nats:
    """As little of a client as tests need. Without a user it goes to a server that is alone."""

    def __init__(self, node, work=None, user=None, password=None):
        raw = socket.create_connection(("127.0.0.1", node.port), 5)
        self.info = raw.recv(65536)
        self.socket, self.bytes = raw, b""
        options = {"verbose": False, "headers": True, "no_responders": True, "lang": "test", "version": "1"}
        if user is not None:
            context = ssl.create_default_context(cafile=os.path.join(work, "certs/ca.pem"))
            self.socket = context.wrap_socket(raw, server_hostname="localhost")
            options |= {"user": user, "pass": PASSWORDS[user] if password is None else password}
        self.send(f"CONNECT {json.dumps(options)}\r\nPING\r\n".encode())

    def send(self, data):
        self.socket.sendall(data)

    def publish(self, subject, data, reply=""):
        self.send(f"PUB {subject} {reply} {len(data)}\r\n".encode() + data + b"\r\n")

    def subscribe(self, subject, number):
        self.send(f"SUB {subject} {number}\r\n".encode())

    def request(self, subject, data=b"", seconds=5):
        """The answer's bytes; None: there is none."""
        inbox = f"_INBOX.test.{time.monotonic_ns()}"
        self.subscribe(inbox, 99)
        self.publish(subject, data, inbox)
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            answer = self.next(seconds)
            if answer and answer[0] == "MSG" and answer[1] == inbox:
                self.send(b"UNSUB 99\r\n")
                return answer[2]
        return None

    def _line(self):
        while b"\r\n" not in self.bytes:
            more = self.socket.recv(1 << 16)
            if not more:
                raise EOFError
            self.bytes += more
        line, self.bytes = self.bytes.split(b"\r\n", 1)
        return line

    def next(self, seconds=5):
        """("MSG", subject, data) or ("-ERR", text, b"") and the like; None after so long."""
        self.socket.settimeout(seconds)
        try:
            while True:
                line = self._line()
                if line == b"PING":
                    self.send(b"PONG\r\n")
                    continue
                words = line.decode("latin-1").split(" ")
                if words[0] not in ("MSG", "HMSG"):
                    return words[0], " ".join(words[1:]), b""
                size = int(words[-1])
                head = int(words[-2]) if words[0] == "HMSG" else 0
                while len(self.bytes) < size + 2:
                    self.bytes += self.socket.recv(1 << 16)
                data, self.bytes = self.bytes[head:size], self.bytes[size + 2:]
                return "MSG", words[1], data
        except (TimeoutError, socket.timeout, ssl.SSLError, EOFError, OSError):
            return None

    def close(self):
        self.socket.close()


class Delay:
    """A port behind which a server is so many seconds away, there and back."""

    def __init__(self, port, round_trip):
        self.target, self.delay = port, round_trip / 2
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                near, _ = self.listener.accept()
                # What the server says first comes after the way there, too.
                time.sleep(2 * self.delay)
                far = socket.create_connection(("127.0.0.1", self.target))
            except OSError:
                return
            for a, b in ((near, far), (far, near)):
                a.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                threading.Thread(target=self._carry, args=(a, b), daemon=True).start()

    def _carry(self, source, target):
        waiting, arrived = [], threading.Condition()

        def pass_on():
            while True:
                with arrived:
                    while not waiting:
                        arrived.wait()
                    at, data = waiting.pop(0)
                time.sleep(max(0, at - time.monotonic()))
                try:
                    if not data:
                        return target.shutdown(socket.SHUT_WR)
                    target.sendall(data)
                except OSError:
                    return

        threading.Thread(target=pass_on, daemon=True).start()
        data = b"-"
        while data:
            try:
                data = source.recv(1 << 16)
            except OSError:
                data = b""
            with arrived:
                waiting.append((time.monotonic() + self.delay, data))
                arrived.notify()
