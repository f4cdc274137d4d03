#include "native/round_trip.h"

#include "native/reference_decoder.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::test {

Bytes decode(const UpdateCase& u, std::span<const std::byte> payload, unsigned threads, Isa isa) {
  const Exact exact(payload), mirror(u.mirror);
  Exact out(u.records.size());
  native::PayloadMemory memory;
  auto job = u.decode_job(exact.span(), out.span());
  job.mirror.blocks.records = mirror.span().data();
  job.threads = threads;
  EXPECT_EQ(native::decode_payload(job, isa, memory), Status::ok);
  return {out.span().begin(), out.span().end()};
}

void check_everything(UpdateCase u, native::PayloadSettings settings) {
  SCOPED_TRACE(rc::toString(u.desc) + (u.intra ? " intra" : u.keyframe ? " keyframe" : " update"));
  const Bytes payload = encode(u, settings, Isa::scalar);
  EXPECT_LE(payload.size(), native::payload_bound(u.desc, u.blocks.size()));
  static unsigned turn = 0;
  const bool all = everything();
  const auto isas = supported_isas();
  for (const Isa isa : all ? isas : isas.subspan(turn++ % isas.size(), 1)) {
    SCOPED_TRACE(to_string(isa));
    for (const unsigned threads : {1U, 2U, 7U}) {
      if (threads > 1 && (isa != best_isa() || (!all && threads != (turn % 8 < 4 ? 2 : 7))))
        continue;
      settings.threads = threads;
      if (isa != Isa::scalar || threads > 1) {
        EXPECT_EQ(encode(u, settings, isa), payload);
      }
      EXPECT_EQ(decode(u, payload, threads, isa), u.records);
    }
  }
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload,
                                          u.presence, u.intra, u.mirror_presence);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(*expected, u.records);
}

UpdateCase any_update(const TextureDesc& desc, Content content, std::uint32_t one_in,
                      std::uint64_t seed) {
  if (seed % 4 == 0) return make_intra(desc, content, one_in, seed);
  return make_update(desc, content, seed % 4 == 1, one_in, seed);
}

}  // namespace gicodec::test
