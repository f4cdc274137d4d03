"""Files on the disk, and what errors say."""

import gc
import json
import os
import pickle
import threading

import numpy as np
import pytest

import gicodec
from test_codec import recording


def test_a_file_that_shrinks_is_cut_off(tmp_path):
    path = tmp_path / "x.gic"
    path.write_bytes(recording(frames=20)[0].getvalue())
    with gicodec.open(path) as file:
        assert file.is_complete
        first = file["color"][0]
        os.truncate(path, 700)
        with pytest.raises(gicodec.Error) as caught:
            file["color"][15]
        assert caught.value.status >= 300
    path.write_bytes(recording(frames=20)[0].getvalue()[:-40])
    with gicodec.open(path) as file:
        assert not file.is_complete and "cut off" in repr(file)
        assert (file["color"][0] == first).all()


def test_a_file_that_cannot_be_read_says_so(tmp_path):
    path = tmp_path / "x.gic"
    path.write_bytes(recording(frames=3)[0].getvalue())
    file = gicodec.open(path)
    file._contents.stream.close()
    with pytest.raises(ValueError, match="closed file"):
        file["color"][0]
    with pytest.raises(IsADirectoryError):
        gicodec.open(tmp_path)
    with pytest.raises(FileNotFoundError):
        gicodec.open(tmp_path / "none.gic")
    (tmp_path / "empty.gic").write_bytes(b"")
    with pytest.raises(gicodec.FormatError):
        gicodec.open(tmp_path / "empty.gic")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_a_pipe_is_read_to_its_end(tmp_path):
    data, path = recording(frames=3)[0].getvalue(), tmp_path / "pipe.gic"
    os.mkfifo(path)
    writing = threading.Thread(target=path.write_bytes, args=(data,))
    writing.start()
    with gicodec.open(path) as file:
        assert len(file.frames) == 3
    writing.join()


def test_a_file_is_a_mapping(tmp_path):
    path = tmp_path / "x.gic"
    path.write_bytes(recording(frames=3)[0].getvalue())
    with gicodec.open(path) as file:
        assert list(file.keys()) == list(file) and "color" in file and "nothing" not in file
        for (name, texture), value in zip(file.items(), file.values()):
            assert file[name] is texture is value
            assert texture.ndim == texture[0].ndim and texture.size == texture[0].size


def test_errors_name_the_setting():
    desc = gicodec.ddgi_irradiance((2, 1, 1))
    for settings, said in [({"backend": "zip"}, "backend='zip'.*lz4"), ({"isa": "vax"}, "isa='vax'"),
                           ({"level": 7}, "level=7"), ({"gop": -1}, "gop"),
                           ({"max_error": -1}, "max_error=-1"), ({"texture_id": 256}, "texture_id=256")]:
        with pytest.raises(ValueError, match=said):
            gicodec.Encoder(desc, **settings)
    with pytest.raises(ValueError, match="isa='vax'"):
        gicodec.Decoder(desc, isa="vax")
    for level in (-1, 10, "best"):
        with pytest.raises(ValueError, match="0 to 9"):
            gicodec.encode(np.zeros(4), level)
    volume = gicodec.VolumeDesc("probes", {"color": desc})
    with pytest.raises(KeyError, match="no texture 'colour'"):
        gicodec.VolumeEncoder(volume).encode({"color": np.zeros(desc.shape, desc.dtype), "colour": 1})


def test_errors_are_pickled():
    with pytest.raises(gicodec.FormatError) as caught:
        gicodec.open(b"no container")
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is type(caught.value) and str(again) == str(caught.value)
    assert (again.status, again.name) == (caught.value.status, caught.value.name)


def room():
    return gicodec.VolumeDesc("probes", {"color": gicodec.ddgi_irradiance((2, 2, 2))})


def frames_of(data, desc):
    """The frames of a container, each of one number."""
    with gicodec.open(data) as file:
        return [(frame, int(file["color"][place].ravel()[0])) for place, frame in enumerate(file.frames)]


def test_a_refused_frame_does_not_spoil_those_behind_it():
    desc = gicodec.ddgi_irradiance((2, 2, 2))
    writer = gicodec.Writer(None, {"room": room()})
    with writer:
        for frame in (0, 1, 5):
            writer.add(frame, {"color": desc.empty() + np.uint32(frame)})
        for frame in (4, 5):
            with pytest.raises(gicodec.ArgumentError):
                writer.add(frame, {"color": desc.empty() + np.uint32(99)})
        writer.add(6, {"color": desc.empty() + np.uint32(6)})
    assert frames_of(writer.getvalue(), desc) == [(0, 0), (1, 1), (5, 5), (6, 6)]


def test_a_full_disk_that_has_room_again(tmp_path, monkeypatch):
    desc = gicodec.ddgi_irradiance((2, 2, 2))
    path = tmp_path / "x.gic"
    writer = gicodec.Writer(path, {"room": room()})
    stream, write, full = writer._output._stream, writer._output._stream.write, [True]

    class Disk:
        def __getattr__(self, name):
            return getattr(stream, name)

        def write(self, data):
            if full[0] and len(data) > 40:
                return write(data[:20]) if stream.tell() == writer._output._size else failing()
            return write(data)

    def failing():
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writer._output, "_stream", Disk())
    noise = np.random.default_rng(3).integers(0, 1 << 30, desc.shape, np.uint32)
    for frame in range(3):
        with pytest.raises(OSError):
            writer.add(frame, {"color": noise})
    full[0] = False
    for frame in range(3, 6):
        writer.add(frame, {"color": desc.empty() + np.uint32(frame)})
    writer.close()
    assert frames_of(path, desc)[-3:] == [(3, 3), (4, 4), (5, 5)]
    assert os.listdir(tmp_path) == ["x.gic"]


def test_a_writer_replaces_nothing_but_containers(tmp_path):
    def write(path, **options):
        with gicodec.Writer(path, {"room": room()}, **options) as writer:
            writer.add(0, {"color": gicodec.ddgi_irradiance((2, 2, 2)).empty()})

    path, link = tmp_path / "x.gic", tmp_path / "link.gic"
    write(path)
    path.chmod(0o640)
    link.symlink_to(path)
    write(link, overwrite=True)
    assert link.is_symlink() and path.stat().st_mode & 0o777 == 0o640
    path.write_text("mine")
    with pytest.raises(FileExistsError, match="no container"):
        write(path, overwrite=True)
    assert path.read_text() == "mine"
    with pytest.raises(FileExistsError, match="device"):
        write("/dev/null", overwrite=True)
    # Somebody takes the name meanwhile: what was written stays.
    first, second = (gicodec.Writer(tmp_path / "y.gic", {"room": room()}) for _ in range(2))
    first.close()
    with pytest.raises(FileExistsError, match="partial"):
        second.close()
    del second
    kept, = tmp_path.glob("y.gic.*.partial")
    assert gicodec.open(kept).frames == []


def test_a_file_system_without_links(tmp_path, monkeypatch):
    def link(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", link)
    gicodec.Writer(tmp_path / "x.gic", {"room": room()}).close()
    assert os.listdir(tmp_path) == ["x.gic"]


def test_threads_write_one_file(tmp_path):
    volumes = {name: room() for name in "ab"}
    desc = gicodec.ddgi_irradiance((2, 2, 2))
    for _ in range(5):
        writer, step = gicodec.Writer(None, volumes), threading.Barrier(2)

        def add(name):
            for frame in range(20):
                step.wait()
                writer.add(frame, {"color": desc.empty() + np.uint32(frame)}, volume=name)

        threads = [threading.Thread(target=add, args=(name,)) for name in volumes]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        writer.close()
        with gicodec.open(writer.getvalue()) as file:
            for name in volumes:
                assert [int(one.ravel()[0]) for one in file[f"{name}/color"]] == list(range(20))


def test_files_go_without_close(tmp_path):
    path = tmp_path / "x.gic"
    path.write_bytes(recording(frames=2)[0].getvalue())
    before = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    gc.collect()
    gc.disable()
    try:
        for _ in range(20):
            gicodec.open(path)["color"][0]
    finally:
        gc.enable()
    if before:
        assert len(os.listdir("/proc/self/fd")) <= before + 1


def test_many_textures_keep_within_the_limits():
    desc = gicodec.map_texture((64, 64), "R32_UINT")
    names = [f"t{number}" for number in range(40)]
    with gicodec.Writer(None, {"room": gicodec.VolumeDesc("textures", dict.fromkeys(names, desc))}) as writer:
        writer.add(0, {name: desc.empty() + np.uint32(place) for place, name in enumerate(names)})
    most = 1 << 25
    with gicodec.open(writer.getvalue(), limits={"max_total_bytes": most}) as file:
        for place, name in enumerate(names):
            assert file[name][0].ravel()[0] == place
            held = (file._contents._first, *file._contents._players.values())
            assert len(held) <= 17 and sum(player.memory for player in held) <= most
        for _ in range(2):  # in turns
            assert (file["t0"][0] == 0).all() and (file["t39"][0] == 39).all()
        assert file._repr_html_().count("<img") == 16


def test_closing_while_others_read():
    data = recording(frames=3)[0].getvalue()
    for _ in range(50):
        file = gicodec.open(data)

        def read():
            for _ in range(20):
                try:
                    file.metadata, file["color"].largest_error, file.volumes[0].desc, file["color"][1]
                except gicodec.ArgumentError as error:
                    assert "closed" in str(error)

        threads = [threading.Thread(target=read) for _ in range(2)]
        for thread in threads:
            thread.start()
        file.close()
        for thread in threads:
            thread.join()


def test_arrays_of_strangers():
    for shape in ([9] * 100_000, [None], [1.5], ["2"], [True], "", {}):
        about = {"array": json.dumps({"dtype": "|u1", "shape": shape})}
        desc = gicodec.map_texture((1, 1), "R8_UINT", (1, 1, 1))
        with gicodec.Writer(None, {"array": gicodec.VolumeDesc("textures", {"array": desc})},
                            metadata=about) as writer:
            writer.add(0, {"array": desc.empty()})
        with pytest.raises(ValueError, match="damaged"):
            gicodec.decode(writer.getvalue())
    with pytest.raises(TypeError, match="format 'O'"):
        gicodec.encode(np.zeros(3), out=np.array([None] * 9999))
    with pytest.raises(TypeError, match="filled"):
        gicodec.encode(np.ma.masked_equal([1, 2], 2))
    with pytest.raises(ValueError, match="zero"):
        gicodec.VolumeDesc("textures", {"a\0b": gicodec.map_texture((8, 8), "R8_UINT")})
    with pytest.raises(ValueError, match="max_total_bytes is 0 to"):
        gicodec.open(b"", limits={"max_total_bytes": -1})
    big = np.arange(5000, dtype=">i4").reshape(50, 100)
    assert gicodec.decode(gicodec.encode(big)).dtype == big.dtype and (gicodec.decode(gicodec.encode(big)) == big).all()


def test_names_of_strangers_are_shown_safely():
    evil = "a\x1b[31mred\x9b"
    desc = gicodec.map_texture((8, 8), "R8_UINT")
    with gicodec.Writer(None, {"room": gicodec.VolumeDesc("textures", {evil: desc})}) as writer:
        writer.add(0, {evil: desc.empty()})
    with gicodec.open(writer.getvalue()) as file:
        for text in (repr(file), repr(file.volumes[0]), repr(file[evil]), repr(file.volumes[0].desc)):
            assert text.replace("\n", "").isprintable(), text
