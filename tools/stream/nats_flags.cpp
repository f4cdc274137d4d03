#include "nats_flags.h"

#include "dump/error.h"
#include "dump/text.h"
#include "nats_tracks.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gicodec::streaming {

void add_nats_flags(tools::Command& app, NatsFlags& flags, const std::string& what,
                    const std::string& group) {
  app.add_option("--nats", flags.urls, what)->type_name("URL[,URL...]")->group(group);
  app.add_option("--nats-prefix", flags.prefix,
                 "What subjects begin with: a publisher and its viewers have the same")
      ->type_name("NAME")
      ->show_default()
      ->group(group);
  app.add_option("--nats-user", flags.user, "User of the servers")->type_name("NAME")->group(group);
  app.add_option("--nats-password-file", flags.password_file,
                 "File whose first line is the user's password")
      ->type_name("FILE")
      ->group(group);
  app.add_option("--nats-ca", flags.ca,
                 "PEM file of authorities that may vouch for the servers; default: the system's")
      ->type_name("FILE")
      ->group(group);
}

void check_nats_flags(const NatsFlags& flags) {
  if (flags.user.empty() != flags.password_file.empty())
    tools::fail(tools::Exit::usage,
                "--nats-user and --nats-password-file belong together; name both");
  if (!flags.urls.empty()) {
    static_cast<void>(TrackSubjects(flags.prefix));
    static_cast<void>(nats_urls(flags.urls, "--nats"));
    for (const auto& [flag, path] : {std::pair("--nats-ca", flags.ca),
                                     std::pair("--nats-password-file", flags.password_file)}) {
      if (!path.empty() && access(path.c_str(), R_OK) != 0)
        tools::fail(tools::Exit::io, "{} {}: cannot be read: {}", flag, tools::printable(path),
                    std::strerror(errno));
    }
    return;
  }
  if (!flags.user.empty() || !flags.password_file.empty() || !flags.ca.empty() ||
      flags.prefix != NatsFlags{}.prefix)
    tools::fail(tools::Exit::usage,
                "--nats-prefix, --nats-user, --nats-password-file and --nats-ca are for --nats");
}

}  // namespace gicodec::streaming
