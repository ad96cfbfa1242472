// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

namespace moiregauge::internal {
namespace {

// Correlation of |X|^2 of two Hann segments that overlap by half (Welch 1967, Eq. (13)).
constexpr double kNeighbours = 1.0 / 36.0;

// Returns the largest even length up to n with factors 2, 3 and 5 only.
std::size_t quick_length(std::size_t n) {
  for (n -= n % 2; n > 2; n -= 2) {
    std::size_t rest = n;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) break;
  }
  return n;
}

// Sum of |X|^2 over windowed segments without mean and slope.
class Segments {
 public:
  explicit Segments(std::size_t length) : window_(length), padded_(length), power_(length / 2 + 1, 0.0) {
    for (std::size_t i = 0; i < length; ++i) {
      window_[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
      window_squares_ += window_[i] * window_[i];
    }
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  }

  void add(const double* value) {
    const std::size_t n = window_.size();
    const double middle = 0.5 * static_cast<double>(n - 1);
    double sum = 0.0, moment = 0.0, square = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double x = static_cast<double>(i) - middle;
      sum += value[i];
      moment += x * value[i];
      square += x * x;
    }
    const double mean = sum / static_cast<double>(n), slope = moment / square;
    for (std::size_t i = 0; i < n; ++i)
      padded_[i] = window_[i] * (value[i] - mean - slope * (static_cast<double>(i) - middle));
    fft_.fwd(transform_, padded_);
    for (std::size_t k = 0; k < power_.size(); ++k) power_[k] += std::norm(transform_[k]);
    ++count_;
  }

  [[nodiscard]] Spectrum spectrum(double interval_s) const {
    const std::size_t n = window_.size();
    const auto length = static_cast<double>(n);
    Spectrum result;
    for (std::size_t k = 0; k < power_.size(); ++k) {
      const double sides = k == 0 || 2 * k == n ? 1.0 : 2.0;
      result.frequency_hz.push_back(static_cast<double>(k) / (length * interval_s));
      result.psd.push_back(sides * interval_s * power_[k] / (window_squares_ * static_cast<double>(count_)));
    }
    result.resolution_hz = 1.5 / (length * interval_s);
    const auto segments = static_cast<double>(count_);
    result.averages = segments / (1.0 + 2.0 * kNeighbours * (segments - 1.0) / segments);
    result.segment_samples = n;
    result.segments = count_;
    return result;
  }

 private:
  std::vector<double> window_, padded_, power_;
  std::vector<std::complex<double>> transform_;
  double window_squares_ = 0.0;
  std::size_t count_ = 0;
  Eigen::FFT<double> fft_;
};

}  // namespace

tl::expected<Spectrum, std::string> welch(const Series& series, const EvenTimes& times) {
  const std::size_t longest = times.longest().count;
  if (longest < kMinSamples)
    return tl::unexpected(fmt::format("the longest stretch of ok rows without a gap has {} frames, and {} are needed",
                                      longest, kMinSamples));
  const std::size_t length = quick_length(std::clamp(longest / 3, kMinSamples, kMaxSegment));
  Segments segments(length);
  std::size_t samples = 0;
  for (const Stretch& stretch : times.stretches) {
    if (stretch.count < length) continue;
    std::size_t end = 0;
    for (std::size_t at = 0; at + length <= stretch.count; at += length / 2) {
      segments.add(&series.value[stretch.first + at]);
      end = at + length;
    }
    samples += end;
  }
  Spectrum spectrum = segments.spectrum(times.interval_s);
  spectrum.samples = samples;
  return spectrum;
}

Spectrum periodogram(const double* value, std::size_t count, double interval_s) {
  const std::size_t length = quick_length(count);
  Segments segments(length);
  segments.add(value);
  Spectrum spectrum = segments.spectrum(interval_s);
  spectrum.samples = length;
  return spectrum;
}

}  // namespace moiregauge::internal
