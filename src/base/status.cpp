#include <gicodec/status.h>

namespace gicodec {

std::string_view to_string(Status status) noexcept {
  switch (status) {
    case Status::ok:
      return "no error";
    case Status::end:
      return "nothing is left to read";
    case Status::invalid_argument:
      return "an argument is null or outside its range, or a struct has no struct_size";
    case Status::invalid_description:
      return "the description is invalid";
    case Status::view_too_small:
      return "the texture view does not cover what is described";
    case Status::block_out_of_range:
      return "a block index is beyond the last";
    case Status::block_repeated:
      return "a block index occurs twice";
    case Status::unsupported_format:
      return "the format is unknown, its components are not valid, or the backend cannot code "
             "them; zstd, lz4 and raw code all valid ones";
    case Status::unknown_backend:
      return "no backend of that name is built in or was given";
    case Status::buffer_too_small:
      return "the output buffer is too small";
    case Status::unsupported_backend:
      return "the backend cannot do this";
    case Status::unsupported_shape:
      return "the backend cannot code blocks of this shape; zstd, lz4 and raw can";
    case Status::unknown_kind:
      return "no kind of that number or name is built in or was given";
    case Status::unknown_volume:
      return "there is no volume of that number";
    case Status::unknown_texture:
      return "the volume has no texture of that number or name";
    case Status::unknown_group:
      return "the volume has no texture group of that number";
    case Status::unknown_connection:
      return "there is no connection of that number, or it has no session";
    case Status::mask_mismatch:
      return "the length of the mask is not the number of blocks";
    case Status::invalid_geometry:
      return "the geometry is out of range or for another grid";
    case Status::invalid_name:
      return "the name is unknown, too long, not UTF-8 or used twice";
    case Status::invalid_time:
      return "the time is not finite";
    case Status::invalid_bound:
      return "the threshold or error bound is out of range, or both are set";
    case Status::invalid_interval:
      return "the interval is 0, or bundled textures have different ones";
    case Status::presence_missing:
      return "presence was published without the texture that it belongs to";
    case Status::presence_invalid:
      return "the presence has more records than the block";
    case Status::unknown_region:
      return "the texture has no region of that number";
    case Status::unknown_frame:
      return "the container has no frame of that number, or cannot seek";
    case Status::wrong_frame:
      return "the frame comes before the last one, or already has a packet of that region";
    case Status::invalid_settings:
      return "the backend or the machine does not support a preset, level, chunk, number of "
             "threads or instruction set";
    case Status::out_of_order:
      return "the call comes too early or too late";
    case Status::out_of_memory:
      return "out of memory";
    case Status::limit_exceeded:
      return "a limit of the caller, a backend or the format is exceeded";
    case Status::cancelled:
      return "the call was cancelled";
    case Status::truncated:
      return "the input is cut off";
    case Status::corrupt:
      return "the input is corrupt";
    case Status::checksum_mismatch:
      return "the checksum does not match";
    case Status::not_gicodec:
      return "the input is not in this format";
    case Status::unsupported_version:
      return "the format's version is unknown to this library; a newer one may read it";
    case Status::unsupported_feature:
      return "the input needs a feature that this library lacks";
    case Status::description_mismatch:
      return "the packet belongs to another texture description";
    case Status::reference_missing:
      return "the packet builds on an update that this session does not hold";
    case Status::backend_missing:
      return "the packet needs a backend that is neither built in nor given";
    case Status::backend_failed:
      return "the codec reported an error";
    case Status::backend_unavailable:
      return "the codec is not available on this machine";
    case Status::io_failed:
      return "reading or writing failed";
  }
  return "unknown status";
}

}  // namespace gicodec
