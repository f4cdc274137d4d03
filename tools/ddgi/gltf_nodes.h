// The node tree of a glTF file and its animation.
#pragma once

#include "gltf_accessor.h"

#include <memory>

namespace gicodec::ddgi {

/// World transforms of all nodes at any time. Checked when made: the nodes are trees.
class NodeTree {
 public:
  /// `scene`: whose nodes count, -1 for all.
  NodeTree(const tinygltf::Model& model, const AccessorReader& reader, int scene);

  /// Nodes that belong to the scene, parents first.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }
  /// True if the node or one above it is animated.
  [[nodiscard]] bool moves(std::uint32_t node) const { return moves_[node]; }
  /// One transform per node, by index. Animations repeat after their longest channel.
  [[nodiscard]] std::vector<Affine> world(double time) const;

 private:
  struct Pose {
    Vec3 translation;
    Quat rotation;
    Vec3 scale{1, 1, 1};
    bool fixed = false;  ///< given as a matrix
    Affine matrix;
  };
  enum class Path : std::uint8_t { translation, rotation, scale };
  enum class Interpolation : std::uint8_t { step, linear, cubic };
  struct Channel {
    std::uint32_t node;
    Path path;
    Interpolation interpolation;
    std::vector<float> times;
    std::vector<std::array<float, 4>> values;  ///< three per time for cubic
  };

  void add_nodes(const tinygltf::Model& model, const AccessorReader& reader,
                 const std::vector<int>& roots);
  void add_channels(const tinygltf::Model& model, const AccessorReader& reader);
  static std::array<float, 4> evaluate(const Channel& channel, float time);

  std::vector<Pose> rest_;
  std::vector<std::int32_t> parent_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> moves_;
  std::vector<Channel> channels_;
  float duration_ = 0;
};

}  // namespace gicodec::ddgi
