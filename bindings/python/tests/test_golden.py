"""Golden containers have the hashes of tests/golden/hashes.txt, as in C++, C and JavaScript."""

import collections
import pathlib
import struct

import pytest

import gicodec

GOLDEN = pathlib.Path(__file__).resolve().parents[3] / "tests" / "golden"
EXPECTED = collections.defaultdict(list)
for line in (GOLDEN / "hashes.txt").read_text().splitlines():
    EXPECTED[line.split()[0]].append(line)


def hash_of(data):
    """FNV-1a of 64 bits."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{value:016x}"


def number_of(texture):
    return texture._number


@pytest.mark.parametrize("name", EXPECTED)
def test_golden(name):
    ends = [line for line in EXPECTED[name] if line.split()[1] == "ends"]
    expected = [line for line in EXPECTED[name] if line not in ends]
    lines = []
    try:
        file = gicodec.open((GOLDEN / name).read_bytes())
        for place, frame in enumerate(file.frames):
            for texture in sorted(file.textures.values(), key=number_of):
                lines.append(f"{name} {frame} {number_of(texture)} "
                             f"{hash_of(texture[place].tobytes())}")
        assert lines == expected  # what is behind the last frame is not read
    except gicodec.Error as error:
        # Frames are looked up before they are read: damage may end a file before its first one, and
        # a file with a bad index (index_*) plays only front to back, as C does.
        assert lines == expected[:len(lines)]
        assert ends != [f"{name} ends 1"] or name.startswith("index_"), str(error)


SESSIONS = GOLDEN.parent / "session" / "golden"


def session_lines(name):
    """The updates of a recorded session, of which the server's messages are given to a client."""
    delivery = name.split("_")[0]
    client = gicodec.Client(delivery=delivery, token="token")
    client.hello()
    data, at, lines, serial = (SESSIONS / name).read_bytes(), 0, [], 0
    while at < len(data):
        from_server, size = struct.unpack_from("<BI", data, at)
        message, at = data[at + 5:at + 5 + size], at + 5 + size
        if from_server != 1:
            continue
        client.receive(message)
        state = client.state
        if state["serial"] == serial:
            continue
        serial = state["serial"]
        for place, texture in enumerate(client.volumes[0].textures):
            hashed = hash_of(client.volumes[0].read(texture).tobytes())
            lines.append(f"{name} {state['update']} {place} {hashed}")
    assert client.state["reason"] == "the server ends"
    return lines


def test_sessions():
    lines = [line for path in sorted(SESSIONS.glob("*.session")) for line in session_lines(path.name)]
    assert lines == (SESSIONS / "hashes.txt").read_text().splitlines()


def test_unknown_version_is_named():
    with pytest.raises(gicodec.Error, match=r"version 3\.0, and gicodec \d.* reads version 1: take"):
        gicodec.open((GOLDEN / "bad_major.gic").read_bytes())
