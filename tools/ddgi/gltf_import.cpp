#include "framing.h"
#include "gltf.h"
#include "gltf_extras.h"
#include "gltf_file.h"
#include "gltf_nodes.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <filesystem>

namespace gicodec::ddgi {
namespace {

Vec3 colour(const std::vector<double>& c) {
  if (c.size() < 3) return {1, 1, 1};
  const auto channel = [&](std::size_t i) {
    return static_cast<float>(std::clamp(c[i], 0.0, 1e6));
  };
  return {channel(0), channel(1), channel(2)};
}

double extension_number(const tinygltf::ExtensionMap& map, const char* extension, const char* name,
                        double otherwise) {
  const auto found = map.find(extension);
  if (found == map.end() || !found->second.Has(name)) return otherwise;
  const auto& value = found->second.Get(name);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

class Importer {
 public:
  Importer(const tinygltf::Model& model, const std::string& path)
      : model_(model), path_(path), reader_(model, path) {}

  Scene run() {
    for (const auto& image : model_.images) add_image(image);
    for (const auto& material : model_.materials) add_material(material);
    scene_.add_material({.name = "default", .colour = {0.7F, 0.7F, 0.7F}});
    for (const auto& mesh : model_.meshes) add_mesh(mesh);
    int root = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    if (static_cast<std::size_t>(root) >= model_.scenes.size()) root = -1;
    tree_ = std::make_shared<NodeTree>(model_, reader_, root);
    if (root >= 0)
      extras_ = read_extras(model_.scenes[static_cast<std::size_t>(root)].extras, reader_);
    add_nodes();
    if (scene_.triangle_count() == 0)
      reader_.fail("there are no triangles to draw; export its meshes as triangles");
    finish();
    return std::move(scene_);
  }

 private:
  void add_image(const tinygltf::Image& image) {
    const auto w = static_cast<std::size_t>(std::max(image.width, 0)),
               h = static_cast<std::size_t>(std::max(image.height, 0));
    const auto step = static_cast<std::size_t>(std::max(image.component, 0)) *
                      static_cast<std::size_t>(std::max(image.bits, 0)) / 8;
    std::vector<std::array<std::uint8_t, 3>> texels;
    if (w == 0 || h == 0 || step == 0 || image.image.size() / step / w < h) {
      reader_.fail("image " + std::to_string(scene_.images.size()) + " cannot be read");
    }
    texels.reserve(w * h);
    const std::size_t channel = static_cast<std::size_t>(image.bits) / 8;
    for (std::size_t i = 0; i < w * h; ++i) {
      // The high byte of each channel; little-endian. Grey images have one or two channels.
      const auto* texel = image.image.data() + i * step + channel - 1;
      const std::size_t g = image.component >= 3 ? channel : 0, b = 2 * g;
      texels.push_back({texel[0], texel[g], texel[b]});
    }
    scene_.add_image(
        Image(static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h), std::move(texels)));
  }

  [[nodiscard]] std::int32_t image_of(int texture) const {
    if (texture < 0) return -1;
    if (static_cast<std::size_t>(texture) >= model_.textures.size())
      reader_.fail("a material names a texture that is not there");
    const int source = model_.textures[static_cast<std::size_t>(texture)].source;
    if (source >= static_cast<int>(scene_.images.size()))
      reader_.fail("a texture names an image that is not there");
    return source;
  }

  void add_material(const tinygltf::Material& from) {
    Material material;
    material.name = from.name;
    material.colour = min(colour(from.pbrMetallicRoughness.baseColorFactor), {1, 1, 1});
    material.image = image_of(from.pbrMetallicRoughness.baseColorTexture.index);
    material.two_sided = from.doubleSided;
    const auto strength = static_cast<float>(std::clamp(
        extension_number(from.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1),
        0.0, 1e6));
    if (from.emissiveFactor.size() == 3) material.emission = colour(from.emissiveFactor) * strength;
    // An emissive image counts by its mean.
    const std::int32_t glow = image_of(from.emissiveTexture.index);
    if (glow >= 0)
      material.emission =
          material.emission * scene_.images[static_cast<std::size_t>(glow)].sample({}, 1e9F);
    scene_.add_material(std::move(material));
  }

  void add_mesh(const tinygltf::Mesh& from) {
    std::vector<std::uint32_t> parts;
    for (const auto& primitive : from.primitives) {
      Mesh mesh = read_primitive(primitive);
      if (!mesh.triangles.empty()) parts.push_back(scene_.add_mesh(std::move(mesh)));
    }
    meshes_.push_back(std::move(parts));
  }

  Mesh read_primitive(const tinygltf::Primitive& from) {
    Mesh mesh;
    const int mode = from.mode < 0 ? TINYGLTF_MODE_TRIANGLES : from.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
        mode != TINYGLTF_MODE_TRIANGLE_FAN)
      return mesh;
    const auto attribute = [&](const char* name) {
      const auto found = from.attributes.find(name);
      return found == from.attributes.end() ? -1 : found->second;
    };
    const int positions = attribute("POSITION"), normals = attribute("NORMAL"),
              uvs = attribute("TEXCOORD_0");
    if (positions < 0) return mesh;
    for (const auto& p : reader_.floats(positions, 3)) mesh.positions.push_back({p[0], p[1], p[2]});
    if (uvs >= 0) {
      for (const auto& t : reader_.floats(uvs, 2)) mesh.uvs.push_back({t[0], t[1]});
    }
    if (normals >= 0) {
      for (const auto& n : reader_.floats(normals, 3)) mesh.normals.push_back({n[0], n[1], n[2]});
    }
    const std::size_t count = mesh.positions.size();
    if (mesh.uvs.empty()) mesh.uvs.resize(count);
    if (mesh.uvs.size() != count || (!mesh.normals.empty() && mesh.normals.size() != count)) {
      reader_.fail("a mesh has attributes of different lengths");
    }
    std::vector<std::uint32_t> indices;
    if (from.indices >= 0) {
      indices = reader_.indices(from.indices);
    } else {
      for (std::uint32_t i = 0; i < count; ++i) indices.push_back(i);
    }
    for (const std::uint32_t i : indices) {
      if (i >= count) reader_.fail("a mesh has an index beyond its vertices");
    }
    const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    for (std::size_t i = 0; i + 2 < indices.size(); i += step) {
      if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        mesh.triangles.push_back({indices[0], indices[i + 1], indices[i + 2]});
      } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2) {
        mesh.triangles.push_back({indices[i + 1], indices[i], indices[i + 2]});
      } else {
        mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
      }
    }
    const bool has_material =
        from.material >= 0 && static_cast<std::size_t>(from.material) < model_.materials.size();
    mesh.material = static_cast<std::uint32_t>(
        has_material ? static_cast<std::size_t>(from.material) : model_.materials.size());
    if (mesh.normals.empty()) make_flat(mesh);
    return mesh;
  }

  /// glTF asks for flat normals where a mesh has none: no two triangles share a vertex then.
  static void make_flat(Mesh& mesh) {
    Mesh flat;
    flat.material = mesh.material;
    for (const auto& t : mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(flat.positions.size());
      const Vec3 n = normalize(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                     mesh.positions[t[2]] - mesh.positions[t[0]]));
      for (const std::uint32_t i : t) {
        flat.positions.push_back(mesh.positions[i]);
        flat.uvs.push_back(mesh.uvs[i]);
        flat.normals.push_back(n);
      }
      flat.triangles.push_back({first, first + 1, first + 2});
    }
    mesh = std::move(flat);
  }

  void add_nodes() {
    const std::vector<Affine> world = tree_->world(0);
    std::uint64_t triangles = 0;
    for (const std::uint32_t index : tree_->order()) {
      const auto& node = model_.nodes[index];
      if (node.mesh >= 0) {
        if (static_cast<std::size_t>(node.mesh) >= meshes_.size())
          reader_.fail("a node names a mesh that is not there");
        const auto& parts = meshes_[static_cast<std::size_t>(node.mesh)];
        for (const std::uint32_t part : parts) triangles += scene_.meshes[part].triangles.size();
        if (triangles > kMaxGltfTriangles) {
          reader_.fail(fmt::format("has more than {} triangles", kMaxGltfTriangles));
        }
        if (!parts.empty()) {
          scene_.add_object({.name = node.name,
                             .meshes = parts,
                             .transform = world[index],
                             .dynamic = tree_->moves(index)});
          object_nodes_.push_back(index);
        }
      }
      const double light = extension_number(node.extensions, "KHR_lights_punctual", "light", -1);
      if (light >= 0) add_light(static_cast<std::size_t>(light), index);
      if (node.camera >= 0 && camera_node_ < 0) add_camera(node.camera, index);
    }
  }

  void add_light(std::size_t number, std::uint32_t node) {
    if (number >= model_.lights.size()) reader_.fail("a node names a light that is not there");
    const auto& from = model_.lights[number];
    Light light;
    light.type = from.type == "directional" ? LightType::sun
                 : from.type == "spot"      ? LightType::spot
                                            : LightType::point;
    light.colour = colour(from.color) * static_cast<float>(std::clamp(from.intensity, 0.0, 1e6));
    light.cos_inner = static_cast<float>(std::cos(from.spot.innerConeAngle));
    light.cos_outer =
        std::min(static_cast<float>(std::cos(from.spot.outerConeAngle)), light.cos_inner - 1e-3F);
    scene_.lights.push_back(light);
    light_nodes_.push_back(node);
  }

  void add_camera(int number, std::uint32_t node) {
    if (static_cast<std::size_t>(number) >= model_.cameras.size())
      reader_.fail("a node names a camera that is not there");
    const auto& camera = model_.cameras[static_cast<std::size_t>(number)];
    if (camera.type != "perspective") return;
    camera_node_ = static_cast<std::int32_t>(node);
    fov_y_ = static_cast<float>(std::clamp(camera.perspective.yfov, 0.01, 3.0)) * 180 / kPi;
  }

  void finish() {
    const Vec3 size = scene_.bounds().size();
    if (!std::isfinite(length(size)) || length(size) > 1e6F)
      reader_.fail("its extent is beyond reason; scale it to metres");
    if (length(size) <= 0) reader_.fail("all its triangles are a single point");
    set_light();
    scene_.animate = [tree = tree_, objects = object_nodes_, lights = light_nodes_](
                         double time, FrameState& state) {
      const std::vector<Affine> world = tree->world(time);
      for (std::size_t i = 0; i < objects.size(); ++i) {
        if (tree->moves(objects[i])) state.transforms[i] = world[objects[i]];
      }
      for (std::size_t i = 0; i < lights.size(); ++i) {
        const Affine& m = world[lights[i]];
        state.lights[i].position = m.t;
        state.lights[i].direction = direction(-m.z);
      }
    };
    if (camera_node_ >= 0) {
      scene_.camera_path = [tree = tree_, node = static_cast<std::size_t>(camera_node_),
                            fov = fov_y_, exposure = extras_.exposure.value_or(1)](double time) {
        const Affine m = tree->world(time)[node];
        return Camera{.eye = m.t,
                      .target = m.t - normalize(m.z),
                      .up = normalize(m.y),
                      .fov_y = fov,
                      .exposure = exposure};
      };
    }
    frame();
  }

  void set_light() {
    if (extras_.sky) {
      scene_.sky = *extras_.sky;
    } else if (!scene_.lights.empty()) {
      scene_.sky = {.zenith = {0.02F, 0.03F, 0.05F},
                    .horizon = {0.04F, 0.045F, 0.05F},
                    .ground = {0.01F, 0.01F, 0.01F}};
    } else {
      // A file without lights is shown by day.
      scene_.sky = {.zenith = {0.15F, 0.27F, 0.55F},
                    .horizon = {0.45F, 0.52F, 0.60F},
                    .ground = {0.12F, 0.11F, 0.10F}};
      scene_.lights.push_back({.type = LightType::sun,
                               .colour = {3, 2.7F, 2.3F},
                               .direction = normalize({-0.4F, -1, -0.3F})});
    }
  }

  /// Volume and camera, by rays where the file does not say.
  void frame() {
    if (extras_.volume) {
      scene_.grid = extras_.volume->grid;
      scene_.volume = extras_.volume->box;
      if (camera_node_ >= 0) return;
    }
    const RayScene rays(scene_);
    if (!extras_.volume) {
      scene_.grid = {16, 8, 16};
      scene_.volume = find_volume(rays);
    }
    if (camera_node_ >= 0) return;
    if (const auto view = find_view(rays)) scene_.cameras.push_back(view->camera);
  }

  const tinygltf::Model& model_;
  std::string path_;
  AccessorReader reader_;
  Scene scene_;
  std::shared_ptr<NodeTree> tree_;
  std::vector<std::vector<std::uint32_t>> meshes_;  ///< of the scene, by mesh of the file
  std::vector<std::uint32_t> object_nodes_, light_nodes_;
  std::int32_t camera_node_ = -1;
  float fov_y_ = 60;
  GltfExtras extras_;
};

}  // namespace

Scene load_gltf(const std::string& path, bool outside) {
  std::vector<std::string> files;
  const tinygltf::Model model = read_gltf_file(path, files, outside);
  Scene scene = Importer(model, path).run();
  scene.name = std::filesystem::path(path).filename().string();
  scene.files = std::move(files);
  return scene;
}

}  // namespace gicodec::ddgi
