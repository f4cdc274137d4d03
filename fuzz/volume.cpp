// Volumes of every kind with contents and losses that the input chooses.
#include "input.h"
#include "payload_conformance.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto rows = test::payload_rows();
  const test::Row& row = rows[input.below(static_cast<std::uint32_t>(rows.size()))];
  test::Generator random(input.u16());
  const auto textures = static_cast<std::uint32_t>(textures_of(row.volume).size());
  const auto backends = built_in_backends();
  const auto* backend = backends[input.below(static_cast<std::uint32_t>(backends.size()))];
  switch (input.below(3)) {
    case 0: {
      const auto found = test::check_codec(row.volume, input.below(textures), *backend, random);
      fuzz::check(found.empty() || found == "unsupported", found.c_str());
      break;
    }
    case 1: {
      const auto found = test::check_container(row, random);
      fuzz::check(found.empty(), found.c_str());
      break;
    }
    default: {
      const auto delivery = input.below(2) == 0 ? Delivery::unicast : Delivery::shared;
      const auto found = test::check_session(row, *backend, delivery, 2 + input.below(6), random);
      fuzz::check(found.empty() || found == "unsupported", found.c_str());
    }
  }
  // A description that was not written by anybody.
  for (const Kind* kind : built_in_kinds()) {
    const auto volume = kind->read(input.rest());
    if (!volume) continue;
    fuzz::check(validate(*volume) == Status::ok, "what a kind reads is valid");
    std::vector<std::byte> again;
    fuzz::check(kind->write(*volume, again) == Status::ok, "and can be written");
  }
  return 0;
}
