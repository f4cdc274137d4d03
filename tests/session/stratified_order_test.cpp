// The order in which vertices of irradiance vectors come (Pacanowski et al. §4.1).
#include "session/server/stratified_order.h"
#include "session/bricks.h"
#include "session/server/priority.h"

#include <gicodec/irradiance_vectors.h>

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

namespace gicodec {
namespace {

using namespace test;

std::size_t count_of(const Grid& grid) { return std::size_t{grid.x} * grid.y * grid.z; }

std::array<std::uint32_t, 3> place_of(const Grid& grid, std::uint32_t vertex) {
  return {vertex % grid.x, vertex / grid.x % grid.y, vertex / grid.x / grid.y};
}

bool is_corner(const Grid& grid, std::uint32_t vertex) {
  const auto at = place_of(grid, vertex);
  const std::array<std::uint32_t, 3> last{grid.x - 1, grid.y - 1, grid.z - 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] != 0 && at[axis] != last[axis]) return false;
  }
  return true;
}

std::size_t corners_of(const Grid& grid) {
  return std::size_t{grid.x > 1 ? 2U : 1U} * (grid.y > 1 ? 2U : 1U) * (grid.z > 1 ? 2U : 1U);
}

/// Vertices in their order.
std::vector<std::uint32_t> in_order(const std::vector<std::uint32_t>& places) {
  std::vector<std::uint32_t> vertices(places.size());
  std::iota(vertices.begin(), vertices.end(), 0U);
  std::ranges::sort(vertices, {}, [&](std::uint32_t vertex) { return places[vertex]; });
  return vertices;
}

/// What is wrong with the order of a grid's vertices; empty if nothing is.
std::string wrong_with(const Grid& grid) {
  const auto places = stratified_order(grid);
  if (places != stratified_order(grid)) return "another order for the same grid";
  if (places.size() != count_of(grid)) return "not as many places as vertices";
  const auto vertices = in_order(places);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    if (places[vertices[i]] != i) return "no permutation";
    if (is_corner(grid, vertices[i]) != (i < corners_of(grid))) return "corners are not first";
  }
  // Along the longest axis; of axes as long as each other along any of them.
  const std::array<std::uint32_t, 3> size{grid.x, grid.y, grid.z};
  const std::uint32_t longest = std::max({grid.x, grid.y, grid.z});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] != longest) continue;
    std::vector<std::size_t> left(longest), come(longest);
    for (std::size_t i = corners_of(grid); i < vertices.size(); ++i) {
      ++left[place_of(grid, vertices[i])[axis]];
    }
    bool even = true;
    for (std::size_t i = corners_of(grid); i < vertices.size() && even; ++i) {
      const std::size_t slice = place_of(grid, vertices[i])[axis];
      ++come[slice], --left[slice];
      const std::size_t most = *std::ranges::max_element(come);
      for (std::size_t s = 0; s < longest; ++s)
        even = even && (left[s] == 0 || come[s] + 1 >= most);
    }
    if (even) return "";
  }
  return "some slices have more than others";
}

TEST(StratifiedOrder, OfGridsThatAreFlatOrSmall) {
  for (const Grid& grid :
       {Grid{1, 1, 1}, Grid{1, 1, 9}, Grid{5, 1, 1}, Grid{1, 7, 1}, Grid{2, 1, 1}, Grid{2, 2, 2},
        Grid{1, 4, 4}, Grid{3, 3, 3}, Grid{16, 16, 16}}) {
    EXPECT_EQ(wrong_with(grid), "") << grid.x << 'x' << grid.y << 'x' << grid.z;
  }
  EXPECT_EQ(stratified_order({1, 1, 1}), (std::vector<std::uint32_t>{0}));
}

RC_GTEST_PROP(StratifiedOrder, IsEvenOverTheSlicesOfTheLongestAxis, (std::uint64_t seed)) {
  Random random(seed);
  const Grid grid{pick(random, 1, 14), pick(random, 1, 14), pick(random, 1, 14)};
  RC_LOG() << grid.x << 'x' << grid.y << 'x' << grid.z;
  const std::string wrong = wrong_with(grid);
  RC_LOG() << ": " << wrong;
  RC_ASSERT(wrong.empty());
}

/// Of axes as long as each other along the last.
TEST(StratifiedOrder, GoesAlongTheLastOfTheLongestAxes) {
  constexpr Grid kEven{4, 3, 4};
  const auto vertices = in_order(stratified_order(kEven));
  for (std::uint32_t slice = 0; slice < kEven.z; ++slice) {
    EXPECT_EQ(place_of(kEven, vertices[corners_of(kEven) + slice])[2], slice);
  }
}

/// Within a slice they come by chance: not row by row.
TEST(StratifiedOrder, IsRandomWithinASlice) {
  constexpr Grid kSlices{12, 12, 20};
  const auto vertices = in_order(stratified_order(kSlices));
  double turn = 0, step = 0;
  std::array<std::uint32_t, 3> last{};
  for (const std::uint32_t vertex : vertices) {
    const auto at = place_of(kSlices, vertex);
    if (at[2] != 7) continue;
    turn += at[0] < last[0] ? 1 : 0;
    step += std::abs(static_cast<double>(at[1]) - static_cast<double>(last[1]));
    last = at;
  }
  EXPECT_NEAR(turn / 144, 0.46, 0.15);
  EXPECT_NEAR(step / 144, 4, 1);
}

TEST(BlockOrder, IsThatOfVerticesOnlyWhereBlocksAreVertices) {
  constexpr Grid kVertices{4, 3, 5};
  const auto vectors = *irradiance_vector_volume(kVertices);
  EXPECT_EQ(block_order(vectors.groups[0].textures[0].desc), stratified_order(kVertices));
  const auto order = block_order(ddgi_irradiance(kVertices));
  ASSERT_EQ(order.size(), count_of(kVertices));
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], spread_order(kVertices, i));
}

/// A budget of blocks gives bundles: as many vertices in each update until all have come.
TEST(StratifiedOrder, IsHowAClientWithABudgetOfBlocksIsSentThem) {
  for (const Grid& grid : {Grid{6, 5, 9}, Grid{1, 1, 9}, Grid{11, 4, 2}}) {
    for (const std::uint32_t budget : {8U, 13U, 64U}) {
      for (const char* backend : {"native", "zstd"}) {
        const VolumeDesc volume = *irradiance_vector_volume(grid);
        const TextureDesc& desc = volume.groups[0].textures[0].desc;
        const std::uint32_t all = block_count(desc);
        Distributor distributor = make_distributor(backend);
        ASSERT_TRUE(distributor.add_volume(volume, {grid}).ok());
        const ClientId client = *distributor.connect(Delivery::unicast, {budget, 0});
        ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(all, 1)), Status::ok);
        Random random(budget);
        Texture vectors(desc);
        vectors.fill(Fill::noise, random);
        ASSERT_EQ(distributor.publish(0, 0, std::as_const(vectors).view()), Status::ok);
        const auto order = in_order(stratified_order(grid));
        std::map<StreamId, Decoder> decoders;
        for (std::uint32_t sent = 0; sent < all;) {
          ASSERT_EQ(distributor.update(), Status::ok);
          const auto blocks = sent_by(distributor, client, decoders, volume)[0];
          const std::uint32_t due = std::min(budget, all - sent);
          ASSERT_EQ(blocks.size(), due);
          EXPECT_TRUE(std::ranges::is_permutation(blocks, std::span(order).subspan(sent, due)));
          if (sent == 0) {
            const auto corners = std::ranges::count_if(
                blocks, [&](std::uint32_t vertex) { return is_corner(grid, vertex); });
            EXPECT_EQ(static_cast<std::size_t>(corners), corners_of(grid));
          }
          sent += due;
        }
        EXPECT_EQ(contents(decoders.begin()->second), vectors.blocks());
        ASSERT_EQ(distributor.update(), Status::ok);
        EXPECT_TRUE(distributor.packets(client).empty());
      }
    }
  }
}

/// The same through a server and a client, which shows what it has.
TEST(StratifiedOrder, BundlesGoThroughAServer) {
  constexpr Grid kVertices{5, 4, 7};
  constexpr std::uint32_t kBudget = 12, kAll = 140;
  const VolumeDesc volume = *irradiance_vector_volume(kVertices, true);
  ServerOptions server_options;
  server_options.proofs = true;
  auto server = *Server::create(server_options);
  ASSERT_TRUE(server.add_volume("vectors", volume, {kVertices}).ok());
  ClientOptions options;
  options.budget.blocks = kBudget;
  auto client = *Client::create(options);
  const ConnectionId connection = *server.connect(0);
  server.receive(connection, *client.hello(), 0);
  Random random(3);
  Texture vectors(volume.groups[0].textures[0].desc);
  vectors.fill(Fill::noise, random);
  Message subscribe;
  ASSERT_EQ(write_message(AnyMessage(Subscribe{1, 0, 0, BlockMask(kAll, 1)}), subscribe),
            Status::ok);
  server.receive(connection, subscribe, 0);
  ASSERT_EQ(server.publish(0, 0, std::as_const(vectors).view()), Status::ok);
  const auto order = in_order(stratified_order(kVertices));
  std::uint32_t held = 0;
  double now = 0;
  for (int update = 0; held < kAll && update < 100; ++update) {
    now += 0.1;
    ASSERT_EQ(server.update(now, now), Status::ok);
    for (const Message& message : joined(server.take_messages(connection))) {
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) server.receive(connection, reply, now);
    if (client.frame().volumes.empty()) continue;
    const ClientTexture& texture = client.frame().volumes[0].textures[0];
    const auto come = static_cast<std::uint32_t>(
        std::ranges::count_if(texture.changed, [](auto serial) { return serial != 0; }));
    EXPECT_EQ(come, std::min(held + kBudget, kAll));
    held = come;
    for (std::uint32_t i = 0; i < held; ++i) EXPECT_NE(texture.changed[order[i]], 0U);
  }
  EXPECT_EQ(held, kAll);
  EXPECT_EQ(client.statistics().failed_proofs, 0U);
  EXPECT_GT(client.statistics().proofs, 10U);
  EXPECT_TRUE(
      same(client.frame().volumes[0].textures[0].texels, std::as_const(vectors).view().bytes));
}

}  // namespace
}  // namespace gicodec
