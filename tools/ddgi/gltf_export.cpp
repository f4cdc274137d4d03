#include "dump/error.h"
#include "dump/file.h"
#include "gltf.h"
#include "gltf_extras.h"

#include <tiny_gltf.h>

#include <map>
#include <sstream>
#include <tuple>

namespace gicodec::ddgi {
namespace {

std::vector<double> doubles(Vec3 v) { return {v.x, v.y, v.z}; }

/// Rotation of a matrix whose columns are orthogonal and not mirrored.
Quat rotation_of(const Affine& m) {
  const Vec3 x = normalize(m.x), y = normalize(m.y), z = normalize(m.z);
  const float trace = x.x + y.y + z.z;
  if (trace > 0) {
    const float s = 2 * std::sqrt(trace + 1);
    return {(y.z - z.y) / s, (z.x - x.z) / s, (x.y - y.x) / s, s / 4};
  }
  if (x.x > y.y && x.x > z.z) {
    const float s = 2 * std::sqrt(1 + x.x - y.y - z.z);
    return {s / 4, (y.x + x.y) / s, (z.x + x.z) / s, (y.z - z.y) / s};
  }
  if (y.y > z.z) {
    const float s = 2 * std::sqrt(1 + y.y - x.x - z.z);
    return {(y.x + x.y) / s, s / 4, (z.y + y.z) / s, (z.x - x.z) / s};
  }
  const float s = 2 * std::sqrt(1 + z.z - x.x - y.y);
  return {(z.x + x.z) / s, (z.y + y.z) / s, s / 4, (x.y - y.x) / s};
}

Affine camera_transform(const Camera& camera) {
  const Vec3 z = normalize(camera.eye - camera.target), x = normalize(cross(camera.up, z));
  return {x, cross(z, x), z, camera.eye};
}

/// A transform that turns -z, the direction of glTF's lights, into the light's, bit for bit.
Affine light_transform(const Light& light) {
  Vec3 u, v;
  basis(normalize(-light.direction), u, v);
  return {u, v, -light.direction, light.position};
}

/// The least power of two that is not below the channels, so that dividing by it is exact.
float scale_of(Vec3 colour) {
  int exponent = 0;
  (void)std::frexp(std::max({colour.x, colour.y, colour.z}), &exponent);
  return std::ldexp(1.0F, exponent);
}

class Exporter {
 public:
  explicit Exporter(const Scene& scene, const FrameState& state, const SecondUvs& second)
      : scene_(scene), state_(state), second_(second) {
    model_.asset.generator = "gicodec gi-trace";
    model_.buffers.resize(1);
    model_.scenes.resize(1);
    model_.defaultScene = 0;
  }

  std::string run(double start, std::uint32_t frames, double fps) {
    for (const Image& image : scene_.images) add_image(image);
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) add_material(i);
    add_objects(start, frames, fps);
    add_lights();
    add_camera(start, frames, fps);
    model_.scenes[0].extras = to_value({.sky = state_.sky,
                                        .volume = {{scene_.grid, scene_.volume}},
                                        .exposure = scene_.camera_at(start).exposure});
    if (!animation_.channels.empty()) model_.animations.push_back(animation_);
    tinygltf::TinyGLTF writer;
    std::ostringstream stream;
    if (!writer.WriteGltfSceneToStream(&model_, stream, false, true)) {
      tools::fail(tools::Exit::internal, "the glTF file cannot be composed");
    }
    return stream.str();
  }

 private:
  template <typename T>
  int add_accessor(std::span<const T> data, int component, int type, int target,
                   std::size_t count) {
    auto& bytes = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = data.size_bytes();
    view.target = target;
    const auto* first = reinterpret_cast<const unsigned char*>(data.data());
    bytes.insert(bytes.end(), first, first + data.size_bytes());
    model_.bufferViews.push_back(view);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  void add_image(const Image& image) {
    tinygltf::Image out;
    out.name = fmt::format("image{}", model_.images.size());
    out.mimeType = "image/png";
    out.width = static_cast<int>(image.base().width);
    out.height = static_cast<int>(image.base().height);
    out.component = 3;
    out.bits = 8;
    out.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    for (const auto& texel : image.base().texels)
      out.image.insert(out.image.end(), texel.begin(), texel.end());
    model_.images.push_back(std::move(out));
    tinygltf::Texture texture;
    texture.source = static_cast<int>(model_.images.size()) - 1;
    model_.textures.push_back(texture);
  }

  void add_material(std::size_t index) {
    const Material& from = scene_.materials[index];
    tinygltf::Material out;
    out.name = from.name;
    out.doubleSided = from.two_sided;
    out.pbrMetallicRoughness.baseColorFactor = {from.colour.x, from.colour.y, from.colour.z, 1};
    out.pbrMetallicRoughness.metallicFactor = 0;
    out.pbrMetallicRoughness.roughnessFactor = 1;
    out.pbrMetallicRoughness.baseColorTexture.index = from.image;
    const Vec3 e = state_.emission[index];
    const float strength = std::max(1.0F, scale_of(e));
    out.emissiveFactor = doubles(e / strength);
    if (strength > 1) {
      out.extensions["KHR_materials_emissive_strength"] = tinygltf::Value(tinygltf::Value::Object{
          {"emissiveStrength", tinygltf::Value(static_cast<double>(strength))}});
      use("KHR_materials_emissive_strength");
    }
    model_.materials.push_back(std::move(out));
  }

  void use(const std::string& extension) {
    auto& used = model_.extensionsUsed;
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
  }

  /// The mesh with a vertex for each place that it has in the second texture coordinates.
  static Mesh split(const Mesh& mesh, const std::vector<std::array<Vec2, 3>>& corners,
                    std::vector<Vec2>& uvs) {
    Mesh out;
    out.material = mesh.material;
    std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> vertices;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = mesh.triangles[t][i];
        const Vec2 uv = corners[t][i];
        const auto [place, isnew] = vertices.try_emplace(
            {from, uv.x, uv.y}, static_cast<std::uint32_t>(out.positions.size()));
        triangle[i] = place->second;
        if (!isnew) continue;
        out.positions.push_back(mesh.positions[from]);
        out.normals.push_back(mesh.normals[from]);
        out.uvs.push_back(mesh.uvs[from]);
        uvs.push_back(uv);
      }
      out.triangles.push_back(triangle);
    }
    return out;
  }

  tinygltf::Primitive primitive(const Mesh& whole,
                                const std::vector<std::array<Vec2, 3>>* corners) {
    std::vector<Vec2> second;
    const Mesh cut = corners != nullptr ? split(whole, *corners, second) : Mesh{};
    const Mesh& mesh = corners != nullptr ? cut : whole;
    const auto count = mesh.positions.size();
    Box box;
    for (const Vec3 p : mesh.positions) box.add(p);
    tinygltf::Primitive out;
    out.mode = TINYGLTF_MODE_TRIANGLES;
    out.material = static_cast<int>(mesh.material);
    const int position =
        add_accessor<Vec3>(mesh.positions, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                           TINYGLTF_TARGET_ARRAY_BUFFER, count);
    model_.accessors.back().minValues = doubles(box.lo);
    model_.accessors.back().maxValues = doubles(box.hi);
    out.attributes["POSITION"] = position;
    out.attributes["NORMAL"] =
        add_accessor<Vec3>(mesh.normals, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                           TINYGLTF_TARGET_ARRAY_BUFFER, count);
    out.attributes["TEXCOORD_0"] =
        add_accessor<Vec2>(mesh.uvs, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2,
                           TINYGLTF_TARGET_ARRAY_BUFFER, count);
    if (corners != nullptr) {
      out.attributes["TEXCOORD_1"] =
          add_accessor<Vec2>(second, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2,
                             TINYGLTF_TARGET_ARRAY_BUFFER, count);
    }
    out.indices = add_accessor<std::array<std::uint32_t, 3>>(
        mesh.triangles, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, mesh.triangles.size() * 3);
    return out;
  }

  /// A node that can be animated.
  int add_moving_node(const std::string& name, const Affine& transform) {
    tinygltf::Node node;
    node.name = name;
    const Quat q = rotation_of(transform);
    node.translation = doubles(transform.t);
    node.rotation = {q.x, q.y, q.z, q.w};
    node.scale = doubles({length(transform.x), length(transform.y), length(transform.z)});
    return add_node(std::move(node));
  }

  /// A node whose transform keeps its bits.
  int add_fixed_node(const std::string& name, const Affine& transform) {
    tinygltf::Node node;
    node.name = name;
    if (!(transform == Affine{})) {
      for (const Vec3 column : {transform.x, transform.y, transform.z, transform.t}) {
        for (const float value : {column.x, column.y, column.z}) node.matrix.push_back(value);
        node.matrix.push_back(node.matrix.size() == 15 ? 1 : 0);
      }
    }
    return add_node(std::move(node));
  }

  int add_node(tinygltf::Node node) {
    model_.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model_.nodes.size()) - 1;
    model_.scenes[0].nodes.push_back(index);
    return index;
  }

  void add_objects(double start, std::uint32_t frames, double fps) {
    std::vector<FrameState> states;
    for (std::uint32_t f = 0; f < frames; ++f) states.push_back(scene_.state_at(start + f / fps));
    std::size_t instance = 0;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const Object& object = scene_.objects[i];
      tinygltf::Mesh mesh;
      mesh.name = object.name;
      for (const std::uint32_t m : object.meshes) {
        const auto* const corners = second_.empty() ? nullptr : &second_[instance];
        ++instance;
        if (!scene_.meshes[m].triangles.empty())
          mesh.primitives.push_back(primitive(scene_.meshes[m], corners));
      }
      model_.meshes.push_back(std::move(mesh));
      const int node = object.dynamic ? add_moving_node(object.name, state_.transforms[i])
                                      : add_fixed_node(object.name, state_.transforms[i]);
      model_.nodes.back().mesh = static_cast<int>(model_.meshes.size()) - 1;
      if (!object.dynamic) continue;
      std::vector<Affine> path;
      path.reserve(states.size());
      for (const FrameState& state : states) path.push_back(state.transforms[i]);
      animate(node, path, fps);
    }
  }

  void animate(int node, const std::vector<Affine>& path, double fps) {
    std::vector<Vec3> translations;
    std::vector<Quat> rotations;
    for (const Affine& m : path) {
      translations.push_back(m.t);
      rotations.push_back(rotation_of(m));
    }
    if (times_ < 0) {
      std::vector<float> times;
      for (std::size_t f = 0; f < path.size(); ++f)
        times.push_back(static_cast<float>(static_cast<double>(f) / fps));
      times_ = add_accessor<float>(times, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 0,
                                   times.size());
      model_.accessors.back().minValues = {times.front()};
      model_.accessors.back().maxValues = {times.back()};
    }
    const auto channel = [&](const char* target, int values) {
      tinygltf::AnimationSampler sampler;
      sampler.input = times_;
      sampler.output = values;
      sampler.interpolation = "LINEAR";
      animation_.samplers.push_back(sampler);
      tinygltf::AnimationChannel out;
      out.sampler = static_cast<int>(animation_.samplers.size()) - 1;
      out.target_node = node;
      out.target_path = target;
      animation_.channels.push_back(out);
    };
    channel("translation", add_accessor<Vec3>(translations, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                              TINYGLTF_TYPE_VEC3, 0, path.size()));
    channel("rotation", add_accessor<Quat>(rotations, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                           TINYGLTF_TYPE_VEC4, 0, path.size()));
  }

  void add_lights() {
    for (const Light& light : state_.lights) {
      if (light.type == LightType::area) continue;  // glTF knows none
      if (std::max({light.colour.x, light.colour.y, light.colour.z}) <= 0) continue;
      const float intensity = scale_of(light.colour);
      tinygltf::Light out;
      out.type = light.type == LightType::sun    ? "directional"
                 : light.type == LightType::spot ? "spot"
                                                 : "point";
      out.intensity = intensity;
      out.color = doubles(light.colour / intensity);
      if (light.type == LightType::spot) {
        out.spot.innerConeAngle = std::acos(double{light.cos_inner});
        out.spot.outerConeAngle = std::acos(double{light.cos_outer});
      }
      model_.lights.push_back(out);
      add_fixed_node(fmt::format("light{}", model_.lights.size() - 1), light_transform(light));
      model_.nodes.back().extensions["KHR_lights_punctual"] =
          tinygltf::Value(tinygltf::Value::Object{
              {"light", tinygltf::Value(static_cast<int>(model_.lights.size()) - 1)}});
      use("KHR_lights_punctual");
    }
  }

  void add_camera(double start, std::uint32_t frames, double fps) {
    const Camera camera = scene_.camera_at(start);
    tinygltf::Camera out;
    out.type = "perspective";
    out.perspective.yfov = radians(camera.fov_y);
    out.perspective.aspectRatio = 16.0 / 9;
    out.perspective.znear = 0.05;
    out.perspective.zfar = 1000;
    model_.cameras.push_back(out);
    const int node = add_moving_node("camera", camera_transform(camera));
    model_.nodes.back().camera = 0;
    std::vector<Affine> path;
    for (std::uint32_t f = 0; f < frames; ++f)
      path.push_back(camera_transform(scene_.camera_at(start + f / fps)));
    animate(node, path, fps);
  }

  const Scene& scene_;
  const FrameState& state_;
  const SecondUvs& second_;
  tinygltf::Model model_;
  tinygltf::Animation animation_;
  int times_ = -1;
};

}  // namespace

void save_gltf(const std::string& path, const Scene& scene, double start, std::uint32_t frames,
               double fps, tools::Existing existing, const SecondUvs& second) {
  if (!path.ends_with(".glb"))
    tools::fail(tools::Exit::usage, "{}: scenes are exported as .glb; name the file so", path);
  const FrameState state = scene.state_at(start);
  const std::string bytes = Exporter(scene, state, second).run(start, frames, fps);
  tools::write_file(path, std::as_bytes(std::span(bytes)), existing);
}

std::string gltf_bytes(const Scene& scene, double start) {
  const FrameState state = scene.state_at(start);
  return Exporter(scene, state, {}).run(start, 1, 1);
}

}  // namespace gicodec::ddgi
