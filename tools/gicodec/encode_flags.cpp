// The flags of gicodec encode.
#include "common/error_flags.h"
#include "encode.h"

#include <memory>

namespace gicodec::tools {
namespace {

constexpr const char* kEncodeFooter =
    "Dumps are files NAME.FFFF.exr (or NAME_FFFF, NAME-FFFF, NAMEFFFF), or .dds, .ktx2, .raw, one\n"
    "per texture and frame; a directory stands for all of them in it. PNG, TIFF and DPX are read\n"
    "where every sample is an exact code; they come back as EXR. A container of ours may be\n"
    "replaced, another file never. While it is being written the container is FILE.partial; one\n"
    "that a killed encode left has to be moved or removed, unless --resume is given.\n"
    "\n"
    "Examples:\n"
    "  gicodec encode -o villa.gic dumps/villa/*.exr\n"
    "  gicodec encode -o villa.gic --backend hevc --hevc-packing planes dumps/villa/\n"
    "  gicodec encode -o room.gic --grid 16x8x16 --core color=8 --core vis=16 *.exr\n"
    "  gicodec encode -o room.gic --layout rtxgi --grid 16x8x16 *.dds\n"
    "  gicodec encode -o light.gic --block 8x8x8 lightmap.*.ktx2\n"
    "  gicodec encode -o room.gic --channels color=R=irr.R,G=irr.G,B=irr.B *.exr\n"
    "  gicodec encode -o room.gic --max-error color=1 --max-error vis=0.001 *.exr\n"
    "  gicodec encode -o - dumps/villa/ | ssh host gicodec decode - -o out/\n";

}  // namespace

std::shared_ptr<const EncodeOptions> add_encode_flags(Cli& cli) {
  auto options = std::make_shared<EncodeOptions>();
  Command* command = cli.app.add_command("encode", "Packs dumps into a .gic container");
  command->footer(kEncodeFooter);
  command->add_option("-o,--output", options->output, "Container to write; - for standard output")
      ->type_name("FILE");
  command->add_option("files", options->inputs, "Dumps of any number of textures and frames")
      ->type_name("FILE");
  command
      ->add_option("--jobs", options->jobs,
                   "Instead of all else: print a line for each job of this manifest, to be run "
                   "here or on other machines (docs/batch.md)")
      ->type_name("JSON");
  command->add_flag("--resume", options->resume,
                    "Keep an output that these flags made, if it gives back the dumps; begin anew "
                    "where an encode was killed");
  command->add_flag("--allow-gaps", options->geometry.numbers.allow_gaps,
                    "Accept missing frames and textures that lack frames");
  command
      ->add_option("--inactive", options->inactive,
                   "Text file with probe indices and ranges a-b that need not be stored")
      ->type_name("FILE");
  command
      ->add_option("--region", options->region,
                   "Cut volumes into boxes of so many blocks, each to be read without the others; "
                   "of a pool runs of X*Y*Z slots")
      ->type_name("XxYxZ");
  add_threads(*command, options->threads);
  add_backend_flags(*command, options->backend);
  add_error_flag(*command, options->max_error, "LOSES BITS: how far texels may be off", "Coding");
  add_geometry_flags(*command, options->geometry);
  add_world_flags(*command, options->world);
  add_number_flags(*command, options->geometry.numbers);
  command->callback([&cli, options, command] {
    options->given = command->given_options(
        {"--output", "files", "--jobs", "--resume", "--threads", "--isa", "--help"});
    cli.run = [&cli, options] { return encode(*options, cli); };
  });
  return options;
}

void add_encode(Cli& cli) { (void)add_encode_flags(cli); }

}  // namespace gicodec::tools
