// The native decoder on hostile payloads, on every instruction set, with memory that stay from
// payload to payload as in a decoder: one verdict, one result, that of a fresh workspace.
#include "cost.h"
#include "payload.h"

#include "base/bytes.h"
#include "native/frame/payload.h"

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

/// One session on every instruction set.
class Session {
 public:
  Status operator()(const DecodeJob& job) {
    Exact first(job.records.size(), 1);
    Status looked = Status::ok;
    check_cost("a payload is looked at for what its bytes are worth", [&] {
      looked = native::check_payload(job.desc, job.blocks.size(), job.payload, memory_[0]);
      return refusal(job.payload.size());
    });
    Status verdict = Status::ok;
    for (std::size_t i = 0; i < supported_isas().size(); ++i) {
      DecodeJob mine = job;
      mine.records = i == 0 ? job.records : first.span();
      mine.threads = 1 + i % 2;
      PayloadStatistics statistics;
      if (i % 2 != 0) mine.statistics = &statistics;  // As `gicodec info` asks for.
      Status status = Status::ok;
      check_cost("a payload costs what it is worth", [&] {
        status = native::decode_payload(mine, supported_isas()[i], memory_[i]);
        return decoding(job.desc, job.payload.size(), mine.threads.count);
      });
      check(status != Status::ok || looked == Status::ok, "what is refused is not decoded");
      check_work(job, statistics);
      if (i == 0) verdict = status;
      check(status == verdict, "the same verdict on every instruction set");
      check(status != Status::ok || same(job.records, mine.records),
            "the same records on every instruction set");
    }
    return verdict;
  }

 private:
  /// Nothing is decoded more than once: a repetition and a residual per plane of each record, one
  /// mode of a block for each of the pair model's planes.
  static void check_work(const DecodeJob& job, const PayloadStatistics& done) {
    const std::size_t records = job.records.size() / job.desc.record.bytes;
    std::uint64_t repeats = 0, modes = 0;
    for (const auto count : done.repeats) repeats += count;
    for (const auto& model : done.modes) {
      for (const auto count : model) modes += count;
    }
    check(repeats <= records && modes <= 2 * job.blocks.size(), "blocks are decoded once");
    for (const auto symbols : done.plane_symbols)
      check(symbols <= records, "records are decoded once");
  }

  native::PayloadMemory memory_[4];
};

/// Changes one chunk and puts the directory right; false if the payload cannot be taken apart.
bool mutate_chunk(Bytes& payload, std::size_t room, Random& random) {
  ByteReader reader(payload);
  const unsigned parts = reader.fixed<std::uint8_t>() >> 4;
  static_cast<void>(reader.bytes((parts & 1) != 0 ? 8 : 0));
  const auto aligned = [parts](std::size_t size) {
    return (parts & 2) != 0 ? (size + 3) / 4 * 4 : size;
  };
  std::vector<std::size_t> ends = {payload.size()};
  if ((parts & 2) != 0) {
    const auto count = reader.fixed<std::uint32_t>();
    if (count == 0 || count > reader.rest().size() / 4) return false;
    ends.resize(count);
    for (auto& end : ends) end = reader.fixed<std::uint32_t>();
  }
  if (!reader.ok()) return false;
  const std::size_t head = payload.size() - reader.rest().size();
  std::vector<Bytes> chunks;
  std::size_t begin = aligned(head);
  for (const auto end : ends) {
    if (end < begin || end > payload.size()) return false;
    const auto bytes = std::span(payload).subspan(begin, end - begin);
    chunks.emplace_back(bytes.begin(), bytes.end());
    begin = aligned(end);
  }
  auto& chunk = chunks[pick(random, chunks.size())];
  mutate(chunk, chunk.size() + room);
  payload.resize(head);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    payload.resize(aligned(payload.size()));
    payload.insert(payload.end(), chunks[i].begin(), chunks[i].end());
    const auto end = static_cast<std::uint32_t>(payload.size());
    if ((parts & 2) != 0) {
      std::memcpy(payload.data() + head - 4 * (chunks.size() - i), &end, sizeof end);
    }
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto describe = [](Input& input) { return input.any_desc(); };
  return fuzz_payloads(data, size, describe, [](const TextureDesc&) { return Session(); });
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  const auto change = [](std::span<const std::byte> head, Bytes& bytes, std::size_t room,
                         Random& random) {
    Input front(head), part(bytes);
    const auto desc = front.any_desc();
    static_cast<void>(part.byte());
    static_cast<void>(part.blocks(desc));
    const auto rest = part.rest();
    Bytes payload(rest.begin(), rest.end());
    if (once_in(random, 3) || !mutate_chunk(payload, room, random)) {
      return mutate(bytes, bytes.size() + room);
    }
    bytes.resize(bytes.size() - rest.size());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
  };
  return mutate_parts(data, size, max_size, seed, kPayloadHead, change);
}
