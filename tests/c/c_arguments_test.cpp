// Calls of the C interface with null, short, long and misplaced arguments give a status.
#include "c_support.h"

#include <gicodec/gicodec.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>

namespace gicodec {
namespace {

using namespace test;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  return files;
}

TEST(CArguments, TestsCallEveryFunction) {
  std::string tests;
  for (const auto& path : files_in(GICODEC_C_TESTS_DIR)) tests += text_of(path);
  const std::regex declaration(R"(GICODEC_C_API[^;(]*?\b(gicodec_[a-z0-9_]+)\s*\()");
  std::size_t found = 0;
  for (const auto& path : files_in(GICODEC_INCLUDE_DIR "/gicodec/c")) {
    const std::string header = text_of(path);
    for (auto at = std::sregex_iterator(header.begin(), header.end(), declaration);
         at != std::sregex_iterator(); ++at, ++found) {
      EXPECT_NE(tests.find((*at)[1].str() + "("), std::string::npos) << (*at)[1];
    }
  }
  EXPECT_GT(found, 130U);
}

TEST(CArguments, NumbersAreThoseOfTheLibrary) {
  const std::string header = text_of(GICODEC_INCLUDE_DIR "/gicodec/c/base.h");
  const std::string enumeration = text_of(GICODEC_INCLUDE_DIR "/gicodec/status.h");
  const std::regex enumerator(R"(\n +([a-z_]+) = ([0-9]+),)");
  std::size_t statuses = 0;
  for (auto at = std::sregex_iterator(enumeration.begin(), enumeration.end(), enumerator);
       at != std::sregex_iterator(); ++at, ++statuses) {
    std::string name = (*at)[1];
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
    EXPECT_NE(header.find("  GICODEC_" + name + " = " + (*at)[2].str() + ","), std::string::npos)
        << name;
    const auto number = static_cast<gicodec_status>(std::stoi((*at)[2]));
    EXPECT_EQ(gicodec_status_text(number), to_string(static_cast<Status>(number)));
  }
  EXPECT_GT(statuses, 40U);
  EXPECT_STREQ(gicodec_status_text(-1), gicodec_status_text(1 << 20));
  EXPECT_EQ(gicodec_version_text(), kVersionString);
  EXPECT_EQ(gicodec_version() >> 16, kVersionMajor);
  EXPECT_EQ(GICODEC_TILING_SLICES_YX_Z, static_cast<int>(Tiling::slices_yx_z));
  EXPECT_EQ(GICODEC_MODEL_HEMISPHERES, static_cast<int>(Model::hemispheres));
  EXPECT_EQ(GICODEC_PRESENCE_BRICK, static_cast<int>(Presence::brick));
  EXPECT_EQ(GICODEC_SPACE_POOL, static_cast<int>(Space::pool));
  EXPECT_EQ(GICODEC_COMPONENT_OPAQUE, static_cast<int>(ComponentType::opaque));
  EXPECT_EQ(static_cast<std::size_t>(GICODEC_MAX_COMPONENTS), kMaxComponents);
}

/// A struct with bytes of a later version behind it.
template <typename Struct>
struct Longer {
  Struct known = sized<Struct>();
  unsigned char later[16] = {};
  Longer() { known.struct_size = sizeof(Longer); }
};

TEST(CArguments, StructsOfOtherVersions) {
  const auto desc = irradiance();
  const auto create = [&](const gicodec_encoder_options* options) {
    gicodec_encoder* encoder = nullptr;
    const gicodec_status status = gicodec_encoder_create(&desc, options, &encoder);
    EXPECT_EQ(encoder != nullptr, status == GICODEC_OK);
    gicodec_encoder_destroy(encoder);
    return status;
  };
  auto options = sized<gicodec_encoder_options>();
  EXPECT_EQ(create(&options), GICODEC_OK);
  for (const std::uint32_t size : {0U, 4U, static_cast<std::uint32_t>(sizeof options) - 1, 5000U}) {
    options.struct_size = size;
    EXPECT_EQ(create(&options), kInvalid) << size;
  }
  Longer<gicodec_encoder_options> longer;
  EXPECT_EQ(create(&longer.known), GICODEC_OK);
  longer.later[15] = 1;
  EXPECT_EQ(create(&longer.known), GICODEC_UNSUPPORTED_FEATURE);

  // What is filled in keeps its size, and nothing behind it changes.
  Longer<gicodec_texture_info> info;
  std::memset(info.later, 0xAA, sizeof info.later);
  ASSERT_EQ(gicodec_texture_desc_info(&desc, &info.known), GICODEC_OK);
  EXPECT_EQ(info.known.struct_size, sizeof info);
  EXPECT_TRUE(std::ranges::all_of(info.later, [](auto byte) { return byte == 0xAA; }));
  info.known.struct_size = 8;
  EXPECT_EQ(gicodec_texture_desc_info(&desc, &info.known), kInvalid);
}

TEST(CArguments, SettingsOutOfRange) {
  const auto desc = irradiance();
  const auto status_of = [&](auto change) {
    auto options = sized<gicodec_encoder_options>();
    change(options);
    gicodec_encoder* encoder = nullptr;
    const gicodec_status status = gicodec_encoder_create(&desc, &options, &encoder);
    gicodec_encoder_destroy(encoder);
    return status;
  };
  EXPECT_EQ(status_of([](auto& o) { o.backend = "none"; }), GICODEC_UNKNOWN_BACKEND);
  EXPECT_EQ(status_of([](auto& o) { o.preset = "none"; }), GICODEC_INVALID_SETTINGS);
  EXPECT_EQ(status_of([](auto& o) { o.level = 99; }), GICODEC_INVALID_SETTINGS);
  EXPECT_EQ(status_of([](auto& o) { o.chunk = 5000; }), GICODEC_INVALID_SETTINGS);
  EXPECT_EQ(status_of([](auto& o) { o.max_error = -1; }), GICODEC_INVALID_BOUND);
  EXPECT_EQ(status_of([](auto& o) { o.texture_id = 256; }), kInvalid);
  EXPECT_EQ(status_of([](auto& o) { o.backend_count = 1; }), kInvalid);
  const gicodec_backend* const none[] = {nullptr};
  EXPECT_EQ(status_of([&](auto& o) {
              o.backends = none;
              o.backend_count = 1;
            }),
            kInvalid);
  auto host = sized<gicodec_host>();
  const auto with_host = [&](auto& o) { o.host = &host; };
  host.threads = 257;
  EXPECT_EQ(status_of(with_host), GICODEC_INVALID_SETTINGS);
  host.threads = 1;
  host.isa = "mmx";
  EXPECT_EQ(status_of(with_host), GICODEC_INVALID_SETTINGS);
  host.isa = "scalar";
  EXPECT_EQ(status_of(with_host), GICODEC_OK);
  host.release = [](void*, void*, std::size_t) {};
  EXPECT_EQ(status_of(with_host), kInvalid);
  host.struct_size = 0;
  EXPECT_EQ(status_of(with_host), kInvalid);
}

TEST(CArguments, DescriptionsOutOfRange) {
  auto out = sized<gicodec_texture_desc>();
  EXPECT_EQ(gicodec_ddgi_irradiance(0, 1, 1, 64, &out), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_ddgi_irradiance(1, 1, 1, 5, &out), GICODEC_UNSUPPORTED_FORMAT);
  EXPECT_EQ(gicodec_ddgi_irradiance(1, 1, 1, 64, nullptr), kInvalid);
  EXPECT_EQ(gicodec_ddgi_visibility(1, 1, 1, 83, &out), GICODEC_OK);
  EXPECT_EQ(gicodec_ddgi_visibility(UINT32_MAX, 1, 1, 83, &out), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&out)).substr(0, 5), "grid:");
  EXPECT_EQ(gicodec_map_texture(8, 8, 1, 0, 8, 1, 83, &out), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&out)).substr(0, 6), "block:");
  EXPECT_EQ(gicodec_map_texture(8, 8, 1, 65, 8, 1, 83, &out), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_map_texture(0, 8, 1, 8, 8, 1, 83, &out), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&out)).substr(0, 6), "block:");
  EXPECT_EQ(gicodec_map_texture(8, 8, 1, 8, 8, 1, 5, &out), GICODEC_UNSUPPORTED_FORMAT);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&out)).substr(0, 7), "format:");
  for (const auto field : {&gicodec_texture_desc::guard_band, &gicodec_texture_desc::space,
                           &gicodec_texture_desc::presence, &gicodec_texture_desc::model,
                           &gicodec_texture_desc::tiling, &gicodec_texture_desc::pad_before,
                           &gicodec_texture_desc::pad_after}) {
    for (const std::uint32_t number : {9U, 255U, 256U, 257U, UINT32_MAX}) {
      auto desc = irradiance();
      desc.*field = number;
      EXPECT_EQ(gicodec_texture_desc_check(&desc), GICODEC_INVALID_DESCRIPTION) << number;
      EXPECT_NE(gicodec_texture_desc_problem(&desc), nullptr) << number;
    }
  }
  auto desc = irradiance();
  desc.component_count = 3;
  EXPECT_EQ(gicodec_texture_desc_check(&desc), GICODEC_UNSUPPORTED_FORMAT);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&desc)).substr(0, 7), "format:");
  desc = irradiance();
  desc.struct_size = 0;
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&desc)).substr(0, 12), "struct_size:");
  desc = irradiance();
  EXPECT_EQ(gicodec_texture_desc_problem(&desc), nullptr);
  desc.block[0] = 256 + 8;
  EXPECT_EQ(gicodec_texture_desc_check(&desc), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(std::string_view(gicodec_texture_desc_problem(&desc)).substr(0, 6), "block:");

  EXPECT_EQ(gicodec_format_from_name("VK_FORMAT_R16G16_SFLOAT"), 83U);
  EXPECT_EQ(gicodec_format_from_name("R16G16"), 0U);
  EXPECT_EQ(gicodec_format_from_name(nullptr), 0U);
  EXPECT_EQ(gicodec_format_name(5), nullptr);
  EXPECT_EQ(gicodec_format_at(gicodec_format_count()), 0U);
  EXPECT_EQ(gicodec_layout_name(gicodec_layout_count()), nullptr);
  EXPECT_EQ(gicodec_layout_summary(gicodec_layout_count()), nullptr);
  EXPECT_EQ(gicodec_kind_name(0), nullptr);
  EXPECT_EQ(gicodec_kind_name(256 + 1), nullptr);
  EXPECT_STREQ(gicodec_kind_name(1), "probes");
  EXPECT_EQ(gicodec_backend_name(256), nullptr);

  gicodec_volume_desc* volume = nullptr;
  EXPECT_EQ(gicodec_volume_desc_create(99, &volume), GICODEC_UNKNOWN_KIND);
  EXPECT_EQ(gicodec_volume_desc_create(257, &volume), GICODEC_UNKNOWN_KIND);
  EXPECT_EQ(gicodec_volume_desc_from_layout("none", 1, 1, 1, &volume), GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_volume_desc_from_layout(nullptr, 1, 1, 1, &volume), GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_volume_desc_from_layout("rtxgi", 0, 1, 1, &volume),
            GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_photon_volume(1, 65, 0, &volume), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_photon_volume(1, 64, 2, &volume), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_voxel_volume(1, 256 + 4, 0, &volume), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_ao_point_volume(0, 1, 1, &volume), GICODEC_INVALID_DESCRIPTION);
  EXPECT_EQ(gicodec_irradiance_vector_volume(0, 1, 1, 0, &volume), GICODEC_INVALID_DESCRIPTION);
  const std::vector<unsigned char> huge(kMaxKindDescription + 1);
  EXPECT_EQ(gicodec_volume_desc_read(1, huge.data(), huge.size(), &volume), GICODEC_LIMIT_EXCEEDED);
  EXPECT_EQ(gicodec_volume_desc_read(256 + 1, huge.data(), 4, &volume), GICODEC_UNKNOWN_KIND);
  EXPECT_EQ(volume, nullptr);

  const auto whole = room(irradiance());
  desc = irradiance();
  EXPECT_EQ(gicodec_volume_desc_add_texture(whole.get(), "", &desc), GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_volume_desc_add_texture(whole.get(), "\xFF", &desc), GICODEC_INVALID_NAME);
  const std::string long_name(256, 'n');
  EXPECT_EQ(gicodec_volume_desc_add_texture(whole.get(), long_name.c_str(), &desc),
            GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_volume_desc_check(whole.get()), GICODEC_OK);
  ASSERT_EQ(gicodec_volume_desc_add_texture(whole.get(), "color", &desc), GICODEC_OK);
  EXPECT_EQ(gicodec_volume_desc_check(whole.get()), GICODEC_INVALID_DESCRIPTION);
  EXPECT_STREQ(gicodec_volume_desc_problem(whole.get()), "name: two textures have the same");
  const auto flat =
      made<OwnedVolume>([](auto made) { return gicodec_volume_desc_create(1, made); });
  auto map = desc;
  map.model = GICODEC_MODEL_NONE;
  ASSERT_EQ(gicodec_volume_desc_add_texture(flat.get(), "color", &map), GICODEC_OK);
  EXPECT_EQ(std::string_view(gicodec_volume_desc_problem(flat.get())).substr(0, 12),
            "kind: probes");
  EXPECT_EQ(gicodec_volume_desc_texture(whole.get(), 2, &desc), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_volume_desc_texture_name(whole.get(), 2), nullptr);
  EXPECT_EQ(gicodec_volume_desc_group_of(whole.get(), 2),
            static_cast<std::uint32_t>(GICODEC_NO_GROUP));
  for (std::size_t group = 1; group < kMaxGroups; ++group) {
    EXPECT_EQ(gicodec_volume_desc_add_group(whole.get(), 1), GICODEC_OK);
  }
  EXPECT_EQ(gicodec_volume_desc_add_group(whole.get(), 1), GICODEC_LIMIT_EXCEEDED);
  EXPECT_EQ(gicodec_volume_desc_groups(whole.get()), kMaxGroups);
  const auto copy =
      made<OwnedVolume>([&](auto made) { return gicodec_volume_desc_copy(whole.get(), made); });
  EXPECT_EQ(gicodec_volume_desc_groups(copy.get()), kMaxGroups);
}

}  // namespace
}  // namespace gicodec
