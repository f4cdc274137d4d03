// Filling what has not arrived: push-pull in three dimensions (Pacanowski et al. §4.1).
#pragma once

#include "vector_field.h"

namespace gicodec::vectors {

/// Gives every vertex that is not known a value from those that are; these stay as they are, bit
/// for bit. `smooth`: what was filled in is filtered at each level. Nothing happens where none is
/// known; else all are afterwards.
void push_pull(VectorField& field, bool smooth);

}  // namespace gicodec::vectors
