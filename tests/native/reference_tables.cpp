#include "native/reference_tables.h"

#include <fstream>
#include <numeric>
#include <stdexcept>

namespace gicodec::reference {
namespace {

constexpr std::size_t kRoles = 11, kSets = 8, kModes = 10;

class Published {
 public:
  Published() : in_(GICODEC_TABLES_FILE) {
    for (auto& role : families_) {
      for (auto& family : role) read(family);
    }
    for (auto& kind : hits_) {
      for (auto& family : kind) read(family);
    }
    demand(in_ && (in_ >> std::ws).eof());
  }
  [[nodiscard]] const Family& family(std::size_t role, unsigned set) const {
    return families_[role][set];
  }
  [[nodiscard]] const HitFamily& hits(bool update, unsigned set) const {
    return hits_[update ? 1 : 0][set];
  }

 private:
  static void demand(bool holds) {
    if (!holds) throw std::runtime_error(GICODEC_TABLES_FILE " is not as docs/native.md says");
  }
  unsigned number(unsigned most) {
    unsigned value = 0;
    char comma = 0;
    in_ >> value >> comma;
    demand(in_ && comma == ',' && value <= most);
    return value;
  }
  void read(Family& family) {
    for (auto& m : family.members) {
      m.k = number(4);
      m.h = number(7);
      for (auto& units : m.units) units = number(255);
      demand(std::accumulate(m.units.begin(), m.units.end(), 0U) <= 255);
    }
    for (auto& member : family.map) member = number(15);
  }
  void read(HitFamily& hits) {
    for (auto& m : hits.members) {
      m.end0 = number(4096);
      m.end1 = number(4096);
      demand(m.end0 < m.end1);
    }
    for (auto& member : hits.map) member = number(15);
  }

  std::ifstream in_;
  Family families_[kRoles][kSets];
  HitFamily hits_[2][kSets];
};

}  // namespace

Tables tables_of(const Sets& sets, bool pairs, bool update) {
  static const Published published;
  const std::size_t u = update ? 1 : 0;
  Tables t;
  t.modes = published.family(kModes, sets[3]);
  if (pairs) {
    for (std::size_t p = 0; p < 2; ++p) t.planes[p] = published.family(6 + 2 * u + p, sets[p]);
    t.hits = published.hits(update, sets[2]);
  } else {
    for (std::size_t p = 0; p < 3; ++p) t.planes[p] = published.family(3 * u + p, sets[p]);
  }
  return t;
}

bool read_sets(Bytes& in, Sets& sets) {
  for (std::size_t i = 0; i < 4; i += 2) {
    const unsigned byte = in.u8();
    sets[i] = byte & 15;
    sets[i + 1] = byte >> 4;
    if (sets[i] >= kSets || sets[i + 1] >= kSets) return false;
  }
  return !in.failed();
}

bool read_hits(Bytes& in, HitFamily& hits) {
  const unsigned members = in.u8();
  if (members < 1 || members > 16) return false;
  for (unsigned m = 0; m < members; ++m) {
    const unsigned end0 = in.u16(), end1 = in.u16();
    if (end0 < 1 || end0 >= end1 || end1 > 4095) return false;
    hits.members[m] = {end0, end1};
  }
  for (std::size_t i = 0; i < 64; i += 2) {
    const unsigned byte = in.u8();
    hits.map[i] = byte & 15;
    hits.map[i + 1] = byte >> 4;
    if (hits.map[i] >= members || hits.map[i + 1] >= members) return false;
  }
  return !in.failed();
}

bool read_overrides(Bytes& in, Family& family) {
  const unsigned members = in.u8();
  if (members > 16) return false;
  for (unsigned i = 0, next = 0; i < members; ++i) {
    const unsigned number = in.u8(), shape = in.u16();
    if (number < next || number >= 16 || shape >> 10 != 0) return false;
    next = number + 1;
    Member m{shape >> 3 & 7, shape & 7, {}};
    const unsigned n = shape >> 6;
    if (m.k > 4 || n > 14) return false;
    for (unsigned s = 0; s < n; ++s) m.units[s] = in.u8();
    m.units[14] = in.u8();
    if (m.units[14] < 1 || std::accumulate(m.units.begin(), m.units.end(), 0U) > 255) return false;
    family.members[number] = m;
  }
  const unsigned contexts = in.u16();
  if (contexts > 256) return false;
  for (unsigned i = 0, next = 0; i < contexts; ++i) {
    const unsigned context = in.u8(), member = in.u8();
    if (context < next || member >= 16) return false;
    next = context + 1;
    family.map[context] = member;
  }
  return !in.failed();
}

}  // namespace gicodec::reference
