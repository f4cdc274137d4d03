"""Golden containers have the hashes of tests/golden/hashes.txt, as in C++, C and JavaScript."""

import collections
import pathlib

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


def test_unknown_version_is_named():
    with pytest.raises(gicodec.Error, match=r"version 3\.0, and gicodec \d.* reads version 1: take"):
        gicodec.open((GOLDEN / "bad_major.gic").read_bytes())
