// Descriptions as JSON, for people and for languages without structs.
#pragma once

#include <gicodec/container.h>
#include <gicodec/kind.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace gicodec::c {

/// Writes JSON text, member by member.
class Json {
 public:
  void begin_object(std::string_view name = {}) { begin(name, '{'); }
  void begin_array(std::string_view name = {}) { begin(name, '['); }
  void end_object() { end('}'); }
  void end_array() { end(']'); }
  /// Of an object with a name, of an array without one. Bytes that are not UTF-8 become U+FFFD.
  void add(std::string_view name, std::string_view value);
  void add(std::string_view name, const char* value) { add(name, std::string_view(value)); }
  void add(std::string_view name, std::uint64_t value);
  void add(std::string_view name, std::int64_t value);
  void add(std::string_view name, std::uint32_t value) { add(name, std::uint64_t{value}); }
  /// With as many digits as bring the same number back; null if it is not finite.
  void add(std::string_view name, float value);
  void add(std::string_view name, bool value);

  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  void begin(std::string_view name, char bracket);
  void end(char bracket);
  void lead(std::string_view name);
  void quote(std::string_view value);

  std::string text_;
  bool first_ = true;
};

/// Adds members to the object that was begun.
void describe(const TextureDesc& desc, Json& json);
/// A whole object.
void describe(const VolumeDesc& volume, Json& json);
void describe(const ContainerDescription& description, Json& json);

}  // namespace gicodec::c
