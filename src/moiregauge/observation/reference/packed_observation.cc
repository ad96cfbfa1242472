// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/packed_observation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace moiregauge::internal {
namespace {

// Largest deviation of an information matrix that counts as the shared one, relative to the largest entry. Rounding
// causes 1e-7. A frame's own normal equations differ by 1e-3 and more.
constexpr double kSameInformation = 1e-6;
constexpr double kSamePlace_px = 1e-7;

enum FrameFlag : unsigned { kIsDamaged = 1, kHasReferences = 2, kHasProblem = 4, kHasStage2 = 8 };
enum MarkerFlag : unsigned {
  kHasCircle = 1,
  kHasOwnCircle = 2,  // in more than position and size
  kHasPatch = 4,
  kIsPatchValid = 8,
  kHasShift = 16,
  kHasStep = 32,
  kIsPredicted = 64,
  kHasPoints = 128,
  kHasOwnImage = 256,  // points that do not follow from the window's map
  kHasOwnInformation = 512,
  kHasExactPrint = 1024  // no template grid to refer to
};

template <typename Bits>
void append_bits(std::string& bytes, Bits value) {
  for (std::size_t k = 0; k < sizeof(Bits); ++k)
    bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * k)));
}

class PackedWriter {
 public:
  static constexpr bool kReads = false;
  void exact(double value) { append_bits(bytes_, std::bit_cast<std::uint64_t>(value)); }
  void rounded(double value) { append_bits(bytes_, std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void whole(long value) { append_bits(bytes_, static_cast<std::uint64_t>(value)); }
  void whole(int value) { append_bits(bytes_, static_cast<std::uint32_t>(value)); }
  void flags(unsigned value) { append_bits(bytes_, static_cast<std::uint16_t>(value)); }
  void count(std::size_t value) { append_bits(bytes_, static_cast<std::uint32_t>(value)); }
  template <typename Enumeration>
  void word(Enumeration value) {
    bytes_ += static_cast<char>(value);
  }
  void text(const std::string& value) {
    count(value.size());
    bytes_ += value;
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Reads packed values. From the first missing or impossible byte on it returns zeros.
class PackedReader {
 public:
  static constexpr bool kReads = true;
  explicit PackedReader(std::string_view bytes) : left_(bytes) {}
  void exact(double& value) { value = std::bit_cast<double>(taken<std::uint64_t>()); }
  void rounded(double& value) { value = static_cast<double>(std::bit_cast<float>(taken<std::uint32_t>())); }
  void whole(long& value) { value = static_cast<long>(taken<std::uint64_t>()); }
  void whole(int& value) { value = static_cast<int>(taken<std::uint32_t>()); }
  void flags(unsigned& value) { value = taken<std::uint16_t>(); }
  // Every counted item has at least one byte, so a larger count is wrong.
  void count(std::size_t& value) {
    value = taken<std::uint32_t>();
    if (value > left_.size()) fail();
    if (!good_) value = 0;
  }
  template <typename Enumeration>
  void word(Enumeration& value, Enumeration last) {
    const auto number = static_cast<int>(taken<unsigned char>());
    if (number > static_cast<int>(last)) fail();
    value = good_ ? static_cast<Enumeration>(number) : Enumeration{};
  }
  void text(std::string& value) {
    std::size_t size = 0;
    count(size);
    value = std::string(left_.substr(0, size));
    left_.remove_prefix(size);
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool is_finished() const { return good_ && left_.empty(); }

 private:
  void fail() {
    good_ = false;
    left_ = {};
  }
  template <typename Bits>
  Bits taken() {
    if (left_.size() < sizeof(Bits)) fail();
    if (!good_) return 0;
    Bits value = 0;
    for (std::size_t k = sizeof(Bits); k-- > 0;)
      value = static_cast<Bits>(static_cast<Bits>(value << 8) | static_cast<unsigned char>(left_[k]));
    left_.remove_prefix(sizeof(Bits));
    return value;
  }
  std::string_view left_;
  bool good_ = true;
};

float single(double value) { return static_cast<float>(value); }

std::array<ImagePoint, kPatchPoints> image_of_grid(const Homography<frame::Window, frame::Image>& window_from_image) {
  const auto back = window_from_image.inverse();
  std::array<ImagePoint, kPatchPoints> image;
  for (int n = 0; n < kPatchPoints; ++n) image[static_cast<std::size_t>(n)] = back(window_point(n));
  return image;
}

bool is_image_of_grid(const PatchFit& fit) {
  const auto grid = image_of_grid(fit.window_from_image);
  for (std::size_t n = 0; n < grid.size(); ++n) {
    if (!(length(grid[n] - fit.image[n]) <= kSamePlace_px)) return false;
  }
  return true;
}

// Returns the information matrix as the fit of a tracked grating computes it, from the stored values.
PatchInformation shared_information(const ObservationPacking::Shared& shared, const PatchFit& fit) {
  const double sigma = static_cast<double>(single(fit.sigma)), gain = static_cast<double>(single(fit.gain[0]));
  if (!(sigma > 0.0)) return PatchInformation::Zero();
  return shared.per_pixel * (static_cast<double>(fit.pixels) / std::pow(shared.gain / gain * sigma, 2));
}

bool has_shared_information(const ObservationPacking::Shared& shared, const PatchFit& fit) {
  if (!shared.has_print) return false;
  const PatchInformation expected = shared_information(shared, fit);
  return (fit.information - expected).cwiseAbs().maxCoeff() <= kSameInformation * expected.cwiseAbs().maxCoeff();
}

bool is_alike(const DetectedCircle& a, const DetectedCircle& b) {
  return a.u_centre_px == b.u_centre_px && a.axis_ratio == b.axis_ratio && a.angle_rad == b.angle_rad &&
         a.circularity == b.circularity && a.ellipse_residual == b.ellipse_residual && a.contrast == b.contrast &&
         a.background == b.background;
}

bool is_blank(const PatchReading& patch) {
  const PatchReading blank;
  return patch.phase_rad == blank.phase_rad && patch.u_phase_rad == blank.u_phase_rad &&
         patch.modulation == blank.modulation && patch.gradient == blank.gradient && patch.u_gradient == 0.0 &&
         patch.straightness_mm == 0.0 && patch.u_straightness_mm == 0.0 && patch.noise_sigma == 0.0 &&
         patch.clipped_share == 0.0;
}

unsigned flags_of(const MarkerObservation& seen, const ObservationPacking::Shared& shared) {
  unsigned flags = 0;
  if (seen.circle) flags |= kHasCircle;
  if (seen.circle && !(shared.circle && is_alike(*seen.circle, *shared.circle))) flags |= kHasOwnCircle;
  if (!is_blank(seen.patch)) flags |= kHasPatch;
  if (seen.patch.valid) flags |= kIsPatchValid;
  if (seen.window_shift.x != 0.0 || seen.window_shift.y != 0.0) flags |= kHasShift;
  if (seen.quantiser.step != 0.0) flags |= kHasStep;
  if (seen.quantiser.predicted) flags |= kIsPredicted;
  if (!seen.points) return flags;
  flags |= kHasPoints;
  if (!is_image_of_grid(*seen.points)) flags |= kHasOwnImage;
  if (!has_shared_information(shared, *seen.points)) flags |= kHasOwnInformation;
  if (!shared.has_print) flags |= kHasExactPrint;
  return flags;
}

// One description serves packing and unpacking: `Archive` writes the values of a const object, or reads them into it.

template <typename Archive, typename To, typename From>
void transfer(Archive& archive, Homography<To, From>& map) {
  Matrix3 matrix = map.matrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) archive.exact(matrix(row, column));
  }
  if constexpr (Archive::kReads) map = Homography<To, From>(matrix);
}
template <typename To, typename From>
void transfer(PackedWriter& archive, const Homography<To, From>& map) {
  Homography<To, From> copy = map;
  transfer(archive, copy);
}

template <typename Archive, typename Circle>
void transfer_circle(Archive& archive, Circle& circle, bool is_own) {
  archive.exact(circle.centre.x);
  archive.exact(circle.centre.y);
  archive.rounded(circle.diameter_px);
  if (!is_own) return;
  for (auto* value : {&circle.u_centre_px, &circle.axis_ratio, &circle.angle_rad, &circle.circularity,
                      &circle.ellipse_residual, &circle.contrast, &circle.background})
    archive.rounded(*value);
}

template <typename Archive, typename Patch>
void transfer_patch(Archive& archive, Patch& patch) {
  for (std::size_t a = 0; a < 2; ++a) {
    for (auto* value : {&patch.phase_rad[a], &patch.u_phase_rad[a], &patch.modulation[a], &patch.gradient[a][0],
                        &patch.gradient[a][1]})
      archive.rounded(*value);
  }
  for (auto* value :
       {&patch.u_gradient, &patch.straightness_mm, &patch.u_straightness_mm, &patch.noise_sigma, &patch.clipped_share})
    archive.rounded(*value);
}

template <typename Archive, typename Print>
void transfer_print(Archive& archive, Print& print, bool is_exact, const PatchWindow& window) {
  for (int n = 0; n < kPatchPoints; ++n) {
    auto& p = print[static_cast<std::size_t>(n)];
    if (is_exact) {
      archive.exact(p.x);
      archive.exact(p.y);
      continue;
    }
    const PrintPoint grid = grid_point(window, n);
    double dx = p.x - grid.x, dy = p.y - grid.y;
    archive.rounded(dx);
    archive.rounded(dy);
    if constexpr (Archive::kReads) p = {grid.x + dx, grid.y + dy};
  }
}

template <typename Archive, typename Fit>
void transfer_fit(Archive& archive, Fit& fit, unsigned flags, const ObservationPacking::Shared& shared) {
  transfer(archive, fit.window_from_image);
  if constexpr (Archive::kReads) fit.image = image_of_grid(fit.window_from_image);
  if ((flags & kHasOwnImage) != 0) {
    for (auto& p : fit.image) {
      archive.exact(p.x);
      archive.exact(p.y);
    }
  }
  transfer_print(archive, fit.print, (flags & kHasExactPrint) != 0, shared.window);
  for (std::size_t k = 0; k < fit.light.size(); ++k) {
    archive.rounded(fit.light[k]);
    archive.rounded(fit.gain[k]);
  }
  archive.rounded(fit.sigma);
  archive.rounded(fit.fundamental[0]);
  archive.rounded(fit.fundamental[1]);
  archive.rounded(fit.last_step);
  archive.whole(fit.pixels);
  if constexpr (Archive::kReads) fit.information = shared_information(shared, fit);
  if ((flags & kHasOwnInformation) == 0) return;
  for (int row = 0; row < 2 * kPatchPoints; ++row) {
    for (int column = 0; column <= row; ++column) {
      archive.rounded(fit.information(row, column));
      if constexpr (Archive::kReads) fit.information(column, row) = fit.information(row, column);
    }
  }
}

template <typename Archive, typename ObservationLog>
void transfer_marker(Archive& archive, ObservationLog& seen, const ObservationPacking::Shared& shared) {
  unsigned flags = 0;
  if constexpr (Archive::kReads) {
    archive.flags(flags);
    archive.word(seen.loss, Loss::kTooCoarse);
    archive.word(seen.occlusion, Occlusion::kAtRest);
    archive.word(seen.order, Order::kContradicted);
    if ((flags & kHasCircle) != 0) seen.circle = shared.circle.value_or(DetectedCircle{});
    if ((flags & kHasPoints) != 0) seen.points.emplace();
    seen.patch.valid = (flags & kIsPatchValid) != 0;
    seen.quantiser.predicted = (flags & kIsPredicted) != 0;
  } else {
    flags = flags_of(seen, shared);
    archive.flags(flags);
    archive.word(seen.loss);
    archive.word(seen.occlusion);
    archive.word(seen.order);
  }
  if ((flags & kHasCircle) != 0) transfer_circle(archive, *seen.circle, (flags & kHasOwnCircle) != 0);
  if ((flags & kHasPatch) != 0) transfer_patch(archive, seen.patch);
  if ((flags & kHasShift) != 0) {
    archive.exact(seen.window_shift.x);
    archive.exact(seen.window_shift.y);
  }
  if ((flags & kHasStep) != 0) archive.rounded(seen.quantiser.step);
  if ((flags & kHasPoints) != 0) transfer_fit(archive, *seen.points, flags, shared);
}

bool is_same(const Matrix3& a, const Matrix3& b) {
  for (int k = 0; k < 9; ++k) {
    if (std::bit_cast<std::uint64_t>(a(k)) != std::bit_cast<std::uint64_t>(b(k))) return false;
  }
  return true;
}

}  // namespace

ObservationPacking::ObservationPacking(const Reference& reference) : shared_(reference.site.markers.size()) {
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    Shared& shared = shared_[i];
    if (i < reference.seen.markers.size()) shared.circle = reference.seen.markers[i].circle;
    if (i >= reference.prints.size() || !reference.prints[i] || !reference.prints[i]->at_rest) continue;
    const PrintModel& print = *reference.prints[i];
    shared.has_print = true;
    shared.window = print.window;
    shared.per_pixel = print.at_rest->system.information(1);
    shared.gain = print.at_rest->gain[0];
  }
}

std::string ObservationPacking::packed(const Observation& seen) const {
  static const Shared nothing;
  PackedWriter writer;
  const bool has_stage2 = !is_same(seen.stage1.matrix(), seen.stage2.matrix());
  const bool has_problem = !seen.reference_problem.empty();
  writer.flags((seen.decode_error ? kIsDamaged : 0U) | (seen.references_seen ? kHasReferences : 0U) |
               (has_problem ? kHasProblem : 0U) | (has_stage2 ? kHasStage2 : 0U));
  writer.whole(seen.frame);
  writer.exact(seen.time_s);
  if (has_problem) writer.text(seen.reference_problem);
  transfer(writer, seen.stage1);
  if (has_stage2) transfer(writer, seen.stage2);
  writer.count(seen.markers.size());
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    transfer_marker(writer, seen.markers[i], i < shared_.size() ? shared_[i] : nothing);
  return writer.take();
}

std::optional<Observation> ObservationPacking::unpacked(std::string_view bytes) const {
  static const Shared nothing;
  PackedReader reader(bytes);
  Observation seen;
  unsigned flags = 0;
  reader.flags(flags);
  seen.decode_error = (flags & kIsDamaged) != 0;
  seen.references_seen = (flags & kHasReferences) != 0;
  reader.whole(seen.frame);
  reader.exact(seen.time_s);
  if ((flags & kHasProblem) != 0) reader.text(seen.reference_problem);
  transfer(reader, seen.stage1);
  seen.stage2 = seen.stage1;
  if ((flags & kHasStage2) != 0) transfer(reader, seen.stage2);
  std::size_t markers = 0;
  reader.count(markers);
  seen.markers.reserve(std::min<std::size_t>(markers, shared_.size()));
  for (std::size_t i = 0; i < markers && reader.good(); ++i) {
    seen.markers.emplace_back();
    transfer_marker(reader, seen.markers.back(), i < shared_.size() ? shared_[i] : nothing);
  }
  if (!reader.is_finished()) return std::nullopt;
  return seen;
}

}  // namespace moiregauge::internal
