// Made by make_interface.py from include/gicodec/c, for the memory of wasm32.

// Statuses by number.
export const STATUS_NAMES = {
  0: 'ok',
  1: 'end',
  100: 'invalid_argument',
  101: 'invalid_description',
  102: 'view_too_small',
  103: 'block_out_of_range',
  104: 'block_repeated',
  105: 'unsupported_format',
  106: 'unknown_backend',
  107: 'buffer_too_small',
  108: 'unsupported_backend',
  109: 'unsupported_shape',
  110: 'unknown_kind',
  111: 'unknown_volume',
  112: 'unknown_texture',
  113: 'unknown_group',
  114: 'unknown_connection',
  115: 'mask_mismatch',
  116: 'invalid_geometry',
  117: 'invalid_name',
  118: 'invalid_time',
  119: 'invalid_bound',
  120: 'invalid_interval',
  121: 'presence_missing',
  122: 'presence_invalid',
  123: 'unknown_region',
  124: 'unknown_frame',
  125: 'wrong_frame',
  126: 'invalid_settings',
  127: 'out_of_order',
  200: 'out_of_memory',
  201: 'limit_exceeded',
  202: 'cancelled',
  300: 'truncated',
  301: 'corrupt',
  302: 'checksum_mismatch',
  303: 'not_gicodec',
  304: 'unsupported_version',
  305: 'unsupported_feature',
  400: 'description_mismatch',
  401: 'reference_missing',
  402: 'backend_missing',
  500: 'backend_failed',
  501: 'backend_unavailable',
  502: 'io_failed',
};

export const OK = 0;
export const END = 1;
export const INVALID_ARGUMENT = 100;
export const INVALID_DESCRIPTION = 101;
export const VIEW_TOO_SMALL = 102;
export const BLOCK_OUT_OF_RANGE = 103;
export const BLOCK_REPEATED = 104;
export const UNSUPPORTED_FORMAT = 105;
export const UNKNOWN_BACKEND = 106;
export const BUFFER_TOO_SMALL = 107;
export const UNSUPPORTED_BACKEND = 108;
export const UNSUPPORTED_SHAPE = 109;
export const UNKNOWN_KIND = 110;
export const UNKNOWN_VOLUME = 111;
export const UNKNOWN_TEXTURE = 112;
export const UNKNOWN_GROUP = 113;
export const UNKNOWN_CONNECTION = 114;
export const MASK_MISMATCH = 115;
export const INVALID_GEOMETRY = 116;
export const INVALID_NAME = 117;
export const INVALID_TIME = 118;
export const INVALID_BOUND = 119;
export const INVALID_INTERVAL = 120;
export const PRESENCE_MISSING = 121;
export const PRESENCE_INVALID = 122;
export const UNKNOWN_REGION = 123;
export const UNKNOWN_FRAME = 124;
export const WRONG_FRAME = 125;
export const INVALID_SETTINGS = 126;
export const OUT_OF_ORDER = 127;
export const OUT_OF_MEMORY = 200;
export const LIMIT_EXCEEDED = 201;
export const CANCELLED = 202;
export const TRUNCATED = 300;
export const CORRUPT = 301;
export const CHECKSUM_MISMATCH = 302;
export const NOT_GICODEC = 303;
export const UNSUPPORTED_VERSION = 304;
export const UNSUPPORTED_FEATURE = 305;
export const DESCRIPTION_MISMATCH = 400;
export const REFERENCE_MISSING = 401;
export const BACKEND_MISSING = 402;
export const BACKEND_FAILED = 500;
export const BACKEND_UNAVAILABLE = 501;
export const IO_FAILED = 502;
export const SELECT_CHANGED = 0;
export const SELECT_ALL = 1;
export const SELECT_LIST = 2;
export const SPACE_GRID = 0;
export const SPACE_POOL = 1;
export const PRESENCE_ALL = 0;
export const PRESENCE_COUNT = 1;
export const PRESENCE_MASK = 2;
export const PRESENCE_BRICK = 3;
export const MODEL_NONE = 0;
export const MODEL_STACKED = 1;
export const MODEL_CONTINUOUS = 2;
export const MODEL_UNORDERED = 3;
export const MODEL_OCTREE = 4;
export const MODEL_HEMISPHERES = 5;
export const TILING_ATLAS_XY_Z = 0;
export const TILING_ATLAS_XZ_Y = 1;
export const TILING_ATLAS_X_YZ = 2;
export const TILING_SLICES_XZ_Y = 3;
export const TILING_SLICES_XY_Z = 4;
export const TILING_BLOCKS = 5;
export const TILING_ATLAS_YZ_X = 6;
export const TILING_SLICES_YX_Z = 7;
export const COMPONENT_UNORM = 0;
export const COMPONENT_SNORM = 1;
export const COMPONENT_UINT = 2;
export const COMPONENT_UFLOAT = 3;
export const COMPONENT_SFLOAT = 4;
export const COMPONENT_EXPONENT = 5;
export const COMPONENT_OPAQUE = 6;
export const MAX_COMPONENTS = 16;
export const NO_GROUP = 255;
export const GOP_ON_REQUEST = 4294967295;
export const METADATA_CONTAINER = 0;
export const METADATA_VOLUME = 1;
export const METADATA_TEXTURE = 2;
export const DELIVERY_UNICAST = 0;
export const DELIVERY_SHARED = 1;
export const EVENT_JOINED = 0;
export const EVENT_RESUMED = 1;
export const EVENT_VIEWPOINT = 2;
export const EVENT_SUBSCRIBED = 3;
export const EVENT_DROPPED = 4;
export const EVENT_EXPIRED = 5;
export const TRACKS_LIST = 0;
export const TRACKS_OBJECT = 1;
export const TRACKS_TICK = 2;

// Structs: their size, and of each field the offset, DataView's name of its type or
// the struct, and the number of elements.
export const host = {size: 32, fields: {
  structSize: [0, 'Uint32', 1],
  threads: [4, 'Uint32', 1],
  allocate: [8, 'Uint32', 1],
  release: [12, 'Uint32', 1],
  memory: [16, 'Uint32', 1],
  run: [20, 'Uint32', 1],
  executor: [24, 'Uint32', 1],
  isa: [28, 'Uint32', 1],
}};
export const limits = {size: 64, fields: {
  structSize: [0, 'Uint32', 1],
  maxTextures: [4, 'Uint32', 1],
  maxTextureBytes: [8, 'BigUint64', 1],
  maxPacketBytes: [16, 'BigUint64', 1],
  maxTotalBytes: [24, 'BigUint64', 1],
  maxWorkBytes: [32, 'BigUint64', 1],
  maxDescriptionBytes: [40, 'BigUint64', 1],
  maxMetadataBytes: [48, 'BigUint64', 1],
  maxIndexBytes: [56, 'BigUint64', 1],
}};
export const view = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  bytes: [4, 'Uint32', 1],
  size: [8, 'Uint32', 1],
  rowPitch: [12, 'Uint32', 1],
  slicePitch: [16, 'Uint32', 1],
  blockPitch: [20, 'Uint32', 1],
}};
export const constView = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  bytes: [4, 'Uint32', 1],
  size: [8, 'Uint32', 1],
  rowPitch: [12, 'Uint32', 1],
  slicePitch: [16, 'Uint32', 1],
  blockPitch: [20, 'Uint32', 1],
}};
export const component = {size: 12, fields: {
  name: [0, 'Uint8', 8],
  offset: [8, 'Uint16', 1],
  bits: [10, 'Uint8', 1],
  type: [11, 'Uint8', 1],
}};
export const textureDesc = {size: 284, fields: {
  structSize: [0, 'Uint32', 1],
  format: [4, 'Uint32', 1],
  grid: [8, 'Uint32', 3],
  block: [20, 'Uint32', 3],
  guardBand: [32, 'Uint32', 1],
  space: [36, 'Uint32', 1],
  presence: [40, 'Uint32', 1],
  model: [44, 'Uint32', 1],
  records: [48, 'Uint32', 3],
  tiling: [60, 'Uint32', 1],
  padBefore: [64, 'Uint32', 1],
  padAfter: [68, 'Uint32', 1],
  slots: [72, 'Uint32', 3],
  recordBytes: [84, 'Uint32', 1],
  componentCount: [88, 'Uint32', 1],
  components: [92, component, 16],
}};
export const textureInfo = {size: 48, fields: {
  structSize: [0, 'Uint32', 1],
  blocks: [4, 'Uint32', 1],
  textureBytes: [8, 'BigUint64', 1],
  width: [16, 'BigUint64', 1],
  height: [24, 'BigUint64', 1],
  slices: [32, 'BigUint64', 1],
  blockBytes: [40, 'Uint32', 1],
  presenceBytes: [44, 'Uint32', 1],
}};
export const encoderOptions = {size: 56, fields: {
  structSize: [0, 'Uint32', 1],
  gop: [4, 'Uint32', 1],
  backend: [8, 'Uint32', 1],
  preset: [12, 'Uint32', 1],
  level: [16, 'Int32', 1],
  chunk: [20, 'Uint32', 1],
  noDifference: [24, 'Uint32', 1],
  textureId: [28, 'Uint32', 1],
  maxError: [32, 'Float32', 1],
  maxErrorCount: [36, 'Uint32', 1],
  maxErrors: [40, 'Uint32', 1],
  backends: [44, 'Uint32', 1],
  backendCount: [48, 'Uint32', 1],
  host: [52, 'Uint32', 1],
}};
export const decoderOptions = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  textureId: [4, 'Uint32', 1],
  limits: [8, 'Uint32', 1],
  backends: [12, 'Uint32', 1],
  backendCount: [16, 'Uint32', 1],
  host: [20, 'Uint32', 1],
}};
export const packetInfo = {size: 72, fields: {
  structSize: [0, 'Uint32', 1],
  version: [4, 'Uint32', 1],
  type: [8, 'Uint32', 1],
  backend: [12, 'Uint32', 1],
  textureId: [16, 'Uint32', 1],
  lossy: [20, 'Uint32', 1],
  sequence: [24, 'Uint32', 1],
  reference: [28, 'Uint32', 1],
  allBlocks: [32, 'Uint32', 1],
  blocks: [36, 'Uint32', 1],
  headerSize: [40, 'BigUint64', 1],
  indexSize: [48, 'BigUint64', 1],
  guardBandSize: [56, 'BigUint64', 1],
  payloadSize: [64, 'BigUint64', 1],
}};
export const geometry = {size: 52, fields: {
  structSize: [0, 'Uint32', 1],
  grid: [4, 'Uint32', 3],
  origin: [16, 'Float32', 3],
  spacing: [28, 'Float32', 3],
  scroll: [40, 'Int32', 3],
}};
export const sink = {size: 12, fields: {
  structSize: [0, 'Uint32', 1],
  self: [4, 'Uint32', 1],
  write: [8, 'Uint32', 1],
}};
export const range = {size: 16, fields: {
  offset: [0, 'BigUint64', 1],
  size: [8, 'BigUint64', 1],
}};
export const source = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  self: [4, 'Uint32', 1],
  read: [8, 'Uint32', 1],
  seek: [12, 'Uint32', 1],
  size: [16, 'Uint32', 1],
  prefetch: [20, 'Uint32', 1],
}};
export const playerOptions = {size: 20, fields: {
  structSize: [0, 'Uint32', 1],
  limits: [4, 'Uint32', 1],
  backends: [8, 'Uint32', 1],
  backendCount: [12, 'Uint32', 1],
  host: [16, 'Uint32', 1],
}};
export const clientOptions = {size: 48, fields: {
  structSize: [0, 'Uint32', 1],
  delivery: [4, 'Uint32', 1],
  budgetBlocks: [8, 'Uint32', 1],
  noTexels: [12, 'Uint32', 1],
  budgetBytes: [16, 'BigUint64', 1],
  token: [24, 'Uint32', 1],
  limits: [28, 'Uint32', 1],
  backends: [32, 'Uint32', 1],
  backendCount: [36, 'Uint32', 1],
  host: [40, 'Uint32', 1],
}};
export const viewpoint = {size: 52, fields: {
  structSize: [0, 'Uint32', 1],
  eye: [4, 'Float32', 3],
  target: [16, 'Float32', 3],
  up: [28, 'Float32', 3],
  fovY: [40, 'Float32', 1],
  aspect: [44, 'Float32', 1],
  time: [48, 'Float32', 1],
}};
export const clientState = {size: 96, fields: {
  structSize: [0, 'Uint32', 1],
  connected: [4, 'Uint32', 1],
  resumed: [8, 'Uint32', 1],
  consistent: [12, 'Uint32', 1],
  epoch: [16, 'BigUint64', 1],
  serial: [24, 'BigUint64', 1],
  update: [32, 'BigUint64', 1],
  time: [40, 'Float64', 1],
  volumes: [48, 'Uint32', 1],
  reason: [52, 'Uint32', 1],
  messages: [56, 'BigUint64', 1],
  bytes: [64, 'BigUint64', 1],
  packets: [72, 'BigUint64', 1],
  blocks: [80, 'BigUint64', 1],
  gaps: [88, 'BigUint64', 1],
}};
export const serverOptions = {size: 184, fields: {
  structSize: [0, 'Uint32', 1],
  level: [4, 'Int32', 1],
  backend: [8, 'Uint32', 1],
  preset: [12, 'Uint32', 1],
  token: [16, 'Uint32', 1],
  scene: [20, 'Uint32', 1],
  sceneGeometry: [24, 'BigUint64', 1],
  epoch: [32, 'BigUint64', 1],
  region: [40, 'Uint32', 3],
  proofs: [52, 'Uint32', 1],
  interval: [56, 'Float64', 1],
  firstUpdateBytes: [64, 'BigUint64', 1],
  maxClients: [72, 'Uint32', 1],
  maxConnections: [76, 'Uint32', 1],
  maxWaiting: [80, 'Uint32', 1],
  maxUnicast: [84, 'Uint32', 1],
  maxUnicastPerOrigin: [88, 'Uint32', 1],
  maxInFlight: [92, 'Uint32', 1],
  maxInFlightBytes: [96, 'BigUint64', 1],
  maxMessageBytes: [104, 'BigUint64', 1],
  maxBytesPerSecond: [112, 'BigUint64', 1],
  maxTotalBytesPerSecond: [120, 'BigUint64', 1],
  messagesPerSecond: [128, 'Float64', 1],
  resyncsPerSecond: [136, 'Float64', 1],
  helloTimeout: [144, 'Float64', 1],
  stallTimeout: [152, 'Float64', 1],
  lingerTimeout: [160, 'Float64', 1],
  backends: [168, 'Uint32', 1],
  backendCount: [172, 'Uint32', 1],
  host: [176, 'Uint32', 1],
}};
export const streamedTexture = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  texture: [4, 'Uint32', 1],
  interval: [8, 'Uint32', 1],
  threshold: [12, 'Float32', 1],
  maxError: [16, 'Float32', 1],
  sourceError: [20, 'Float32', 1],
}};
export const event = {size: 20, fields: {
  structSize: [0, 'Uint32', 1],
  type: [4, 'Uint32', 1],
  connection: [8, 'Uint32', 1],
  client: [12, 'Uint32', 1],
  reason: [16, 'Uint32', 1],
}};
export const connectionState = {size: 88, fields: {
  structSize: [0, 'Uint32', 1],
  client: [4, 'Uint32', 1],
  delivery: [8, 'Uint32', 1],
  inFlight: [12, 'Uint32', 1],
  inFlightBytes: [16, 'BigUint64', 1],
  updates: [24, 'BigUint64', 1],
  bytes: [32, 'BigUint64', 1],
  blocks: [40, 'BigUint64', 1],
  skipped: [48, 'BigUint64', 1],
  updateBytes: [56, 'BigUint64', 1],
  memory: [64, 'BigUint64', 1],
  resyncs: [72, 'Uint32', 1],
  lagging: [76, 'Uint32', 1],
  pending: [80, 'Uint32', 1],
  oldestPending: [84, 'Uint32', 1],
}};
export const track = {size: 12, fields: {
  volume: [0, 'Uint32', 1],
  texture: [4, 'Uint32', 1],
  region: [8, 'Uint32', 1],
}};
export const trackName = {size: 24, fields: {
  structSize: [0, 'Uint32', 1],
  volume: [4, 'Uint32', 1],
  texture: [8, 'Uint32', 1],
  place: [12, 'Uint32', 3],
}};
export const trackPublisherOptions = {size: 32, fields: {
  structSize: [0, 'Uint32', 1],
  snapshotSeconds: [8, 'Float64', 1],
  snapshotShare: [16, 'Float64', 1],
  host: [24, 'Uint32', 1],
}};
export const trackMessage = {size: 32, fields: {
  structSize: [0, 'Uint32', 1],
  type: [4, 'Uint32', 1],
  track: [8, track, 1],
  number: [20, 'Uint32', 1],
  bytes: [24, 'Uint32', 1],
  size: [28, 'Uint32', 1],
}};
export const trackReceiverOptions = {size: 32, fields: {
  structSize: [0, 'Uint32', 1],
  reach: [4, 'Float32', 1],
  subscribedOnly: [8, 'Uint32', 1],
  maxTracks: [12, 'Uint32', 1],
  maxWaitingBytes: [16, 'BigUint64', 1],
  host: [24, 'Uint32', 1],
}};
export const trackObject = {size: 16, fields: {
  track: [0, track, 1],
  number: [12, 'Uint32', 1],
}};
export const trackReceiverState = {size: 72, fields: {
  structSize: [0, 'Uint32', 1],
  wantsHello: [4, 'Uint32', 1],
  complete: [8, 'Uint32', 1],
  wantedChanges: [16, 'BigUint64', 1],
  ticks: [24, 'BigUint64', 1],
  objects: [32, 'BigUint64', 1],
  repeated: [40, 'BigUint64', 1],
  earlier: [48, 'BigUint64', 1],
  damaged: [56, 'BigUint64', 1],
  requests: [64, 'BigUint64', 1],
}};
