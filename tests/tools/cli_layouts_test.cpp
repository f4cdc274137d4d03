// Every layout of an engine as every kind of file, through every command.
#include "dump/block_place.h"
#include "engine_grids.h"
#include "support.h"
#include "tools/cli_support.h"

#include <gicodec/engines.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>

namespace gicodec::tools {
namespace {

constexpr unsigned kLayoutFrames = 2;
/// Attributes that a kind of file keeps.
constexpr const char* kNote = "note";

/// A NaN with a payload, or nothing for a component that has none.
std::optional<std::uint32_t> nan_of(const Component& component) {
  if (component.type == ComponentType::sfloat) return component.bits == 16 ? 0xFD01U : 0x7FA01234U;
  if (component.type == ComponentType::ufloat) return max_code(component);
  return std::nullopt;
}

/// Any bits, and in every block a NaN if the format has some; zero where no block is.
std::vector<std::byte> synthetic(const TextureDesc& desc, unsigned frame) {
  const Extent size = extent(desc);
  const auto random = random_texels(desc, 7);
  std::vector<std::byte> texels(random.size());
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockPlace place = block_place(desc, size, block);
    copy_block(place, random, place, texels);
    if (block % 3 == frame) texels[place.offset] ^= std::byte{0x5A};
    for (const Component& component : desc.record.used()) {
      const auto code = nan_of(component);
      if (!code || block % 2 != 0) continue;
      std::byte* const texel = &texels[place.row(place.rows - 1, place.slices - 1)];
      std::fill_n(texel, desc.record.bytes, std::byte{0});
      store_component(texel, desc.record.bytes, component, *code);
    }
  }
  return texels;
}

class CliLayouts : public testing::TestWithParam<const EngineLayout*> {
 protected:
  void SetUp() override {
    volume_ = *GetParam()->make(grid_);
    for (const NamedTexture* texture : textures_of(volume_)) textures_.push_back(*texture);
  }

  /// A command that is told of the layout.
  [[nodiscard]] std::vector<std::string> command(std::vector<std::string> words) const {
    const std::vector<std::string> flags{"--layout", name_, "--grid", to_string(grid_)};
    words.insert(words.begin() + 1, flags.begin(), flags.end());
    return words;
  }
  void write(const std::string& folder, const std::string& ending) {
    std::filesystem::create_directories(program_.path(folder));
    for (const NamedTexture& texture : textures_) {
      for (unsigned frame = 0; frame < kLayoutFrames; ++frame) {
        DumpInfo info = make_info(texture.desc);
        set_attribute(info.attributes, {kNote, "string", fmt::format("of frame {}", frame)});
        write_dump(
            program_.path(fmt::format("{}/{}.{:04}.{}", folder, texture.name, frame, ending)), info,
            synthetic(texture.desc, frame));
      }
    }
  }
  void expect_same_files(const std::string& a, const std::string& b) {
    const auto names = program_.files(a);
    EXPECT_EQ(program_.files(b), names);
    for (const std::string& name : names) {
      EXPECT_EQ(file_bytes(program_.path(a + "/" + name)),
                file_bytes(program_.path(b + "/" + name)))
          << name;
    }
  }
  void expect_texels(const std::string& folder, const std::string& ending, bool noted) {
    for (const NamedTexture& texture : textures_) {
      for (unsigned frame = 0; frame < kLayoutFrames; ++frame) {
        const Dump dump = read_dump(
            program_.path(fmt::format("{}/{}.{:04}.{}", folder, texture.name, frame, ending)),
            hints_of(texture.desc));
        EXPECT_EQ(dump.texels, synthetic(texture.desc, frame)) << texture.name;
        const Attribute* note = find_attribute(dump.info.attributes, kNote);
        ASSERT_EQ(note != nullptr, noted);
        if (note != nullptr) {
          EXPECT_EQ(note->value, fmt::format("of frame {}", frame));
        }
      }
    }
  }
  void expect_cropped(const std::string& folder, const std::string& ending) {
    const auto words = [&](const char* origin, const char* size) {
      return command({"crop", "--origin", origin, "--size", size, "-o", "cropped", folder});
    };
    const bool pool = std::ranges::any_of(
        textures_, [](const NamedTexture& texture) { return texture.desc.space == Space::pool; });
    if (pool) {
      program_.expect_failure(Exit::bad_input, words("0,0,0", "1x1x1"), {"holds a pool"});
      return;
    }
    program_.succeed(words("0,0,1", "1x1x2"));
    for (const NamedTexture& texture : textures_) {
      const TextureDesc& whole = texture.desc;
      TextureDesc part = whole;
      part.grid = {1, 1, 2};
      if (whole.records != Grid{}) {
        part.records = {std::min<std::uint32_t>(whole.records.x, whole.block.x),
                        std::min<std::uint32_t>(whole.records.y, whole.block.y), 2};
      }
      const auto path = program_.path(fmt::format("cropped/{}.0001.{}", texture.name, ending));
      const Dump dump = read_dump(path, hints_of(part));
      const auto from = synthetic(whole, 1);
      std::vector<std::byte> wanted(dump.texels.size());
      for (std::uint32_t block = 0; block < 2; ++block) {
        const std::uint32_t at = whole.grid.x * whole.grid.y * (block + 1);
        copy_block(block_place(whole, extent(whole), at), from,
                   block_place(part, extent(part), block), wanted);
      }
      EXPECT_EQ(dump.texels, wanted) << texture.name;
    }
    std::filesystem::remove_all(program_.path("cropped"));
  }
  void expect_part(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "lacks " << part;
  }

  const Grid grid_ = test::engine_grid(GetParam()->unit);
  const std::string name_{GetParam()->name};
  VolumeDesc volume_;
  std::vector<NamedTexture> textures_;
  Program program_;
};

/// One of all layouts.
test::Sweep& sweep() {
  static test::Sweep all;
  return all;
}

/// Through a container and back.
TEST_P(CliLayouts, ComeBackAsEveryKindOfFile) {
  for (const std::string ending : {"exr", "dds", "ktx2", "raw"}) {
    SCOPED_TRACE(ending);
    const auto lacking = std::ranges::find_if(textures_, [&](const NamedTexture& texture) {
      return !has_format(*image_kind("x." + ending), texture.desc.record.format);
    });
    if (lacking != textures_.end() || !sweep().takes()) continue;
    const std::string out = "out-" + ending, file = name_ + "-" + ending + ".gic";
    const std::string all = fmt::format("{0} of {0} files", kLayoutFrames * textures_.size());
    write(ending, ending);
    program_.succeed(command({"encode", "-o", file, ending}));
    expect_part(program_.succeed({"verify", file, ending}).out, all);
    program_.succeed({"decode", file, "-o", out});
    expect_same_files(ending, out);
    expect_texels(out, ending, ending != "dds");
    const auto json =
        nlohmann::json::parse(program_.succeed({"info", file, "--format", "json"}).out);
    EXPECT_EQ(json["volumes"][0]["name"], name_);
    EXPECT_EQ(json["textures"].size(), textures_.size());
    const std::string& first = textures_.front().name;
    const std::string frame = fmt::format("{}.0001.{}", first, ending);
    program_.succeed(command({"preview", ending + "/" + frame, "-o", ending + ".png"}));
    expect_cropped(ending, ending);

    program_.succeed(command({"compare", ending, out}));
    Dump dump = read_dump(program_.path(out + "/" + frame), hints_of(textures_.front().desc));
    dump.texels[block_place(dump.info.desc, extent(dump.info.desc), 0).offset] ^= std::byte{1};
    write_dump(program_.path(out + "/" + frame), dump.info, dump.texels, Existing::replace);
    EXPECT_EQ(program_.run(command({"compare", ending, out})).exit, 1);
    const Outcome verified = program_.run({"verify", file, out});
    EXPECT_EQ(verified.exit, 1);
    expect_part(verified.out, fmt::format("{} of {} files", kLayoutFrames * textures_.size() - 1,
                                          kLayoutFrames * textures_.size()));
    program_.succeed({"preview", file, "--texture", first, "-o", "a-" + ending + ".png"});
  }
}

/// From every kind of file to every other, and back to the first by a container of these.
TEST_P(CliLayouts, BecomeOtherKindsOfFiles) {
  constexpr std::array<const char*, 4> kEndings{"exr", "dds", "ktx2", "raw"};
  const auto lacking = [&](const std::string& ending) {
    return std::ranges::find_if(textures_, [&](const NamedTexture& texture) {
      return !has_format(*image_kind("x." + ending), texture.desc.record.format);
    });
  };
  for (const std::string from : kEndings) {
    if (lacking(from) != textures_.end()) continue;
    write(from, from);
    program_.succeed(command({"encode", "-o", from + ".gic", from}));
    for (const std::string to : kEndings) {
      if (!sweep().takes()) continue;
      SCOPED_TRACE(from + " to " + to);
      const std::string out = from + "-" + to;
      const std::vector<std::string> decode{"decode", from + ".gic", "-o", out, "--files", to};
      if (const auto texture = lacking(to); texture != textures_.end()) {
        program_.expect_failure(Exit::bad_input, decode,
                                {from + ".gic: texture " + texture->name,
                                 std::string(find_format(texture->desc.record.format)->name),
                                 "which dds files cannot have; --files takes exr, ktx2, raw"});
        continue;
      }
      const std::string said = program_.succeed(decode).err;
      if (from == to) {
        expect_same_files(from, out);
        continue;
      }
      EXPECT_EQ(said.find("do not have its attributes") != std::string::npos, to == "dds") << said;
      expect_texels(out, to, from != "dds" && to != "dds");
      program_.succeed(command({"compare", from, out}));
      program_.succeed(command({"encode", "-o", "again.gic", out}));
      program_.succeed({"decode", "again.gic", "-o", "back", "--files", from});
      expect_texels("back", from, from != "dds" && to != "dds");
      if (from != "dds" && to != "dds") expect_same_files(from, "back");
      std::filesystem::remove_all(program_.path("back"));
    }
  }
}

/// Who writes them is told the format and where it can be.
TEST_P(CliLayouts, WhatAKindOfFileLacksIsNamed) {
  for (const NamedTexture& texture : textures_) {
    const Format format = texture.desc.record.format;
    for (const char* ending : {"exr", "ktx2", "raw"}) {
      EXPECT_TRUE(has_format(*image_kind(fmt::format("x.{}", ending)), format)) << texture.name;
    }
    if (has_format(ImageKind::dds, format)) continue;
    try {
      write_dump(program_.path("x.dds"), make_info(texture.desc), synthetic(texture.desc, 0));
      ADD_FAILURE() << texture.name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::bad_input);
      expect_part(error.what(),
                  fmt::format("x.dds: DDS files have no format {}; --files takes ktx2, exr or raw",
                              find_format(format)->name));
    }
    EXPECT_TRUE(program_.files().empty());
    // A file of another format is not taken for one.
    TextureDesc other = texture.desc;
    other.record = Format::A2B10G10R10_UNORM_PACK32;
    write_dump(program_.path(texture.name + ".0000.dds"), make_info(other), synthetic(other, 0));
    program_.expect_failure(Exit::bad_input,
                            command({"preview", texture.name + ".0000.dds", "-o", "a.png"}),
                            {"is of format A2B10G10R10", find_format(format)->name.data()});
  }
}

std::vector<const EngineLayout*> layouts() {
  std::vector<const EngineLayout*> all;
  for (const EngineLayout& layout : engine_layouts()) all.push_back(&layout);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Engines, CliLayouts, testing::ValuesIn(layouts()), [](const auto& layout) {
  std::string name(layout.param->name);
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace gicodec::tools
