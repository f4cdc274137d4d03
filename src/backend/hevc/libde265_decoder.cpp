#include "backend/hevc/codec.h"

#include <libde265/de265.h>

#include <climits>
#include <cstring>

namespace gicodec::hevc {
namespace {

struct FreeContext {
  void operator()(de265_decoder_context* context) const noexcept {
    static_cast<void>(de265_free_decoder(context));
  }
};

bool has_format(const de265_image* image, const PictureFormat& format) {
  const auto chroma = format.monochrome ? de265_chroma_mono : de265_chroma_444;
  if (de265_get_chroma_format(image) != chroma) return false;
  for (int i = 0; i < static_cast<int>(format.planes()); ++i) {
    if (de265_get_image_width(image, i) != static_cast<int>(format.width) ||
        de265_get_image_height(image, i) != static_cast<int>(format.height) ||
        de265_get_bits_per_pixel(image, i) != format.bit_depth) {
      return false;
    }
  }
  return true;
}

class Libde265Decoder final : public PictureDecoder {
 public:
  explicit Libde265Decoder(std::unique_ptr<de265_decoder_context, FreeContext> context)
      : context_(std::move(context)) {}

  Status decode(const AccessUnit& unit, Picture& picture) override {
    for (const NalUnit& nal : unit.units) {
      if (nal.size() > INT_MAX) return Status::limit_exceeded;
      if (de265_push_NAL(context_.get(), nal.data(), static_cast<int>(nal.size()), 0, nullptr) !=
          DE265_OK) {
        return Status::backend_failed;
      }
    }
    de265_push_end_of_frame(context_.get());
    // A step reads a NAL unit or finishes the picture. The library reports "more" work as long as a
    // picture waits for output.
    const std::size_t most_steps = 2 * unit.units.size() + 8;
    int more = 1;
    for (std::size_t step = 0; more != 0 && !finished(); ++step) {
      const de265_error error = de265_decode(context_.get(), &more);
      if (error == DE265_ERROR_WAITING_FOR_INPUT_DATA) break;
      if (error != DE265_OK || step == most_steps) return Status::corrupt;
    }
    if (has_warnings()) return Status::corrupt;
    const de265_image* image = de265_get_next_picture(context_.get());
    if (image == nullptr || !has_format(image, picture.format)) return Status::corrupt;
    copy(image, picture);
    return de265_peek_next_picture(context_.get()) == nullptr ? Status::ok : Status::corrupt;
  }

 private:
  bool finished() const {
    return de265_get_number_of_NAL_units_pending(context_.get()) == 0 &&
           de265_peek_next_picture(context_.get()) != nullptr;
  }

  // True for any warning, except that a single-threaded stream leaves threads idle.
  bool has_warnings() {
    for (;;) {
      const de265_error warning = de265_get_warning(context_.get());
      if (warning == DE265_OK) return false;
      if (warning != DE265_WARNING_NO_WPP_CANNOT_USE_MULTITHREADING) return true;
    }
  }

  static void copy(const de265_image* image, Picture& picture) {
    const std::size_t row = picture.format.row_bytes();
    for (std::size_t i = 0; i < picture.format.planes(); ++i) {
      int stride = 0;
      const std::uint8_t* from = de265_get_image_plane(image, static_cast<int>(i), &stride);
      std::byte* to = picture.plane(i).data();
      for (std::uint32_t y = 0; y < picture.format.height; ++y, from += stride, to += row) {
        std::memcpy(to, from, row);
      }
    }
  }

  std::unique_ptr<de265_decoder_context, FreeContext> context_;
};

}  // namespace

Result<std::unique_ptr<PictureDecoder>> open_libde265(unsigned threads) {
  // libde265 builds its tables for the first decoder and drops them with the last. Keeping them
  // makes the next decoder open ten times faster.
  static const bool initialised = de265_init() == DE265_OK;
  if (!initialised) return Status::backend_failed;
  std::unique_ptr<de265_decoder_context, FreeContext> context(de265_new_decoder());
  if (!context) return Status::out_of_memory;
  if (threads > 1 &&
      de265_start_worker_threads(context.get(), static_cast<int>(threads)) != DE265_OK) {
    return Status::backend_failed;
  }
  return std::unique_ptr<PictureDecoder>(std::make_unique<Libde265Decoder>(std::move(context)));
}

}  // namespace gicodec::hevc
