// SPDX-License-Identifier: Apache-2.0
// Lists the structs that run.mgj stores. A struct is stored field by field in the order of its declaration.
// If a struct gains a field, its number here must follow, or it does not compile. The constant kAdded states since
// which version the field exists, so that older files can be read.
#pragma once

#include "moiregauge/io/journal/stored_values.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

template <typename Frame>
inline constexpr std::size_t kFields<Point<Frame>> = 2;
template <typename Frame>
inline constexpr std::size_t kFields<Extent<Frame>> = 2;

// clang-format off
// Site and camera.
template <> inline constexpr std::size_t kFields<Site> = 2;
template <> inline constexpr std::size_t kFields<Marker> = 5;
template <> inline constexpr std::size_t kFields<Circle> = 2;
template <> inline constexpr std::size_t kFields<Grating> = 6;
template <> inline constexpr std::size_t kFields<KnownTo> = 4;
template <> inline constexpr std::size_t kFields<Camera> = 11;

// One frame.
template <> inline constexpr std::size_t kFields<Observation> = 8;
template <> inline constexpr std::size_t kFields<MarkerObservation> = 8;
template <> inline constexpr std::size_t kFields<Quantiser> = 2;
template <> inline constexpr std::size_t kFields<DetectedCircle> = 9;
template <> inline constexpr std::size_t kFields<PatchReading> = 10;
template <> inline constexpr std::size_t kFields<PatchFit> = 10;

// Reference frame.
template <> inline constexpr std::size_t kFields<Reference> = 14;
template <> inline constexpr std::size_t kFields<Tone> = 2;
template <> inline constexpr std::size_t kFields<ToneCurve> = 3;
template <> inline constexpr std::size_t kFields<CirclePoint> = 4;
template <> inline constexpr std::size_t kFields<View> = 2;
template <> inline constexpr std::size_t kFields<RasterPlan> = 10;
template <> inline constexpr std::size_t kFields<PrintModel> = 8;
template <> inline constexpr std::size_t kFields<PrintMisses> = 2;
template <> inline constexpr std::size_t kFields<PatchAtRest> = 3;
template <> inline constexpr std::size_t kFields<Outline> = 4;
template <> inline constexpr std::size_t kFields<PatchWindow> = 3;
template <> inline constexpr std::size_t kFields<PatchFitOptions> = 5;
template <> inline constexpr std::size_t kFields<CircleSearch> = 2;
template <> inline constexpr std::size_t kFields<RejectedOutline> = 4;

// Run.
template <> inline constexpr std::size_t kFields<InputInfo> = 14;
template <> inline constexpr std::size_t kFields<CameraProcessing> = 6;
template <> inline constexpr std::size_t kFields<EchoSums> = 14;
template <> inline constexpr std::size_t kFields<NoiseSums> = 5;
template <> inline constexpr std::size_t kFields<GratingShares> = 2;
template <> inline constexpr std::size_t kFields<BlurSlope> = 2;
template <> inline constexpr std::size_t kFields<EchoShare> = 2;
template <> inline constexpr std::size_t kFields<GrainSums> = 4;
template <> inline constexpr std::size_t kFields<SlopeSteps> = 2;
template <> inline constexpr std::size_t kFields<EdgeGap> = 2;
template <> inline constexpr std::size_t kFields<FrameRange> = 4;
template <> inline constexpr std::size_t kFields<TimeRange> = 2;
template <> inline constexpr std::size_t kFields<MeasureOptions> = 14;
template <> inline constexpr std::size_t kFields<ChannelText> = 3;
template <> inline constexpr std::size_t kFields<MarkerChoice> = 4;
template <> inline constexpr std::size_t kFields<NewName> = 2;
template <> inline constexpr std::size_t kFields<SearchArea> = 2;
template <> inline constexpr std::size_t kFields<PixelRegion> = 4;
template <> inline constexpr std::size_t kFields<PrintScale> = 3;
template <> inline constexpr std::size_t kFields<SolveOptions> = 4;
template <> inline constexpr std::size_t kFields<ObserveOptions> = 4;
template <> inline constexpr std::size_t kFields<RasterOptions> = 3;
template <> inline constexpr std::size_t kFields<CircleOptions> = 3;

// clang-format on

// Version 3: tone curve and line width. Version 5: slow motion and start time. Version 6: channels.
template <>
inline constexpr std::array kAdded<Reference>{AddedFields{12, 2, 3}, AddedFields{}};
template <>
inline constexpr std::array kAdded<PrintModel>{AddedFields{7, 1, 3}, AddedFields{}};
template <>
inline constexpr std::array kAdded<PatchFitOptions>{AddedFields{4, 1, 3}, AddedFields{}};
template <>
inline constexpr std::array kAdded<InputInfo>{AddedFields{10, 1, 3}, AddedFields{12, 2, 5}};
template <>
inline constexpr std::array kAdded<MeasureOptions>{AddedFields{12, 1, 3}, AddedFields{10, 2, 5}, AddedFields{13, 1, 6}};
inline constexpr int kSinceWidth = 3;

// Version 5: ranges in seconds, slow motion and start time, zero, grey levels at edges, choice of markers. Version 7:
// the previous frame in the gratings. Version 8: its structure and directions. Version 9: scatter of the grain.
// Version 10: shares of each grating. Version 11: blur by movement. Version 12: products of each grating.
template <>
inline constexpr std::array kAdded<CameraProcessing>{AddedFields{4, 1, 5}, AddedFields{5, 1, 7}};
template <>
inline constexpr std::array kAdded<GrainSums>{AddedFields{3, 1, 9}, AddedFields{}};
template <>
inline constexpr std::array kAdded<EchoSums>{AddedFields{8, 2, 8}, AddedFields{10, 1, 10}, AddedFields{11, 2, 11},
                                             AddedFields{13, 1, 12}};
template <>
inline constexpr std::array kAdded<ObserveOptions>{AddedFields{3, 1, 5}, AddedFields{}};
template <>
inline constexpr std::array kAdded<FrameRange>{AddedFields{3, 1, 5}, AddedFields{}};

// Return true for valid values. The switches make the compiler report a missing value.
[[nodiscard]] constexpr bool is_known(ToneCurve::Kind kind) {
  return kind >= ToneCurve::Kind::kLinear && kind <= ToneCurve::Kind::kGamma;
}
[[nodiscard]] constexpr bool is_known(ToneSource source) {
  return source >= ToneSource::kAssumed && source <= ToneSource::kFootage;
}
[[nodiscard]] constexpr bool is_known(Role role) {
  switch (role) {
    case Role::kReference:
    case Role::kTarget:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(Pattern pattern) {
  switch (pattern) {
    case Pattern::kAuto:
    case Pattern::kGrid:
    case Pattern::kSquares:
    case Pattern::kDots:
    case Pattern::kLinesX:
    case Pattern::kLinesY:
    case Pattern::kCheckerboard:
    case Pattern::kCosine:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(Loss loss) {
  switch (loss) {
    case Loss::kNone:
    case Loss::kNotSeen:
    case Loss::kOutsidePicture:
    case Loss::kNoModulation:
    case Loss::kCovered:
    case Loss::kTooCoarse:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(Occlusion cover) {
  switch (cover) {
    case Occlusion::kNone:
    case Occlusion::kNow:
    case Occlusion::kAtRest:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(Order order) {
  switch (order) {
    case Order::kUnproven:
    case Order::kProven:
    case Order::kContradicted:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(TemplateUse use) {
  switch (use) {
    case TemplateUse::kAuto:
    case TemplateUse::kOn:
    case TemplateUse::kOff:
      return true;
  }
  return false;
}
[[nodiscard]] constexpr bool is_known(BoardAxes axes) {
  switch (axes) {
    case BoardAxes::kPrint:
    case BoardAxes::kImage:
      return true;
  }
  return false;
}

template <typename To, typename From>
struct Stored<Homography<To, From>> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    Matrix3 matrix = value.matrix();
    moiregauge::internal::store(archive, matrix);
    if constexpr (Archive::kReads) value = Homography<To, From>(matrix);
  }
};

// Stores one triangle of a symmetric matrix.
template <>
struct Stored<PatchInformation> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    for (int row = 0; row < value.rows(); ++row) {
      for (int column = 0; column <= row; ++column) {
        archive.number(value(row, column));
        if constexpr (Archive::kReads) value(column, row) = value(row, column);
      }
    }
  }
};

// Stores the inputs of the system and rebuilds it when reading.
template <>
struct Stored<PatchSystem> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    NormalMatrix normal = value.normal();
    int pixels = value.pixels();
    PatchFitOptions options = value.options();
    const bool has_width = version_of(archive) >= kSinceWidth;
    for (int row = 0; row < kColumns; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        if (has_width || (row != kWidthColumn && column != kWidthColumn)) archive.number(normal(row, column));
      }
    }
    archive.number(pixels);
    moiregauge::internal::store(archive, options);
    if (!has_width) options.has_width = false;
    if constexpr (Archive::kReads) {
      auto made = PatchSystem::of(normal, pixels, options);
      if (!made) return archive.fail();
      value = *std::move(made);
    }
  }
};

// Stores the Fourier series. Its table is rebuilt when reading.
template <>
struct Stored<PrintTemplate> {
  static constexpr int kHighest = 4096;
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    int order = value.order();
    std::vector<double> series;  // real and imaginary parts; n varies slowest
    for (int n = -order; n <= order; ++n) {
      for (int m = -order; m <= order; ++m) {
        series.push_back(value.coefficient(m, n).real());
        series.push_back(value.coefficient(m, n).imag());
      }
    }
    archive.number(order);
    moiregauge::internal::store(archive, series);
    if constexpr (Archive::kReads) {
      if (order < 1 || order > kHighest) return archive.fail();
      std::vector<std::complex<double>> read;
      for (std::size_t k = 0; k + 1 < series.size(); k += 2) read.emplace_back(series[k], series[k + 1]);
      if (const auto side = static_cast<std::size_t>(2 * order + 1); read.size() != side * side) return archive.fail();
      value = PrintTemplate(order, read);
    }
  }
};

// Stores the name of the method.
template <>
struct Stored<const Method*> {
  template <typename Archive, typename Value>
  static void store(Archive& archive, Value& value) {
    std::string name(value == nullptr ? "" : value->name);
    archive.text(name);
    if constexpr (Archive::kReads) {
      if (name.empty()) return;
      value = method_named(name);
      if (value == nullptr) archive.fail();
    }
  }
};

}  // namespace moiregauge::internal
