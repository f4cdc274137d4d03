"""The codecs of numcodecs and Zarr, in use."""

import numpy as np
import pytest

zarr = pytest.importorskip("zarr")
numcodecs = pytest.importorskip("numcodecs")

import gicodec.numcodecs  # noqa: E402
import gicodec.zarr  # noqa: E402

FIELD = (np.sin(np.arange(40)[:, None, None] / 7) * np.cos(np.arange(30)[:, None] / 5) *
         np.linspace(1, 2, 50))


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64", "uint16"])
def test_zarr_arrays_come_back(tmp_path, dtype):
    field = (FIELD * 100).astype(dtype)
    array = zarr.create_array(tmp_path / "x.zarr", shape=field.shape, chunks=(16, 16, 16), dtype=dtype,
                              serializer=gicodec.zarr.GicodecCodec(level="strong"), compressors=None)
    array[:] = field
    back = zarr.open_array(tmp_path / "x.zarr", mode="r")
    assert np.array_equal(back[:], field) and np.array_equal(back[3:9, ::2, -4:], field[3:9, ::2, -4:])
    assert isinstance(back.metadata.codecs[0], gicodec.zarr.GicodecCodec)


def test_zarr_within_a_bound(tmp_path):
    field = FIELD.astype(np.float32) + 3
    sizes = []
    for bound in (0, 0.001):
        array = zarr.create_array(tmp_path / f"{bound}.zarr", shape=field.shape, chunks=field.shape,
                                  dtype="float32", compressors=None,
                                  serializer=gicodec.zarr.GicodecCodec(max_error=bound))
        array[:] = field
        sizes.append(array.nbytes_stored())
        assert np.abs(array[:] / field - 1).max() <= bound
    assert sizes[1] < sizes[0] * 0.7


def test_numcodecs():
    codec = numcodecs.registry.get_codec({"id": "gicodec", "level": 9})
    field = FIELD.astype(np.float16)
    coded = codec.encode(field)
    assert codec.decode(coded).tobytes() == field.tobytes()
    out = np.empty_like(field)
    codec.decode(coded, out=out)
    assert np.array_equal(out, field)
    assert numcodecs.registry.get_codec(codec.get_config()) == codec


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", [">f4", "<f4", ">i2", "<f8", "|u1"])
def test_zarr_2_in_any_order_of_bytes_and_axes(tmp_path, dtype, order):
    field = (FIELD * 100 + 200).astype(dtype)
    array = zarr.create_array(tmp_path / "x.zarr", shape=field.shape, chunks=(16, 30, 16), dtype=dtype,
                              order=order, zarr_format=2, compressors=gicodec.numcodecs.Gicodec())
    array[:] = field
    assert np.array_equal(zarr.open_array(tmp_path / "x.zarr", mode="r")[:], field)


def test_zarr_refuses_chunks_of_another_size_or_type(tmp_path):
    for other in (np.zeros(1 << 20, np.float16), np.full((4,), 70000, np.float32)):
        array = zarr.create_array(tmp_path / f"{other.size}.zarr", shape=(4,), chunks=(4,), dtype="float16",
                                  serializer=gicodec.zarr.GicodecCodec(), compressors=None)
        array[:] = np.ones(4)
        chunk, = (path for path in (tmp_path / f"{other.size}.zarr").rglob("*") if path.parent.name == "c")
        chunk.write_bytes(gicodec.encode(other))
        with pytest.raises(ValueError, match="not 8 bytes"):
            array[:]
    with pytest.raises(ValueError, match="not 8 bytes"):
        gicodec.numcodecs.Gicodec().decode(gicodec.encode(np.zeros(1 << 20)), out=np.zeros(4, np.float16))
