#include "native/reference_decoder.h"

#include "native/reference_adaptive.h"
#include "native/reference_entropy.h"
#include "native/reference_model.h"
#include "native/reference_packing.h"
#include "native/reference_tokens.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

namespace gicodec::reference {
namespace {

class Decoder {
 public:
  Decoder(const TextureDesc& desc, std::span<const std::uint32_t> blocks,
          std::span<const std::byte> mirror, std::span<const std::uint8_t> received,
          std::span<const std::byte> presence, bool intra, std::span<const std::byte> held_presence)
      : desc_(desc),
        planes_(desc),
        blocks_(blocks),
        mirror_(mirror),
        received_(received),
        presence_(presence),
        intra_(intra),
        held_presence_(held_presence),
        records_(std::size_t{desc.block.x} * desc.block.y * desc.block.z),
        block_bytes_(records_ * desc.record.bytes) {}

  std::optional<std::vector<std::byte>> payload(std::span<const std::byte> bytes) {
    Bytes in(bytes);
    const unsigned head = in.u8(), parts = head >> 4;
    if (in.failed() || (head & 15) != 3 || (parts & 9) == 9) return {};
    if ((parts & 8) != 0) {
      choose_box(1U << 20);
    } else if ((parts & 1) == 0) {
      choose_box();
    } else if (!read_box(in)) {
      return {};
    }
    if ((parts & 4) != 0 && !planes_.read_steps(in)) return {};
    std::map<std::array<std::uint32_t, 3>, std::vector<std::uint32_t>> chunks;  // by z, y, x
    for (const auto block : blocks_) {
      const auto c = coordinates(block);
      chunks[{c[2] / box_[2], c[1] / box_[1], c[0] / box_[0]}].push_back(block);
    }
    std::vector<std::size_t> ends(std::min<std::size_t>(chunks.size(), 1), bytes.size());
    if ((parts & 2) != 0) {
      if (chunks.size() < 2 || in.u32() != chunks.size()) return {};
      ends.assign(chunks.size(), 0);
      for (auto& end : ends) end = in.u32();
    }
    std::size_t at = bytes.size() - in.left();
    if (in.failed() || ends.size() != chunks.size()) return {};
    for (std::size_t i = 0; const auto& [where, blocks] : chunks) {
      const std::size_t begin = (parts & 2) != 0 ? (at + 3) / 4 * 4 : at, end = ends[i++];
      if (begin >= end || end > bytes.size()) return {};
      for (; at < begin; ++at) {
        if (bytes[at] != std::byte{0}) return {};
      }
      if (!chunk(blocks, bytes.subspan(begin, end - begin))) return {};
      at = end;
    }
    if (at != bytes.size()) return {};
    std::vector<std::byte> out;
    for (const auto block : blocks_) {
      const auto raw = raw_.find(block);
      const auto records = raw != raw_.end() ? raw->second : planes_.pack(done_.at(block));
      out.insert(out.end(), records.begin(), records.end());
    }
    return out;
  }

 private:
  [[nodiscard]] bool pairs() const { return planes_.pairs(); }
  [[nodiscard]] bool has_neighbours() const {
    return desc_.model == Model::stacked || desc_.model == Model::continuous ||
           desc_.model == Model::hemispheres;
  }
  [[nodiscard]] bool update() const { return !mirror_.empty() && !intra_; }
  [[nodiscard]] std::array<std::uint32_t, 3> coordinates(std::uint32_t block) const {
    return {block % desc_.grid.x, block / desc_.grid.x % desc_.grid.y,
            block / desc_.grid.x / desc_.grid.y};
  }

  bool read_box(Bytes& in) {
    const std::uint32_t grid[3] = {desc_.grid.x, desc_.grid.y, desc_.grid.z};
    std::uint64_t volume = 1;
    for (unsigned a = 0; a < 3; ++a) {
      box_[a] = in.u16();
      if (box_[a] < 1 || box_[a] > grid[a]) return false;
      volume *= box_[a];
    }
    return volume <= 1U << 20 && in.u16() == 0 && !in.failed();
  }
  void choose_box() {
    const auto volume = [&] { return std::uint64_t{box_[0]} * box_[1] * box_[2]; };
    std::ranges::copy(std::array{desc_.grid.x, desc_.grid.y, desc_.grid.z}, box_.begin());
    const std::uint64_t most = std::clamp<std::uint64_t>(volume() / 2, 1024, 2048);
    const std::uint64_t values = records_ * planes_.size();
    choose_box(std::min(most, std::max<std::uint64_t>((1U << 20) / values, 64)));
  }
  void choose_box(std::uint64_t n) {
    const auto volume = [&] { return std::uint64_t{box_[0]} * box_[1] * box_[2]; };
    std::ranges::copy(std::array{desc_.grid.x, desc_.grid.y, desc_.grid.z}, box_.begin());
    while (volume() > n) {
      unsigned longest = 2;
      for (const unsigned axis : {0U, 1U}) {
        if (box_[axis] > box_[longest]) longest = axis;
      }
      box_[longest] = (box_[longest] + 1) / 2;
    }
  }

  [[nodiscard]] std::size_t presence_bytes() const {
    return desc_.presence == Presence::count  ? 2
           : desc_.presence == Presence::mask ? (records_ + 7) / 8
                                              : 8 + (records_ / 6 + 7) / 8;
  }
  /// The presence of a block of the update.
  [[nodiscard]] std::span<const std::byte> presence_of(std::uint32_t block) const {
    const auto place =
        static_cast<std::size_t>(std::ranges::lower_bound(blocks_, block) - blocks_.begin());
    return presence_.subspan(place * presence_bytes(), presence_bytes());
  }
  /// Which records of a block of the update exist.
  [[nodiscard]] std::vector<bool> exists(std::uint32_t block) const {
    std::vector<bool> all(records_, true);
    if (desc_.presence == Presence::all) return all;
    const bool counted = desc_.presence == Presence::count;
    const auto presence = presence_of(block);
    const std::byte* const said = presence.data();
    if (desc_.presence == Presence::brick) {
      for (unsigned r = 0; r < records_; ++r) all[r] = bits_at(said + 8, r / 6, 1) != 0;
      return all;
    }
    const unsigned count = counted ? bits_at(said, 0, 16) : 0;
    for (unsigned r = 0; r < records_; ++r) all[r] = counted ? r < count : bits_at(said, r, 1) != 0;
    return all;
  }

  /// The block at −1 along an axis, if it lies in the same box.
  std::optional<std::uint32_t> neighbour(std::uint32_t block, unsigned axis) const {
    const std::uint32_t step[3] = {1, desc_.grid.x, desc_.grid.x * desc_.grid.y};
    if (!has_neighbours() || coordinates(block)[axis] % box_[axis] == 0) return {};
    return block - step[axis];
  }

  Surroundings surroundings(std::uint32_t block, const std::vector<std::uint32_t>& blocks,
                            bool flat) const {
    Surroundings s;
    s.exists = exists(block);
    if (update()) s.previous = planes_.unpack(mirror_.data() + block * block_bytes_);
    if (flat && !pairs()) return s;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const auto n = neighbour(block, axis);
      if (!n) continue;
      const bool listed = std::ranges::binary_search(blocks, *n), coded = listed && !flat;
      const bool held = !mirror_.empty() && received_[*n] != 0 && !(intra_ && listed);
      if (!coded && !held) continue;
      s.now[axis] = coded ? done_.at(*n) : planes_.unpack(mirror_.data() + *n * block_bytes_);
      if (update()) s.before[axis] = planes_.unpack(mirror_.data() + *n * block_bytes_);
    }
    return s;
  }

  bool chunk(const std::vector<std::uint32_t>& blocks, std::span<const std::byte> bytes) {
    Bytes in(bytes);
    const unsigned first = in.u8();
    if (in.failed()) return false;
    if (first == 0) {
      for (const auto block : blocks) {
        std::vector<std::byte> records(block_bytes_);
        const auto there = exists(block);
        for (std::size_t r = 0; r < records_; ++r) {
          if (!there[r]) continue;
          const auto raw = in.take(desc_.record.bytes);
          if (in.failed()) return false;
          std::ranges::copy(raw, records.begin() + static_cast<std::ptrdiff_t>(r * raw.size()));
        }
        raw_[block] = std::move(records);
      }
      return in.at_end();
    }
    if ((first & 3) == 2 && first < 12) return adaptive_chunk(blocks, first, in.take(in.left()));
    if ((first & 3) == 3) return token_chunk(blocks, first, in);
    if ((first & 3) != 1 || (first >> 2 & 7) > 5) return false;
    if (std::uint64_t{box_[0]} * box_[1] * box_[2] > 4096) return false;
    std::size_t raw = 0;
    for (const auto block : blocks) {
      raw += static_cast<std::size_t>(std::ranges::count(exists(block), true)) * desc_.record.bytes;
    }
    if (bytes.size() > raw + 8 * blocks.size() + 80) return false;
    const unsigned lanes = 1U << (first >> 2 & 7);
    if (lanes != 32 && blocks.size() >= std::size_t{16} * lanes) return false;
    const bool flat = (first & 64) != 0;
    if (!flat && !has_neighbours()) return false;
    Head head;
    head.update = update();
    head.columns = desc_.block.x;
    head.rows = static_cast<unsigned>(records_ / desc_.block.x);
    head.mantissas = desc_.record.format == Format::E5B9G9R9_UFLOAT_PACK32;
    for (const auto& plane : planes_.all()) {
      head.bits.push_back(plane.bits);
      head.low.push_back(plane.low);
    }
    if (!read_head(in, first, head)) return false;
    Lanes coder(in, lanes);
    if (in.failed() || !coder.valid()) return false;

    std::vector<std::uint32_t> order = blocks;
    if (!flat) {
      std::ranges::stable_sort(order, {}, [&](std::uint32_t block) {
        const auto c = coordinates(block);
        return c[0] % box_[0] + c[1] % box_[1] + c[2] % box_[2];
      });
    }
    std::size_t next = 0;
    while (next < order.size()) {
      std::vector<std::uint32_t> group;
      while (next < order.size() && group.size() < lanes &&
             (flat || !touches(order[next], group))) {
        group.push_back(order[next++]);
      }
      std::vector<Surroundings> around;
      for (const auto block : group) around.push_back(surroundings(block, blocks, flat));
      const auto values =
          pairs() ? decode_pairs(head, around, coder) : decode_planes(head, around, coder);
      if (!values) return false;
      for (std::size_t l = 0; l < group.size(); ++l) done_[group[l]] = (*values)[l];
    }
    return coder.finished();
  }

  bool adaptive_chunk(const std::vector<std::uint32_t>& blocks, unsigned first,
                      std::span<const std::byte> stream) {
    std::vector<AdaptiveBlock> all;
    for (const auto block : blocks) {
      AdaptiveBlock one{exists(block), {}, coordinates(block)};
      const auto copy = [block](std::span<const std::byte> from, std::size_t size) {
        return std::vector(from.data() + block * size, from.data() + (block + 1) * size);
      };
      if (update()) one.previous = copy(mirror_, block_bytes_);
      if (desc_.presence == Presence::brick) {
        const auto said = presence_of(block);
        one.presence.assign(said.begin(), said.end());
        if (update() && !held_presence_.empty() && received_[block] != 0)
          one.previous_presence = copy(held_presence_, presence_bytes());
      }
      all.push_back(std::move(one));
    }
    const auto held = held_around(blocks);
    auto records = first == 6    ? decode_rows(desc_, box_, all, held, stream)
                   : first == 10 ? decode_matches(desc_, all, stream)
                                 : decode_adaptive(desc_, box_, all, held, held_bricks(), stream);
    if (!records) return false;
    for (std::size_t i = 0; i < blocks.size(); ++i) raw_[blocks[i]] = std::move((*records)[i]);
    return true;
  }

  bool token_chunk(const std::vector<std::uint32_t>& blocks, unsigned first, Bytes& in) {
    if (desc_.presence != Presence::all || desc_.model == Model::unordered) return false;
    if (std::uint64_t{box_[0]} * box_[1] * box_[2] > 4096) return false;
    if (update() && (first & 4) != 0) return false;
    const RecordPlanes planes(desc_);  // without steps
    const Values zeros = planes.unpack(std::vector<std::byte>(block_bytes_).data());
    std::map<std::uint32_t, Values> done;
    const auto around = [&](std::uint32_t block) {
      TokenAround a{zeros, {zeros, zeros, zeros}};
      if (update()) a.reference = planes.unpack(mirror_.data() + block * block_bytes_);
      constexpr std::array<unsigned, 3> kXZY{0, 2, 1};
      std::array<std::optional<std::uint32_t>, 3> beside;
      for (unsigned i = 0; i < 3; ++i) {
        const auto n = beside[i] = neighbour(block, kXZY[i]);
        if (n && done.contains(*n)) {
          a.copies[i] = done.at(*n);
        } else if (n && !mirror_.empty() && received_[*n] != 0) {
          a.copies[i] = planes.unpack(mirror_.data() + *n * block_bytes_);
        }
      }
      const auto known = [&](unsigned i) { return beside[i] && done.contains(*beside[i]); };
      for (const unsigned i : {0U, 2U, 1U})
        if ((first & 4) != 0 && known(i)) a.reference = done.at(*beside[i]);
      if (known(2)) a.above = std::distance(done.begin(), done.find(*beside[2]));
      return a;
    };
    TokenReader reader(planes, desc_.block, records_, blocks.size());
    if (!reader.read(first, in)) return false;
    for (const auto block : blocks) {
      done[block] = reader.next(around(block));
      raw_[block] = planes.pack(done[block]);
    }
    return reader.finished();
  }

  /// The received blocks of the chunk's box that are not in the update.
  HeldBlocks held_around(const std::vector<std::uint32_t>& blocks) const {
    HeldBlocks held;
    if (mirror_.empty() || desc_.model < Model::continuous) return held;
    const auto box_of = [&](std::uint32_t block) {
      auto at = coordinates(block);
      for (unsigned axis = 0; axis < 3; ++axis) at[axis] /= box_[axis];
      return at;
    };
    for (std::uint32_t block = 0; block < received_.size(); ++block) {
      if (received_[block] == 0 || box_of(block) != box_of(blocks[0]) ||
          std::ranges::binary_search(blocks, block)) {
        continue;
      }
      const auto records = mirror_.subspan(block * block_bytes_, block_bytes_);
      held[coordinates(block)].assign(records.begin(), records.end());
    }
    return held;
  }

  /// The received blocks that are not in the update.
  std::vector<HeldBrick> held_bricks() const {
    std::vector<HeldBrick> held;
    if (mirror_.empty() || held_presence_.empty()) return held;
    for (std::uint32_t block = 0; block < received_.size(); ++block) {
      if (received_[block] == 0 || std::ranges::binary_search(blocks_, block)) continue;
      const auto said = held_presence_.subspan(block * presence_bytes(), presence_bytes());
      const auto records = mirror_.subspan(block * block_bytes_, block_bytes_);
      held.push_back({{said.begin(), said.end()}, {records.begin(), records.end()}});
    }
    return held;
  }

  bool touches(std::uint32_t block, const std::vector<std::uint32_t>& group) const {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const auto n = neighbour(block, axis);
      if (n && std::ranges::find(group, *n) != group.end()) return true;
    }
    return false;
  }

  bool read_head(Bytes& in, unsigned first, Head& head) const {
    const bool repeats_follow = (first & 128) != 0, overrides_follow = (first & 32) != 0;
    Sets sets;
    head.repeats = repeats_follow && !pairs();
    const bool partial = desc_.presence != Presence::all;
    if (!read_sets(in, sets) || (head.repeats && ((first & 64) != 0 || partial || head.mantissas)))
      return false;
    std::array<bool, 4> used = {};
    if (pairs()) {
      for (auto& frequent : head.frequent) frequent = static_cast<int>(in.u16());
      used = {true, true, !repeats_follow, update()};
    } else {
      used[3] = true;
      std::uint64_t coded = 0;
      for (std::size_t p = 0; p < planes_.size(); p += 8) coded |= std::uint64_t{in.u8()} << p;
      if (coded >> planes_.size() != 0) return false;
      for (std::size_t p = 0; p < planes_.size(); ++p) {
        head.coded.push_back((coded >> p & 1) != 0);
        head.constant.push_back(head.coded[p] ? 0 : static_cast<int>(in.u16()));
        if (head.constant[p] >> planes_.all()[p].bits != 0) return false;
        if (head.coded[p]) used[head.place(p)] = true;
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      if (!used[i] && sets[i] != 0) return false;
    }
    head.tables = tables_of(sets, pairs(), update());
    if (repeats_follow && !read_repeat_tables(in, head.tables.repeats)) return false;
    const auto roles = std::span(head.tables.planes).first(pairs() ? 2 : 3);
    return !in.failed() && (!overrides_follow || std::ranges::all_of(roles, [&](auto& tables) {
      return read_overrides(in, tables);
    }));
  }

  const TextureDesc& desc_;
  RecordPlanes planes_;
  std::span<const std::uint32_t> blocks_;
  std::span<const std::byte> mirror_;
  std::span<const std::uint8_t> received_;
  std::span<const std::byte> presence_;
  bool intra_;
  std::span<const std::byte> held_presence_;
  std::size_t records_, block_bytes_;
  std::array<std::uint32_t, 3> box_{};
  std::map<std::uint32_t, Values> done_;
  std::map<std::uint32_t, std::vector<std::byte>> raw_;
};

}  // namespace

std::optional<std::vector<std::byte>> decode(const TextureDesc& desc,
                                             std::span<const std::uint32_t> blocks,
                                             std::span<const std::byte> mirror,
                                             std::span<const std::uint8_t> received,
                                             std::span<const std::byte> payload,
                                             std::span<const std::byte> presence, bool intra,
                                             std::span<const std::byte> held_presence) {
  return Decoder(desc, blocks, mirror, received, presence, intra, held_presence).payload(payload);
}

}  // namespace gicodec::reference
