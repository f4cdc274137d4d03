// The C interface of libgicodec, all of it but <gicodec/c/hevc.h>.
#ifndef GICODEC_C_GICODEC_H
#define GICODEC_C_GICODEC_H

#include <gicodec/c/base.h>
#include <gicodec/c/client.h>
#include <gicodec/c/container.h>
#include <gicodec/c/decoder.h>
#include <gicodec/c/description.h>
#include <gicodec/c/encoder.h>
#include <gicodec/c/server.h>
#include <gicodec/c/tracks.h>

#endif
