#include "native/raster/channels.h"

#include "quantise/component_code.h"

namespace gicodec::native {
namespace {

/// Of exponents that mantissas are shifted by.
constexpr unsigned kMaxExponentBits = 5;
constexpr unsigned kMaxLinearBits = 16;

Scale scale_of(const Component& component) {
  switch (component.type) {
    case ComponentType::unorm:
    case ComponentType::uint:
      return component.bits <= kMaxLinearBits ? Scale::linear : Scale::none;
    case ComponentType::ufloat:
      return is_float(component) ? Scale::ufloat : Scale::linear;
    case ComponentType::sfloat:
      return component.bits == 16 ? Scale::half : Scale::none;
    case ComponentType::snorm:
    case ComponentType::exponent:
    case ComponentType::opaque:
      return Scale::none;
  }
  return Scale::none;
}

}  // namespace

Channels channels_of(const Record& record) noexcept {
  Channels channels;
  unsigned exponent = record.count;
  for (unsigned c = record.count; c-- > 0;) {
    const Component& component = record.components[c];
    if (component.type == ComponentType::exponent && component.bits <= kMaxExponentBits)
      exponent = c;
  }
  channels.shared = exponent < record.count;
  if (channels.shared) channels.channel[channels.count++].component = record.components[exponent];
  for (unsigned i = 0; i < record.count; ++i) {
    const unsigned c = record.count >= 3 && i < 2 ? 1 - i : i;
    if (c == exponent) continue;
    const Component& component = record.components[c];
    channels.channel[channels.count++] = {.component = component,
                                          .scale = scale_of(component),
                                          .in_units = channels.shared &&
                                                      component.type == ComponentType::ufloat &&
                                                      !is_float(component)};
  }
  return channels;
}

}  // namespace gicodec::native
