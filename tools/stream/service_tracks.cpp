// What a service publishes over NATS.
#include "dump/dump.h"
#include "dump/error.h"
#include "service.h"

namespace gicodec::streaming {

void Service::begin_tracks() {
  if (!nats_) return;
  tracks_.emplace(tools::take(TrackPublisher::create(server_, options_.tracks), "tracks"));
}

void Service::publish_tracks() {
  if (!nats_) return;
  nats_->publish(*tracks_);
  statistics_.published(tracks_->statistics(), nats_->unanswered());
}

/// Ends the service if another publisher has taken over.
void Service::attend_tracks() {
  if (!nats_) return;
  const bool goes_on = nats_->attend(*tracks_);
  if (const std::string remarks = nats_->remarks(); !remarks.empty()) log("{}", remarks);
  if (goes_on) return;
  log("another gi-server publishes under this --nats-prefix now; this one ends");
  replaced_ = true;
}

}  // namespace gicodec::streaming
