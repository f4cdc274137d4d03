// gicodec info: reports what a container holds and where its bytes go.
#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/http_source.h"
#include "common/volume_words.h"
#include "container_report.h"
#include "geometry_flags.h"
#include "info_dump.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace gicodec::tools {
namespace {

constexpr const char* kInfoFooter =
    "Of a dump it says what is in it, and the command that packs it. Of a container: ratios are\n"
    "against the full textures, guard bands included, and against the records of the\n"
    "blocks in the packets. Packet bytes count everything: header, block indices, guard bands "
    "that\n"
    "do not follow the rule, payload. Packets are checked, of volumes of any kind. --verbose "
    "decodes\n"
    "native packets, as far as their size warrants it, and says how many bytes their heads,\n"
    "tables, modes and planes take, and in percent how often each mode, the way in which a block\n"
    "is predicted (docs/native.md), was chosen.\n"
    "\n"
    "Of a URL only the index is read, which says how many packets there are and how many bytes "
    "they\n"
    "take, with what surrounds them; --packets and --verbose read all.\n"
    "\n"
    "Examples:\n"
    "  gicodec info villa.gic\n"
    "  gicodec info villa.gic --fps 10\n"
    "  gicodec info villa.gic --packets\n"
    "  gicodec info https://example.com/villa.gic\n"
    "  gicodec info villa.gic --format json | jq .textures[0].updates\n";

struct InfoOptions {
  std::string input;
  std::string format = "text";
  bool packets = false;
  bool metadata = false;
  bool verbose = false;
  std::optional<double> fps;
  bool allow_incomplete = false;
  GeometryFlags geometry;
  DecoderFlags decoder;
};

void add_packet(const ContainerPacket& packet, const InfoOptions& options, LookBudget& budget,
                ContainerReport& all) {
  const std::string where = all.input.where(packet);
  TextureReport& report = all.textures[packet.texture_id];
  const ContainerDescription& description = all.input.description();
  const TextureEntry& entry = description.textures[packet.texture_id];
  check(verify_checksum(packet.bytes), where);
  const PacketInfo info = take(peek(packet.bytes), where);
  std::optional<TextureDesc> desc;
  if (is_known(entry)) desc = part_of(description, entry, packet.region);
  if (desc && !info.all_blocks && info.blocks > block_count(*desc)) check(Status::corrupt, where);
  for (Sums* sums : {is_keyframe(info.type) ? &report.keyframes : &report.updates, &report.all}) {
    sums->add(info, packet.bytes.size(), desc ? &*desc : nullptr);
  }
  if (!report.first_frame) report.first_frame = packet.frame;
  report.last_frame = packet.frame;
  report.backends.insert(info.backend);
  if (options.verbose && desc) report.payload.add(packet, info, *desc, where, budget);
  if (!options.packets) return;
  report.packets.push_back({packet.frame, packet.region, info, packet.bytes.size(),
                            blocks_in(info, desc ? &*desc : nullptr)});
}

Totals totals_of(const ContainerInput& input, const std::vector<TextureReport>& reports,
                 std::size_t frames, bool damaged) {
  Totals totals;
  totals.frames = frames;
  totals.bytes = input.bytes();
  totals.whole = !damaged && !input.cut_off();
  // The size of a pipe, read to its end.
  if (!totals.bytes && !damaged) totals.bytes = input.bytes_read();
  std::uint64_t file_bytes = 0;
  bool known = totals.whole;  // otherwise some files' frames are missing
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const std::optional<std::uint64_t> full = reports[i].all.full_bytes;
    totals.packet_bytes += reports[i].all.bytes;
    totals.texture_bytes =
        totals.texture_bytes && full ? std::optional(*totals.texture_bytes + *full) : std::nullopt;
    file_bytes += input.textures()[i].file_bytes;
    known &= input.textures()[i].file_bytes > 0;
    if (!reports[i].first_frame) continue;
    totals.first_frame = std::min(totals.first_frame.value_or(UINT64_MAX), *reports[i].first_frame);
    totals.last_frame = std::max(totals.last_frame.value_or(0), *reports[i].last_frame);
  }
  if (known) totals.file_bytes = file_bytes;
  return totals;
}

/// Reads all packets, and counts frames. Throws Error at damage.
void add_packets(const InfoOptions& options, const Cli& cli, ContainerReport& report,
                 std::size_t& frames) {
  LookBudget budget;
  Progress progress("reading frame", 0, cli);
  while (report.input.skip_frame()) {
    progress.step();
    ++frames;
    for (const ContainerPacket& packet : report.input.packets()) {
      add_packet(packet, options, budget, report);
    }
  }
}

/// Takes what the index lists; false if there is none.
bool add_listed(ContainerReport& report, std::size_t& frames) {
  const auto listed = report.input.from_index();
  if (!listed) return false;
  frames = listed->frames;
  const ContainerDescription& description = report.input.description();
  for (const ListedPart& part : listed->parts) {
    TextureReport& own = report.textures[part.part.texture_id];
    const TextureEntry& entry = description.textures[part.part.texture_id];
    std::optional<std::uint64_t> full;
    if (is_known(entry)) full = texture_bytes(part_of(description, entry, part.part.region));
    own.keyframes.add_listed(part.keyframes, part.keyframe_bytes, full);
    own.updates.add_listed(part.packets - part.keyframes, part.bytes - part.keyframe_bytes, full);
    own.all.add_listed(part.packets, part.bytes, full);
    own.first_frame = std::min(own.first_frame.value_or(part.first_frame), part.first_frame);
    own.last_frame = std::max(own.last_frame.value_or(0), part.last_frame);
  }
  report.by_index = true;
  return true;
}

Exit info(const InfoOptions& options, const Cli& cli) {
  if (!is_url(options.input) && is_dump(options.input)) {
    print_dump(options.input, options.geometry, options.format == "json");
    return Exit::ok;
  }
  ContainerInput input(options.input, options.decoder);
  ContainerReport report{input, {}, {}, options.fps, options.metadata, false, {}};
  report.textures.resize(input.textures().size());
  std::size_t frames = 0;
  const bool all = input.cost() == nullptr || options.packets || options.verbose;
  try {
    if (all || !add_listed(report, frames)) add_packets(options, cli, report, frames);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    report.damage = error.what();
  }
  // Behind the packets, which are listed whether or not it is sound.
  std::string damaged_metadata;
  try {
    if (report.damage.empty()) input.read_metadata(options.allow_incomplete);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    damaged_metadata = error.what();
  }
  if (!cli.quiet) remark_cost(input);
  report.totals = totals_of(input, report.textures, frames, !report.damage.empty());
  if (options.format == "json") {
    print_json(to_json(report));
  } else {
    print_text(report);
  }
  if (!report.damage.empty()) {
    remark(fmt::format("{}; {}", report.damage, recovery(input)));
    return Exit::bad_input;
  }
  if (!damaged_metadata.empty()) {
    remark(damaged_metadata);
    return Exit::bad_input;
  }
  return report_cut_off(input, recovery(input), options.allow_incomplete);
}

}  // namespace

void add_info(Cli& cli) {
  auto options = std::make_shared<InfoOptions>();
  Command* command = cli.app.add_command(
      "info", "Lists volumes, textures, frames, sizes and ratios of a container");
  command->footer(kInfoFooter);
  command
      ->add_option("container", options->input,
                   "Container to read, file or URL; - for standard input")
      ->required()
      ->type_name("FILE");
  command->add_flag("--packets", options->packets, "One line per packet as well");
  command->add_flag("--metadata", options->metadata, "What is kept about the files as well");
  command->add_flag("--verbose", options->verbose,
                    "What native packets are made of as well; decodes them");
  command->add_option("--fps", options->fps, "Frames per second, for the bit rate")
      ->allow(in_range(0.001, 1e6))
      ->type_name("N");
  add_allow_incomplete(*command, options->allow_incomplete);
  add_output_format(*command, options->format);
  add_geometry_flags(*command, options->geometry);
  add_http_flags(*command, options->decoder.http);
  command->callback([&cli, options] { cli.run = [&cli, options] { return info(*options, cli); }; });
}

}  // namespace gicodec::tools
