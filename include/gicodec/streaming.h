// Streaming servers and clients, with all of <gicodec/gicodec.h>.
#pragma once

#include <gicodec/client.h>
#include <gicodec/delivery.h>
#include <gicodec/gicodec.h>
#include <gicodec/protocol.h>
#include <gicodec/recorder.h>
#include <gicodec/server.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>
#include <gicodec/upload.h>
