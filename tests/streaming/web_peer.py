#!/usr/bin/env python3
"""web_peer.py KIND URL [ARGUMENT...]: connects to a gi-server and does what no client does.

Exit code 0 if the server does what that deserves, 1 if not. Kinds that hold connections open say
"there" when they do, and stay until killed."""
import ssl
import sys
import time

from web_socket import (BINARY, CONTINUATION, PING, TEXT, UPDATE, UPGRADE, WELCOME, Peer, connect,
                        frame, hello)

LIMIT = 1 << 20  # bytes of a message, as the server has it by default


def dropped(peer, expected):
    got = peer.goodbye()
    print(f"{kind}: {got}", flush=True)
    return got in expected


def until_closed(peer, send):
    """Goes on until the server has had enough: the connection breaks then."""
    try:
        while True:
            send()
    except OSError:
        pass


def text(peer):
    peer.say(hello())
    peer.send(frame(TEXT, b"hello"))
    return dropped(peer, ["malformed"])


def claims(peer):
    """A frame that claims more than any message may have; nothing of it is sent."""
    peer.say(hello())
    peer.send(frame(BINARY, b"x", size=1 << 40))
    return dropped(peer, ["too large"])


def oversized(peer):
    """A message that grows beyond the limit by fragments."""
    peer.say(hello())
    peer.send(frame(BINARY, b"x" * 65536, final=False))
    for _ in range(LIMIT // 65536 + 1):
        peer.send(frame(CONTINUATION, b"x" * 65536, final=False))
    return dropped(peer, ["too large"])


def crumbs(peer):
    peer.say(hello())
    peer.send(frame(BINARY, b"x", final=False))
    many = frame(CONTINUATION, b"x", final=False) * 10000
    until_closed(peer, lambda: peer.send(many))
    return dropped(peer, ["flood", "too large", None])


def empties(peer):
    peer.say(hello())
    peer.send(frame(BINARY, b"", final=False))
    many = frame(CONTINUATION, b"", final=False) * 10000
    until_closed(peer, lambda: peer.send(many))
    return dropped(peer, ["flood", None])


def pings(peer):
    peer.say(hello())
    many = frame(PING, b"x" * 100) * 1000
    until_closed(peer, lambda: peer.send(many))
    return dropped(peer, ["flood", None])


def opcode(peer):
    peer.say(hello())
    peer.send(frame(5, b"x"))
    return dropped(peer, [None])


def empty(peer):
    peer.say(b"")
    return dropped(peer, ["malformed"])


def unread(peer):
    """Takes nothing of what it asks for."""
    peer.say(hello())
    time.sleep(float(sys.argv[3]))
    return True


def elsewhere(_):
    """Paths that are not the protocol's."""
    for path in ("/x", "/health"):
        try:
            Peer(url, path)
            return False
        except ConnectionError:
            pass
    return True


def held(make):
    """As many connections as are asked for, each as far as `make` brings it, from an address of
    their own; those that the server ends are made again."""
    count, source = int(sys.argv[3]), sys.argv[4]
    links, told = [], False
    while True:
        while len(links) < count:
            try:
                links.append(make(source))
            except OSError:
                break
        if not told:
            print("there", flush=True)
        told = True
        time.sleep(0.2)
        for link in list(links):
            try:
                link.sendall(b"x")  # One byte now and then, as if more were to come.
            except OSError:
                links.remove(link)


def silent(source):
    return connect(url.replace("wss:", "ws:"), source)


def half_tls(source):
    link = silent(source)
    link.sendall(bytes.fromhex("160301020001"))
    return link


def half_http(source):
    link = connect(url, source)
    link.sendall(UPGRADE.format(path="/", more="").encode()[:60])
    return link


def crowd(_):
    """Handshakes that go no further, each from an address of its own: the oldest ones make room."""
    count, room = int(sys.argv[3]), 64
    links = [half_http(f"127.0.{1 + i // 100}.{250 - i % 100}") for i in range(count)]
    for link in links[:-room]:
        link.settimeout(30)
        try:
            if link.recv(1):
                return False
        except ConnectionResetError:
            pass
    for link in links[-room:]:
        link.setblocking(False)
        try:
            link.recv(1)
            return False  # Closed, or an answer to half a question.
        except (BlockingIOError, ssl.SSLWantReadError):
            pass
    return True


def secrets(peer):
    """Says a token, and prints what nobody else is to read: it, the ticket, and texels."""
    token = sys.argv[3].encode()
    peer.say(hello(token))
    ticket = texels = None
    while texels is None:
        message = peer.message()
        if message[0] == WELCOME:
            ticket = message[7:23]
        elif message[0] == UPDATE and len(message) > 4096:
            texels = message[len(message) // 2:][:48]
    for secret in (token, ticket, texels):
        print(secret.hex())
    return True


def forwarded(_):
    """Connections through a proxy of a server that takes two of an address."""
    def comes(address):
        try:
            return Peer(url, more=f"X-Forwarded-For: {address}\r\n")
        except OSError:
            return None
    kept = [comes("203.0.113.7"), comes("198.51.100.1, 203.0.113.7")]
    kept += [comes("203.0.113.8"), comes("2001:db8::1"), comes("no address")]
    refused = [comes("203.0.113.7"), comes("203.0.113.8,203.0.113.7")]
    kept.pop(0).link.close()  # makes room
    for _ in range(100):
        again = comes("203.0.113.7")
        if again is not None:
            break
        time.sleep(0.1)
    return all(kept) and not any(refused) and again is not None


KINDS = {one.__name__: one for one in (text, claims, oversized, crumbs, empties, pings, opcode, empty,
                                       unread, secrets)}
HELD = {one.__name__: one for one in (silent, half_tls, half_http)}

kind, url = sys.argv[1], sys.argv[2]
if kind in ("elsewhere", "crowd", "forwarded"):
    good = {"elsewhere": elsewhere, "crowd": crowd, "forwarded": forwarded}[kind](None)
elif kind in HELD:
    held(HELD[kind])
else:
    good = KINDS[kind](Peer(url))
sys.exit(0 if good else 1)
