"""Peers of script/compare that need more than zstd and xz: each takes the texels of one texture in one frame and gives
a row, or nothing where it is not installed or does not know the format. Every row was decoded to the same bits.

OpenEXR, pcodec and OpenZL are Python packages, JPEG XL and meshoptimizer Debian packages: script/bootstrap peers.
"""
import ctypes, ctypes.util, resource, shutil, subprocess, sys, tempfile
from pathlib import Path

try:
    import numpy
except ImportError:
    numpy = None


def processor_time():
    """Of this program and of those that it ran."""
    usages = [resource.getrusage(of) for of in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def timed(call):
    """What it returns, and seconds of processor time."""
    before = processor_time()
    result = call()
    return result, processor_time() - before


def row(name, encode, decode, texels):
    packed, encode_time = timed(encode)
    back, decode_time = timed(lambda: decode(packed))
    if back != texels:
        raise RuntimeError(f'{name} lost bits')
    return {'name': name, 'bytes': len(packed), 'encode': encode_time, 'decode': decode_time}


def least(rows):
    return [min(rows, key=lambda one: one['bytes'])] if rows else []


def words_of(texels, size, word):
    """Texels of `size` bytes as words: [texel][component]."""
    return numpy.frombuffer(texels, dtype={1: '<u1', 2: '<u2', 4: '<u4'}[word]).reshape(-1, size // word)


# OpenEXR, whose bytes are counted without the header.
def exr_header_size(data):
    at = 8
    while data[at] != 0:
        for _ in range(2):  # name and type
            at = data.index(b'\0', at) + 1
        at += 4 + int.from_bytes(data[at:at + 4], 'little')
    return at + 1


def exr(texels, size, word, extent, format):
    if numpy is None or 'SFLOAT' not in format or 'BLOCK' in format:
        return []
    try:
        import OpenEXR
    except ImportError:
        return []
    type_of = {2: '<f2', 4: '<f4'}[word]
    image = numpy.frombuffer(texels, dtype=type_of).reshape(extent[1] * extent[2], extent[0], -1)
    rows = []
    for name in ('ZIP', 'PIZ', 'ZSTD', 'HTJ2K256'):
        kind = getattr(OpenEXR, f'{name}_COMPRESSION', None)
        if kind is None:
            continue
        with tempfile.TemporaryDirectory() as folder:
            file = str(Path(folder) / 'x.exr')

            def encode():
                channels = {'RGBA'[c]: numpy.ascontiguousarray(image[:, :, c]) for c in range(image.shape[2])}
                OpenEXR.File({'compression': kind, 'type': OpenEXR.scanlineimage}, channels).write(file)
                return Path(file).read_bytes()

            def decode(_):
                with OpenEXR.File(file, separate_channels=True) as read:
                    parts = [read.channels()[c].pixels for c in 'RGBA'[:image.shape[2]]]
                    return numpy.stack(parts, axis=-1).astype(type_of).tobytes()
            one = row(f'exr {name.lower()}', encode, decode, texels)
            one['bytes'] -= exr_header_size(Path(file).read_bytes())
            rows.append(one)
    return rows


# JPEG XL, of codes that are ordered as the values are.
def codes_of(texels, size, word, format):
    """[texel][component] of at most 16 bits, and the largest code that is named: cjxl loses bits of other depths
    than 8 and 16. Nothing where there is more."""
    if format.startswith('B10G11R11'):
        packed = words_of(texels, 4, 4)[:, 0]
        return numpy.stack([packed & 2047, packed >> 11 & 2047, packed >> 22 << 1], axis=-1), 65535
    if format.startswith('E5B9G9R9'):
        packed = words_of(texels, 4, 4)[:, 0]
        parts = numpy.stack([packed & 511, packed >> 9 & 511, packed >> 18 & 511], axis=-1)
        light = parts.astype('f8') * 2.0 ** (packed >> 27).astype('f8')[:, None] * 2.0 ** -24
        return light.astype('<f2').view('<u2').astype('u4'), 65535
    if 'PACK32' in format or 'BLOCK' in format or word > 2:
        return None, 0
    codes = words_of(texels, size, word).astype('u4')
    if 'SFLOAT' in format:
        codes = numpy.where(codes >> 15 == 1, 65535 - codes, codes | 32768)
    return codes, (1 << 8 * word) - 1


def jpeg_xl(texels, size, word, extent, format):
    if numpy is None or not shutil.which('cjxl') or not shutil.which('djxl'):
        return []
    codes, most = codes_of(texels, size, word, format)
    if codes is None:
        return []
    count = codes.shape[1]
    # Colour together, alpha and second channels on their own.
    parts = [range(3)] + [[c] for c in range(3, count)] if count >= 3 else [[c] for c in range(count)]
    total = {'name': 'jpeg xl', 'bytes': 0, 'encode': 0, 'decode': 0}
    for part in parts:
        header = f"P{6 if len(part) == 3 else 5}\n{extent[0]} {extent[1] * extent[2]}\n{most}\n".encode()
        pixels = codes[:, list(part)].astype('>u2' if most > 255 else 'u1').tobytes()
        with tempfile.TemporaryDirectory() as folder:
            plain, packed, back = (Path(folder) / name for name in ('a.ppm', 'a.jxl', 'b.ppm'))
            plain.write_bytes(header + pixels)
            for key, command in (('encode', ['cjxl', '-d', '0', '-e', '9', plain, packed]),
                                 ('decode', ['djxl', packed, back])):
                total[key] += timed(lambda: subprocess.run(command, check=True, capture_output=True))[1]
            if not back.read_bytes().endswith(pixels):
                raise RuntimeError('jpeg xl lost bits')
            total['bytes'] += packed.stat().st_size
    return [total]


def pcodec(texels, size, word, extent, format):
    """Each component on its own."""
    if numpy is None or word == 1 or 'BLOCK' in format:
        return []
    try:
        from pcodec import ChunkConfig, standalone
    except ImportError:
        return []
    type_of = {2: '<f2', 4: '<f4'}[word] if 'SFLOAT' in format else {2: '<u2', 4: '<u4'}[word]
    values = numpy.frombuffer(texels, dtype=type_of).reshape(-1, size // word)
    config = ChunkConfig(compression_level=8)
    parts = [numpy.ascontiguousarray(values[:, c]) for c in range(values.shape[1])]

    def encode():
        return [standalone.simple_compress(part, config) for part in parts]

    def decode(packed):
        return numpy.stack([standalone.simple_decompress(one) for one in packed], axis=-1).tobytes()
    packed, encode_time = timed(encode)
    back, decode_time = timed(lambda: decode(packed))
    if back != texels:
        raise RuntimeError('pcodec lost bits')
    return [{'name': 'pcodec', 'bytes': sum(map(len, packed)), 'encode': encode_time, 'decode': decode_time}]


def openzl(texels, size, word, extent, format):
    """Without a trained graph: the best of numbers, their differences, and bytes of records apart."""
    try:
        import openzl.ext as zl
    except ImportError:
        return []
    nodes = zl.nodes
    numbers = {1: nodes.ConvertSerialToNum8, 2: nodes.ConvertSerialToNumLE16, 4: nodes.ConvertSerialToNumLE32}[word]()
    rows = []
    for steps in ([numbers], [numbers, nodes.DeltaInt()],
                  [nodes.ConvertSerialToStruct(struct_size_bytes=size), nodes.TransposeSplit()]):
        compressor = zl.Compressor()
        graph = zl.graphs.Compress()(compressor)
        for step in reversed(steps):
            graph = step(compressor, graph)
        compressor.select_starting_graph(graph)

        def encode():
            context = zl.CCtx()
            context.ref_compressor(compressor)
            context.set_parameter(zl.CParam.FormatVersion, zl.MAX_FORMAT_VERSION)
            return context.compress([zl.Input(zl.Type.Serial, numpy.frombuffer(texels, dtype='u1'))])

        def decode(packed):
            return bytes(zl.DCtx().decompress(packed)[0].content.as_nparray())
        rows.append(row('openzl', encode, decode, texels))
    return least(rows)


def meshoptimizer(texels, size, word, extent, format):
    """Its vertex codec, then zstd, as glTF files have it."""
    name = ctypes.util.find_library('meshoptimizer')
    if name is None or size % 4 != 0:
        return []
    library = ctypes.CDLL(name)
    count = len(texels) // size
    for function in (library.meshopt_encodeVertexBufferBound, library.meshopt_encodeVertexBuffer):
        function.restype = ctypes.c_size_t
    sizes = (ctypes.c_size_t(count), ctypes.c_size_t(size))

    def zstd(level, data):
        return subprocess.run(['zstd', level, '-c', '-q'], input=data, check=True, capture_output=True).stdout

    def encode():
        room = ctypes.create_string_buffer(library.meshopt_encodeVertexBufferBound(*sizes))
        used = library.meshopt_encodeVertexBuffer(room, ctypes.c_size_t(len(room)), texels, *sizes)
        return zstd('-19', room.raw[:used])

    def decode(packed):
        vertices = zstd('-d', packed)
        out = ctypes.create_string_buffer(len(texels))
        if library.meshopt_decodeVertexBuffer(out, *sizes, vertices, ctypes.c_size_t(len(vertices))) != 0:
            raise RuntimeError('meshopt refused its own bytes')
        return out.raw
    return [row('meshopt', encode, decode, texels)]


PEERS = (exr, jpeg_xl, pcodec, openzl, meshoptimizer)


def rows_of(texels, size, word, extent, format):
    rows = []
    for peer in PEERS:
        try:
            rows += peer(texels, size, word, extent, format)
        except (RuntimeError, subprocess.CalledProcessError) as error:
            said = error if isinstance(error, RuntimeError) else f'{error.cmd[0]} ended with {error.returncode}'
            print(f'compare: {peer.__name__} is left out: {said}', file=sys.stderr)
    return rows
