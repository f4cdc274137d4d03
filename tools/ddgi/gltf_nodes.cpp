#include "gltf_nodes.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

namespace gicodec::ddgi {
namespace {

Quat normalized(std::array<float, 4> q) {
  const float l = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(l > 0)) return {};
  return {q[0] / l, q[1] / l, q[2] / l, q[3] / l};
}

Vec3 vec3(const std::vector<double>& v, Vec3 otherwise) {
  if (v.size() != 3) return otherwise;
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Affine affine(const std::vector<double>& m) {
  const auto column = [&](std::size_t c) {
    return Vec3{static_cast<float>(m[4 * c]), static_cast<float>(m[4 * c + 1]),
                static_cast<float>(m[4 * c + 2])};
  };
  return {column(0), column(1), column(2), column(3)};
}

}  // namespace

NodeTree::NodeTree(const tinygltf::Model& model, const AccessorReader& reader, int scene)
    : rest_(model.nodes.size()), parent_(model.nodes.size(), -1), moves_(model.nodes.size()) {
  std::vector<int> roots;
  if (scene >= 0) {
    roots = model.scenes[static_cast<std::size_t>(scene)].nodes;
  } else {
    std::vector<bool> child(model.nodes.size());
    for (const auto& node : model.nodes) {
      for (const int c : node.children) {
        if (c >= 0 && static_cast<std::size_t>(c) < child.size())
          child[static_cast<std::size_t>(c)] = true;
      }
    }
    for (std::size_t i = 0; i < child.size(); ++i) {
      if (!child[i]) roots.push_back(static_cast<int>(i));
    }
  }
  add_nodes(model, reader, roots);
  add_channels(model, reader);
  for (const std::uint32_t node : order_) {
    if (parent_[node] >= 0 && moves_[static_cast<std::size_t>(parent_[node])]) moves_[node] = 1;
  }
}

void NodeTree::add_nodes(const tinygltf::Model& model, const AccessorReader& reader,
                         const std::vector<int>& roots) {
  std::vector<bool> seen(model.nodes.size());
  const auto add = [&](int index, std::int32_t parent) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.nodes.size()) {
      reader.fail(fmt::format("there is no node {}", index));
    }
    const auto i = static_cast<std::size_t>(index);
    if (seen[i]) reader.fail(fmt::format("node {} is in the tree twice", index));
    seen[i] = true;
    parent_[i] = parent;
    order_.push_back(static_cast<std::uint32_t>(index));
    const auto& node = model.nodes[i];
    Pose& pose = rest_[i];
    if (node.matrix.size() == 16) {
      pose.fixed = true;
      pose.matrix = affine(node.matrix);
    }
    pose.translation = vec3(node.translation, {0, 0, 0});
    pose.scale = vec3(node.scale, {1, 1, 1});
    if (node.rotation.size() == 4) {
      const auto& r = node.rotation;
      pose.rotation = normalized({static_cast<float>(r[0]), static_cast<float>(r[1]),
                                  static_cast<float>(r[2]), static_cast<float>(r[3])});
    }
  };
  for (const int root : roots) add(root, -1);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t parent = order_[i];
    for (const int child : model.nodes[parent].children)
      add(child, static_cast<std::int32_t>(parent));
  }
}

void NodeTree::add_channels(const tinygltf::Model& model, const AccessorReader& reader) {
  for (const auto& animation : model.animations) {
    for (const auto& from : animation.channels) {
      if (from.target_path != "translation" && from.target_path != "rotation" &&
          from.target_path != "scale")
        continue;
      if (from.target_node < 0) continue;
      if (static_cast<std::size_t>(from.target_node) >= model.nodes.size() || from.sampler < 0 ||
          static_cast<std::size_t>(from.sampler) >= animation.samplers.size()) {
        reader.fail("an animation names a node or sampler that is not there");
      }
      const auto& sampler = animation.samplers[static_cast<std::size_t>(from.sampler)];
      Channel channel{};
      channel.node = static_cast<std::uint32_t>(from.target_node);
      channel.path = from.target_path == "translation" ? Path::translation
                     : from.target_path == "rotation"  ? Path::rotation
                                                       : Path::scale;
      channel.interpolation = sampler.interpolation == "STEP"          ? Interpolation::step
                              : sampler.interpolation == "CUBICSPLINE" ? Interpolation::cubic
                                                                       : Interpolation::linear;
      for (const auto& time : reader.floats(sampler.input, 1)) channel.times.push_back(time[0]);
      channel.values = reader.floats(sampler.output, channel.path == Path::rotation ? 4 : 3);
      const std::size_t per_time = channel.interpolation == Interpolation::cubic ? 3 : 1;
      if (channel.times.empty() || channel.values.size() != channel.times.size() * per_time ||
          !std::is_sorted(channel.times.begin(), channel.times.end())) {
        reader.fail("an animation's times and values do not fit together");
      }
      Pose& pose = rest_[channel.node];
      if (pose.fixed)
        reader.fail(fmt::format("node {} is animated, but has a matrix", channel.node));
      moves_[channel.node] = 1;
      duration_ = std::max(duration_, channel.times.back());
      channels_.push_back(std::move(channel));
    }
  }
}

std::array<float, 4> NodeTree::evaluate(const Channel& c, float time) {
  const auto next = std::upper_bound(c.times.begin(), c.times.end(), time);
  const auto k = static_cast<std::size_t>(next - c.times.begin());
  const std::size_t stride = c.interpolation == Interpolation::cubic ? 3 : 1, middle = stride / 2;
  const auto value = [&](std::size_t i) { return c.values[i * stride + middle]; };
  if (k == 0) return value(0);
  if (k == c.times.size() || c.interpolation == Interpolation::step) return value(k - 1);
  const float span = c.times[k] - c.times[k - 1], t = span > 0 ? (time - c.times[k - 1]) / span : 0;
  std::array<float, 4> a = value(k - 1), b = value(k), out{};
  if (c.interpolation == Interpolation::cubic) {
    const auto &leave = c.values[(k - 1) * 3 + 2], &arrive = c.values[k * 3];
    const float t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < 4; ++i) {
      out[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * leave[i] +
               (-2 * t3 + 3 * t2) * b[i] + span * (t3 - t2) * arrive[i];
    }
    return out;
  }
  float wa = 1 - t, wb = t;
  if (c.path == Path::rotation) {
    float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    if (cosine < 0) {
      cosine = -cosine;
      for (float& x : b) x = -x;
    }
    if (cosine < 0.9995F) {
      const float angle = std::acos(cosine), s = std::sin(angle);
      wa = std::sin(wa * angle) / s;
      wb = std::sin(wb * angle) / s;
    }
  }
  for (std::size_t i = 0; i < 4; ++i) out[i] = a[i] * wa + b[i] * wb;
  return out;
}

std::vector<Affine> NodeTree::world(double time) const {
  // The last key itself is still part of the first pass.
  const double wrapped = duration_ > 0 && time > duration_ ? std::fmod(time, duration_) : time;
  std::vector<Pose> poses = rest_;
  for (const Channel& channel : channels_) {
    const auto v = evaluate(channel, static_cast<float>(wrapped));
    Pose& pose = poses[channel.node];
    switch (channel.path) {
      case Path::translation:
        pose.translation = {v[0], v[1], v[2]};
        break;
      case Path::rotation:
        pose.rotation = normalized(v);
        break;
      case Path::scale:
        pose.scale = {v[0], v[1], v[2]};
        break;
    }
  }
  std::vector<Affine> world(poses.size());
  for (const std::uint32_t node : order_) {
    const Pose& pose = poses[node];
    const Affine local =
        pose.fixed ? pose.matrix
                   : translation(pose.translation) * pose.rotation.affine() * scaling(pose.scale);
    world[node] =
        parent_[node] < 0 ? local : world[static_cast<std::size_t>(parent_[node])] * local;
  }
  return world;
}

}  // namespace gicodec::ddgi
