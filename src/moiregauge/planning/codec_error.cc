// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/codec_error.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kOwnShare = 0.55, kSharedShare = 0.2;  // 1; source: see Lag in codec_error.h
// Rounding: each of the 64 coefficients of a block is wrong by up to half a step, independently in every block.
constexpr double kBlock_px = 64.0;
constexpr double kRoundedShare = 0.5;
constexpr std::size_t kRoundAbout = 16;  // frames: the longest run that x264 predicts in both directions
constexpr double kOverall = 0.9;         // quantile of the steps over the run, their lower limit; chosen

double pitch_px_of(const PatchFit& patch, int from, int to) {
  const auto image = patch.image[static_cast<std::size_t>(to)] - patch.image[static_cast<std::size_t>(from)];
  const auto print = patch.print[static_cast<std::size_t>(to)] - patch.print[static_cast<std::size_t>(from)];
  return length(print) > 0.0 ? length(image) / length(print) : 0.0;
}

// Returns both parts along the grating's axes, pitches. 0 along an axis that it does not show.
std::array<CodecParts, 2> codec_parts_pitches(const PatchFit& patch, const Quantiser& quantiser, Lag lag) {
  std::array<CodecParts, 2> u{};
  if (!(quantiser.step > 0.0) || patch.pixels <= 0) return u;
  for (const int axis : {0, 1}) {
    const double energy =
        patch.sigma * patch.sigma *
        patch.information.block<kPatchPoints, kPatchPoints>(axis * kPatchPoints, axis * kPatchPoints).sum();
    const double pitch_px = axis == 0 ? pitch_px_of(patch, 3, 5) : pitch_px_of(patch, 1, 7);
    if (!(energy > 0.0) || !(pitch_px > 0.0)) continue;
    const double slope = std::sqrt(energy / patch.pixels) / pitch_px;
    const CodecParts px = codec_parts_px(quantiser, lag, slope, patch.pixels);
    u[static_cast<std::size_t>(axis)] = {px.lag / pitch_px, px.rounding / pitch_px};
  }
  return u;
}

// Returns (C + V)^-1. C^-1 = information may be singular. Each point has a ninth of the area, and blocks are rounded
// independently. So the mean of nine points has the rounding of the whole area.
PatchInformation widened(const PatchInformation& information, const std::array<CodecParts, 2>& u) {
  PatchInformation v = PatchInformation::Zero();
  for (const int axis : {0, 1}) {
    auto block = v.block<kPatchPoints, kPatchPoints>(axis * kPatchPoints, axis * kPatchPoints);
    const auto [lag, rounding] = u[static_cast<std::size_t>(axis)];
    block.setIdentity();
    block *= lag * lag + kPatchPoints * rounding * rounding;
    block.array() += lag * lag;
  }
  const PatchInformation a = PatchInformation::Identity() + information * v;
  const PatchInformation out = a.partialPivLu().solve(information);
  return 0.5 * (out + out.transpose());
}

}  // namespace

CodecParts codec_parts_px(const Quantiser& quantiser, Lag lag, double slope_rms, double area_px) {
  if (!(quantiser.step > 0.0) || !(slope_rms > 0.0)) return {};
  const double dead_zone = dead_zone_px(quantiser.step, slope_rms);
  const double rounded = kRoundedShare * dead_zone * std::sqrt(kBlock_px / std::max(area_px, kBlock_px));
  if (!quantiser.predicted) return {0.0, rounded};
  const double lagging = (lag == Lag::kOwn ? kOwnShare : kSharedShare) * dead_zone;
  return {lagging / std::hypot(1.0, lagging / kMaxLag_px), rounded};
}

double codec_u_px(const Quantiser& quantiser, Lag lag, double slope_rms, double area_px) {
  const auto [lagging, rounding] = codec_parts_px(quantiser, lag, slope_rms, area_px);
  return std::hypot(lagging, rounding);
}

CodecHistory::CodecHistory(const Reference& reference, const Observations& observations)
    : starts_with_key_frame_(reference.seen.frame == 0) {
  const auto note = [this](const Quantiser& q) { lossy_ = lossy_ || !q.is_lossless(); };
  const std::size_t markers = reference.site.markers.size();
  for (std::size_t i = 0; i < markers; ++i) {
    is_target_.push_back(reference.site.markers[i].role == Role::kTarget);
    then_.push_back(reference.seen.markers[i].quantiser);
    note(then_.back());
    then_.back().step = reference.step_of(i, then_.back());
  }
  std::vector<bool> is_complete(markers, true);
  steps_.resize(observations.size() * markers);
  auto at = steps_.begin();
  for (const Observation& seen : observations) {
    for (const MarkerObservation& marker : seen.markers) note(marker.quantiser);
    for (std::size_t i = 0; i < markers; ++i, ++at) {
      if (i >= seen.markers.size()) {
        is_complete[i] = false;
        continue;
      }
      const Quantiser& quantiser = seen.markers[i].quantiser;
      *at = {static_cast<float>(reference.step_of(i, quantiser)), quantiser.predicted};
    }
  }
  if (!lossy_) {
    steps_ = {};
    return;
  }
  for (std::size_t i = 0; i < markers; ++i) {
    std::vector<float> all;
    for (std::size_t n = 0; n < observations.size(); ++n) all.push_back(steps_[n * markers + i].step);
    if (!is_complete[i]) {
      for (std::size_t n = 0; n < all.size(); ++n) steps_[n * markers + i] = {};
      continue;
    }
    if (all.empty()) continue;
    std::vector<float> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    const float overall = sorted[static_cast<std::size_t>(kOverall * static_cast<double>(sorted.size() - 1))];
    for (std::size_t n = 0; n < all.size(); ++n) {
      const std::size_t from = n - std::min(n, kRoundAbout), to = std::min(all.size(), n + kRoundAbout + 1);
      const float about = *std::max_element(all.begin() + static_cast<long>(from), all.begin() + static_cast<long>(to));
      steps_[n * markers + i].step = std::max(about, overall);
    }
  }
}

Quantiser CodecHistory::at(std::size_t n, std::size_t marker) const {
  if (!lossy_) return {};
  const Step& step = steps_[n * is_target_.size() + marker];
  return {static_cast<double>(step.step), step.predicted};
}

Quantiser CodecHistory::in_reference_frame(std::size_t marker) const { return then_[marker]; }

std::vector<Quantiser> CodecHistory::of_next(const Reference& reference, const Observation& seen) const {
  const std::size_t markers = std::min(is_target_.size(), seen.markers.size());
  const std::size_t all = steps_.size() / std::max<std::size_t>(1, is_target_.size());
  std::vector<Quantiser> out(is_target_.size());
  for (std::size_t i = 0; i < markers; ++i) {
    const Quantiser& own = seen.markers[i].quantiser;
    out[i] = {reference.step_of(i, own), own.predicted};
    for (std::size_t n = all - std::min(all, kRoundAbout); n < all; ++n)
      out[i].step = std::max(out[i].step, static_cast<double>(steps_[n * is_target_.size() + i].step));
  }
  return out;
}

BundleFrame with_codec_error(const BundleFrame& frame, const CodecHistory& codec,
                             const std::vector<Quantiser>& quantisers) {
  BundleFrame out = frame;
  for (std::size_t i = 0; i < out.points.size() && i < quantisers.size(); ++i) {
    if (!out.points[i] || quantisers[i].is_lossless()) continue;
    const auto u = codec_parts_pitches(*out.points[i], quantisers[i], codec.lag_of(i));
    out.points[i]->information = widened(out.points[i]->information, u);
  }
  return out;
}

BundleFrame with_codec_error(const BundleFrame& frame, const CodecHistory& codec,
                             std::optional<std::size_t> observation) {
  BundleFrame out = frame;
  if (!codec.is_lossy()) return out;
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    if (!out.points[i]) continue;
    const Quantiser quantiser = observation ? codec.at(*observation, i) : codec.in_reference_frame(i);
    const Lag lag = observation ? codec.lag_of(i) : codec.lag_in_reference_frame(i);
    out.points[i]->information =
        widened(out.points[i]->information, codec_parts_pitches(*out.points[i], quantiser, lag));
  }
  return out;
}

BoardExtent codec_mm(const Reference& reference, std::size_t marker, const PatchReading& patch,
                     const Quantiser& quantiser, Lag lag) {
  const RasterPlan& plan = reference.plans[marker];
  if (!(quantiser.step > 0.0) || !reference.site.markers[marker].grating || !(plan.pitch_mm > 0.0)) return {};
  const Grating& grating = *reference.site.markers[marker].grating;
  const double mm_per_px = reference.view.mm_per_px(grating.centre);
  const double area_px = grating.width_mm * grating.height_mm / (mm_per_px * mm_per_px);
  std::array<double, 2> u{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const bool reads = axis == 0 ? plan.reads_x : plan.reads_y;
    const double slope = patch.modulation[axis] * kTwoPi / (plan.pitch_mm / mm_per_px) / std::sqrt(2.0);
    if (reads) u[axis] = codec_u_px(quantiser, lag, slope, area_px) * mm_per_px;
  }
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return {std::hypot(c * u[0], s * u[1]), std::hypot(s * u[0], c * u[1])};
}

}  // namespace moiregauge::internal
