#include "c/host.h"

#include "c/calls.h"

namespace gicodec::c {

Status Host::set(const gicodec_host* given) {
  if (const Status status = take(given, given_); status != Status::ok) return status;
  if ((given_.allocate == nullptr) != (given_.release == nullptr)) return Status::invalid_argument;
  memory_ = {given_.allocate, given_.release, given_.memory};
  if (given_.threads > kMaxThreads) return Status::invalid_settings;
  threads_.count = given_.threads == 0 ? 1 : given_.threads;
  if (given_.run != nullptr) threads_.executor = {run, this};
  if (given_.isa != nullptr) {
    const auto isa = isa_from_string(given_.isa);
    if (!isa || !is_supported(*isa)) return Status::invalid_settings;
    isa_ = *isa;
  }
  given_.isa = nullptr;  // the caller's text
  return Status::ok;
}

void Host::run(void* self, unsigned count, void (*work)(void*, unsigned) noexcept, void* context) {
  const gicodec_host& host = static_cast<Host*>(self)->given_;
  host.run(host.executor, count, work, context);
}

}  // namespace gicodec::c
