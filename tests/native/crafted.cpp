#include "native/crafted.h"

#include "native/reference_decoder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec::test {

using namespace native;

namespace {

Status check(const UpdateCase& u, const Bytes& payload) {
  PayloadMemory memory;
  return check_payload(u.desc, u.blocks.size(), payload, memory);
}
Status decode(const UpdateCase& u, const Bytes& payload, Bytes& out) {
  out.resize(u.records.size());
  PayloadMemory memory;
  return decode_payload(u.decode_job(payload, out), best_isa(), memory);
}

}  // namespace

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}
int at(const Bytes& payload, std::size_t place) { return std::to_integer<int>(payload[place]); }
Bytes with(Bytes payload, std::size_t place, int value) {
  payload.at(place) = static_cast<std::byte>(value);
  return payload;
}
Bytes longer(Bytes payload, std::size_t by) {
  payload.resize(payload.size() + by);
  return payload;
}

void expect_sound(const UpdateCase& u, const Bytes& payload) {
  Bytes out;
  EXPECT_EQ(check(u, payload), Status::ok);
  EXPECT_EQ(decode(u, payload, out), Status::ok);
  EXPECT_EQ(out, u.records);
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload,
                                          u.presence, u.intra, u.mirror_presence);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(*expected, u.records);
}
void expect_refused(const UpdateCase& u, const Bytes& payload, Status status) {
  Bytes out;
  EXPECT_EQ(decode(u, payload, out), status);
  EXPECT_FALSE(reference::decode(u.desc, u.blocks, u.mirror, u.received, payload, u.presence,
                                 u.intra, u.mirror_presence)
                   .has_value());
}
void expect_refused_at_once(const UpdateCase& u, const Bytes& payload, Status status) {
  expect_refused(u, payload, status);
  EXPECT_EQ(check(u, payload), status);
}

Bytes payload_of(const UpdateCase& u, const ChunkHead& head, const Groups& groups) {
  const PlaneLayout layout = plane_layout(u.desc);
  AdaptedTables adapted;
  const Tables& tables = adapted.apply(layout.pairs, !u.keyframe, head.tables);
  std::size_t steps = 0;
  for (const auto& group : groups) steps += group.size();
  std::vector<std::uint8_t> words(steps * kMaxStepBytes + kSlack);
  Output output{};
  std::fill(std::begin(output.state), std::end(output.state), kStateLow);
  output.next = words.data() + words.size();
  for (std::size_t g = groups.size(); g-- > 0;) {
    const auto& group = groups[g];
    kernels(best_isa()).encode_steps(group.data(), group.data() + group.size(), tables, output);
  }
  Bytes payload = bytes({kVersion});
  write_head(layout, head, payload);
  ByteWriter writer(payload);
  for (unsigned l = 0; l < head.lanes; ++l) writer.fixed(output.state[l]);
  const std::uint8_t* const end = words.data() + words.size();
  writer.bytes(std::as_bytes(std::span<const std::uint8_t>(output.next, end)));
  return payload;
}

Encoded encoded(const UpdateCase& u) {
  Encoded e;
  PayloadSettings settings;
  settings.chunk.observe = [&](const Step* begin, const Step* end) {
    e.groups.insert(e.groups.begin(), {begin, end});
  };
  const Bytes payload = encode(u, settings, best_isa());
  EXPECT_EQ(payload.at(0), std::byte{kVersion});
  ByteReader reader(std::span<const std::byte>(payload).subspan(kChunk));
  const auto first = reader.fixed<std::uint8_t>();
  EXPECT_EQ(first & 3, kModelledChunk);
  read_head(plane_layout(u.desc), !u.keyframe, first, reader, e.head);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(payload_of(u, e.head, e.groups), payload);
  e.head.tables.clear();
  return e;
}

UpdateCase colour(bool keyframe) {
  auto u = make_update(probe_texture(Format::A2B10G10R10_UNORM_PACK32, {5, 4, 3}, 4, 1),
                       Content::smooth, keyframe, 1, 1);
  // A plane that is constant.
  for (std::size_t i = 3; i < u.records.size(); i += 4) u.records[i] &= std::byte{0x3F};
  return u;
}
UpdateCase visibility(bool keyframe) {
  auto u = make_update(probe_texture(Format::R16G16_SFLOAT, {4, 3, 3}, 8, 1), Content::smooth,
                       keyframe, 1, 1);
  // Few enough bits that no chunk is raw.
  for (Bytes* records : {&u.records, &u.mirror}) {
    for (std::size_t i = 1; i < records->size(); i += 2) (*records)[i] &= std::byte{1};
  }
  return u;
}

}  // namespace gicodec::test
