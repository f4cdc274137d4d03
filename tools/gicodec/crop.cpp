// gicodec crop: cuts a box of probes out of dumps.
#include "common/cli.h"
#include "common/stored_texture.h"
#include "dump/block_place.h"
#include "dump/cure.h"
#include "dump/directory.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/geometry_attributes.h"
#include "dump/sequence.h"
#include "dump/text.h"
#include "dump/texture_file.h"
#include "geometry_flags.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>

namespace gicodec::tools {
namespace {

constexpr const char* kCropFooter =
    "Writes dumps of the same names that hold only the probes, or blocks, of a box of the grid,\n"
    "texels and attributes as they are, but gicodec:origin, which goes to the first one of the\n"
    "box, and those that say its size. A block is what --block says, 8x8 texels unless given.\n"
    "Files that are there already are kept unless --overwrite is given, the inputs always.\n"
    "\n"
    "Examples:\n"
    "  gicodec crop --origin 4,0,8 --size 8x8x8 -o small/ dumps/villa/*.exr\n"
    "  gicodec crop --origin 0,0,0 --size 4x4x4 --compression piz -o small/ dumps/villa/\n";

constexpr auto kCompressions = std::span(kExrCompressions).first<5>();

struct CropOptions {
  std::vector<std::string> inputs;
  std::string output;
  std::string origin;
  std::string size;
  std::string compression;
  bool overwrite = false;
  GeometryFlags geometry;
};

/// Moves the attribute of the origin to that of the box.
void move_origin(Attributes& attributes, const Grid& by) {
  const auto origin = find_floats(attributes, kOriginAttribute, 3);
  const auto spacing = find_floats(attributes, kSpacingAttribute, 3);
  if (!origin || !spacing) return;
  const auto moved = [&](std::size_t axis, std::uint32_t probes) {
    return (*origin)[axis] + static_cast<float>(probes) * (*spacing)[axis];
  };
  set_attribute(attributes,
                {kOriginAttribute, "v3f",
                 fmt::format("{} {} {}", moved(0, by.x), moved(1, by.y), moved(2, by.z))});
}

/// TextureDesc::records of the box.
Grid cropped_records(const TextureDesc& desc, const Grid& origin, const Grid& size) {
  if (desc.records == Grid{}) return {};
  const auto side = [](std::uint32_t all, std::uint32_t first, std::uint32_t count,
                       std::uint32_t block) {
    return std::min(all - first * block, count * block);
  };
  return {side(desc.records.x, origin.x, size.x, desc.block.x),
          side(desc.records.y, origin.y, size.y, desc.block.y),
          side(desc.records.z, origin.z, size.z, desc.block.z)};
}

/// Throws unless an image has all blocks of the box.
void require_box(const TextureDesc& desc, const Grid& origin, const Grid& size,
                 const std::string& path) {
  const auto fits = [](std::uint32_t start, std::uint32_t count, std::uint32_t all) {
    return std::uint64_t{start} + count <= all;
  };
  if (!fits(origin.x, size.x, desc.grid.x) || !fits(origin.y, size.y, desc.grid.y) ||
      !fits(origin.z, size.z, desc.grid.z)) {
    fail(Exit::usage, "{}: {} {}s from ({}, {}, {}) on do not fit its grid {}", path,
         to_string(size), block_word(desc), origin.x, origin.y, origin.z, to_string(desc.grid));
  }
  if (desc.space == Space::pool) {
    fail(Exit::bad_input, "{}: holds a pool, whose blocks are no box of anything", path);
  }
}

/// True if attributes say what a file's texture is, or have to: a file of another kind did.
bool is_described(const DumpInfo& info, const std::string& path) {
  return is_probes(info.desc) || !is_written(require_image_kind(path)) ||
         find_attribute(info.attributes, kFormat) != nullptr;
}

Dump crop_dump(const Dump& from, const Grid& origin, const Grid& size, const std::string& path) {
  const TextureDesc& old_desc = from.info.desc;
  require_box(old_desc, origin, size, path);
  Dump to;
  to.info = from.info;
  to.info.desc.grid = size;
  to.info.desc.records = cropped_records(old_desc, origin, size);
  if (to.info.head && is_described(from.info, path)) describe(to.info.attributes, to.info.desc);
  // A file that flags described gets a sidecar, which says its size.
  std::erase_if(to.info.attributes, [](const Attribute& attribute) {
    return attribute.name == kRawSidecar && attribute.value == "none";
  });
  move_origin(to.info.attributes, origin);
  (void)drop_size_fields(to.info.attributes);
  const TextureDesc& desc = to.info.desc;
  to.texels.resize(static_cast<std::size_t>(texture_bytes(desc)));
  const Extent old_size = extent(old_desc), new_size = extent(desc);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const Grid at = block_position(desc, block);
    const std::uint32_t old_block =
        at.x + origin.x + old_desc.grid.x * (at.y + origin.y + old_desc.grid.y * (at.z + origin.z));
    copy_block(block_place(old_desc, old_size, old_block), from.texels,
               block_place(desc, new_size, block), to.texels);
  }
  return to;
}

/// The same file name, with the extension of EXR for images that are only read.
std::string output_path(const CropOptions& options, const Sequence& sequence, std::uint64_t frame) {
  FileNames names = sequence.names;
  names.extension = written_extension(sequence);
  return path_text(native_path(options.output) / native_path(names.of(sequence.name, frame)));
}

/// Refuses outputs that would destroy a file, before any is written.
void check_outputs(const CropOptions& options, const std::vector<Sequence>& sequences) {
  InputFiles inputs;
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      for (const std::string& path : files_of(file.path)) inputs.add(path);
    }
  }
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      for (const auto& path : files_of(output_path(options, sequence, file.frame))) {
        check_output(path, inputs, overwrite_if(options.overwrite));
      }
    }
  }
}

/// What cropped files lack of a file, in words; throws if its images are not of one grid, or have
/// no such box.
std::string not_kept(const std::vector<DumpInfo>& images, const Grid& origin, const Grid& size,
                     const std::string& path) {
  std::vector<std::string> lost;
  for (const DumpInfo& image : images) {
    if (image.desc.grid != images.front().desc.grid || image.place.level > 0) {
      fail(Exit::bad_input,
           "{}: holds images of several sizes ({}), which are no box of one grid; {}", path,
           listed(images, image_words), to_cure(Cure::raw_files));
    }
    require_box(image.desc, origin, size, path);
    lost.insert(lost.end(), image.lost.begin(), image.lost.end());
    Attributes attributes = image.attributes;
    for (std::string& name : drop_size_fields(attributes)) lost.push_back("attribute " + name);
  }
  return listed(lost, [](const std::string& what) { return what; });
}

Exit crop(const CropOptions& options, const Cli& cli) {
  const auto size = grid_from_string(options.size);
  if (!size) {
    fail(Exit::usage, "--size does not take \"{}\"; expected probes such as 8x4x8", options.size);
  }
  const auto origin = grid_from_string(options.origin, 0);
  if (!origin) {
    fail(Exit::usage, "--origin does not take \"{}\"; expected a probe such as 4,0,8",
         options.origin);
  }
  for (const std::string& path : options.inputs) require_exists(path);
  SequenceRemarks remarks;
  const auto sequences = group_sequences(options.inputs, options.geometry.numbers, &remarks);
  for (const std::string& line : remarks.left_out) remark(line);
  for (const std::string& line : remarks.guesses) {
    if (!cli.quiet) remark(line);
  }
  check_outputs(options, sequences);
  check_names(options.geometry, sequences);
  std::size_t files = 0;
  std::vector<Hints> hints;
  for (const Sequence& sequence : sequences) {
    files += sequence.frames.size();
    std::vector<std::string> paths;
    for (const FrameFile& file : sequence.frames) paths.push_back(file.path);
    hints.push_back(settle_formats(paths, hints_for(options.geometry, sequence.name)));
    for (const std::string& path : paths) {
      const std::string lost = not_kept(read_dump_infos(path, hints.back()), *origin, *size, path);
      if (!lost.empty()) remark(fmt::format("{}: {} not kept", path, lost));
    }
  }
  const OutputDirectory directory(options.output);
  Progress progress("cropping file", files, cli);
  for (const Sequence& sequence : sequences) {
    const Hints& own = hints[static_cast<std::size_t>(&sequence - sequences.data())];
    for (const FrameFile& file : sequence.frames) {
      progress.step();
      std::vector<Dump> images = read_dumps(file.path, own);
      for (Dump& image : images) {
        image = crop_dump(image, *origin, *size, file.path);
        for (std::size_t i = 0; image.info.head && i < kCompressions.size(); ++i) {
          if (options.compression != kCompressions[i]) continue;
          set_attribute(image.info.attributes,
                        {"compression", "compression", fmt::format("0x0{}", i)});
        }
      }
      write_dumps(output_path(options, sequence, file.frame), images,
                  overwrite_if(options.overwrite));
    }
  }
  if (!cli.quiet) {
    remark(fmt::format("{}: {} file{} written", options.output, files, files == 1 ? "" : "s"));
  }
  return Exit::ok;
}

}  // namespace

void add_crop(Cli& cli) {
  auto options = std::make_shared<CropOptions>();
  Command* command = cli.app.add_command("crop", "Cuts a box of probes out of dumps");
  command->footer(kCropFooter);
  command->add_option("--origin", options->origin, "First probe of the box")
      ->required()
      ->type_name("X,Y,Z");
  command->add_option("--size", options->size, "Probes of the box")->required()->type_name("XxYxZ");
  command->add_option("-o,--output", options->output, "Directory to write to; made if needed")
      ->required()
      ->type_name("DIR");
  command->add_option("files", options->inputs, "Dumps of any number of textures and frames")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--compression", options->compression,
                   "Compression of the EXR files; default: as before")
      ->allow(one_of(std::vector<std::string>(kCompressions.begin(), kCompressions.end())));
  command->add_flag("--allow-gaps", options->geometry.numbers.allow_gaps,
                    "Accept missing frames and textures that lack frames");
  add_overwrite(*command, options->overwrite, "Replace files that are there already");
  add_geometry_flags(*command, options->geometry);
  add_number_flags(*command, options->geometry.numbers);
  command->callback([&cli, options] { cli.run = [&cli, options] { return crop(*options, cli); }; });
}

}  // namespace gicodec::tools
