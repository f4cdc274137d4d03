#include "gltf_extras.h"

#include "dump/dump.h"

#include <fmt/core.h>
#include <gicodec/probes.h>
#include <tiny_gltf.h>

namespace gicodec::ddgi {
namespace {

using tinygltf::Value;

constexpr const char* kName = "gicodec";
constexpr double kMax = 1e6;  // metres, radiance

Value array(Vec3 v) {
  return Value(Value::Array{Value(double{v.x}), Value(double{v.y}), Value(double{v.z})});
}

/// An object of the extras and its name, for messages.
struct Part {
  const Value& value;
  std::string name;
  const AccessorReader& reader;

  [[noreturn]] void fail(const char* member, const char* expected) const {
    reader.fail(fmt::format("{}.{}: expected {}; correct it, or remove it from the scene's extras",
                            name, member, expected));
  }
  [[nodiscard]] const Value& member(const char* member) const {
    static const Value none;
    return value.Has(member) ? value.Get(member) : none;
  }
  [[nodiscard]] std::optional<Part> part(const char* member) const {
    if (!value.Has(member)) return std::nullopt;
    if (!value.Get(member).IsObject()) fail(member, "an object");
    return Part{value.Get(member), fmt::format("{}.{}", name, member), reader};
  }
  [[nodiscard]] std::array<double, 3> numbers(const char* member, double least,
                                              const char* expected) const {
    const Value& list = this->member(member);
    if (!list.IsArray() || list.ArrayLen() != 3) fail(member, expected);
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Value& number = list.Get(static_cast<int>(i));
      out[i] = number.IsNumber() ? number.GetNumberAsDouble() : kMax + 1;
      if (!(out[i] >= least && out[i] <= kMax)) fail(member, expected);
    }
    return out;
  }
  [[nodiscard]] Vec3 vector(const char* member, double least, const char* expected) const {
    const auto n = numbers(member, least, expected);
    return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
  }
};

Sky read_sky(const Part& part) {
  const auto light = [&](const char* member) {
    return part.vector(member, 0, "three radiances of 0 to 1000000");
  };
  Sky sky{.zenith = light("zenith"),
          .horizon = light("horizon"),
          .ground = light("ground"),
          .sun_direction =
              direction(part.vector("sun_direction", -kMax, "three numbers that are not all 0")),
          .glow = light("glow")};
  if (sky.sun_direction == Vec3{0, 0, 0})
    part.fail("sun_direction", "three numbers that are not all 0");
  return sky;
}

GltfExtras::Volume read_volume(const Part& part) {
  constexpr const char* grid = "probes along x, y and z";
  const auto n = part.numbers("grid", 1, grid);
  for (const double probes : n) {
    if (probes != std::floor(probes)) part.fail("grid", grid);
  }
  GltfExtras::Volume volume{
      {static_cast<std::uint32_t>(n[0]), static_cast<std::uint32_t>(n[1]),
       static_cast<std::uint32_t>(n[2])},
      {part.vector("first", -kMax, "a position"), part.vector("last", -kMax, "a position")}};
  if (validate(ddgi_irradiance(volume.grid)) != Status::ok) part.fail("grid", grid);
  const Vec3 size = volume.box.size();
  if (size.x <= 0 || size.y <= 0 || size.z <= 0) part.fail("last", "a position beyond the first");
  return volume;
}

}  // namespace

Value to_value(const GltfExtras& extras) {
  Value::Object all;
  if (extras.sky) {
    const Sky& sky = *extras.sky;
    all["sky"] = Value(Value::Object{{"zenith", array(sky.zenith)},
                                     {"horizon", array(sky.horizon)},
                                     {"ground", array(sky.ground)},
                                     {"sun_direction", array(sky.sun_direction)},
                                     {"glow", array(sky.glow)}});
  }
  if (extras.volume) {
    const auto& [grid, box] = *extras.volume;
    const auto count = [](std::uint32_t n) { return Value(static_cast<int>(n)); };
    all["volume"] = Value(
        Value::Object{{"grid", Value(Value::Array{count(grid.x), count(grid.y), count(grid.z)})},
                      {"first", array(box.lo)},
                      {"last", array(box.hi)}});
  }
  if (extras.exposure) all["exposure"] = Value(double{*extras.exposure});
  return Value(Value::Object{{kName, Value(std::move(all))}});
}

GltfExtras read_extras(const Value& extras, const AccessorReader& reader) {
  GltfExtras out;
  if (!extras.IsObject()) return out;
  const auto ours = Part{extras, "extras", reader}.part(kName);
  if (!ours) return out;
  if (const auto sky = ours->part("sky")) out.sky = read_sky(*sky);
  if (const auto volume = ours->part("volume")) out.volume = read_volume(*volume);
  const Value& exposure = ours->member("exposure");
  if (exposure.IsNumber()) {
    const double factor = exposure.GetNumberAsDouble();
    if (!(factor >= 1e-6 && factor <= kMax))
      ours->fail("exposure", "a factor of 0.000001 to 1000000");
    out.exposure = static_cast<float>(factor);
  }
  return out;
}

}  // namespace gicodec::ddgi
