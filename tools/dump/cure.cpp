#include "dump/cure.h"

namespace gicodec::tools {

std::string_view cure_text(Cure cure) noexcept {
  switch (cure) {
    case Cure::keep_values:
      return "--vk-format {} keeps such values as they are";
    case Cure::read_as_format:
      return "--vk-format reads its texels as a known format of as many bytes, and every bit comes "
             "back";
    case Cure::describe_raw:
      return "--vk-format and --extent do without one";
    case Cure::fix_format:
      return "check its format and size, or give --vk-format";
    case Cure::check_format:
      return "check --vk-format, or leave it out";
    case Cure::cut_rest:
      return "\"truncate -s {} {}\" cuts them off";
    case Cure::map_channels:
      return "use {}";
    case Cure::pick_channels:
      return "--channels R=NAME,... picks those to keep, and without --vk-format all are kept";
    case Cure::leave_format_out:
      return "without --vk-format it is kept as it is";
    case Cure::grid_or_block:
      return "use --grid for probes, or --block 8x8x1 for another texture";
    case Cure::give_flag:
      return "use {}";
    case Cure::fix_columns:
      return "check --grid, --tiling and --core";
    case Cure::fix_layout:
      return "check --layout and --grid";
    case Cure::leave_layout_out:
      return "set it to zero, or leave out --layout, so that every texel is in a block";
    case Cure::decode_first:
      return "\"gicodec decode {} -o DIR\" makes dumps of it";
    case Cure::name_dumps:
      return "name the dumps, or their folder";
    case Cure::gaps:
      return "--allow-gaps accepts that, --stills makes a texture of each file";
    case Cure::stills:
      return "--stills makes a texture of each";
    case Cure::frames_from:
      return "--frames-from {}{} takes their numbers for those of frames";
    case Cure::play_gaps:
      return "\"gicodec encode --allow-gaps\" makes a container that can be played";
    case Cure::one_folder:
      return "rename one of them, or give one folder at a time";
    case Cure::fewer_files:
      return "name those to take";
    case Cure::name_others:
      return "name them to take them";
    case Cure::one_kind:
      return "give files of one kind at a time";
    case Cure::fewer_textures:
      return "pack some files each";
    case Cure::fewer_frames:
      return "encode fewer frames into each";
    case Cure::crop:
      return "\"gicodec crop\" cuts it into parts";
    case Cure::raw_files:
      return "\"gicodec encode\" and \"gicodec decode --files raw\" make a file of each image";
    case Cure::other_files:
      return "--files takes {} for it";
    case Cure::as_floats:
      return "\"gicodec encode --vk-format {}\" packs its values as floats, which they can have";
    case Cure::other_folder:
      return "decode to another folder";
    case Cure::one_frame:
      return "--frames {} gives that one alone";
    case Cure::more_memory:
      return "--max-memory {} allows it";
    case Cure::incomplete:
      return "--allow-incomplete goes on with what is there";
    case Cure::one_volume:
      return "--volume {} takes one volume alone";
    case Cure::other_volume:
      return "--volume {} takes another volume alone";
    case Cure::overwrite:
      return "--overwrite replaces it";
    case Cure::name_container:
      return "name another output, as in -o x.gic, or remove it first";
    case Cure::rename:
      return "rename one of them";
    case Cure::name_it:
      return "name it {}";
    case Cure::transcode:
      return "make BC7, ASTC or RGBA of it first, as KTX-Software's \"ktx transcode\" does";
    case Cure::flatten:
      return "flatten it, as oiiotool --flatten does";
    case Cure::erase_attribute:
      return "write the file without it, as oiiotool --eraseattrib does";
    case Cure::one_level:
      return "write it with one level, or mipmapped, as maketx does";
    case Cure::write_zip:
      return "write it with ZIP or PIZ";
    case Cure::more_bits:
      return "write it with 16 bits or as EXR, or keep them as --vk-format R8G8B8A8_UNORM";
    case Cure::write_plain:
      return "write it without, since a container compresses it";
    case Cure::split_array:
      return "write a file for each";
    case Cure::fetch_lfs:
      return "\"git lfs pull\" fetches it";
    case Cure::encode_again:
      return "encode again once it is written";
    case Cure::get_again:
      return "get the file again";
  }
  return "";
}

}  // namespace gicodec::tools
