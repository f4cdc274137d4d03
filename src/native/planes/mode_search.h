// An encoder's choice of modes.
#pragma once

#include "native/frame/workspace.h"
#include "native/planes/tables.h"

#include <array>

namespace gicodec::native {

/// In 1/16 bits; 65535 for modes not to be tried.
struct Estimates {
  alignas(64) std::uint16_t cost[kModes][kLanes];
};

/// Fills the group's modes and reference lanes by an estimate of what each mode costs, from some
/// rows of its blocks; `estimates`, if given, is for the two kinds of modes a group may have.
/// Precondition: the current values are in lanes.
void choose_modes(const Update& u, std::size_t g, Group& group, Workspace& w,
                  Estimates* estimates = nullptr);
/// Fills the reference lanes for the modes the group has.
void load_modes(const Update& u, std::size_t g, const Group& group, Workspace& w);
/// As choose_modes(), by the exact cost under `tables` of the modes with the best estimates.
void choose_modes_exactly(const Update& u, std::size_t g, const Tables& tables, Group& group,
                          Workspace& w);

}  // namespace gicodec::native
