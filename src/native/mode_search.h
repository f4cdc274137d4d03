// An encoder's choice of modes.
#pragma once

#include "native/tables.h"
#include "native/workspace.h"

namespace gicodec::native {

/// Fills the group's modes and reference lanes by an estimate of what each mode costs.
void choose_modes(const Update& u, std::size_t g, Group& group, Workspace& w);
/// Fills the reference lanes for the modes the group has.
void load_modes(const Update& u, std::size_t g, const Group& group, Workspace& w);
/// As choose_modes(), by the exact cost under `tables`: about sixteen times the work.
void choose_modes_exactly(const Update& u, std::size_t g, const Tables& tables, Group& group,
                          Workspace& w);

}  // namespace gicodec::native
