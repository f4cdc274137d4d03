// Messages: what was written is read again, and no bytes do harm.
#include "shapes.h"

#include <gicodec/probes.h>
#include <gicodec/protocol.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

std::string random_secret(Random& random, std::size_t max) {
  std::string secret(pick(random, 0, static_cast<std::uint32_t>(max)), ' ');
  for (char& c : secret) c = static_cast<char>(pick(random, 0, 255));
  return secret;
}

/// Of characters of all sizes, control characters included.
std::string random_text(Random& random, std::size_t max) {
  const std::string characters[] = {std::string(1, static_cast<char>(pick(random, 0, 127))), "ü",
                                    "\u20AC", "\U0001F4A1"};
  std::string text;
  for (auto count = pick(random, 0, static_cast<std::uint32_t>(max)); count > 0; --count) {
    const std::string& next = characters[pick(random, 0, 3)];
    if (text.size() + next.size() <= max) text += next;
  }
  return text;
}

StreamId random_stream(Random& random) {
  const bool whole = chance(random, 2);
  return {static_cast<std::uint16_t>(pick(random, 0, kMaxVolumes - 1)),
          static_cast<std::uint8_t>(pick(random, 0, 255)),
          whole ? StreamId::kWholeVolume : pick(random, 0, kMaxBlocks - 1)};
}

std::vector<HeldState> random_held(Random& random) {
  std::vector<HeldState> held(pick(random, 0, 5));
  for (HeldState& state : held) {
    state = {random_stream(random), static_cast<std::uint32_t>(random()),
             static_cast<std::uint32_t>(random())};
  }
  return held;
}

Position random_position(Random& random) {
  Position position{};
  for (float& coordinate : position) coordinate = static_cast<float>(pick(random, 0, 999)) - 500;
  return position;
}

constexpr std::uint32_t kEdition = 7;

std::vector<DescribedVolume> random_volumes(Random& random) {
  std::vector<DescribedVolume> volumes(pick(random, 0, 3));
  std::uint32_t id = 0;
  for (DescribedVolume& volume : volumes) {
    id += pick(random, 0, 300);
    volume.id = static_cast<std::uint16_t>(id++);
    volume.added = pick(random, 0, kEdition);
    volume.name = random_text(random, 20);
    volume.geometry.grid = {pick(random, 1, 9), pick(random, 1, 9), pick(random, 1, 9)};
    volume.geometry.origin = random_position(random);
    volume.geometry.scroll = {-kMaxScroll, kMaxScroll, 0};
    volume.kind = static_cast<std::uint8_t>(pick(random, 0, 255));
    volume.description = noise(random, pick(random, 0, 50));
    volume.region = {pick(random, 1, 9), pick(random, 1, 9), pick(random, 1, 9)};
    volume.textures.resize(pick(random, 0, 3));
    for (DescribedTexture& texture : volume.textures) {
      texture.name = random_text(random, 20);
      texture.layout = any_layout(random, any_desc(random));
      texture.largest_error = chance(random, 2) ? 0 : std::numeric_limits<float>::infinity();
    }
  }
  return volumes;
}

Ticket random_ticket(Random& random) {
  Ticket ticket{};
  for (auto& byte : ticket) byte = static_cast<std::byte>(pick(random, 1, 255));
  return ticket;
}

/// Ascending, of messages of update 900.
std::vector<TrackRun> random_runs(Random& random) {
  std::vector<TrackRun> runs(pick(random, 0, 5));
  std::uint32_t region = 0;
  for (TrackRun& run : runs) {
    region += pick(random, 0, 50);
    run = {{3, 1, region}, pick(random, 1, 40), pick(random, 0, 900), pick(random, 0, 300)};
    region += run.count;
  }
  return runs;
}

/// `packet`: what the parts of an update refer to.
AnyMessage random_message(Random& random, const Bytes& packet) {
  const auto number = [&] { return static_cast<std::uint32_t>(random()); };
  const auto delivery = [&] { return chance(random, 2) ? Delivery::unicast : Delivery::shared; };
  switch (pick(random, 0, 11)) {
    case 0:
      return Hello{number(),
                   chance(random, 2) ? Ticket{} : random_ticket(random),
                   delivery(),
                   {number(), random()},
                   random_secret(random, kMaxToken),
                   number(),
                   random_held(random)};
    case 1:
      return Resync{number(), number(), random_held(random)};
    case 2:
      return Acknowledge{number(), number()};
    case 3:
      return Viewpoint{
          random_position(random), random_position(random), random_position(random), 45, 1.5F, 3};
    case 4: {
      BlockMask mask(pick(random, 0, 100), 0);
      for (auto& block : mask) block = chance(random, 3) ? 1 : 0;
      return Subscribe{number(), static_cast<std::uint16_t>(pick(random, 0, 9)),
                       static_cast<std::uint8_t>(pick(random, 0, 255)), mask};
    }
    case 5:
      return Goodbye{static_cast<Reason>(pick(random, 0, 13)), random_text(random, kMaxText)};
    case 6:
      return Welcome{number(),          random_ticket(random),
                     chance(random, 2), delivery(),
                     random(),          {random_text(random, kMaxName), random()},
                     kEdition,          random_volumes(random)};
    case 7:
      return Volumes{kEdition, random_volumes(random)};
    case 8:
      return TrackList{random(),
                       900,
                       pick(random, 0, 900),
                       {random_text(random, kMaxName), random()},
                       kEdition,
                       random_volumes(random),
                       random_runs(random)};
    case 9: {
      const std::uint64_t update = pick(random, 1, 900);
      TrackObject object{random(),
                         update,
                         pick(random, 0, static_cast<std::uint32_t>(update - 1)),
                         pick(random, 0, 1023),
                         number(),
                         random_stream(random),
                         {},
                         {}};
      if (object.stream.region == StreamId::kWholeVolume) object.stream.region = 0;
      for (std::uint32_t i = 0, packets = pick(random, 1, 2); i < packets; ++i)
        object.packets.push_back(std::span<const std::byte>(packet).first(packet.size() / (i + 1)));
      if (chance(random, 2)) object.proof = {random()};
      return object;
    }
    case 10: {
      TrackTick tick{random(), 900, 12.5, number(), {}, pick(random, 0, 900), random_runs(random)};
      tick.scrolls.resize(pick(random, 0, 3), {-kMaxScroll, 0, kMaxScroll});
      return tick;
    }
    default: {
      UpdateMessage update{number(), number(), number(), random(), 12.5, {}, {}, {}};
      update.scrolls.resize(pick(random, 0, 3), {-kMaxScroll, 0, kMaxScroll});
      for (std::uint32_t i = 0, parts = pick(random, 0, 3); i < parts; ++i) {
        const auto size = pick(random, 0, static_cast<std::uint32_t>(packet.size()));
        update.parts.push_back({random_stream(random),
                                static_cast<std::uint8_t>(pick(random, 0, kMaxTier)),
                                std::span<const std::byte>(packet).first(size)});
      }
      for (std::uint32_t i = 0, proofs = pick(random, 0, 3); i < proofs; ++i) {
        update.proofs.push_back({random_stream(random), random()});
      }
      return update;
    }
  }
}

RC_GTEST_PROP(Messages, AreReadAsTheyWereWritten, (std::uint64_t seed)) {
  Random random(seed);
  const Bytes packet = noise(random, 100);
  const AnyMessage message = random_message(random, packet);
  Message bytes, again;
  RC_ASSERT(write_message(message, bytes) == Status::ok);
  const Exact exact{std::span<const std::byte>(bytes)};
  const auto read = read_message(exact.span());
  RC_ASSERT(read.status() == Status::ok);
  RC_ASSERT(read->index() == message.index());
  RC_ASSERT(write_message(*read, again) == Status::ok);
  RC_ASSERT(again == bytes);
  // Every prefix is refused, and so is a byte too many.
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Exact prefix(std::span<const std::byte>(bytes).first(size));
    RC_ASSERT(!read_message(prefix.span()).ok());
  }
  bytes.push_back(std::byte{0});
  RC_ASSERT(!read_message(bytes).ok());
}

RC_GTEST_PROP(Messages, AnyBytesAreReadOrRefused, (std::uint64_t seed)) {
  Random random(seed);
  const Bytes packet = noise(random, 30);
  Message bytes;
  RC_ASSERT(write_message(random_message(random, packet), bytes) == Status::ok);
  for (int i = 0; i < 20; ++i) {
    Message damaged = bytes;
    for (std::uint32_t flips = pick(random, 1, 4); flips > 0; --flips) {
      const auto bit = pick(random, 0, static_cast<std::uint32_t>(damaged.size() * 8 - 1));
      damaged = flip_bit(damaged, bit);
    }
    const Exact exact{std::span<const std::byte>(damaged)};
    const auto read = read_message(exact.span());
    if (!read) continue;
    Message again;
    RC_ASSERT(write_message(*read, again) == Status::ok);
  }
}

TEST(Messages, NumbersOfObjectsAreLimited) {
  const Bytes packet(9);
  TrackObject object{1, 9, 8, 1024, 1, {0, 0, 0}, {std::span<const std::byte>(packet)}, {}};
  Message bytes;
  EXPECT_EQ(write_message(object, bytes), Status::invalid_argument);
  object.number = 1023;
  EXPECT_EQ(write_message(object, bytes), Status::ok);
  const TrackTick tick{1, 9, 0, 1, {}, 0, {{{0, 0, 0}, 1, 0, 1024}}};
  EXPECT_EQ(write_message(tick, bytes), Status::invalid_argument);
}

TEST(Messages, RefusesAnotherVersionAndAnotherProtocol) {
  for (const AnyMessage& said :
       {AnyMessage(Hello{}), AnyMessage(Welcome{.ticket = {std::byte{1}}})}) {
    Message good;
    ASSERT_EQ(write_message(said, good), Status::ok);
    Message other = good;
    for (unsigned version = 0; version <= UINT8_MAX; ++version) {
      if (version == kProtocolVersion) continue;
      other[5] = static_cast<std::byte>(version);
      EXPECT_EQ(read_message(other).status(), Status::unsupported_version) << version;
    }
    other = good;
    other[1] = std::byte{'x'};
    EXPECT_EQ(read_message(other).status(), Status::not_gicodec);
  }
}

TEST(Messages, RefusesWhatIsBeyondTheLimits) {
  Message subscribe;
  ASSERT_EQ(write_message(Subscribe{1, 0, 0, BlockMask(100, 1)}, subscribe), Status::ok);
  EXPECT_EQ(read_message(subscribe, {.max_bytes = 1000, .max_blocks = 99}).status(),
            Status::limit_exceeded);
  EXPECT_EQ(read_message(subscribe, {.max_bytes = 3}).status(), Status::limit_exceeded);
  EXPECT_TRUE(read_message(subscribe, {.max_bytes = 1000, .max_blocks = 100}).ok());
}

/// A Welcome with the names "Scene", "Volume" and "Texture".
Welcome named_welcome() {
  Welcome welcome{.ticket = {std::byte{1}}, .scene = {"Scene", 1}};
  DescribedVolume volume{.name = "Volume", .kind = kKindProbes, .geometry = {{1, 1, 1}}};
  volume.textures.push_back({"Texture"});
  welcome.volumes.push_back(volume);
  return welcome;
}

TEST(Messages, TakesTextsAsLongAsTheLimits) {
  Welcome welcome = named_welcome();
  welcome.scene.name.assign(kMaxName, 's');
  welcome.volumes[0].description.assign(kMaxKindDescription, std::byte{7});
  Message message;
  ASSERT_EQ(write_message(welcome, message), Status::ok);
  const auto read = read_message(message);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(std::get<Welcome>(*read).scene.name, welcome.scene.name);
  EXPECT_EQ(std::get<Welcome>(*read).volumes, welcome.volumes);
  welcome.volumes[0].description.push_back(std::byte{7});
  EXPECT_EQ(write_message(welcome, message), Status::invalid_argument);
}

TEST(Messages, TakesTheLastVolume) {
  Message message;
  ASSERT_EQ(write_message(Subscribe{1, kMaxVolumes - 1, 0, {}}, message), Status::ok);
  const auto read = read_message(message);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(std::get<Subscribe>(*read).volume, kMaxVolumes - 1);
  EXPECT_EQ(write_message(Subscribe{1, kMaxVolumes, 0, {}}, message), Status::invalid_argument);
}

TEST(Messages, RefusesNumbersThatAreNone) {
  constexpr float kMarked = 1234.5F;
  Viewpoint viewpoint;
  viewpoint.eye = {kMarked, 0, 0};
  Message message;
  ASSERT_EQ(write_message(viewpoint, message), Status::ok);
  const auto marked = std::as_bytes(std::span(&kMarked, 1));
  const auto at = std::search(message.begin(), message.end(), marked.begin(), marked.end());
  ASSERT_NE(at, message.end());
  ASSERT_TRUE(read_message(message).ok());
  for (const float none :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::ranges::copy(std::as_bytes(std::span(&none, 1)), at);
    EXPECT_EQ(read_message(message).status(), Status::corrupt);
  }
}

TEST(Messages, RefusesRegionsBeyondTheirRange) {
  Welcome welcome;
  welcome.ticket[0] = std::byte{1};
  welcome.volumes.resize(1);
  welcome.volumes[0].geometry.grid = {2, 2, 2};
  welcome.volumes[0].textures = {{"t", Tiling::blocks, 0}};
  const std::pair<Grid, bool> cases[] = {{{65535, 1, 1}, true},
                                         {{65536, 1, 1}, false},
                                         {{1, 1, UINT32_MAX}, false},
                                         {{1, 0, 1}, false}};
  for (const auto& [region, good] : cases) {
    welcome.volumes[0].region = region;
    Message message;
    EXPECT_EQ(write_message(welcome, message) == Status::ok, good) << region.x;
  }
}

TEST(Messages, RefusesTextThatIsNoUtf8) {
  const AnyMessage sound[] = {named_welcome(), Goodbye{Reason::left, "Text"}};
  std::size_t names = 0;
  for (const AnyMessage& message : sound) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    for (const std::string_view name : {"Scene", "Volume", "Texture", "Text"}) {
      const auto text = std::as_bytes(std::span(name));
      const auto at = std::search(bytes.begin(), bytes.end(), text.begin(), text.end());
      if (at == bytes.end()) continue;
      ++names;
      // An alone continuation, a lead without one, what is overlong or a surrogate.
      for (const std::string_view bad : {"\x80", "\xC3", "\xC0\x80", "\xED\xA0\x80", "\xFF"}) {
        Message damaged = bytes;
        std::ranges::copy(std::as_bytes(std::span(bad)), damaged.begin() + (at - bytes.begin()));
        EXPECT_EQ(read_message(damaged).status(), Status::corrupt) << name;
      }
    }
  }
  EXPECT_EQ(names, 5U);  // "Text" begins "Texture", too.
  Message hello;
  EXPECT_EQ(write_message(Hello{.token = "\xFF\x80"}, hello), Status::ok);
  EXPECT_TRUE(read_message(hello).ok()) << "a token is a secret, not text";
}

TEST(Messages, WriterRefusesWhatCannotBeRead) {
  Message out;
  EXPECT_EQ(write_message(Hello{.token = std::string(kMaxToken + 1, 'x')}, out),
            Status::invalid_argument);
  EXPECT_EQ(write_message(Welcome{}, out), Status::invalid_argument);
  Welcome welcome{.ticket = {std::byte{1}}};
  welcome.scene.name.assign(kMaxName + 1, 'x');
  EXPECT_EQ(write_message(welcome, out), Status::invalid_argument);
  for (auto spoil :
       {+[](Welcome& w) { w.scene.name = "\xFF"; }, +[](Welcome& w) { w.volumes[0].name = "\xC3"; },
        +[](Welcome& w) { w.volumes[0].textures[0].name = "\xED\xA0\x80"; },
        +[](Welcome& w) { w.volumes[0].description.resize(kMaxKindDescription + 1); },
        +[](Welcome& w) { w.volumes[0].region.y = 0; },
        +[](Welcome& w) { w.volumes[0].id = kMaxVolumes; },
        +[](Welcome& w) { w.volumes[0].added = w.generation + 1; },
        +[](Welcome& w) { w.volumes.push_back(w.volumes[0]); },
        +[](Welcome& w) { w.volumes[0].geometry.spacing[0] = 0; },
        +[](Welcome& w) { w.volumes[0].textures[0].largest_error = -1; }}) {
    welcome = named_welcome();
    EXPECT_EQ(write_message(welcome, out), Status::ok);
    spoil(welcome);
    EXPECT_EQ(write_message(welcome, out), Status::invalid_argument);
  }
  EXPECT_EQ(write_message(Goodbye{Reason::left, "\xFF"}, out), Status::invalid_argument);
  UpdateMessage update;
  update.parts.push_back({{}, kMaxTier, {}});
  EXPECT_EQ(write_message(update, out), Status::ok);
  update.parts[0].tier = kMaxTier + 1;
  EXPECT_EQ(write_message(update, out), Status::invalid_argument);
  EXPECT_EQ(write_message(Viewpoint{.fov_y = std::numeric_limits<float>::quiet_NaN()}, out),
            Status::invalid_argument);
}

}  // namespace
}  // namespace gicodec
