// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/phase/sampling_moire/sampling_window.h"

namespace moiregauge::internal {
namespace {

// Averaged part of the field. (x0, y0) is its first pixel, in field pixels.
struct Region {
  int x0, y0, width, height;
  [[nodiscard]] double x_from_centre(int x) const { return x - 0.5 * (width - 1); }
  [[nodiscard]] double y_from_centre(int y) const { return y - 0.5 * (height - 1); }
};

Region centred(int width, int height, int region_px) {
  const int w = std::min(region_px, width);
  const int h = std::min(region_px, height);
  return {(width - w) / 2, (height - h) / 2, w, h};
}

// Returns `wrapped_rad` plus the multiple of 2 pi that brings it nearest to a neighbour's phase.
double continued(double wrapped_rad, double neighbour_rad) {
  return wrapped_rad + kTwoPi * std::round((neighbour_rad - wrapped_rad) / kTwoPi);
}

double mean_amplitude(const Image<std::complex<double>>& fringe, const Region& region, double& least) {
  double sum = 0.0;
  double least_square = std::norm(fringe.at(region.x0, region.y0));
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const double square = std::norm(fringe.at(region.x0 + x, region.y0 + y));
      least_square = std::min(least_square, square);
      sum += std::sqrt(square);
    }
  }
  least = std::sqrt(least_square);
  return sum / (static_cast<double>(region.width) * region.height);
}

// Returns phi minus the carrier, rad, known up to multiples of 2 pi.
Image<double> less_carrier(const Image<std::complex<double>>& fringe, const Region& region, Axis axis,
                           double pitch_px) {
  Image<double> phase(region.width, region.height);
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const double s = axis == Axis::kX ? region.x_from_centre(x) : region.y_from_centre(y);
      phase.at(x, y) = std::arg(fringe.at(region.x0 + x, region.y0 + y)) - kTwoPi * s / pitch_px;
    }
  }
  return phase;
}

// Unwraps the phase from the centre along its row, then from that row up and down every column. Returns false at a
// dislocation, where neighbours of different columns differ by a whole period. No unwrapping is right around one.
bool continue_outwards(Image<double>& phase) {
  const int xc = phase.width() / 2;
  const int yc = phase.height() / 2;
  for (int x = xc + 1; x < phase.width(); ++x) phase.at(x, yc) = continued(phase.at(x, yc), phase.at(x - 1, yc));
  for (int x = xc - 1; x >= 0; --x) phase.at(x, yc) = continued(phase.at(x, yc), phase.at(x + 1, yc));
  const auto continue_row = [&phase](int y, int from) {
    for (int x = 0; x < phase.width(); ++x) phase.at(x, y) = continued(phase.at(x, y), phase.at(x, from));
    for (int x = 1; x < phase.width(); ++x) {
      if (!(std::abs(phase.at(x, y) - phase.at(x - 1, y)) < kPi)) return false;
    }
    return true;
  };
  for (int y = yc + 1; y < phase.height(); ++y) {
    if (!continue_row(y, y - 1)) return false;
  }
  for (int y = yc - 1; y >= 0; --y) {
    if (!continue_row(y, y + 1)) return false;
  }
  return true;
}

// Fits the mean and the least-squares plane, and computes the rms deviation from it. The plane's columns are orthogonal
// on a full rectangle.
void fit_plane(const Image<double>& phase, const Region& region, RegionPhase& result) {
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_yy = 0.0;
  for (int y = 0; y < region.height; ++y) {
    const double v = region.y_from_centre(y);
    for (int x = 0; x < region.width; ++x) {
      const double u = region.x_from_centre(x);
      sum += phase.at(x, y);
      sum_x += u * phase.at(x, y);
      sum_y += v * phase.at(x, y);
      sum_xx += u * u;
      sum_yy += v * v;
    }
  }
  const double count = static_cast<double>(region.width) * region.height;
  const double mean = sum / count;
  result.gradient_x_rad_per_px = sum_xx > 0.0 ? sum_x / sum_xx : 0.0;
  result.gradient_y_rad_per_px = sum_yy > 0.0 ? sum_y / sum_yy : 0.0;
  double squares = 0.0;
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const double rest = phase.at(x, y) - mean - result.gradient_x_rad_per_px * region.x_from_centre(x) -
                          result.gradient_y_rad_per_px * region.y_from_centre(y);
      squares += rest * rest;
    }
  }
  result.phase_rad = wrapped(mean);
  result.straightness_rad = std::sqrt(squares / count);
}

}  // namespace

RegionPhase region_mean(const FringeField& field, Axis axis, double pitch_px, int region_px) {
  RegionPhase result;
  if (field.fringe.width() < 1 || field.fringe.height() < 1 || region_px < 1) return result;
  const Region region = centred(field.fringe.width(), field.fringe.height(), region_px);
  result.centre_x_px = field.margin + region.x0 + 0.5 * (region.width - 1);
  result.centre_y_px = field.margin + region.y0 + 0.5 * (region.height - 1);
  double least = 0.0;
  const double amplitude = mean_amplitude(field.fringe, region, least);
  const double response = field.sampling_pitch_px > 0.0 && pitch_px < kNoCarrier
                              ? window_response(field.sampling_pitch_px, 1.0 / pitch_px)
                              : 1.0;
  result.modulation = 2.0 * amplitude / std::abs(response);
  // This form of the condition refuses NaN, too.
  if (!(result.modulation > kMinModulation && least > kMinRelativeModulation * amplitude)) return result;
  Image<double> phase = less_carrier(field.fringe, region, axis, pitch_px);
  if (!continue_outwards(phase)) return result;
  fit_plane(phase, region, result);
  result.valid = true;
  return result;
}

RegionPhase measure_region(ImageView<double> picture, Axis axis, const Sampling& sampling) {
  const int margin = window_margin(sampling.sampling_pitch_px);
  const int support = sampling.region_px + 2 * margin;
  const Region part = centred(picture.width, picture.height, support);
  const FringeField field =
      sampling_moire(picture.part(part.x0, part.y0, part.width, part.height), axis, sampling.sampling_pitch_px);
  RegionPhase result = region_mean(field, axis, sampling.pitch_px, sampling.region_px);
  result.centre_x_px += part.x0;
  result.centre_y_px += part.y0;
  return result;
}

double phase_bound(double noise_sigma, double modulation, double pixels) {
  return noise_sigma / modulation * std::sqrt(2.0 / pixels);
}

double region_mean_uncertainty(double noise_sigma, double modulation, double sampling_pitch_px, double pitch_px,
                               int region_px) {
  const SamplingWindow window(sampling_pitch_px);
  // If T = P, the carrier within the window cancels.
  const bool is_matched = pitch_px == sampling_pitch_px && window.is_integer();
  // Sums of the first taps. Each is rotated to the phase of the window's own pixel.
  const int taps = 2 * window.margin + 1;
  std::vector<std::complex<double>> first_along{{}};
  std::vector<double> first_across{0.0};
  for (int u = -window.margin; u <= window.margin; ++u) {
    first_across.push_back(first_across.back() + window.triangle(u));
    if (is_matched)
      first_along.emplace_back(first_across.back());
    else
      first_along.push_back(first_along.back() + window.along(u) * std::polar(1.0, kTwoPi * u / pitch_px));
  }
  // Weight of a pixel: the taps of all windows of the region that contain it.
  double along = 0.0, across = 0.0;
  for (int j = 0; j < region_px + taps - 1; ++j) {
    const auto from = static_cast<std::size_t>(std::max(0, j - region_px + 1));
    const auto to = static_cast<std::size_t>(std::min(taps, j + 1));
    along += std::norm(first_along[to] - first_along[from]);
    across += std::pow(first_across[to] - first_across[from], 2);
  }
  const double response = is_matched ? 1.0 : window_response(sampling_pitch_px, 1.0 / pitch_px);
  const double sum = static_cast<double>(region_px) * region_px * response;
  return noise_sigma / modulation * std::sqrt(2.0 * along * across) / sum;
}

}  // namespace moiregauge::internal
