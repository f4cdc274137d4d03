// gicodec view: a container as one page of HTML, to look at or to send to somebody.
#include "common/cli.h"
#include "common/container_input.h"
#include "common/installed.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

namespace gicodec::tools {
namespace {

constexpr const char* kViewFooter =
    "The page has everything inside, asks no server for anything, and works from a disk. It shows\n"
    "probes with irradiance and visibility, grids of three.js and Bevy's ambient cubes, and "
    "lights\n"
    "the scene of --scene by them.\n"
    "\n"
    "Examples:\n"
    "  gicodec view villa.gic\n"
    "  gicodec view villa.gic --scene villa.glb --export villa.html\n";

/// Where the page takes what is inside it.
constexpr std::string_view kMark = "<!-- files -->";
constexpr std::uint64_t kMost = std::uint64_t{256} << 20;

struct ViewOptions {
  std::string input, scene, page, output;
  bool overwrite = false;
};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&<>\"'").find(c) == std::string_view::npos) {
      out += c;
    } else {
      out += fmt::format("&#{};", static_cast<int>(c));
    }
  }
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

/// A file as a part of a page that is not run. `magic`: its first bytes.
std::string inside(const std::string& id, const std::string& path, std::string_view magic = {}) {
  require_exists(path);
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(native_path(path), failed);
  if (failed) fail(Exit::io, "{}: cannot be read: {}", path, failed.message());
  if (size > kMost) {
    fail(Exit::bad_input,
         "{}: has {} bytes, and a page takes {}; a server shows larger files: gi-server --play {} "
         "--listen-web 127.0.0.1:8080 --insecure-web",
         path, size, kMost, path);
  }
  const std::string bytes = file_contents(path);
  if (!bytes.starts_with(magic)) {
    fail(
        Exit::bad_input,
        "{}: is no binary glTF file (.glb), which the page takes; gi-trace --export-gltf makes one",
        path);
  }
  return fmt::format(
      "<script type=\"application/octet-stream\" id=\"{}\" data-name=\"{}\">{}</script>\n", id,
      escaped(path_text(native_path(path).filename())), base64(bytes));
}

std::string page_of(const ViewOptions& options) {
  std::string page = options.page;
  if (page.empty()) page = installed_folder("web");
  if (page.empty()) {
    fail(Exit::io,
         "the page is not installed beside this program; packages bring it, script/build-web makes "
         "it, and --page build/web/viewer.html names it");
  }
  if (options.page.empty()) page += "/viewer.html";
  std::string text = file_contents(page);
  const std::size_t at = text.find(kMark);
  if (at == text.npos) {
    fail(Exit::bad_input, "{}: is not the viewer.html that script/build-web makes", page);
  }
  std::string files = inside("container", options.input);
  if (!options.scene.empty()) files += inside("scene", options.scene, "glTF");
  return text.replace(at, kMark.size(), files);
}

/// A file of its own in the folder for such, which stays for the browser.
std::string temporary_page(const std::string& input) {
  std::random_device random;
  const auto folder = std::filesystem::temp_directory_path() /
                      fmt::format("gicodec-view-{:08x}{:08x}", random(), random());
  std::filesystem::create_directory(folder);
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
  return path_text(folder / native_path(input).stem()) + ".html";
}

Exit view(const ViewOptions& options, const Cli& cli) {
  InputFiles inputs({options.input});
  if (!options.scene.empty()) inputs.add(options.scene);
  if (!options.page.empty()) inputs.add(options.page);
  const Existing existing = overwrite_if(options.overwrite);
  if (!options.output.empty()) check_output(options.output, inputs, existing);
  (void)ContainerInput(options.input);  // says what is wrong with it
  const std::string page = page_of(options);
  const std::string output =
      options.output.empty() ? temporary_page(options.input) : options.output;
  write_file(output, std::as_bytes(std::span(page)), existing);
  const bool opened = !options.output.empty() || open_in_browser(output);
  if (!opened || (!options.output.empty() && !cli.quiet && !shares_standard_error(output))) {
    remark(fmt::format("{}: {} bytes{}", output, page.size(),
                       opened ? "" : "; open it in a browser, since none was found"));
  }
  return Exit::ok;
}

}  // namespace

void add_view(Cli& cli) {
  auto options = std::make_shared<ViewOptions>();
  Command* command =
      cli.app.add_command("view", "Shows a container in the browser, or makes a page to send");
  command->footer(kViewFooter);
  command->add_option("container", options->input, "Container to show")
      ->required()
      ->type_name("FILE");
  command->add_option("--scene", options->scene, "glTF scene to light, as .glb")->type_name("FILE");
  command
      ->add_option("--export", options->output,
                   "Page to write, with everything inside; - for standard output")
      ->type_name("FILE");
  command
      ->add_option("--page", options->page,
                   "viewer.html to put it into; default: the one that is installed")
      ->type_name("FILE");
  command->add_flag("--overwrite", options->overwrite, "Replace a page that is there already");
  command->callback([&cli, options] { cli.run = [&cli, options] { return view(*options, cli); }; });
}

}  // namespace gicodec::tools
