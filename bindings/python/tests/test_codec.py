"""Encoders, decoders, containers and sessions through the package."""

import copy
import io
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import gicodec


def noisy(shape, dtype, seed=1):
    random = np.random.default_rng(seed)
    count = int(np.prod(shape)) * np.dtype(dtype).itemsize
    return np.frombuffer(random.bytes(count), dtype).reshape(shape).copy()


def same(a, b):
    return a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes()


def room(grid=(4, 3, 2)):
    return gicodec.VolumeDesc("probes", {"color": gicodec.ddgi_irradiance(grid),
                                         "vis": gicodec.ddgi_visibility(grid)})


def recording(path=None, frames=5, **options):
    """A file, and the textures of its frames."""
    volume, states = room(), []
    textures = {name: noisy(desc.shape, desc.dtype) for name, desc in volume.textures.items()}
    with gicodec.Writer(path, {"room": volume}, metadata={"made by": "a test"}, scene="villa",
                        geometry={"room": {"grid": (4, 3, 2), "spacing": (1, 2, 3)}},
                        **options) as writer:
        for frame in range(frames):
            for array in textures.values():
                array.flat[frame::50] = frame
            writer.add(10 + 2 * frame, textures)
            states.append({name: array.copy() for name, array in textures.items()})
    return writer, states


@pytest.mark.parametrize("format", gicodec.formats.names())
def test_every_format_comes_back(format):
    desc = gicodec.map_texture((19, 7, 2), format, (8, 4, 1))
    texture, out = noisy(desc.shape, desc.dtype), desc.empty()
    packet = gicodec.Encoder(desc).encode(texture)
    gicodec.Decoder(desc).decode(packet, out)
    assert same(out, texture)


def test_all_halves_come_back():
    halves = np.arange(1 << 16, dtype=np.uint16).view(np.float16).reshape(256, 256)
    assert same(gicodec.decode(gicodec.encode(halves)), halves)
    desc = gicodec.map_texture((256, 256), "R16_SFLOAT")
    floats = desc.as_float(halves[..., np.newaxis])[..., 0]
    assert np.array_equal(floats.view(np.uint32), halves.astype(np.float32).view(np.uint32))


def test_packed_floats_are_exact():
    shared = gicodec.map_texture((4, 1), "E5B9G9R9_UFLOAT_PACK32")
    words = np.array([[[0]], [[511 | 5 << 9 | 1 << 18 | 31 << 27]],
                      [[1 | 1 << 27]], [[256 | 16 << 27]]], np.uint32).reshape(1, 4, 1)
    expected = [[0, 0, 0], [511 * 2.0**7, 5 * 2.0**7, 2.0**7], [2.0**-23, 0, 0], [1, 0, 0]]
    assert shared.as_float(words).reshape(4, 3).tolist() == expected
    small = gicodec.map_texture((2, 1), "B10G11R11_UFLOAT_PACK32")
    words = np.array([0x3C0 | 0x400 << 11 | 0x1E0 << 22, 1], np.uint32).reshape(1, 2, 1)
    assert small.as_float(words).reshape(2, 3).tolist() == [[1, 2, 1], [2.0**-20, 0, 0]]
    ten = gicodec.map_texture((1, 1), "A2B10G10R10_UNORM_PACK32")
    word = np.array([1023 | 0 << 10 | 341 << 20 | 2 << 30], np.uint32).reshape(1, 1, 1)
    assert np.allclose(ten.as_float(word).reshape(4), [1, 0, 1 / 3, 2 / 3])


def test_blocks_lists_and_snapshots():
    desc = gicodec.ddgi_irradiance((4, 3, 2))
    texture = noisy(desc.shape, desc.dtype)
    encoder, decoder = gicodec.Encoder(desc), gicodec.Decoder(desc)
    decoder.decode(encoder.encode(texture, blocks=[7, 3]))
    assert decoder.received.nonzero()[0].tolist() == [3, 7]
    late = gicodec.Decoder(desc)
    late.decode(encoder.snapshot())
    assert late.state_hash == decoder.state_hash and late.sequence == encoder.sequence == 1
    assert same(late.read(), encoder.read())
    with pytest.raises(gicodec.ArgumentError, match="twice"):
        encoder.encode(texture, blocks=[3, 3])
    info = gicodec.peek(encoder.encode(texture))
    assert info["backend"] == "native" and info["sequence"] == 2


def test_records_are_not_copied_and_stay_safe():
    desc = gicodec.ddgi_irradiance((4, 3, 2))
    encoder, decoder = gicodec.Encoder(desc), gicodec.Decoder(desc)
    texture = noisy(desc.shape, desc.dtype)
    decoder.decode(encoder.encode(texture))
    part = decoder.records()[5]
    assert part.shape == (1, 8, 8, 1) and not part.flags.writeable
    with pytest.raises(BufferError):
        decoder.decode(encoder.encode(texture, blocks="all"))
    with pytest.raises(BufferError):
        decoder.close()
    before = part.tobytes()
    del decoder  # the array keeps it
    assert part.tobytes() == before


def test_a_file_is_a_sequence_of_frames(tmp_path):
    path = tmp_path / "x.gic"
    _, states = recording(path)
    with gicodec.open(path) as file:
        assert list(file) == ["color", "vis"] and len(file) == 2
        assert file.frames == [10, 12, 14, 16, 18]
        assert file.metadata == {"made by": "a test"} and file.scene == "villa"
        assert file.volumes[0].geometry["spacing"] == [1, 2, 3]
        color = file["color"]
        assert len(color) == 5 and color.format == "A2B10G10R10_UNORM_PACK32"
        for place in (4, 0, -1, 1, 2, 3, -5):
            assert same(color[place], states[place]["color"])
        assert same(color[1:4], np.stack([state["color"] for state in states[1:4]]))
        assert color[5:].shape == (0, *color.shape)
        assert all(same(a, b["vis"]) for a, b in zip(file["vis"], states))
        for place in (5, -6):
            with pytest.raises(IndexError):
                color[place]
        with pytest.raises(KeyError, match="color, vis"):
            file["colour"]
        assert color.blocks(2).shape == (24, 1, 8, 8, 1)
        assert same(color.blocks(2, guard_band=True)[5, 0, :, :, 0],
                    states[2]["color"][:10, 50:60, 0])
        assert color.as_float(0).shape == (*color.shape[:-1], 4)
        assert "5 frames" in repr(file) and "<img" in file._repr_html_()
        out = color.desc.empty()
        assert color.read(3, out) is out and same(out, states[3]["color"])
        kept = color[0]
    assert same(kept, states[0]["color"])
    with pytest.raises(gicodec.ArgumentError):
        color[0]


def test_files_from_bytes_and_streams():
    writer, states = recording()
    for source in (writer.getvalue(), bytearray(writer.getvalue()), io.BytesIO(writer.getvalue())):
        assert same(gicodec.open(source)["vis"][-1], states[-1]["vis"])


def test_arrays_that_do_not_fit_are_refused():
    half = gicodec.map_texture((6, 4), "R16G16B16A16_SFLOAT")
    good = np.arange(96, dtype=np.float16).reshape(4, 6, 4)
    volume = gicodec.VolumeDesc("textures", {"color": half})
    with gicodec.Writer(None, {"room": volume}) as writer:
        for wrong in (good.astype("f4"), good.astype(">f2"), good.astype(object), good.tolist()):
            with pytest.raises(TypeError, match="the texture 'color' is an array of float16, not of"):
                writer.add(0, {"color": wrong})
        for wrong in (good.transpose(1, 0, 2), good[:2], np.stack([good] * 5)):
            with pytest.raises(ValueError, match=r"is an array of shape \(4, 6, 4\), not .*: .*row"):
                writer.add(0, {"color": wrong})
        with pytest.raises(ValueError, match="has 192 bytes, not 200"):
            writer.add(0, {"color": b"x" * 200})
        for frame in (-1, 1.5, 1 << 64):
            with pytest.raises(ValueError, match="a whole number from 0 on"):
                writer.add(frame, {"color": good})
        with pytest.raises(KeyError, match="there are room"):
            writer.add(0, {"color": good}, volume="hall")
        for frame, same_bits in enumerate((good, good.view(np.uint16), good.tobytes(), good[None])):
            writer.add(frame, {"color": same_bits})
    texture = gicodec.open(writer.getvalue())["color"]
    assert len(texture) == 4 and all(same(frame, good) for frame in texture)
    with pytest.raises(TypeError, match="float16, not of float32"):
        texture.read(0, np.empty((4, 6, 4), np.float32))
    with pytest.raises(ValueError, match="is no .gic file; KTX2"):
        gicodec.open(b"KTX 20 and so on" * 9)


def test_descriptions_that_are_wrong():
    for wrong in ((0, 4), (-1, 4), (1 << 33, 4), (2.0, 4)):
        with pytest.raises(gicodec.ArgumentError, match="map_texture.* whole numbers from 1 on"):
            gicodec.map_texture(wrong, "R8_UNORM")
    with pytest.raises(ValueError, match="a grid has 3 numbers"):
        gicodec.ddgi_irradiance((4, 4))
    with pytest.raises(ValueError, match="R16G16B16A16_SFLOAT"):
        gicodec.map_texture((4, 4), "r16g16b16a16_float")
    with pytest.raises(TypeError, match="VkFormat"):
        gicodec.map_texture((4, 4), np.float16)
    with pytest.raises(ValueError, match="irradiance_maps"):
        gicodec.VolumeDesc("maps")
    with pytest.raises(TypeError, match="a TextureDesc"):
        gicodec.VolumeDesc("textures", {"color": np.zeros(4)})


def test_threads_take_turns():
    desc = gicodec.map_texture((64, 64), "R16_UINT")
    rng = np.random.default_rng(3)
    given = [rng.integers(0, 65536, desc.shape, np.uint16) for _ in range(6)]
    with gicodec.Writer(None, {"room": gicodec.VolumeDesc("textures", {"a": desc})}) as writer:
        for frame, array in enumerate(given):
            writer.add(frame, {"a": array})
    texture = gicodec.open(writer.getvalue())["a"]
    encoder = gicodec.Encoder(desc)
    with ThreadPoolExecutor(4) as pool:
        read = list(pool.map(lambda i: same(texture[i % 6], given[i % 6]), range(60)))
        packets = list(pool.map(lambda i: encoder.encode(given[i % 6], "all"), range(60)))
    assert all(read) and sorted(gicodec.peek(packet)["sequence"] for packet in packets) == list(range(1, 61))
    encoder.close()
    with pytest.raises(gicodec.ArgumentError, match="the Encoder is closed"):
        encoder.encode(given[0])


def test_arrays_longer_than_a_texture():
    for shape in ((3_000_001,), (1_500_000, 3)):
        array = np.random.default_rng(1).integers(0, 5, shape, np.uint8)
        back = gicodec.decode(gicodec.encode(array, "turbo"))
        assert back.shape == shape and same(back, array)


def test_handles_are_not_copied():
    color = gicodec.map_texture((8, 8), "R8_UNORM")
    volume = gicodec.VolumeDesc("textures", {"color": color})
    with gicodec.Writer(None, {"room": volume}) as writer:
        writer.add(0, {"color": color.empty()})
    file = gicodec.open(writer.getvalue())
    for ways, objects in (((copy.deepcopy, pickle.dumps), (file, file["color"])),
                          ((copy.copy, copy.deepcopy, pickle.dumps), (gicodec.Encoder(color), volume))):
        for way in ways:
            for one in objects:
                with pytest.raises(TypeError, match="neither copied nor pickled"):
                    way(one)
    texture = file["color"]
    file.close()
    for use in (lambda: texture[0], lambda: texture.largest_error, lambda: file.metadata):
        with pytest.raises(gicodec.ArgumentError, match="the file is closed"):
            use()
    file = gicodec.open(writer.getvalue())
    assert copy.deepcopy(color) == color and file["color"][0].shape == color.shape


def test_a_writer_leaves_nothing_half_done(tmp_path):
    path = tmp_path / "x.gic"
    with pytest.raises(KeyError, match="'vis'"):
        with gicodec.Writer(path, {"room": room()}) as writer:
            writer.add(0, {"color": room().textures["color"].empty()})
    assert list(tmp_path.iterdir()) == []
    recording(path)
    with pytest.raises(IsADirectoryError):
        gicodec.Writer(tmp_path, {"room": room()}, overwrite=True)
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        gicodec.Writer(tmp_path / "no" / "x.gic", {"room": room()})
    gicodec.Writer(tmp_path / "dropped.gic", {"room": room()})
    with pytest.raises(FileExistsError, match="overwrite"):
        recording(path)
    first = path.read_bytes()
    recording(path, frames=2, overwrite=True)
    assert path.read_bytes() != first
    assert list(tmp_path.iterdir()) == [path]


def test_errors_have_their_status():
    with pytest.raises(gicodec.FormatError) as caught:
        gicodec.open(b"no container")
    assert caught.value.name == "not_gicodec" and caught.value.status == 303
    writer, _ = recording()
    with pytest.raises(gicodec.ResourceError) as caught:
        gicodec.open(writer.getvalue(), limits={"max_texture_bytes": 100})
    assert caught.value.name == "limit_exceeded"
    with pytest.raises(TypeError, match="max_texture_bytes"):
        gicodec.open(writer.getvalue(), limits={"max_bytes": 100})
    damaged = bytearray(writer.getvalue())
    damaged[len(damaged) // 2] ^= 1
    with pytest.raises(gicodec.FormatError):
        for texture in gicodec.open(damaged).textures.values():
            for _ in texture:
                pass
    with pytest.raises(ValueError, match="no format"):
        gicodec.ddgi_irradiance((1, 1, 1), "RGB10")
    color = gicodec.ddgi_irradiance((1, 1, 1))
    with pytest.raises(gicodec.ArgumentError, match="grid: the textures of a group"):
        gicodec.VolumeDesc("probes", {"a": color, "b": gicodec.ddgi_irradiance((2, 1, 1))})
    color.struct.guard_band = 2
    with pytest.raises(gicodec.ArgumentError, match="guard_band: it is 0 or 1"):
        gicodec.TextureDesc(color.struct)


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64", "uint8", "int16", "uint32",
                                   "int64", "bool", ">f4"])
@pytest.mark.parametrize("shape", [(), (0,), (7,), (5, 6), (4, 5, 3), (3, 4, 5, 6), (2, 3, 4, 5, 4)])
def test_plain_arrays(dtype, shape):
    array = noisy(shape, "u1") % 2 == 0 if dtype == "bool" else noisy(shape, dtype)
    for level in (None, 0, 9, "turbo"):
        back = gicodec.decode(gicodec.encode(array, level))
        assert back.shape == array.shape and back.tobytes() == array.astype(back.dtype).tobytes()
    out = np.empty(shape, np.dtype(dtype).newbyteorder("="))
    assert gicodec.decode(gicodec.encode(array), out=out) is out


def test_arrays_within_a_bound():
    array = np.random.default_rng(1).random((20, 30, 40), np.float32)
    coded = gicodec.encode(array, max_error=0.01)
    assert np.abs(gicodec.decode(coded) / array - 1).max() <= 0.01
    assert len(coded) < len(gicodec.encode(array)) / 2
    with pytest.raises(ValueError, match="max_error"):
        gicodec.encode(array.astype(np.int32), max_error=1)
    with pytest.raises(TypeError, match="complex128"):
        gicodec.encode(np.zeros(3, complex))
    target = bytearray(1 << 20)
    used = gicodec.encode(array, out=target)
    assert same(gicodec.decode(used), array)
    with pytest.raises(ValueError, match="out must"):
        gicodec.encode(array, out=bytearray(10))


def test_a_session():
    volume = room()
    textures = {name: noisy(desc.shape, desc.dtype) for name, desc in volume.textures.items()}
    server, client = gicodec.Server(token="sesame"), gicodec.Client(token="sesame")
    number, connection = server.add_volume("room", volume), server.connect(0)
    server.receive(connection, client.hello(), 0)

    def update(tick):
        server.publish(number, textures)
        server.update(tick / 30, tick / 30)
        for message in server.messages(connection):
            assert client.receive(message)
        for message in client.messages():
            server.receive(connection, message, tick / 30)

    for tick in range(1, 20):
        update(tick)
    (held,) = client.volumes
    assert held.name == "room" and client.state["consistent"]
    assert all(same(held.read(name), texture) for name, texture in textures.items())
    serial, out = client.state["serial"], held.read("vis")
    textures["vis"][20, 40] += 1
    for tick in range(20, 23):
        update(tick)
    assert held.changed("vis", after=serial).size == 1
    assert same(held.read("vis", out, after=serial), textures["vis"])
    assert [event["type"] for event in server.events()] == ["joined"]
    client.disconnect()
    for message in client.messages():
        server.receive(connection, message, 1)
    assert [event["type"] for event in server.events()] == ["dropped"]


def test_layouts():
    for name in gicodec.layouts():
        volume = gicodec.VolumeDesc.of_layout(name, (4, 4, 4))
        assert volume.json()["groups"] and volume.textures
    with pytest.raises(ValueError, match="there is no layout 'none': paper"):
        gicodec.VolumeDesc.of_layout("none", (1, 1, 1))
