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
    for (auto& role : tables_) {
      for (auto& tables : role) read(tables);
    }
    for (auto& kind : repeats_) {
      for (auto& tables : kind) read(tables);
    }
    demand(in_ && (in_ >> std::ws).eof());
  }
  [[nodiscard]] const DistributionTables& tables(std::size_t role, unsigned set) const {
    return tables_[role][set];
  }
  [[nodiscard]] const RepeatTables& repeats(bool update, unsigned set) const {
    return repeats_[update ? 1 : 0][set];
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
  void read(DistributionTables& tables) {
    for (auto& m : tables.distributions) {
      m.k = number(4);
      m.h = number(7);
      for (auto& units : m.units) units = number(255);
      demand(std::accumulate(m.units.begin(), m.units.end(), 0U) <= 255);
    }
    for (auto& distribution : tables.map) distribution = number(15);
  }
  void read(RepeatTables& repeats) {
    for (auto& m : repeats.distributions) {
      m.end0 = number(4096);
      m.end1 = number(4096);
      demand(m.end0 < m.end1);
    }
    for (auto& distribution : repeats.map) distribution = number(15);
  }

  std::ifstream in_;
  DistributionTables tables_[kRoles][kSets];
  RepeatTables repeats_[2][kSets];
};

}  // namespace

Tables tables_of(const Sets& sets, bool pairs, bool update) {
  static const Published published;
  const std::size_t u = update ? 1 : 0;
  Tables t;
  t.modes = published.tables(kModes, sets[3]);
  if (pairs) {
    for (std::size_t p = 0; p < 2; ++p) t.planes[p] = published.tables(6 + 2 * u + p, sets[p]);
    t.repeats = published.repeats(update, sets[2]);
  } else {
    for (std::size_t p = 0; p < 3; ++p) t.planes[p] = published.tables(3 * u + p, sets[p]);
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

unsigned read_repeats(Bytes& in, std::array<RepeatDistribution, 16>& distributions) {
  const unsigned count = in.u8();
  if (count > 16) return 0;
  for (unsigned m = 0; m < count; ++m) {
    const unsigned end0 = in.u16(), end1 = in.u16();
    if (end0 < 1 || end0 >= end1 || end1 > 4095) return 0;
    distributions[m] = {end0, end1};
  }
  return count;
}

bool read_repeat_tables(Bytes& in, RepeatTables& repeats) {
  const unsigned distributions = read_repeats(in, repeats.distributions);
  if (distributions == 0) return false;
  for (std::size_t i = 0; i < 64; i += 2) {
    const unsigned byte = in.u8();
    repeats.map[i] = byte & 15;
    repeats.map[i + 1] = byte >> 4;
    if (repeats.map[i] >= distributions || repeats.map[i + 1] >= distributions) return false;
  }
  return !in.failed();
}

bool read_distribution(Bytes& in, Distribution& m) {
  const unsigned shape = in.u16(), n = shape >> 6;
  m = {shape >> 3 & 7, shape & 7, {}};
  if (m.k > 4 || n > 14) return false;
  for (unsigned s = 0; s < n; ++s) m.units[s] = in.u8();
  m.units[14] = in.u8();
  return m.units[14] >= 1 && std::accumulate(m.units.begin(), m.units.end(), 0U) <= 255;
}

bool read_overrides(Bytes& in, DistributionTables& tables) {
  const unsigned distributions = in.u8();
  if (distributions > 16) return false;
  for (unsigned i = 0, next = 0; i < distributions; ++i) {
    const unsigned number = in.u8();
    if (number < next || number >= 16) return false;
    next = number + 1;
    if (!read_distribution(in, tables.distributions[number])) return false;
  }
  const unsigned contexts = in.u16();
  if (contexts > 256) return false;
  for (unsigned i = 0, next = 0; i < contexts; ++i) {
    const unsigned context = in.u8(), distribution = in.u8();
    if (context < next || distribution >= 16) return false;
    next = context + 1;
    tables.map[context] = distribution;
  }
  return !in.failed();
}

}  // namespace gicodec::reference
