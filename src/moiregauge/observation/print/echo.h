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
// Noise. An echo correlates the residuals of a frame with those of the previous one at the same pixel, and only there.
// Only pixels count whose prediction changed by several grey levels. Whole grey levels hide a small share of a small
// change. echo_sums.h has the model of these products.
//
// Behind a codec that predicts frames from others there is no noise to compare. It repeats what is below its step, so
// edges count from a pixel of movement on. For less movement, blur that grows with it is the test (movement_blur.h). A mean
// of three frames shows the images before and after alike, which is even. From two pixels on, that is no blur of an
// exposure, which reaches half as far. Without a codec, these two tests find the mean of equal frames. It lies in the
// middle of its images, so its odd column is zero.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "moiregauge/observation/print/echo_sums.h"
#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

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
  bool shows_noise = true;    // false behind a lossy codec: its errors follow the image content, as an echo does
  bool is_predicted = false;  // the codec predicts parts of it from other frames
};

// Collects the sums. The effort ends when the shares are decided, and the blur is.
class EchoWatch {
 public:
  // Adds the gratings of the next frame.
  void add(const LightPicture& picture, const std::vector<SeenPrint>& prints);
  // Interrupts the sequence: the next frame has no predecessors.
  void interrupt() { tracks_.clear(); }
  // Returns true if further frames change nothing.
  [[nodiscard]] bool is_finished() const { return has_shares_ && has_blur_; }
  [[nodiscard]] const EchoSums& sums() const { return sums_; }

 private:
  struct Pixel {
    int x = 0, y = 0;
  };
  // A grating in one frame. At rest it has its centre only.
  struct Moment {
    ImagePoint centre;  // px
    std::optional<PrintFromImage> map;
    std::vector<double> residuals, predicted;  // per pixel, light; NaN outside the window
    ImagePoint along;                          // direction of the print's x axis
    std::array<double, 2> variance{};          // blur along both axes since the reference frame, px^2
  };
  struct Track {
    std::vector<Pixel> pixels;    // by rows
    ImagePoint placed;            // px, centre for which the pixels were chosen
    std::vector<Moment> moments;  // newest first
    // Least mean square of the residuals of a fit, light^2.
    double least_square = std::numeric_limits<double>::infinity();
  };
  // Share by the edges of one grating in one frame.
  struct EdgeShare {
    double share = 0.0, u = 0.0;
    double both_sides = 0.0;         // share of the images before and after, each
    Extent<frame::Image> direction;  // unit vector along the movement
  };
  // Share by the edges of several gratings of a frame: sums of the weights w, of w s and of w times the direction.
  struct SharesOfGratings {
    double weight = 0.0, weighted = 0.0;
    ImagePoint direction;
    double both_weight = 0.0, both_sides = 0.0;  // the same of the shares of both sides
  };
  static void place(const LumaView& luma, const PatchWindow& window, const Moment& now, Track& track);
  static void predict(const LightPicture& picture, const SeenPrint& print, const Track& track, Moment& now);
  // Adds a grating to its track, with the residuals that its shares need. Returns true if it moved within the track.
  static bool follow(const LightPicture& picture, const SeenPrint& print, Track& track, bool needs_shares);
  // `visible_px`: smallest movement that counts.
  static std::optional<EdgeShare> share_by_edges_of(const SeenPrint& print, const Track& track, double visible_px);
  // Adds blur and movement of a grating in the frame before. Each has two axes.
  void add_blur_of(const SeenPrint& print, Track& track);
  void add_edges(std::size_t marker, const EdgeShare& edges, SharesOfGratings& shares);
  void add_noise(const SeenPrint& print, Track& track);
  void add_frame(const SharesOfGratings& shares);

  std::vector<Track> tracks_;  // per marker
  EchoSums sums_;
  std::vector<BlurReading> blurs_;
  std::vector<double> both_sides_;  // per frame
  int frame_ = 0;
  int examined_ = 0;   // frames with movement
  int predicted_ = 0;  // those that a codec predicts
  // Further frames change neither the shares, nor the blur.
  bool has_shares_ = false, has_blur_ = false;
};

}  // namespace moiregauge::internal
