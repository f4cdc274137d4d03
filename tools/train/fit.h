// The reduction of counts to the native codec's tables.
#pragma once

#include "train/histograms.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gicodec::train {

struct HitEnds {
  std::uint16_t end0, end1;
};

/// A few distributions, and the one of each context.
template <typename Member>
struct Family {
  std::array<Member, native::kMembers> member;
  std::array<std::uint8_t, native::kContexts> map;
};

struct Model {
  Family<native::Member> role[native::kRoles][native::kSets];
  Family<HitEnds> hits[2][native::kSets];
};

/// Clusters each subject's histograms to sets and each set's contexts to members. Tells on standard
/// error what all of that takes.
void fit(const std::array<std::vector<Histogram>, kSubjects>& histograms, unsigned threads,
         Model& model);

}  // namespace gicodec::train
