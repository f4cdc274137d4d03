// AO points beside the paper's coding, and their pictures beside AO in screen space: Table 1 of
// Neff et al. for the tracer's scenes, in simulated time.
#include "ao_coders.h"

#include "ao/pixel_light.h"
#include "ao/point_light.h"
#include "ao/point_server.h"
#include "ao/twisting.h"
#include "ddgi/scenes.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

namespace gicodec::bench {
namespace {

using ao::PointLight;
using ao::PointServer;
using ddgi::Vec3;

constexpr std::uint32_t kWidth = 480, kHeight = 270;
constexpr double kStart = 2;    // seconds: all scenes move
constexpr double kClient = 60;  // pictures per second
constexpr int kPictures = 8, kEvery = 3;

struct Options {
  std::vector<std::string> scenes{"tomb", "villa", "street"};
  std::vector<std::string> points{"512", "1024", "2048"}, rates{"5", "15", "30", "60"};
  std::uint32_t max_points = 1000000, rays = 64, reference = 512, threshold = 4;
  bool rays_anew = false, all_seen = false, quick = false;
  float margin = 20;
  std::string pictures, preset = "strong";
  unsigned threads = 0;
};

std::vector<unsigned> whole(std::span<const std::string> texts) {
  std::vector<unsigned> numbers;
  for (const std::string& text : texts) {
    unsigned& number = numbers.emplace_back();
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    if (parsed.ptr != text.data() + text.size() || number == 0) {
      tools::fail(tools::Exit::usage, "expected a whole number from 1 on, not \"{}\"", text);
    }
  }
  return numbers;
}

/// AO of each pixel, 1 where there is no surface.
std::vector<float> draw(const ddgi::RayScene& scene, ddgi::ClientLight& light,
                        const ddgi::Camera& camera, ddgi::ThreadPool& pool) {
  const ddgi::PictureView view{camera, kWidth, kHeight};
  const ddgi::PictureRays rays(view);
  light.prepare(scene, view, pool);
  std::vector<float> picture(std::size_t{kWidth} * kHeight, 1);
  pool.run(kHeight, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < kWidth; ++column) {
      const float x = static_cast<float>(column) + 0.5F, y = static_cast<float>(row) + 0.5F;
      const Vec3 direction = rays.direction(x, y);
      auto hit = scene.intersect(camera.eye, direction, rays.spread());
      if (!hit) continue;
      if (hit->back) hit->normal = -hit->normal, hit->geometric_normal = -hit->geometric_normal;
      picture[row * kWidth + column] =
          light.irradiance({*hit, -direction, x, y}).x / ao::kAmbientLight;
    }
  });
  return picture;
}

double psnr(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (double{a[i]} - b[i]) * (double{a[i]} - b[i]);
  return -10 * std::log10(std::max(sum / static_cast<double>(a.size()), 1e-10));
}

/// Mean over windows of 8×8 pixels (Wang et al. 2004).
double ssim(std::span<const float> a, std::span<const float> b) {
  constexpr std::uint32_t kWindow = 8, kStep = 4;
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03, kCount = kWindow * kWindow;
  double sum = 0;
  std::size_t windows = 0;
  for (std::uint32_t y = 0; y + kWindow <= kHeight; y += kStep) {
    for (std::uint32_t x = 0; x + kWindow <= kWidth; x += kStep, ++windows) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (std::uint32_t i = 0; i < kWindow * kWindow; ++i) {
        const std::size_t at = std::size_t{y + i / kWindow} * kWidth + x + i % kWindow;
        const double p = a[at], q = b[at];
        ma += p, mb += q, aa += p * p, bb += q * q, ab += p * q;
      }
      ma /= kCount, mb /= kCount;
      const double va = aa / kCount - ma * ma, vb = bb / kCount - mb * mb;
      sum += (2 * ma * mb + kC1) * (2 * (ab / kCount - ma * mb) + kC2) /
             ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
    }
  }
  return sum / static_cast<double>(windows);
}

void write(const Options& options, const std::string& name, std::span<const float> picture) {
  if (options.pictures.empty()) return;
  ddgi::Picture out{kWidth, kHeight, {}};
  for (const float v : picture) out.pixels.push_back(Vec3{1, 1, 1} * (v * v));
  keep_picture(options.pictures, name, out, 1);
}

struct Quality {
  double psnr = 0, ssim = 0;
  void add(std::span<const float> picture, std::span<const float> reference) {
    psnr += bench::psnr(picture, reference) / kPictures;
    ssim += bench::ssim(picture, reference) / kPictures;
  }
};

/// One scene with its references.
class Run {
 public:
  Run(const Options& options, std::string name, ddgi::ThreadPool& pool)
      : options_(options),
        name_(std::move(name)),
        pool_(pool),
        scene_(*ddgi::make_scene(name_ == "twist" ? "tomb" : name_)) {
    if (name_ == "twist") column_.emplace(scene_, Vec3{2, 0.05F, 3});
    show(kStart);
  }

  void references() {
    ao::ScreenSpaceLight screen(32, 0.6F);
    Quality quality;
    for (int i = 0; i < kPictures; ++i) {
      show(picture_time(i));
      ao::TracedLight light(*rays_, options_.reference, 0.6F);
      references_.push_back(draw(*rays_, light, camera(i), pool_));
      const auto picture = draw(*rays_, screen, camera(i), pool_);
      quality.add(picture, references_.back());
      if (i == kPictures - 1) {
        write(options_, name_ + "-reference", references_.back());
        write(options_, name_ + "-screen", picture);
      }
    }
    fmt::print("{:<7} {:>5} {:>7} {:>4} {:>6.2f} {:>6.4f}\n", name_, "SSAO", "", 60, quality.psnr,
               quality.ssim);
    std::fflush(stdout);
  }

  void points(double per_metre, unsigned label) {
    ao::ServerOptions server_options;
    server_options.generation.points = per_metre;
    server_options.generation.max_points = options_.max_points;
    server_options.rays = options_.rays;
    server_options.rays_anew = options_.rays_anew;
    server_options.threshold = options_.threshold;
    if (column_) {
      server_options.generation.margin = ao::TwistingColumn::kMargin;
      server_options.spare_cells = 0.1;
    }
    const ddgi::Scene rest = scene_;
    PointServer first(rest, server_options, pool_);
    find_column(first);
    update(first, kStart);
    const auto& held = first.memory().statistics();
    for (const unsigned rate : whole(options_.rates)) rate_of(first, rate, label, held);
  }

  /// Generated per square metre, so that `points` of the largest setting keep to the limit.
  [[nodiscard]] double fitting(double points) {
    ao::GenerationOptions options;
    options.points = points;
    options.max_points = 1;
    const double of_one = ao::generate_points(scene_, options, pool_).points;
    return std::min(points, of_one * options_.max_points);
  }

 private:
  static double picture_time(int i) { return kStart + (1 + kEvery * i) / kClient; }
  [[nodiscard]] ddgi::Camera camera(int i) const { return scene_.camera_at(picture_time(i)); }

  void show(double time) {
    if (column_) {
      rays_.reset();
      shown_ = std::make_unique<ddgi::Scene>(column_->at(scene_, time));
      rays_ = std::make_unique<ddgi::RayScene>(*shown_);
    } else if (!rays_) {
      rays_ = std::make_unique<ddgi::RayScene>(scene_);
    }
    rays_->set_state(scene_.state_at(time));
  }

  void find_column(const PointServer& server) {
    const auto& instances = server.generated().instances;
    for (column_instance_ = 0;
         column_ && instances[column_instance_].object != column_->object();) {
      ++column_instance_;
    }
    if (column_) at_rest_ = instances[column_instance_].points;
  }

  void update(PointServer& server, double time) {
    show(time);
    if (column_) ao::TwistingColumn::move(time, at_rest_, server.move(column_instance_));
    std::vector<ao::ExtendedView> views;
    if (!options_.all_seen) {
      views.push_back(
          {scene_.camera_at(time), static_cast<float>(kWidth) / kHeight, options_.margin});
    }
    server.update(*rays_, views);
  }

  void rate_of(const PointServer& first, unsigned rate, unsigned label,
               const ao::PointMemory::Statistics& held) {
    PointServer server = first;
    const VolumeDesc volume = server.volume();
    AoCoders coders(volume, options_.preset);
    auto textures = server.textures();
    const UpdateBytes begin = coders.update(textures);
    PointLight received, own(ao::Placement::own);
    UpdateBytes sum;
    Quality quality, quality_own;
    std::uint64_t updates = 0;
    for (int i = 0; i < kPictures; ++i) {
      const auto due = static_cast<std::uint64_t>((picture_time(i) - kStart) * rate + 1e-6);
      while (updates < due) {
        update(server, kStart + static_cast<double>(++updates) / rate);
        textures = server.textures();
        sum += coders.update(textures);
      }
      if (options_.quick) continue;
      hold(volume, textures, received);
      hold(volume, textures, own);
      show(picture_time(i));
      const auto picture = draw(*rays_, received, camera(i), pool_);
      quality.add(picture, references_[static_cast<std::size_t>(i)]);
      quality_own.add(draw(*rays_, own, camera(i), pool_),
                      references_[static_cast<std::size_t>(i)]);
      if (i == kPictures - 1) write(options_, fmt::format("{}-{}-{}", name_, label, rate), picture);
    }
    const auto n = static_cast<double>(std::max<std::uint64_t>(updates, 1));
    const auto mbps = [&](std::size_t bytes) {
      return static_cast<double>(bytes) / n * 8 * rate * 1e-6;
    };
    const auto per = [&](std::size_t bytes) { return static_cast<double>(bytes) / n; };
    fmt::print(
        "{:<7} {:>5} {:>7} {:>4} {:>6.2f} {:>6.4f} {:>6.2f} {:>7.2f} {:>7.2f} {:>8.0f} {:>8.0f} "
        "{:>7.0f} {:>6.3f} {:>6.3f} {:>8} {:>8} {:>8} {:>6.3f} {:>6} {:>6.1f}\n",
        name_, label, held.points, rate, quality.psnr, quality.ssim, quality_own.psnr,
        mbps(sum.native), mbps(sum.paper), per(sum.paper), per(sum.planes), per(sum.native),
        ratio(sum.native, sum.paper), ratio(sum.native, sum.planes), begin.paper, begin.planes,
        begin.native, ratio(begin.native, begin.paper), held.overflow(), per(sum.dirty));
    std::fflush(stdout);
  }

  static void hold(const VolumeDesc& volume, std::span<const Bytes> textures, PointLight& light) {
    light.update({volume, {}, kinds::held_of(volume, textures)}, 0);
  }

  const Options& options_;
  std::string name_;
  ddgi::ThreadPool& pool_;
  ddgi::Scene scene_;
  std::optional<ao::TwistingColumn> column_;
  std::size_t column_instance_ = 0;
  std::vector<ao::SurfacePoint> at_rest_;
  std::unique_ptr<ddgi::Scene> shown_;  ///< with the column as it is; `rays_` looks at it
  std::unique_ptr<ddgi::RayScene> rays_;
  std::vector<std::vector<float>> references_;
};

tools::Exit run(const Options& options) {
  fmt::print(
      "{:<7} {:>5} {:>7} {:>4} {:>6} {:>6} {:>6} {:>7} {:>7} {:>8} {:>8} {:>7} {:>6} {:>6} {:>8} "
      "{:>8} {:>8} {:>6} {:>6} {:>6}\n",
      "scene", "N", "points", "Hz", "PSNR", "SSIM", "own", "Mbit/s", "paper", "paper B", "planes B",
      "nativeB", "/paper", "/plane", "1 paper", "1 planes", "1 native", "ratio", "lost", "dirty");
  for (const std::string& name : options.scenes) {
    ddgi::ThreadPool pool(options.threads);
    Run scene(options, name, pool);
    if (!options.quick) scene.references();
    const auto settings = whole(options.points);
    const double most = *std::ranges::max_element(settings);
    const double fitting = scene.fitting(most) / most;
    for (const unsigned points : settings) scene.points(points * fitting, points);
  }
  return tools::Exit::ok;
}

}  // namespace

void add_ao_points(tools::Command& command, Measurement& chosen) {
  const auto options = std::make_shared<Options>();
  command.add_option("scenes", options->scenes, "tomb, villa, street, twist")->show_default();
  command
      .add_option("--points", options->points,
                  "Settings of points; where the largest is too many for --max-points, all are "
                  "fewer in proportion")
      ->show_default();
  command.add_option("--rates", options->rates, "Updates per second")->show_default();
  command.add_option("--max-points", options->max_points, "")->show_default();
  command.add_option("--rays", options->rays, "Of a point")->show_default();
  command.add_option("--reference", options->reference, "Rays of a pixel")->show_default();
  command.add_option("--threshold", options->threshold, "Of 255")->show_default();
  command.add_option("--margin", options->margin, "Degrees of the extended view")->show_default();
  command.add_option("--pictures", options->pictures, "Folder for PNG of the last frame");
  command
      .add_option("--preset", options->preset, "Of native; fast has no models for more than 64 MiB")
      ->show_default();
  command.add_option("--threads", options->threads, "");
  command.add_flag("--rays-anew", options->rays_anew, "Other rays in each update");
  command.add_flag("--all", options->all_seen, "Update points that the camera does not see, too");
  command.add_flag("--quick", options->quick, "No pictures");
  choose(command, chosen, options, run);
}

}  // namespace gicodec::bench
