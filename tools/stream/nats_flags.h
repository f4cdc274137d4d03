// Flags of programs that use NATS.
#pragma once

#include "common/command_line.h"
#include "transport.h"

#include <string>

namespace gicodec::streaming {

/// Adds "--nats URL[,URL...]", whose help says `what`, and what goes with it, to a group.
void add_nats_flags(tools::Command& app, NatsFlags& flags, const std::string& what,
                    const std::string& group);
/// Throws tools::Error of Exit::usage if other flags of the kind are given without --nats.
void check_nats_flags(const NatsFlags& flags);

}  // namespace gicodec::streaming
