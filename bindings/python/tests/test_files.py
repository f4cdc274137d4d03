"""Files on the disk, and what errors say."""

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
    file._stream.close()
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
