// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/modes/mode_shapes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::RowVectorXd;

constexpr double kTwoPiOfModes = 2.0 * std::numbers::pi;
constexpr double kMinShareOk = 0.5;  // least share of ok rows of an axis; chosen
constexpr int kMaxBandLines = 200;   // lines of a peak's band; chosen
constexpr int kSideFirst = 4;        // first and last line to either side that show the noise around a peak; chosen
constexpr int kSideLast = 24;
constexpr double kSameFrequency = 3.0;  // u within which two peaks are one; chosen

// One axis of one target over all observations.
struct ModeAxis {
  std::size_t target = 0;
  BoardAxis axis = BoardAxis::kX;
  std::vector<double> value;  // NaN: not ok
  [[nodiscard]] Index row() const {
    return quantity_row(target, axis == BoardAxis::kX ? Quantity::kDx : Quantity::kDy);
  }
};

std::vector<ModeAxis> axes_of(const Samples& samples, const JointErrors& joint) {
  std::vector<ModeAxis> axes;
  const std::size_t targets = joint.targets.size(), frames = joint.frames.size();
  for (std::size_t t = 0; t < targets; ++t) {
    for (const BoardAxis axis : {BoardAxis::kX, BoardAxis::kY}) {
      ModeAxis one{t, axis, {}};
      std::size_t ok = 0;
      for (std::size_t n = 0; n < frames; ++n) {
        const Sample& sample = samples[n * targets + t];
        const double value = axis == BoardAxis::kX ? sample.displacement.x : sample.displacement.y;
        const bool is_ok = sample.status == Status::kOk && std::isfinite(value) && std::isfinite(sample.time_s);
        one.value.push_back(is_ok ? value : kNotMeasured);
        ok += is_ok;
      }
      if (static_cast<double>(ok) >= kMinShareOk * static_cast<double>(frames)) axes.push_back(std::move(one));
    }
  }
  return axes;
}

// Rows in which all axes have a value, with a Hann window over them.
struct CommonRows {
  std::vector<std::size_t> row;
  std::vector<double> time_s, window;
  double duration_s = 0.0, middle_s = 0.0;
};

CommonRows common_rows(const Samples& samples, std::size_t targets, const std::vector<ModeAxis>& axes) {
  CommonRows out;
  for (std::size_t n = 0; !axes.empty() && n < axes.front().value.size() && out.row.size() < kMaxFitted; ++n) {
    if (std::any_of(axes.begin(), axes.end(), [n](const ModeAxis& axis) { return std::isnan(axis.value[n]); }))
      continue;
    out.row.push_back(n);
    out.time_s.push_back(samples[n * targets].time_s);
  }
  if (out.row.size() < kMinSamples) return out;
  const double first = out.time_s.front(), last = out.time_s.back();
  const double step = (last - first) / static_cast<double>(out.row.size() - 1);
  out.duration_s = last - first + step;
  out.middle_s = 0.5 * (first + last);
  for (const double t : out.time_s)
    out.window.push_back(0.5 + 0.5 * std::cos(kTwoPiOfModes * (t - out.middle_s) / out.duration_s));
  return out;
}

// Removes from weights their response to a constant and to a steady drift.
void make_blind_to_drift(const CommonRows& rows, std::vector<Complex>& weight) {
  double n = 0.0, tt = 0.0, t1 = 0.0;
  Complex sum = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const double t = rows.time_s[i] - rows.middle_s, h = rows.window[i];
    n += h, t1 += h * t, tt += h * t * t;
    sum += weight[i], moment += t * weight[i];
  }
  const double det = n * tt - t1 * t1;
  const Complex a = (tt * sum - t1 * moment) / det, b = (n * moment - t1 * sum) / det;
  for (std::size_t i = 0; i < weight.size(); ++i)
    weight[i] -= rows.window[i] * (a + b * (rows.time_s[i] - rows.middle_s));
}

// Returns the weights of the line at a frequency: X = sum of weight times value.
std::vector<Complex> line_weights(const CommonRows& rows, double frequency_hz) {
  std::vector<Complex> weight;
  for (std::size_t i = 0; i < rows.row.size(); ++i)
    weight.push_back(rows.window[i] *
                     std::polar(1.0, -kTwoPiOfModes * frequency_hz * (rows.time_s[i] - rows.middle_s)));
  make_blind_to_drift(rows, weight);
  return weight;
}

Complex line_of(const CommonRows& rows, const std::vector<Complex>& weight, const ModeAxis& axis) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < weight.size(); ++i) sum += weight[i] * axis.value[rows.row[i]];
  return sum;
}

// Returns the frequencies of a peak's band, 1 / duration apart. The window spreads a sine over three lines.
std::vector<double> band_of(const Peak& peak, const CommonRows& rows) {
  const double width = std::isnan(peak.damping) ? 0.0 : 2.0 * peak.damping * peak.frequency_hz;
  const double reach = std::clamp(std::floor(width * rows.duration_s), 1.0, 0.5 * kMaxBandLines);
  std::vector<double> out;
  for (double k = -reach; k <= reach; k += 1.0) {
    const double f = peak.frequency_hz + k / rows.duration_s;
    if (f > 1.0 / rows.duration_s) out.push_back(f);
  }
  return out;
}

// Returns the weights q with R_k = sum of q times value of k: those of the lines, by the reference's lines.
std::vector<Complex> shape_weights(const CommonRows& rows, const Peak& peak, const ModeAxis& reference) {
  std::vector<Complex> q(rows.row.size(), 0.0);
  double power = 0.0;
  for (const double f : band_of(peak, rows)) {
    const auto weight = line_weights(rows, f);
    const Complex line = line_of(rows, weight, reference);
    power += std::norm(line);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += std::conj(line) * weight[i];
  }
  for (Complex& w : q) w /= power;
  return q;
}

// Lines to either side of a peak's band that show the noise around it.
std::vector<double> side_lines(const CommonRows& rows, const Peak& peak) {
  const double highest = 0.5 * static_cast<double>(rows.row.size() - 1) / rows.duration_s;
  const double reach = band_of(peak, rows).back() - peak.frequency_hz;
  std::vector<double> out;
  for (int k = kSideFirst; k <= kSideLast; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const double f = peak.frequency_hz + side * (reach + k / rows.duration_s);
      if (f > 2.0 / rows.duration_s && f < highest) out.push_back(f);
    }
  }
  return out;
}

// Everything that the shapes at one peak share.
struct ShapeContext {
  const std::vector<ModeAxis>& axes;
  const CommonRows& rows;
  const JointErrors& joint;
  std::size_t reference = 0;
  std::vector<Complex> q;
  std::vector<double> excess;  // variance of a sample by which the record is noisier than stated, mm^2
};

// Returns for each axis the variance of one sample by which the record is noisier around the peak than stated. The
// median over the lines is robust against other peaks: for an exponential distribution it is ln 2 of the mean.
std::vector<double> excess_noise(const ShapeContext& at, const Peak& peak) {
  std::vector<std::vector<double>> power(at.axes.size());
  for (const double f : side_lines(at.rows, peak)) {
    const auto weight = line_weights(at.rows, f);
    for (std::size_t k = 0; k < at.axes.size(); ++k)
      power[k].push_back(std::norm(line_of(at.rows, weight, at.axes[k])));
  }
  std::vector<double> out(at.axes.size(), 0.0);
  for (std::size_t k = 0; k < at.axes.size() && !power[k].empty(); ++k) {
    const Index row = at.axes[k].row();
    double squares = 0.0, stated = 0.0;
    for (std::size_t i = 0; i < at.rows.row.size(); ++i) {
      const double h2 = at.rows.window[i] * at.rows.window[i];
      squares += h2;
      stated += h2 * at.joint.frames[at.rows.row[i]].noise(row, row);
    }
    const auto middle = power[k].begin() + static_cast<std::ptrdiff_t>(power[k].size() / 2);
    std::nth_element(power[k].begin(), middle, power[k].end());
    out[k] = std::max(0.0, *middle / std::numbers::ln2 - stated) / squares;
  }
  return out;
}

// Returns the covariance of the real and imaginary part of R of axis k.
Eigen::Matrix2d covariance_of(const ShapeContext& at, std::size_t k, Complex ratio) {
  const Index a = at.axes[k].row(), b = at.axes[at.reference].row();
  const JointErrors& joint = at.joint;
  const Index constant = joint.constant.cols(), varying = joint.frames[at.rows.row.front()].varying.cols();
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(2, constant + varying), loadings = shared;
  for (std::size_t i = 0; i < at.rows.row.size(); ++i) {
    const FrameErrors& errors = joint.frames[at.rows.row[i]];
    const Complex by_own = at.q[i], by_reference = -ratio * at.q[i];
    Eigen::Matrix2d w, noise;  // rows of w: real and imaginary part; columns: the errors of both axes
    w << by_own.real(), by_reference.real(), by_own.imag(), by_reference.imag();
    noise << errors.noise(a, a) + at.excess[k], errors.noise(a, b), errors.noise(b, a),
        errors.noise(b, b) + at.excess[at.reference];
    sum += w * noise * w.transpose();
    loadings.row(0) << errors.constant_share * joint.constant.row(a), errors.varying.row(a);
    loadings.row(1) << errors.constant_share * joint.constant.row(b), errors.varying.row(b);
    shared += w * loadings;
  }
  return sum + shared * shared.transpose();
}

// Amplitude and phase of R. Where |R| is below its u, the phase is unknown and has the u of a uniform distribution.
ModeEntry entry_of(const ModeAxis& axis, Complex ratio, const Eigen::Matrix2d& covariance) {
  constexpr double kUnknownPhase = std::numbers::pi / std::numbers::sqrt3;
  ModeEntry out{axis.target, axis.axis, ratio.real(), ratio.imag(), std::abs(ratio), 0.0, std::arg(ratio), 0.0};
  const Eigen::Vector2d along(std::cos(out.phase_rad), std::sin(out.phase_rad)), across(-along.y(), along.x());
  out.u_ratio = std::sqrt(std::max(0.0, along.dot(covariance * along)));
  const double u_across = std::sqrt(std::max(0.0, across.dot(covariance * across)));
  out.u_phase_rad = u_across < kUnknownPhase * out.ratio ? u_across / out.ratio : u_across > 0.0 ? kUnknownPhase : 0.0;
  return out;
}

struct NamedPeak {
  Peak peak;
  std::size_t axis = 0;  // index in the axes
};

std::vector<NamedPeak> all_peaks(const std::vector<ModeAxis>& axes, const std::vector<TargetSpectra>& spectra) {
  std::vector<NamedPeak> out;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (axes[k].target >= spectra.size()) continue;
    const TargetSpectra& both = spectra[axes[k].target];
    for (const Peak& peak : (axes[k].axis == BoardAxis::kX ? both.x : both.y).peaks) out.push_back({peak, k});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const NamedPeak& a, const NamedPeak& b) { return a.peak.amplitude_mm > b.peak.amplitude_mm; });
  return out;
}

// Returns the strongest peak of each frequency.
std::vector<NamedPeak> distinct_peaks(const std::vector<NamedPeak>& peaks, double resolution_hz) {
  std::vector<NamedPeak> out;
  for (const NamedPeak& next : peaks) {
    const bool is_known = std::any_of(out.begin(), out.end(), [&](const NamedPeak& known) {
      const double u = std::hypot(known.peak.u_frequency_hz, next.peak.u_frequency_hz);
      const double apart = std::abs(known.peak.frequency_hz - next.peak.frequency_hz);
      return apart <= std::max(resolution_hz, kSameFrequency * u);
    });
    if (!is_known) out.push_back(next);
  }
  std::sort(out.begin(), out.end(),
            [](const NamedPeak& a, const NamedPeak& b) { return a.peak.frequency_hz < b.peak.frequency_hz; });
  return out;
}

ModeShape shape_of(const NamedPeak& named, const std::vector<ModeAxis>& axes, const CommonRows& rows,
                   const JointErrors& joint) {
  constexpr double kHannWidth = 2.0;  // half width of a line of a Hann window, 1 / duration
  ModeShape out{named.peak, named.axis, static_cast<long>(rows.row.size()), kHannWidth / rows.duration_s, {}};
  ShapeContext at{axes, rows, joint, named.axis, shape_weights(rows, named.peak, axes[named.axis]), {}};
  at.excess = excess_noise(at, named.peak);
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const bool is_reference = k == named.axis;
    const Complex ratio = is_reference ? Complex(1.0) : line_of(rows, at.q, axes[k]);
    const Eigen::Matrix2d none = Eigen::Matrix2d::Zero();
    out.entries.push_back(entry_of(axes[k], ratio, is_reference ? none : covariance_of(at, k, ratio)));
  }
  return out;
}

}  // namespace

std::vector<ModeShape> mode_shapes(const Samples& samples, const JointErrors& joint,
                                   const std::vector<TargetSpectra>& spectra) {
  const std::vector<ModeAxis> axes = axes_of(samples, joint);
  const CommonRows rows = common_rows(samples, joint.targets.size(), axes);
  if (rows.row.size() < kMinSamples) return {};
  std::vector<ModeShape> shapes;
  for (const NamedPeak& peak : distinct_peaks(all_peaks(axes, spectra), 1.0 / rows.duration_s))
    shapes.push_back(shape_of(peak, axes, rows, joint));
  return shapes;
}

}  // namespace moiregauge::internal
