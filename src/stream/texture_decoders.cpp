#include "stream/texture_decoders.h"

#include "stream/decoder_memory.h"
#include "texture/copy_block.h"

#include <algorithm>
#include <numeric>

namespace gicodec {

TextureDecoders::TextureDecoders(std::vector<Texture> textures, DecoderOptions options)
    : textures_(std::move(textures)), options_(std::move(options)), changed_(textures_.size()) {}

Result<TextureDecoders> TextureDecoders::create(std::vector<Texture> textures,
                                                DecoderOptions options) {
  auto scratch = DecoderScratch::create();
  if (!scratch) return scratch.status();
  options.scratch = *std::move(scratch);
  return TextureDecoders(std::move(textures), std::move(options));
}

Status TextureDecoders::check_memory(std::uint64_t more, std::uint64_t shared) noexcept {
  const std::uint64_t all = held_ + shared + beside_;
  needed_ = more <= UINT64_MAX - all ? all + more : UINT64_MAX;
  return needed_ <= options_.limits.max_total_bytes ? Status::ok : Status::limit_exceeded;
}

Status TextureDecoders::set_callers_bytes(std::uint64_t bytes) noexcept {
  beside_ = bytes;
  return check_memory(0, scratched_);
}

const Decoder* TextureDecoders::find(std::uint8_t texture, std::uint32_t region) const noexcept {
  const auto found = decoders_.find({texture, region});
  return found == decoders_.end() ? nullptr : &found->second;
}

Result<Decoder*> TextureDecoders::decoder(std::uint8_t texture, std::uint32_t region) {
  const Part part{texture, region};
  if (const auto found = decoders_.find(part); found != decoders_.end()) return &found->second;
  const auto& [whole, size, presence] = textures_[texture];
  const TextureDesc desc = is_cut(texture) ? region_texture(whole, size, region) : whole;
  // With the lists of a frame's changes, which may come in two packets.
  const std::uint64_t lists = 2 * sizeof(std::uint32_t) * std::uint64_t{block_count(desc)};
  const std::uint64_t more = held_memory(desc) + lists;
  const std::uint64_t shared = std::max(scratched_, scratch_memory(desc, options_.threads.count));
  if (const Status room = check_memory(more, shared); room != Status::ok) return room;
  auto made = Decoder::create(desc, options_);
  if (!made) return made.status();
  Decoder& decoder = decoders_.emplace(part, *std::move(made)).first->second;
  held_ += more;
  scratched_ = shared;
  return &decoder;
}

Status TextureDecoders::decode(std::uint8_t texture, std::uint32_t region,
                               std::span<const std::byte> packet) {
  needed_ = 0;
  const auto found = decoder(texture, region);
  if (!found) return found.status();
  Decoder& decoder = **found;
  if (const auto presence = textures_[texture].presence) {
    const auto existing = this->decoder(*presence, region);
    if (!existing) return existing.status();
    const Status status = decoder.set_presence((*existing)->records());
    if (status != Status::ok) return status;
  }
  if (!noting_) return decoder.decode(packet);
  std::vector<std::uint32_t>& list = changed_[texture];
  const std::size_t most = block_count(decoder.desc());
  if (list.capacity() - list.size() < most) list.reserve(list.size() + std::max(most, list.size()));
  if (const Status status = decoder.decode(packet); status != Status::ok) return status;
  const RegionGrid cut = regions(texture);
  for (const std::uint32_t block : decoder.changed()) {
    list.push_back(is_cut(texture) ? cut.block_of(region, block) : block);
  }
  return Status::ok;
}

void TextureDecoders::clear() noexcept {
  decoders_.clear();
  held_ = 0;
}

void TextureDecoders::begin_changes(bool noted) noexcept {
  noting_ = noted;
  for (auto& blocks : changed_) blocks.clear();
}

void TextureDecoders::settle_changes(bool all) {
  for (std::size_t t = 0; t < changed_.size(); ++t) {
    std::vector<std::uint32_t>& blocks = changed_[t];
    if (all && has_decoders(static_cast<std::uint8_t>(t))) {
      blocks.resize(block_count(textures_[t].desc));
      std::iota(blocks.begin(), blocks.end(), 0U);
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  }
}

Status TextureDecoders::set_layout(std::uint8_t texture, const Layout& layout) {
  if (has_decoders(texture)) return Status::out_of_order;
  TextureDesc desc = textures_[texture].desc;
  desc.layout = layout;
  if (const Status status = validate(desc); status != Status::ok) return status;
  textures_[texture].desc = desc;
  return Status::ok;
}

/// Writes blocks of a region. `numbers`: in the region; `blocks`: in the texture.
Status TextureDecoders::read_region(std::uint8_t texture, std::uint32_t region,
                                    const TextureView& view, std::span<const std::uint32_t> numbers,
                                    std::span<const std::uint32_t> blocks) const {
  const TextureDesc& desc = textures_[texture].desc;
  if (const Decoder* const held = find(texture, region)) {
    return held->read(numbers, desc, view, blocks);
  }
  const auto target = check_view(desc, view);
  if (!target) return target.status();
  for (const std::uint32_t block : blocks) clear_block(desc, *target, block);
  return Status::ok;
}

Status TextureDecoders::read(std::uint8_t texture, const TextureView& view) const {
  std::vector<std::uint32_t> numbers;
  const auto count_to = [&](std::uint32_t end) {
    numbers.resize(end);
    std::iota(numbers.begin(), numbers.end(), 0U);
  };
  if (!is_cut(texture)) {
    if (const Decoder* const held = find(texture, StreamId::kWholeVolume)) return held->read(view);
    count_to(block_count(textures_[texture].desc));
    return read_region(texture, StreamId::kWholeVolume, view, numbers, numbers);
  }
  const RegionGrid cut = regions(texture);
  for (std::uint32_t region = 0; region < cut.regions(); ++region) {
    const std::vector<std::uint32_t> blocks = cut.blocks_of(region);
    count_to(static_cast<std::uint32_t>(blocks.size()));
    const Status status = read_region(texture, region, view, numbers, blocks);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status TextureDecoders::read(std::uint8_t texture, const TextureView& view,
                             std::span<const std::uint32_t> blocks) const {
  const TextureDesc& desc = textures_[texture].desc;
  if (const auto target = check_view(desc, view); !target) return target.status();
  if (std::any_of(blocks.begin(), blocks.end(),
                  [&](std::uint32_t block) { return block >= block_count(desc); })) {
    return Status::block_out_of_range;
  }
  if (!is_cut(texture)) {
    return read_region(texture, StreamId::kWholeVolume, view, blocks, blocks);
  }
  const RegionGrid cut = regions(texture);
  std::vector<std::uint32_t> sorted(blocks.begin(), blocks.end()), numbers;
  const auto place = [&](std::uint32_t block) {
    return std::pair(cut.region_of(block), cut.number_of(block));
  };
  std::sort(sorted.begin(), sorted.end(),
            [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  for (std::size_t first = 0, end = 0; first < sorted.size(); first = end) {
    const std::uint32_t region = cut.region_of(sorted[first]);
    numbers.clear();
    for (end = first; end < sorted.size() && cut.region_of(sorted[end]) == region; ++end) {
      numbers.push_back(cut.number_of(sorted[end]));
    }
    const auto own = std::span(sorted).subspan(first, end - first);
    const Status status = read_region(texture, region, view, numbers, own);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

}  // namespace gicodec
