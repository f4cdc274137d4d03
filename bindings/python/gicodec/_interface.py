"""Made by make_interface.py from include/gicodec/c. Pointers are addresses."""

import ctypes

OK = 0
END = 1
INVALID_ARGUMENT = 100
INVALID_DESCRIPTION = 101
VIEW_TOO_SMALL = 102
BLOCK_OUT_OF_RANGE = 103
BLOCK_REPEATED = 104
UNSUPPORTED_FORMAT = 105
UNKNOWN_BACKEND = 106
BUFFER_TOO_SMALL = 107
UNSUPPORTED_BACKEND = 108
UNSUPPORTED_SHAPE = 109
UNKNOWN_KIND = 110
UNKNOWN_VOLUME = 111
UNKNOWN_TEXTURE = 112
UNKNOWN_GROUP = 113
UNKNOWN_CONNECTION = 114
MASK_MISMATCH = 115
INVALID_GEOMETRY = 116
INVALID_NAME = 117
INVALID_TIME = 118
INVALID_BOUND = 119
INVALID_INTERVAL = 120
PRESENCE_MISSING = 121
PRESENCE_INVALID = 122
UNKNOWN_REGION = 123
UNKNOWN_FRAME = 124
WRONG_FRAME = 125
INVALID_SETTINGS = 126
OUT_OF_ORDER = 127
OUT_OF_MEMORY = 200
LIMIT_EXCEEDED = 201
CANCELLED = 202
TRUNCATED = 300
CORRUPT = 301
CHECKSUM_MISMATCH = 302
NOT_GICODEC = 303
UNSUPPORTED_VERSION = 304
UNSUPPORTED_FEATURE = 305
DESCRIPTION_MISMATCH = 400
REFERENCE_MISSING = 401
BACKEND_MISSING = 402
BACKEND_FAILED = 500
BACKEND_UNAVAILABLE = 501
IO_FAILED = 502
SELECT_CHANGED = 0
SELECT_ALL = 1
SELECT_LIST = 2
SPACE_GRID = 0
SPACE_POOL = 1
PRESENCE_ALL = 0
PRESENCE_COUNT = 1
PRESENCE_MASK = 2
PRESENCE_BRICK = 3
MODEL_NONE = 0
MODEL_STACKED = 1
MODEL_CONTINUOUS = 2
MODEL_UNORDERED = 3
MODEL_OCTREE = 4
MODEL_HEMISPHERES = 5
TILING_ATLAS_XY_Z = 0
TILING_ATLAS_XZ_Y = 1
TILING_ATLAS_X_YZ = 2
TILING_SLICES_XZ_Y = 3
TILING_SLICES_XY_Z = 4
TILING_BLOCKS = 5
TILING_ATLAS_YZ_X = 6
TILING_SLICES_YX_Z = 7
COMPONENT_UNORM = 0
COMPONENT_SNORM = 1
COMPONENT_UINT = 2
COMPONENT_UFLOAT = 3
COMPONENT_SFLOAT = 4
COMPONENT_EXPONENT = 5
COMPONENT_OPAQUE = 6
MAX_COMPONENTS = 16
NO_GROUP = 255
GOP_ON_REQUEST = 4294967295
METADATA_CONTAINER = 0
METADATA_VOLUME = 1
METADATA_TEXTURE = 2
DELIVERY_UNICAST = 0
DELIVERY_SHARED = 1
EVENT_JOINED = 0
EVENT_RESUMED = 1
EVENT_VIEWPOINT = 2
EVENT_SUBSCRIBED = 3
EVENT_DROPPED = 4
EVENT_EXPIRED = 5
TRACKS_LIST = 0
TRACKS_OBJECT = 1
TRACKS_TICK = 2

# Names of statuses.
STATUS_NAMES = {0: 'ok', 1: 'end', 100: 'invalid_argument', 101: 'invalid_description', 102: 'view_too_small', 103: 'block_out_of_range', 104: 'block_repeated', 105: 'unsupported_format', 106: 'unknown_backend', 107: 'buffer_too_small', 108: 'unsupported_backend', 109: 'unsupported_shape', 110: 'unknown_kind', 111: 'unknown_volume', 112: 'unknown_texture', 113: 'unknown_group', 114: 'unknown_connection', 115: 'mask_mismatch', 116: 'invalid_geometry', 117: 'invalid_name', 118: 'invalid_time', 119: 'invalid_bound', 120: 'invalid_interval', 121: 'presence_missing', 122: 'presence_invalid', 123: 'unknown_region', 124: 'unknown_frame', 125: 'wrong_frame', 126: 'invalid_settings', 127: 'out_of_order', 200: 'out_of_memory', 201: 'limit_exceeded', 202: 'cancelled', 300: 'truncated', 301: 'corrupt', 302: 'checksum_mismatch', 303: 'not_gicodec', 304: 'unsupported_version', 305: 'unsupported_feature', 400: 'description_mismatch', 401: 'reference_missing', 402: 'backend_missing', 500: 'backend_failed', 501: 'backend_unavailable', 502: 'io_failed'}


class gicodec_host(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("threads", ctypes.c_uint32),
        ("allocate", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        ("memory", ctypes.c_void_p),
        ("run", ctypes.c_void_p),
        ("executor", ctypes.c_void_p),
        ("isa", ctypes.c_char_p),
    ]


class gicodec_limits(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("max_textures", ctypes.c_uint32),
        ("max_texture_bytes", ctypes.c_uint64),
        ("max_packet_bytes", ctypes.c_uint64),
        ("max_total_bytes", ctypes.c_uint64),
        ("max_work_bytes", ctypes.c_uint64),
        ("max_description_bytes", ctypes.c_uint64),
        ("max_metadata_bytes", ctypes.c_uint64),
        ("max_index_bytes", ctypes.c_uint64),
    ]


class gicodec_view(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("bytes", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("row_pitch", ctypes.c_size_t),
        ("slice_pitch", ctypes.c_size_t),
        ("block_pitch", ctypes.c_size_t),
    ]


class gicodec_const_view(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("bytes", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("row_pitch", ctypes.c_size_t),
        ("slice_pitch", ctypes.c_size_t),
        ("block_pitch", ctypes.c_size_t),
    ]


class gicodec_component(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char * 8),
        ("offset", ctypes.c_uint16),
        ("bits", ctypes.c_uint8),
        ("type", ctypes.c_uint8),
    ]


class gicodec_texture_desc(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("format", ctypes.c_uint32),
        ("grid", ctypes.c_uint32 * 3),
        ("block", ctypes.c_uint32 * 3),
        ("guard_band", ctypes.c_uint32),
        ("space", ctypes.c_uint32),
        ("presence", ctypes.c_uint32),
        ("model", ctypes.c_uint32),
        ("records", ctypes.c_uint32 * 3),
        ("tiling", ctypes.c_uint32),
        ("pad_before", ctypes.c_uint32),
        ("pad_after", ctypes.c_uint32),
        ("slots", ctypes.c_uint32 * 3),
        ("record_bytes", ctypes.c_uint32),
        ("component_count", ctypes.c_uint32),
        ("components", gicodec_component * 16),
    ]


class gicodec_texture_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("blocks", ctypes.c_uint32),
        ("texture_bytes", ctypes.c_uint64),
        ("width", ctypes.c_uint64),
        ("height", ctypes.c_uint64),
        ("slices", ctypes.c_uint64),
        ("block_bytes", ctypes.c_uint32),
        ("presence_bytes", ctypes.c_uint32),
    ]


class gicodec_encoder_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("gop", ctypes.c_uint32),
        ("backend", ctypes.c_char_p),
        ("preset", ctypes.c_char_p),
        ("level", ctypes.c_int32),
        ("chunk", ctypes.c_uint32),
        ("no_difference", ctypes.c_uint32),
        ("texture_id", ctypes.c_uint32),
        ("max_error", ctypes.c_float),
        ("max_error_count", ctypes.c_uint32),
        ("max_errors", ctypes.c_void_p),
        ("backends", ctypes.c_void_p),
        ("backend_count", ctypes.c_size_t),
        ("host", ctypes.c_void_p),
    ]


class gicodec_decoder_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("texture_id", ctypes.c_uint32),
        ("limits", ctypes.c_void_p),
        ("backends", ctypes.c_void_p),
        ("backend_count", ctypes.c_size_t),
        ("host", ctypes.c_void_p),
    ]


class gicodec_packet_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("version", ctypes.c_uint32),
        ("type", ctypes.c_uint32),
        ("backend", ctypes.c_uint32),
        ("texture_id", ctypes.c_uint32),
        ("lossy", ctypes.c_uint32),
        ("sequence", ctypes.c_uint32),
        ("reference", ctypes.c_uint32),
        ("all_blocks", ctypes.c_uint32),
        ("blocks", ctypes.c_uint32),
        ("header_size", ctypes.c_uint64),
        ("index_size", ctypes.c_uint64),
        ("guard_band_size", ctypes.c_uint64),
        ("payload_size", ctypes.c_uint64),
    ]


class gicodec_geometry(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("grid", ctypes.c_uint32 * 3),
        ("origin", ctypes.c_float * 3),
        ("spacing", ctypes.c_float * 3),
        ("scroll", ctypes.c_int32 * 3),
    ]


class gicodec_sink(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("self", ctypes.c_void_p),
        ("write", ctypes.c_void_p),
    ]


class gicodec_range(ctypes.Structure):
    _fields_ = [
        ("offset", ctypes.c_uint64),
        ("size", ctypes.c_uint64),
    ]


class gicodec_source(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("self", ctypes.c_void_p),
        ("read", ctypes.c_void_p),
        ("seek", ctypes.c_void_p),
        ("size", ctypes.c_void_p),
        ("prefetch", ctypes.c_void_p),
    ]


class gicodec_player_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("limits", ctypes.c_void_p),
        ("backends", ctypes.c_void_p),
        ("backend_count", ctypes.c_size_t),
        ("host", ctypes.c_void_p),
    ]


class gicodec_client_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("delivery", ctypes.c_uint32),
        ("budget_blocks", ctypes.c_uint32),
        ("no_texels", ctypes.c_uint32),
        ("budget_bytes", ctypes.c_uint64),
        ("token", ctypes.c_char_p),
        ("limits", ctypes.c_void_p),
        ("backends", ctypes.c_void_p),
        ("backend_count", ctypes.c_size_t),
        ("host", ctypes.c_void_p),
    ]


class gicodec_viewpoint(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("eye", ctypes.c_float * 3),
        ("target", ctypes.c_float * 3),
        ("up", ctypes.c_float * 3),
        ("fov_y", ctypes.c_float),
        ("aspect", ctypes.c_float),
        ("time", ctypes.c_float),
    ]


class gicodec_client_state(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("connected", ctypes.c_uint32),
        ("resumed", ctypes.c_uint32),
        ("consistent", ctypes.c_uint32),
        ("epoch", ctypes.c_uint64),
        ("serial", ctypes.c_uint64),
        ("update", ctypes.c_uint64),
        ("time", ctypes.c_double),
        ("volumes", ctypes.c_uint32),
        ("reason", ctypes.c_uint32),
        ("messages", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
        ("packets", ctypes.c_uint64),
        ("blocks", ctypes.c_uint64),
        ("gaps", ctypes.c_uint64),
    ]


class gicodec_server_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("level", ctypes.c_int32),
        ("backend", ctypes.c_char_p),
        ("preset", ctypes.c_char_p),
        ("token", ctypes.c_char_p),
        ("scene", ctypes.c_char_p),
        ("scene_geometry", ctypes.c_uint64),
        ("epoch", ctypes.c_uint64),
        ("region", ctypes.c_uint32 * 3),
        ("proofs", ctypes.c_uint32),
        ("interval", ctypes.c_double),
        ("first_update_bytes", ctypes.c_uint64),
        ("max_clients", ctypes.c_uint32),
        ("max_connections", ctypes.c_uint32),
        ("max_waiting", ctypes.c_uint32),
        ("max_unicast", ctypes.c_uint32),
        ("max_unicast_per_origin", ctypes.c_uint32),
        ("max_in_flight", ctypes.c_uint32),
        ("max_in_flight_bytes", ctypes.c_uint64),
        ("max_message_bytes", ctypes.c_uint64),
        ("max_bytes_per_second", ctypes.c_uint64),
        ("max_total_bytes_per_second", ctypes.c_uint64),
        ("messages_per_second", ctypes.c_double),
        ("resyncs_per_second", ctypes.c_double),
        ("hello_timeout", ctypes.c_double),
        ("stall_timeout", ctypes.c_double),
        ("linger_timeout", ctypes.c_double),
        ("backends", ctypes.c_void_p),
        ("backend_count", ctypes.c_size_t),
        ("host", ctypes.c_void_p),
    ]


class gicodec_streamed_texture(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("texture", ctypes.c_uint32),
        ("interval", ctypes.c_uint32),
        ("threshold", ctypes.c_float),
        ("max_error", ctypes.c_float),
        ("source_error", ctypes.c_float),
    ]


class gicodec_event(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("type", ctypes.c_uint32),
        ("connection", ctypes.c_uint32),
        ("client", ctypes.c_uint32),
        ("reason", ctypes.c_uint32),
    ]


class gicodec_connection_state(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("client", ctypes.c_uint32),
        ("delivery", ctypes.c_uint32),
        ("in_flight", ctypes.c_uint32),
        ("in_flight_bytes", ctypes.c_uint64),
        ("updates", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
        ("blocks", ctypes.c_uint64),
        ("skipped", ctypes.c_uint64),
        ("update_bytes", ctypes.c_uint64),
        ("memory", ctypes.c_uint64),
        ("resyncs", ctypes.c_uint32),
        ("lagging", ctypes.c_uint32),
        ("pending", ctypes.c_uint32),
        ("oldest_pending", ctypes.c_uint32),
    ]


class gicodec_track(ctypes.Structure):
    _fields_ = [
        ("volume", ctypes.c_uint32),
        ("texture", ctypes.c_uint32),
        ("region", ctypes.c_uint32),
    ]


class gicodec_track_name(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("volume", ctypes.c_char_p),
        ("texture", ctypes.c_char_p),
        ("place", ctypes.c_uint32 * 3),
    ]


class gicodec_track_publisher_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("snapshot_seconds", ctypes.c_double),
        ("snapshot_share", ctypes.c_double),
        ("host", ctypes.c_void_p),
    ]


class gicodec_track_message(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("type", ctypes.c_uint32),
        ("track", gicodec_track),
        ("number", ctypes.c_uint32),
        ("bytes", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
    ]


class gicodec_track_receiver_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("reach", ctypes.c_float),
        ("subscribed_only", ctypes.c_uint32),
        ("max_tracks", ctypes.c_uint32),
        ("max_waiting_bytes", ctypes.c_uint64),
        ("host", ctypes.c_void_p),
    ]


class gicodec_track_object(ctypes.Structure):
    _fields_ = [
        ("track", gicodec_track),
        ("number", ctypes.c_uint32),
    ]


class gicodec_track_receiver_state(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("wants_hello", ctypes.c_uint32),
        ("complete", ctypes.c_uint32),
        ("wanted_changes", ctypes.c_uint64),
        ("ticks", ctypes.c_uint64),
        ("objects", ctypes.c_uint64),
        ("repeated", ctypes.c_uint64),
        ("earlier", ctypes.c_uint64),
        ("damaged", ctypes.c_uint64),
        ("requests", ctypes.c_uint64),
    ]


# What each call returns, and takes.
CALLS = {
    "gicodec_status_text": (ctypes.c_char_p, (ctypes.c_int32,)),
    "gicodec_version": (ctypes.c_uint32, ()),
    "gicodec_version_text": (ctypes.c_char_p, ()),
    "gicodec_ddgi_irradiance": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_ddgi_visibility": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_map_texture": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_format_from_name": (ctypes.c_uint32, (ctypes.c_char_p,)),
    "gicodec_format_name": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_format_count": (ctypes.c_uint32, ()),
    "gicodec_format_at": (ctypes.c_uint32, (ctypes.c_uint32,)),
    "gicodec_texture_desc_check": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_texture_desc_problem": (ctypes.c_char_p, (ctypes.c_void_p,)),
    "gicodec_texture_desc_info": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_texture_desc_complete": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_texture_desc_origin": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_volume_desc_create": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_volume_desc_add_group": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_volume_desc_add_texture": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p,)),
    "gicodec_volume_desc_from_layout": (ctypes.c_int32, (ctypes.c_char_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_photon_volume": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_voxel_volume": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_ao_point_volume": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_irradiance_vector_volume": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_layout_count": (ctypes.c_uint32, ()),
    "gicodec_layout_name": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_layout_summary": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_volume_desc_read": (ctypes.c_int32, (ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_volume_desc_write": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_volume_desc_copy": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_volume_desc_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_volume_desc_check": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_volume_desc_problem": (ctypes.c_char_p, (ctypes.c_void_p,)),
    "gicodec_volume_desc_kind": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_kind_name": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_volume_desc_groups": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_volume_desc_textures": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_volume_desc_group_of": (ctypes.c_uint32, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_volume_desc_texture_name": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_volume_desc_texture": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_volume_desc_json": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_encoder_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_encoder_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_encoder_bound": (ctypes.c_size_t, (ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_encoder_encode": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_encoder_snapshot": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_encoder_request_keyframe": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_encoder_set_preset": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_char_p,)),
    "gicodec_encoder_set_active": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_encoder_set_presence": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_encoder_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_encoder_sequence": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_volume_encoder_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_volume_encoder_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_volume_encoder_encode": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_volume_encoder_snapshot": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_volume_encoder_packets": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_volume_encoder_packet": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_volume_encoder_request_keyframe": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_volume_encoder_set_preset": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_char_p,)),
    "gicodec_volume_encoder_set_active": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_volume_encoder_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_decoder_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_decoder_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_decoder_decode": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_decoder_cancel": (None, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_decoder_set_presence": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_decoder_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_decoder_changed": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_decoder_records": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_decoder_received": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_decoder_sequence": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_decoder_state_hash": (ctypes.c_uint64, (ctypes.c_void_p,)),
    "gicodec_volume_decoder_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_volume_decoder_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_volume_decoder_decode": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_volume_decoder_cancel": (None, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_volume_decoder_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_volume_decoder_changed": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_volume_decoder_records": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_packet_peek": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_backend_name": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_container_create": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_container_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_container_add_volume": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p,)),
    "gicodec_container_set_geometry": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_container_set_largest_error": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_float,)),
    "gicodec_container_add_metadata": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_char_p, ctypes.c_char_p,)),
    "gicodec_container_metadata_count": (ctypes.c_uint32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32,)),
    "gicodec_container_metadata_name": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32,)),
    "gicodec_container_metadata_value": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_container_set_scene": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_uint64,)),
    "gicodec_container_scene": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_container_volumes": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_container_textures": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_container_volume_name": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_container_volume": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_container_geometry": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_container_texture_name": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_container_texture": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_container_largest_error": (ctypes.c_float, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_container_json": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_writer_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_writer_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_writer_add": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint64, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_writer_flush": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_writer_finish": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_writer_bytes": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_writer_take": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_player_open": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_container_version": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_player_open_memory": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_player_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_player_container": (ctypes.c_void_p, (ctypes.c_void_p,)),
    "gicodec_player_select": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_player_select_box": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_player_set_layout": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_player_next": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_player_set_growing": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_player_finished": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_player_seekable": (ctypes.c_uint32, (ctypes.c_void_p,)),
    "gicodec_player_memory": (ctypes.c_uint64, (ctypes.c_void_p,)),
    "gicodec_player_seek": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint64,)),
    "gicodec_player_frame": (ctypes.c_uint64, (ctypes.c_void_p,)),
    "gicodec_player_frames": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_player_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_player_read_changed": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_player_changed": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_client_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_client_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_client_hello": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_client_receive": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_client_message": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_client_cancel": (None, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_client_set_viewpoint": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_client_subscribe": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_client_disconnect": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_client_get_state": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_reason_text": (ctypes.c_char_p, (ctypes.c_uint32,)),
    "gicodec_client_volume": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_client_volume_desc": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_client_volume_name": (ctypes.c_char_p, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_client_geometry": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_client_texels": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_client_changed": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_client_read": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p,)),
    "gicodec_server_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_server_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_server_add_volume": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,)),
    "gicodec_server_remove_volume": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32,)),
    "gicodec_server_publish": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_server_scroll": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int32, ctypes.c_int32, ctypes.c_int32,)),
    "gicodec_server_set_active": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_server_connect": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double, ctypes.c_char_p, ctypes.c_void_p,)),
    "gicodec_server_receive": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double,)),
    "gicodec_server_disconnect": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_double,)),
    "gicodec_server_drop": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32,)),
    "gicodec_server_set_visible": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_server_update": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double, ctypes.c_double,)),
    "gicodec_server_report_update_time": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double, ctypes.c_double,)),
    "gicodec_server_tick": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double,)),
    "gicodec_server_message": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_server_event": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_server_viewpoint": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_server_connection": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p,)),
    "gicodec_track_publisher_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_publisher_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_track_publisher_update": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_double, ctypes.c_double,)),
    "gicodec_track_publisher_message": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_publisher_name": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_publisher_kept_seconds": (ctypes.c_double, (ctypes.c_void_p,)),
    "gicodec_track_publisher_repeat_snapshots": (ctypes.c_int32, (ctypes.c_void_p,)),
    "gicodec_track_receiver_create": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_receiver_destroy": (None, (ctypes.c_void_p,)),
    "gicodec_track_receiver_receive": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_track_receiver_take": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t,)),
    "gicodec_track_receiver_message": (ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_receiver_wanted": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_receiver_requests": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_receiver_name": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,)),
    "gicodec_track_receiver_get_state": (ctypes.c_int32, (ctypes.c_void_p, ctypes.c_void_p,)),
}
# Calls whose result is a status.
FALLIBLE = frozenset((
    "gicodec_ddgi_irradiance",
    "gicodec_ddgi_visibility",
    "gicodec_map_texture",
    "gicodec_texture_desc_check",
    "gicodec_texture_desc_info",
    "gicodec_texture_desc_complete",
    "gicodec_texture_desc_origin",
    "gicodec_volume_desc_create",
    "gicodec_volume_desc_add_group",
    "gicodec_volume_desc_add_texture",
    "gicodec_volume_desc_from_layout",
    "gicodec_photon_volume",
    "gicodec_voxel_volume",
    "gicodec_ao_point_volume",
    "gicodec_irradiance_vector_volume",
    "gicodec_volume_desc_read",
    "gicodec_volume_desc_write",
    "gicodec_volume_desc_copy",
    "gicodec_volume_desc_check",
    "gicodec_volume_desc_texture",
    "gicodec_volume_desc_json",
    "gicodec_encoder_create",
    "gicodec_encoder_encode",
    "gicodec_encoder_snapshot",
    "gicodec_encoder_request_keyframe",
    "gicodec_encoder_set_preset",
    "gicodec_encoder_set_active",
    "gicodec_encoder_set_presence",
    "gicodec_encoder_read",
    "gicodec_volume_encoder_create",
    "gicodec_volume_encoder_encode",
    "gicodec_volume_encoder_snapshot",
    "gicodec_volume_encoder_request_keyframe",
    "gicodec_volume_encoder_set_preset",
    "gicodec_volume_encoder_set_active",
    "gicodec_volume_encoder_read",
    "gicodec_decoder_create",
    "gicodec_decoder_decode",
    "gicodec_decoder_set_presence",
    "gicodec_decoder_read",
    "gicodec_volume_decoder_create",
    "gicodec_volume_decoder_decode",
    "gicodec_volume_decoder_read",
    "gicodec_packet_peek",
    "gicodec_container_create",
    "gicodec_container_add_volume",
    "gicodec_container_set_geometry",
    "gicodec_container_set_largest_error",
    "gicodec_container_add_metadata",
    "gicodec_container_set_scene",
    "gicodec_container_volume",
    "gicodec_container_geometry",
    "gicodec_container_texture",
    "gicodec_container_json",
    "gicodec_writer_create",
    "gicodec_writer_add",
    "gicodec_writer_flush",
    "gicodec_writer_finish",
    "gicodec_writer_take",
    "gicodec_player_open",
    "gicodec_container_version",
    "gicodec_player_open_memory",
    "gicodec_player_select",
    "gicodec_player_select_box",
    "gicodec_player_set_layout",
    "gicodec_player_next",
    "gicodec_player_set_growing",
    "gicodec_player_seek",
    "gicodec_player_frames",
    "gicodec_player_read",
    "gicodec_player_read_changed",
    "gicodec_client_create",
    "gicodec_client_hello",
    "gicodec_client_receive",
    "gicodec_client_set_viewpoint",
    "gicodec_client_subscribe",
    "gicodec_client_disconnect",
    "gicodec_client_get_state",
    "gicodec_client_volume",
    "gicodec_client_volume_desc",
    "gicodec_client_geometry",
    "gicodec_client_changed",
    "gicodec_client_read",
    "gicodec_server_create",
    "gicodec_server_add_volume",
    "gicodec_server_remove_volume",
    "gicodec_server_publish",
    "gicodec_server_scroll",
    "gicodec_server_set_active",
    "gicodec_server_connect",
    "gicodec_server_receive",
    "gicodec_server_disconnect",
    "gicodec_server_drop",
    "gicodec_server_set_visible",
    "gicodec_server_update",
    "gicodec_server_report_update_time",
    "gicodec_server_tick",
    "gicodec_server_event",
    "gicodec_server_viewpoint",
    "gicodec_server_connection",
    "gicodec_track_publisher_create",
    "gicodec_track_publisher_update",
    "gicodec_track_publisher_message",
    "gicodec_track_publisher_name",
    "gicodec_track_publisher_repeat_snapshots",
    "gicodec_track_receiver_create",
    "gicodec_track_receiver_receive",
    "gicodec_track_receiver_take",
    "gicodec_track_receiver_wanted",
    "gicodec_track_receiver_requests",
    "gicodec_track_receiver_name",
    "gicodec_track_receiver_get_state",
))
