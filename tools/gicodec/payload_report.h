// Where the bits of native payloads go, for `gicodec info`.
#pragma once

#include "container_input.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>

namespace gicodec::tools {

/// Decodes the packets of one texture to see what they are made of. Says nothing about a texture
/// that has packets of other backends.
class PayloadReport {
 public:
  /// `where` names file, frame and texture in errors.
  void add(const ContainerPacket& packet, const PacketInfo& info, const TextureDesc& desc,
           const std::string& where);
  void print(Format format) const;
  /// Null if there is nothing to say.
  [[nodiscard]] nlohmann::ordered_json json(Format format) const;

 private:
  struct Session {
    std::unique_ptr<PayloadStatistics> last;  ///< of the last packet
    Decoder decoder;
  };
  std::unique_ptr<Session> session_;
  PayloadStatistics keyframes_, updates_;
  bool other_backends_ = false;
};

}  // namespace gicodec::tools
