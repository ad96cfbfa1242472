// SPDX-License-Identifier: Apache-2.0
// Looks for the previous frame in the current one. A camera that averages over time adds a share s of its last output.
// A moving target then lags, and no residual of a single frame shows that (docs/methods/precise/processing.md).
//
// Both tests look at the residuals r of the gratings' fits, at fixed pixels:
//
// Edges. The grating was elsewhere in the previous frame. Its template there, T(X - D), and the mirrored one, T(X + D),
// differ by the odd column A = T(X - D) - T(X + D). Blur by the movement itself is even, because an exposure is alike
// before and after its middle. So r = s A / 2, together with the columns of the fit. This needs D of a third of a pixel.
//
// Noise. The products of residuals k frames apart have the mean
//
//     <r(t) r(t - k)> / <r^2> = alpha_t + beta d_k^2 + s [k = 1]
//
// A fixed pattern gives alpha. It varies with the place of the edges in their pixels, so every frame has its own.
// Structure of print and paper, displaced by d_k, gives beta. Only pixels count whose prediction changed by several
// grey levels: whole grey levels hide a small share of a small change.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

// Sums over the frames of a recording.
struct EchoSums {
  // Share of the previous frame by the edges, one value per frame: sums of the weights w, of w^2, w s and w s^2.
  double weights = 0.0, squared_weights = 0.0, shares = 0.0, squared_shares = 0.0;
  // Weighted normal equations of beta and s by the noise, lower triangle by rows. alpha is eliminated.
  std::array<double, 3> normal{};
  std::array<double, 2> right{};
  double squares = 0.0, equations = 0.0;
};

// Share of the previous frame and its standard uncertainty, 1.
struct EchoShare {
  double share = 0.0;
  double u = std::numeric_limits<double>::infinity();
};
// Return the share by the edges and by the noise. u is infinite if the recording shows no share.
// Error: u is by the scatter between frames. It is enlarged for few frames, so that 4 u are as rare as 4 sigma.
[[nodiscard]] EchoShare share_by_edges(const EchoSums& sums);
[[nodiscard]] EchoShare share_by_noise(const EchoSums& sums);

// A grating of one frame.
struct SeenPrint {
  std::size_t marker = 0;
  const PrintModel* model = nullptr;
  const PatchFit* fit = nullptr;
  double step = 1.0;  // light per grey level
};

// An image and the light of its grey levels. An empty table: grey levels are light.
struct LightPicture {
  LumaView luma;
  std::span<const std::uint16_t> light;
};

// Collects the sums. The effort ends when one test is decided.
class EchoWatch {
 public:
  // Adds the gratings of the next frame.
  void add(const LightPicture& picture, const std::vector<SeenPrint>& prints);
  // Interrupts the sequence: the next frame has no predecessors.
  void interrupt() { tracks_.clear(); }
  // Returns true if further frames change nothing.
  [[nodiscard]] bool is_finished() const;
  [[nodiscard]] const EchoSums& sums() const { return sums_; }

 private:
  struct Pixel {
    int x = 0, y = 0;
  };
  // A grating in one frame. At rest it has its centre only.
  struct Moment {
    ImagePoint centre;  // px
    std::optional<PrintFromImage> map;
    std::vector<double> residuals, predicted;  // per pixel, light
  };
  struct Track {
    std::vector<Pixel> pixels;
    ImagePoint placed;            // px, centre for which the pixels were chosen
    std::vector<Moment> moments;  // newest first, at most four
  };
  struct FrameShare {
    double weight = 0.0, weighted = 0.0;
  };
  static void place(const LumaView& luma, const PatchWindow& window, const Moment& now, Track& track);
  static void predict(const LightPicture& picture, const SeenPrint& print, const Track& track, Moment& now);
  // Adds a grating to its track. Returns true if it moved within the track.
  static bool follow(const LightPicture& picture, const SeenPrint& print, Track& track);
  static void add_edges(const SeenPrint& print, const Track& track, FrameShare& share);
  void add_noise(double step, const Track& track);

  void add_share(const FrameShare& share);

  std::vector<Track> tracks_;  // per marker
  EchoSums sums_;
  int examined_ = 0;  // frames with movement
};

}  // namespace moiregauge::internal
