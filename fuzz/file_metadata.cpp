// What a container's metadata says of a texture's files, as `info` and `decode` use it: refused, or
// taken for the same again when it is written.
#include "foreign_file.h"

#include "common/stored_texture.h"

#include <array>
#include <limits>

namespace {

using namespace gicodec;
using namespace gicodec::tools;

constexpr std::array<const char*, 15> kKeys = {
    "digits",     "extension",  "separator",    "channels",    "channel:R",
    "file bytes", "encoder",    "dropped",      "lossy",       "inactive",
    "attribute:", "attribute@", "attribute@3:", "attribute:a", ""};
/// Where blocks stand in the file; numbers of their own, since the corpus was grown with the
/// others.
constexpr std::array<const char*, 2> kLayoutKeys = {"slots", "padding"};
constexpr std::uint8_t kFirstOfLayout = 240;

/// A description and an error, then entries: a key or its beginning, and the rest of the key and a
/// value.
TextureEntry read_entry(fuzz::Input& input) {
  constexpr float kErrors[] = {0, 0, 1, std::numeric_limits<float>::infinity()};
  TextureEntry entry{"t", input.any_desc(), 0, kErrors[input.below(4)], {}};
  const auto text = [&] {
    const auto bytes = input.bytes(input.u16() % 2048);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  while (!input.empty()) {
    const std::uint8_t choice = input.byte();
    std::string key = choice < kFirstOfLayout ? kKeys[choice % kKeys.size()]
                                              : kLayoutKeys[choice % kLayoutKeys.size()];
    if (key.empty() || key.back() == ':' || key.back() == '@') key += text();
    entry.metadata.emplace_back(std::move(key), text());
  }
  return entry;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const TextureEntry entry = read_entry(input);
  // Of others no files are made, and containers with such textures are not opened.
  if (find_format(entry.desc.record.format) == nullptr || validate(entry.desc) != Status::ok)
    return 0;
  fuzz::check_cost("metadata costs what it is worth", [&]() -> fuzz::Allowance {
    fuzz::accepted([&] {
      const StoredTexture stored = from_entry(entry, "x.gic");
      const TextureEntry written = to_entry(stored);
      const TextureEntry again = to_entry(from_entry(written, "x.gic"));
      fuzz::check(again.metadata == written.metadata && again.desc == written.desc &&
                      again.largest_error == written.largest_error,
                  "what was read is written and read as the same");
      TextureDesc desc = stored.info.desc;
      fuzz::check(validate(desc) == Status::ok, "its blocks stand somewhere");
      desc.layout = entry.desc.layout;
      fuzz::check(desc == entry.desc, "metadata says nothing else of them");
      fuzz::check(entry.largest_error == 0 || !stored.loss().empty(), "losses are told");
      for (const std::uint64_t frame : {std::uint64_t{0}, std::uint64_t{3}, UINT64_MAX}) {
        const std::string name = stored.file_name(frame);
        fuzz::check(name.find('/') == std::string::npos && printable(name) == name,
                    "files are named in their folder");
        const DumpInfo info = stored.decoded_info(frame);
        fuzz::check(std::ranges::is_sorted(info.attributes, {}, &Attribute::name),
                    "attributes are in order");
      }
      if (!stored.inactive.empty()) {
        fuzz::check(stored.inactive.size() <= block_count(entry.desc) &&
                        stored.inactive.contains(stored.inactive.last()),
                    "inactive probes are probes");
      }
    });
    return {(std::size_t{64} << 10) + 192 * size, (std::size_t{256} << 10) + 1024 * size};
  });
  return 0;
}
