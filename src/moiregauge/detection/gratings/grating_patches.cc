// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_patches.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "moiregauge/detection/gratings/patch_growth.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxAttempts = 500;      // seeds; limits the time in an image with many periodic objects (chosen)
constexpr std::size_t kMaxThinAttempts = 100;  // seeds; each takes about 2 ms
// Pitch divided by sigma of the smoothing, which keeps 0.6 of the fundamental and 0.1 of the second harmonic.
constexpr double kPitchesPerSigma = 6.0;
constexpr double kEdge_px = 1.0;  // margin: the edge may cut the last strip, and the lattice has a small error

// Returns the image in grey levels of 8 bits, for any bit depth.
Image<float> grey_of(const LumaView& luma, int bits) {
  Image<float> out(width_of(luma), height_of(luma));
  const auto scale = static_cast<float>(std::ldexp(1.0, 8 - bits));
  std::visit(
      [&](const auto& view) {
        for (int y = 0; y < view.height; ++y) {
          const auto from = view.row(y);
          std::transform(from.begin(), from.end(), out.row(y).begin(),
                         [scale](auto grey) { return scale * static_cast<float>(grey); });
        }
      },
      luma);
  return out;
}

// Copies of an image smoothed by Gaussians, computed at first use. Sigma has steps of a factor 1.4.
class SmoothedPictures {
 public:
  explicit SmoothedPictures(const Image<float>& grey) : grey_(grey) {}
  const Image<float>& for_pitch(double pitch_px) {
    const int step = static_cast<int>(std::lround(2.0 * std::log2(pitch_px / kPitchesPerSigma)));
    const auto [at, is_new] = copies_.try_emplace(step);
    if (is_new) {
      at->second = grey_;
      cv::Mat pixels(grey_.height(), grey_.width(), CV_32F, at->second.row(0).data());
      cv::GaussianBlur(pixels, pixels, cv::Size(), std::exp2(0.5 * step));
    }
    return at->second;
  }

 private:
  const Image<float>& grey_;
  std::map<int, Image<float>> copies_;
};

ImageExtent extent_of_wave(const Eigen::RowVector2d& k) { return {k.x(), k.y()}; }

DetectedPatch seen_patch(const GrownPatch& grown) {
  const Lattice& lattice = grown.model.lattice;
  const auto k_at = [&](ImagePoint p) -> Eigen::Matrix2d { return grown.to_phi.inverse() * lattice.jacobian(p); };
  DetectedPatch patch;
  PhiBox box = grown.box;
  const Eigen::Matrix2d rough = grown.to_phi.inverse() * lattice.k;
  for (int axis = 0; axis < 2; ++axis) {
    box.low[axis] += kEdge_px * rough.row(axis).norm();
    box.high[axis] -= kEdge_px * rough.row(axis).norm();
  }
  const auto point = [&](double x, double y) { return lattice.at(grown.to_phi * Eigen::Vector2d(x, y)); };
  patch.centre = point(0.5 * (box.low.x() + box.high.x()), 0.5 * (box.low.y() + box.high.y()));
  patch.outline = {point(box.low.x(), box.low.y()), point(box.high.x(), box.low.y()), point(box.high.x(), box.high.y()),
                   point(box.low.x(), box.high.y())};
  const Eigen::Matrix2d k = k_at(patch.centre);
  patch.k_x = extent_of_wave(k.row(0));
  patch.k_y = extent_of_wave(k.row(1));
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Matrix2d corner = k_at(patch.outline[i]);
    patch.k_corners[i] = {extent_of_wave(corner.row(0)), extent_of_wave(corner.row(1))};
  }
  patch.periods_x = box.high.x() - box.low.x();
  patch.periods_y = box.high.y() - box.low.y();
  patch.pattern = grown.pattern;
  patch.modulation = std::max(grown.model.amplitude(1, 0), grown.model.amplitude(0, 1));
  patch.noise = grown.model.residual;
  // The mean is above the mid-level if less than half of the area is dark.
  double low = 1e9, high = -1e9;
  for (int i = 0; i < 256; ++i) {
    const double grey = grown.model.grey(Eigen::Vector2d(i % 16, i / 16) / 16.0);
    low = std::min(low, grey);
    high = std::max(high, grey);
  }
  patch.dark_on_light = grown.model.coefficients[0] > 0.5 * (low + high);
  return patch;
}

// Returns the signed distance in px of p from the line a -> b; positive on the right-hand side in the image (y down).
double signed_distance(ImagePoint a, ImagePoint b, ImagePoint p) {
  const auto ab = b - a, ap = p - a;
  return (ab.x * ap.y - ab.y * ap.x) / std::max(length(ab), 1e-12);
}

bool overlap(const DetectedPatch& a, const DetectedPatch& b) {
  if (holds(a, b.centre) || holds(b, a.centre)) return true;
  return std::any_of(a.outline.begin(), a.outline.end(), [&](ImagePoint p) { return holds(b, p); }) ||
         std::any_of(b.outline.begin(), b.outline.end(), [&](ImagePoint p) { return holds(a, p); });
}

}  // namespace

bool holds(const DetectedPatch& patch, ImagePoint p) {
  int sign = 0;
  for (std::size_t i = 0; i < 4; ++i)
    sign += signed_distance(patch.outline[i], patch.outline[(i + 1) % 4], p) > 0.0 ? 1 : -1;
  return std::abs(sign) == 4;
}

double distance_px(const DetectedPatch& patch, ImagePoint p) {
  if (holds(patch, p)) return 0.0;
  double nearest = 1e300;
  for (std::size_t i = 0; i < 4; ++i) {
    const ImagePoint a = patch.outline[i], b = patch.outline[(i + 1) % 4];
    const auto ab = b - a, ap = p - a;
    const double t = std::clamp((ab.x * ap.x + ab.y * ap.y) / std::max(ab.x * ab.x + ab.y * ab.y, 1e-12), 0.0, 1.0);
    nearest = std::min(nearest, length(p - (a + t * ab)));
  }
  return nearest;
}

std::vector<DetectedPatch> find_grating_patches(const LumaView& luma, const GratingSearchOptions& options) {
  const Image<float> grey = grey_of(luma, options.bits);
  std::vector<DetectedPatch> patches, spent;
  const auto in_any = [](const std::vector<DetectedPatch>& list, ImagePoint at, double within) {
    return std::any_of(list.begin(), list.end(), [&](const DetectedPatch& p) { return distance_px(p, at) <= within; });
  };
  GrowthLimits limits{options.min_periods, options.min_explained, options.min_modulation, {}};
  limits.taken = [&](ImagePoint at) { return in_any(patches, at, 0.0); };
  const auto search = [&](const std::vector<LatticeSeed>& seeds, std::size_t max_attempts, const auto& grow) {
    std::size_t attempts = 0;
    for (const LatticeSeed& seed : seeds) {
      if (in_any(patches, seed.centre, 1.0 / seed.k1.norm()) || in_any(spent, seed.centre, 0.0)) continue;
      if (++attempts > max_attempts) break;
      const Grown grown = grow(seed);
      if (grown.outcome == Growth::kNoLattice) continue;
      const DetectedPatch patch = seen_patch(grown.patch);
      // If two overlap, the first is the grating, because its seed had the higher score. The other is a harmonic or a
      // piece of it.
      const bool keeps =
          grown.outcome == Growth::kPatch &&
          std::none_of(patches.begin(), patches.end(), [&](const DetectedPatch& p) { return overlap(p, patch); });
      (keeps ? patches : spent).push_back(patch);
    }
  };
  const LatticeSeeds seeds = find_lattice_seeds(grey, options.min_modulation);
  SmoothedPictures smoothed(grey);
  const SmoothedPicture smoothed_for = [&](double pitch_px) -> const Image<float>& {
    return smoothed.for_pitch(pitch_px);
  };
  search(seeds.thin_lines, kMaxThinAttempts,
         [&](const LatticeSeed& seed) { return grow_thin_lines(grey, smoothed_for, seed, limits); });
  spent.clear();
  search(seeds.plain, kMaxAttempts, [&](const LatticeSeed& seed) { return grow_patch(grey, seed, limits); });
  std::stable_sort(patches.begin(), patches.end(),
                   [](const DetectedPatch& a, const DetectedPatch& b) { return a.modulation > b.modulation; });
  return patches;
}

}  // namespace moiregauge::internal
