// libgicodec: streams global-illumination data without losing a bit. This header brings in what
// encodes, decodes and stores it; <gicodec/streaming.h> has servers and clients,
// <gicodec/backend.h> is for those who write a backend, and <gicodec/hevc.h> belongs to another
// target.
#pragma once

#include <gicodec/ao_points.h>
#include <gicodec/container.h>
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/engines.h>
#include <gicodec/error_bound.h>
#include <gicodec/inspect.h>
#include <gicodec/io.h>
#include <gicodec/irradiance_maps.h>
#include <gicodec/irradiance_vectors.h>
#include <gicodec/isa.h>
#include <gicodec/kind.h>
#include <gicodec/memory.h>
#include <gicodec/packet.h>
#include <gicodec/photons.h>
#include <gicodec/player.h>
#include <gicodec/probes.h>
#include <gicodec/record.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/textures.h>
#include <gicodec/threads.h>
#include <gicodec/version.h>
#include <gicodec/volume.h>
#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>
#include <gicodec/voxels.h>
