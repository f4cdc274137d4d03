"""Damaged and made-up bytes raise exceptions, and nothing else happens."""

import os

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gicodec
from test_codec import recording

FILE = recording(frames=3)[0].getvalue()
DESC = gicodec.ddgi_irradiance((4, 3, 2))
PACKET = gicodec.Encoder(DESC).encode(
    np.random.default_rng(1).integers(0, 1 << 30, DESC.shape, np.uint32))
ARRAY = gicodec.encode(np.arange(3000, dtype=np.float32).reshape(30, 10, 10))
LIMITS = {"max_texture_bytes": 1 << 22, "max_total_bytes": 1 << 26, "max_work_bytes": 1 << 24}

changes = st.lists(st.tuples(st.integers(0, 1 << 30), st.integers(0, 255)), max_size=8)
cuts = st.one_of(st.none(), st.integers(0, 1 << 30))


def damaged(data, change, cut):
    found = bytearray(data if cut is None else data[:cut % (len(data) + 1)])
    for place, value in change:
        if found:
            found[place % len(found)] = value
    return bytes(found)


# The same inputs at every change; others, and more of them, where GICODEC_FUZZ is set.
FUZZ = "GICODEC_FUZZ" in os.environ


def fuzz(test):
    return settings(max_examples=4000 if FUZZ else 400, deadline=None, derandomize=not FUZZ,
                    suppress_health_check=[HealthCheck.too_slow])(test)


@fuzz
@given(changes, cuts)
def test_containers(change, cut):
    try:
        with gicodec.open(damaged(FILE, change, cut), limits=LIMITS) as file:
            for texture in file.textures.values():
                for array in texture:
                    assert array.shape == texture.shape
    except gicodec.Error as error:
        assert error.status >= 200


@fuzz
@given(changes, cuts)
def test_packets(change, cut):
    decoder = gicodec.Decoder(DESC, limits=LIMITS)
    try:
        decoder.decode(damaged(PACKET, change, cut))
    except gicodec.Error as error:
        assert error.status >= 200
        assert not decoder.received.any()


@fuzz
@given(changes, cuts)
def test_arrays(change, cut):
    try:
        gicodec.decode(damaged(ARRAY, change, cut), limits=LIMITS)
    except (gicodec.Error, ValueError):
        pass


@fuzz
@given(st.binary(max_size=300))
def test_made_up_bytes(data):
    for call in (gicodec.open, gicodec.Decoder(DESC).decode, gicodec.peek, gicodec.Client().receive):
        try:
            call(data)
        except gicodec.Error:
            pass


@fuzz
@given(st.lists(st.binary(max_size=100), max_size=6), changes)
def test_messages(messages, change):
    server, client = gicodec.Server(), gicodec.Client()
    connection = server.connect(0)
    for message in [damaged(client.hello(), change, None), *messages]:
        server.receive(connection, message, 0)
    server.update(0, 0)
    for message in server.messages(connection):
        try:
            client.receive(damaged(message, change, None))
        except gicodec.Error:
            pass
