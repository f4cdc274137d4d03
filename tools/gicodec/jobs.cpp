#include "jobs.h"

#include "dump/directory.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/text.h"
#include "encode.h"
#include "encode_volumes.h"
#include "verified.h"

#include <gicodec/probes.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <utility>

namespace gicodec::tools {
namespace {

using Value = nlohmann::json;

struct Job {
  std::string output;
  std::vector<std::string> inputs, flags;
};

/// A manifest, for messages about its jobs.
class Manifest {
 public:
  explicit Manifest(const std::string& path) : path_(path) {
    Value json;
    try {
      json = Value::parse(file_contents(path));
    } catch (const Value::exception& error) {
      fail(Exit::bad_input, "{}: is no JSON: {}", path_, error.what());
    }
    require_keys(json, {"flags", "jobs"}, "the manifest");
    const auto common = texts(json, "flags", "the manifest");
    if (!json.contains("jobs") || !json["jobs"].is_array() || json["jobs"].empty()) {
      fail(Exit::bad_input, "{}: has no list \"jobs\"", path_);
    }
    for (std::size_t i = 0; i < json["jobs"].size(); ++i) {
      add(json["jobs"][i], common, fmt::format("job {}", i + 1));
    }
  }
  [[nodiscard]] const std::vector<Job>& jobs() const { return jobs_; }

 private:
  void require_keys(const Value& json, std::initializer_list<const char*> known,
                    const std::string& where) const {
    if (!json.is_object()) fail(Exit::bad_input, "{}: {} is not an object", path_, where);
    for (const auto& item : json.items()) {
      const bool found = std::ranges::any_of(known, [&](const char* k) { return item.key() == k; });
      if (!found) {
        fail(Exit::bad_input, "{}: {} has a key \"{}\"; it takes {}", path_, where, item.key(),
             listed(known, std::identity{}));
      }
    }
  }

  [[nodiscard]] std::vector<std::string> texts(const Value& json, const char* key,
                                               const std::string& where) const {
    std::vector<std::string> found;
    if (!json.contains(key)) return found;
    const Value& list = json[key];
    const bool good = list.is_array() && std::ranges::all_of(list, [](const Value& one) {
                        return one.is_string() && !one.get<std::string>().empty();
                      });
    if (!good) fail(Exit::bad_input, "{}: {}: \"{}\" is not a list of texts", path_, where, key);
    for (const Value& one : list) found.push_back(one);
    return found;
  }

  void add(const Value& json, const std::vector<std::string>& common, const std::string& where) {
    require_keys(json, {"output", "inputs", "each", "flags"}, where);
    const auto text = [&](const char* key) {
      return json.contains(key) && json[key].is_string() ? json[key].get<std::string>()
                                                         : std::string();
    };
    Job job{text("output"), texts(json, "inputs", where), common};
    const auto own = texts(json, "flags", where);
    job.flags.insert(job.flags.end(), own.begin(), own.end());
    const std::string each = text("each");
    if (job.output.empty() || job.inputs.empty() == each.empty()) {
      fail(Exit::bad_input, "{}: {} needs \"output\", and either \"inputs\" or \"each\"", path_,
           where);
    }
    if (each.empty()) return add(std::move(job), where);
    const auto place = job.output.find("{}");
    if (place == std::string::npos) {
      fail(Exit::bad_input,
           "{}: {}: \"output\" needs {{}} for the name of each folder, such as out/{{}}.gic", path_,
           where);
    }
    for (const std::string& name : folders_in(each, where)) {
      Job one = job;
      one.output.replace(place, 2, name);
      one.inputs = {path_text(native_path(each) / native_path(name)) + "/"};
      add(std::move(one), where);
    }
  }

  void add(Job job, const std::string& where) {
    const auto place = std::filesystem::absolute(native_path(job.output)).lexically_normal();
    if (!outputs_.insert(path_text(place)).second) {
      fail(Exit::bad_input, "{}: {}: another job writes {} too", path_, where, job.output);
    }
    for (const std::string& input : job.inputs) require_exists(input);
    jobs_.push_back(std::move(job));
  }

  [[nodiscard]] std::vector<std::string> folders_in(const std::string& folder,
                                                    const std::string& where) const {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(native_path(folder), error)) {
      if (entry.is_directory()) names.push_back(path_text(entry.path().filename()));
    }
    if (error) fail(Exit::io, "{}: {}: {}: {}", path_, where, folder, error.message());
    if (names.empty()) fail(Exit::bad_input, "{}: {}: {} has no folders", path_, where, folder);
    std::ranges::sort(names);
    return names;
  }

  std::string path_;
  std::vector<Job> jobs_;
  std::set<std::string> outputs_;
};

std::vector<std::string> command_of(const Job& job) {
  std::vector<std::string> words{"gicodec", "encode", "--quiet", "--resume", "-o", job.output};
  for (const std::string& input : job.inputs) {
    words.push_back(input.starts_with('-') ? "./" + input : input);
  }
  words.insert(words.end(), job.flags.begin(), job.flags.end());
  return words;
}

/// Throws for flags that encode does not take, as far as that does not depend on the dumps, before
/// a thousand jobs find out.
void require_flags(const Job& job, const std::vector<std::string>& words) {
  for (const std::string& flag : job.flags) {
    for (const char* const other : {"-o", "--output", "--jobs", "-h", "--help", "--"}) {
      const std::string_view name(other);
      if (flag == name || (name.size() > 2 && flag.starts_with(std::string(name) + "="))) {
        fail(Exit::usage, "{} is none of a job's flags", other);
      }
    }
  }
  Cli probe;
  probe.app.require_command();
  probe.app.add_flag("-q,--quiet", probe.quiet, "");
  const auto options = add_encode_flags(probe);
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  (void)probe.app.parse(static_cast<int>(arguments.size()), arguments.data());
  if (options->output != job.output || options->inputs.size() != job.inputs.size()) {
    fail(Exit::usage, "its flags name outputs or dumps; these have keys of their own");
  }
  (void)region_of(options->region);
  (void)layout_volume(options->geometry);
  (void)make_encoder(options->backend,
                     probe_texture(Format::A2B10G10R10_UNORM_PACK32, {1, 1, 1}, 8), "", 0, 0, 1);
}

void require_job(const Job& job, const std::vector<std::string>& words,
                 const std::string& manifest) {
  try {
    if (job.output == "-") fail(Exit::usage, "a job writes a file");
    require_folder(job.output);
    require_flags(job, words);
  } catch (const Error& error) {
    fail(Exit::usage, "{}: the job of {}: {}", manifest, job.output, error.what());
  }
}

}  // namespace

Exit write_plan(const std::string& path, const Cli& cli) {
  const Manifest manifest(path);
  std::string plan;
  for (const Job& job : manifest.jobs()) {
    const auto words = command_of(job);
    require_job(job, words, path);
    std::string line;
    for (const std::string& word : words) {
      const auto is_control = [](char c) {
        return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
      };
      if (std::ranges::any_of(word, is_control)) {
        fail(Exit::bad_input, "{}: the job of {}: names have no control characters in a plan", path,
             job.output);
      }
      if (!line.empty()) {
        line += ' ';
      }
      line += shell_word(word);
    }
    plan += line + "\n";
  }
  AtomicFile out("-");
  out.write(std::as_bytes(std::span(plan)));
  out.commit();
  if (!cli.quiet) {
    const std::size_t count = manifest.jobs().size();
    remark(fmt::format("{}: {} job{}", path, count, count == 1 ? "" : "s"));
  }
  return Exit::ok;
}

bool is_finished(const std::string& container, const std::string& flags,
                 const std::vector<std::string>& dumps, const std::vector<std::string>& max_error,
                 bool lossy, unsigned threads) {
  if (!is_container_file(container)) return false;
  VerifyOptions options;
  options.input = container;
  options.format = "json";  // which keeps damage as a finding
  if (!lossy) {
    options.files = dumps;
    options.max_error = max_error;
  }
  options.decoder.threads = threads;
  Cli quiet;
  quiet.quiet = true;
  try {
    const Verified verified = verify_dumps(options, quiet);
    const ContainerInput& input = *verified.input;
    const std::string* const made_by = find_metadata(input.description().metadata, kFlagsKey);
    return made_by != nullptr && *made_by == flags && verified.damage.empty() && !input.cut_off() &&
           (lossy || verified.good());
  } catch (const Error&) {
    return false;  // What is wrong with it does not matter: it is made anew.
  }
}

}  // namespace gicodec::tools
