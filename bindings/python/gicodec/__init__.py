"""Global-illumination textures, without losing a bit: read, write and stream them as numpy arrays.

    file = gicodec.open("x.gic")
    file["color"][0]            # the first frame, an array
    file["color"].as_float(-1)  # the last one, as float32
"""

from . import formats
from ._library import (ArgumentError, BackendError, Error, FormatError, MismatchError, ResourceError,
                       library)
from .arrays import decode, encode
from .codec import Decoder, Encoder, VolumeDecoder, VolumeEncoder, peek
from .container import File, Texture, Volume, open
from .description import (TextureDesc, VolumeDesc, ddgi_irradiance, ddgi_visibility, layouts,
                          map_texture)
from .session import Client, Server
from .writer import Writer

__version__ = library.version_text().decode()

__all__ = [
    "ArgumentError", "BackendError", "Client", "Decoder", "Encoder", "Error", "File", "FormatError",
    "MismatchError", "ResourceError", "Server", "Texture", "TextureDesc", "Volume", "VolumeDecoder",
    "VolumeDesc", "VolumeEncoder", "Writer", "ddgi_irradiance", "ddgi_visibility", "decode", "encode",
    "formats", "layouts", "map_texture", "open", "peek",
]
