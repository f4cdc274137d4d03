// libgicodec streams global-illumination data without losing a bit. This header has probes, and all
// that encodes, decodes and stores volumes. Other kinds (e.g. <gicodec/voxels.h>) and engines
// (<gicodec/engines.h>) have headers of their own. <gicodec/streaming.h> adds servers and clients,
// <gicodec/backend.h> the interface of backends, and <gicodec/hevc.h> belongs to the target
// gicodec::hevc.
#pragma once

#include <gicodec/container.h>
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/error_bound.h>
#include <gicodec/inspect.h>
#include <gicodec/io.h>
#include <gicodec/isa.h>
#include <gicodec/kind.h>
#include <gicodec/memory.h>
#include <gicodec/packet.h>
#include <gicodec/player.h>
#include <gicodec/probes.h>
#include <gicodec/record.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/threads.h>
#include <gicodec/version.h>
#include <gicodec/volume.h>
#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>
