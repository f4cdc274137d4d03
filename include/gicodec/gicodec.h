// libgicodec: streams global-illumination textures without losing a bit. This header brings in all
// of the core library; <gicodec/hevc.h> is separate because it belongs to another target.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/client.h>
#include <gicodec/container.h>
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/host.h>
#include <gicodec/isa.h>
#include <gicodec/packet.h>
#include <gicodec/protocol.h>
#include <gicodec/server.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/version.h>
#include <gicodec/volume.h>
