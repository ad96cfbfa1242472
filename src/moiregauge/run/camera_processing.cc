// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/camera_processing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/observation/print/few_frames.h"
#include "moiregauge/run/codec.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxTiles = 96;
// Largest movement of the references between frames, px, at which the camera counts as still. The movement model of a
// tile is linear: at 0.1 px it leaves 0.1^2 / 2 = 0.005 of the second derivative.
constexpr double kStill_px = 0.1;
constexpr double kAnchor = 0.2;   // largest shift of a circle from its tiles, in diameters (chosen)
constexpr double kEdge_px = 3.0;  // px, width of the blurred edge of a circle: 3 sigma of a usual point spread
// px, the same behind a lossy codec: what it rounds in an edge shows in the whole block, up to 7 sqrt(2) px away.
constexpr double kCodedEdge_px = kEdge_px + 10.0;
constexpr double kDiscTiles = 0.6;  // side of the square of tiles inside a circle, in diameters (inscribed: 0.71)

// Upper limit of the grain ratio (one frame apart to two apart) for frames that are not independent, camera still.
// Independent grain gives 1. A share of 0.05 of the previous frame lowers the ratio by 0.05.
constexpr double kIndependent = 0.96;
// The same limit for a moving camera. Faint texture lowers the ratio by 0.02, if it has a third of the grain's variance
// and passes by at half a pixel per frame. A share of 0.1 leaves 0.95 where the filter works on whole grey levels.
// A lossy codec removes fine grain and adds its own pattern, which changes with the image content: hence the lower
// limit.
constexpr double kIndependentMoving = 0.96;
constexpr double kIndependentMovingLossy = 0.85;
constexpr double kSureOfGrain = 3.0;   // distance of the ratio from 1 that proves averaging, in u
constexpr double kMinValues = 1000.0;  // u of the grain ratio is 0.045 then
// Smallest share by noise that proves averaging, where structure beyond the terms adds to it. Chosen from recordings that move by 0.6 px per frame in
// one direction. Fifteen without an echo had 0.0095 in the mean with a scatter of 0.0125. Four with a share of 0.1 had
// 0.052 to 0.097.
constexpr double kEchoByNoise = 0.04;
constexpr double kSureOfEcho = 3.0;  // distance of a share from 0 that proves averaging, in u
// The same behind a lossy codec. Its errors are alike in successive frames, so u by their scatter is too small. One of 44
// MJPEG recordings without processing reached 3.1 u.
constexpr double kSureOfEchoLossy = 4.0;
// Smallest variance of real grain, grey levels squared. A quiet sensor's variance of 0.1 still leaves 0.05 after
// rounding to whole grey levels. A lower variance than this limit means that noise was removed.
constexpr double kNoGrain = 0.003;

// Share of repeated steps that proves enlargement by pixel repetition. Blurred edges of real images have a few per
// cent. An image enlarged by 1.2 has 1 / 6.
constexpr double kRepeated = 0.12;
constexpr long kMinSteps = 200;
constexpr double kMinJump = 0.08;  // smallest step counted, as a share of the grating's contrast (chosen)

// Share of edge pixels in the emptiest range below which the tone curve has a step. A Gaussian edge has 0.28 or more, also
// behind gamma and S-curves, and 0.02 after histogram equalisation. Chosen between both.
constexpr double kGapShare = 0.08;
constexpr long kMinEdgePixels = 200;  // 0.28 of them scatter by 0.032

constexpr double kMoved_px = 0.03;  // movement of a marker from which on an average matters. Chosen.

// Movement of the references within the longest lag, in pitches, from which on an average falsifies targets at rest too.
// The sum of two images has the phase of their mean position only as long as they are near. At a distance of P / 4 the
// error is up to P / 100 (docs/methods/precise/processing.md).
constexpr double kOverlap = 0.25;
// The same for a strong average. It shows the camera's motion weakened, or as a fading image that stays in its place. So
// all that is more than noise counts: 0.1 px of a pitch of 20 px.
constexpr double kOverlapStrong = 0.005;
// Share of the previous frame from which on an average is strong. 8 bits of feedback show a share of 0.85 as 0.42, and one
// of 0.3 as 0.30. Chosen between both.
constexpr double kStrong = 0.35;

// Share of the images before and after, each, that proves an average, and its least distance from 0 in u. The longest
// exposure has the variance of 1/24, two equal frames show 0.1, and three 1/3. Without an average, four codecs had 0.005
// at most. Chosen.
constexpr double kBothSides = 0.06, kSureOfBothSides = 2.5;
// Least grain ratio of noise that is known to be independent, and the distance from it in u. Chosen.
constexpr double kKeepsNoise = 0.9, kSureOfKept = 2.0;
// Share of the previous frame by noise that excludes equal frames. Means of two frames showed 0.18 to 0.24, because
// structure and whole grey levels take a part. Chosen.
constexpr double kEqualFrames = 0.15;
// Blur where no noise is left to compare: distance of its growth with movement from that of the longest exposure, in
// u, and least distance. Without an average, eight codecs had up to 0.04 above zero. Chosen.
constexpr double kSureOfBlur = 2.0, kBlurOfCodec = 0.02;
// The same distance where u is larger than half the 2/3 of three equal frames. Such a recording shows little, and chance
// would look like an average in one of 40. Chosen.
constexpr double kSureOfUnclearBlur = 4.0, kUnclearBlur = 1.0 / 3.0;

constexpr double kMoves = 2.5;  // significant movement within the longest lag, in u (chosen)

void add_tiles(PixelRectangle at, int width, int height, std::vector<PixelPosition>& all) {
  const auto inside = [](double v, int most) { return static_cast<int>(std::clamp(v, 0.0, double(most))); };
  const int x1 = inside(at.x1, width), y1 = inside(at.y1, height);
  for (int y = inside(at.y0, height); y + kGrainTile <= y1; y += kGrainTile) {
    for (int x = inside(at.x0, width); x + kGrainTile <= x1; x += kGrainTile) all.push_back({x, y});
  }
}

// Returns the tiles to sample. Circles come first, because they are flat. Gratings fill at most as many tiles again.
std::vector<PixelPosition> tiles_of(const Reference& reference, const View& view) {
  std::vector<PixelPosition> all, prints;
  for (const CirclePoint& point : reference.circles) {
    const ImagePoint at = view(point.board);
    const double half = 0.5 * kDiscTiles * reference.diameter_px(point, view);
    add_tiles({at.x - half, at.y - half, at.x + half, at.y + half}, reference.width, reference.height, all);
  }
  if (all.size() > kMaxTiles) all.resize(kMaxTiles);
  for (const Marker& marker : reference.site.markers) {
    if (marker.role == Role::kReference && marker.grating)
      add_tiles(rectangle_round(marker, {}, view), reference.width, reference.height, prints);
  }
  const std::size_t step = prints.size() / kMaxTiles + 1;
  for (std::size_t k = 0; k < prints.size(); k += step) all.push_back(prints[k]);
  return all;
}

// Returns for each tile whether it lies inside a circle. Elsewhere edges move through a tile. They change grey levels
// twice as much in two frames as in one, and an average over time looks the same.
std::vector<bool> lie_on_discs(const std::vector<PixelPosition>& tiles, const Reference& reference, const View& view,
                               double edge_px) {
  std::vector<bool> on(tiles.size(), false);
  for (const CirclePoint& point : reference.circles) {
    const ImagePoint at = view(point.board);
    const double radius = 0.5 * reference.diameter_px(point, view) - edge_px;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      constexpr double kHalf = 0.5 * (kGrainTile - 1);
      const double far_x = std::abs(tiles[t].x + kHalf - at.x) + kHalf;
      const double far_y = std::abs(tiles[t].y + kHalf - at.y) + kHalf;
      if (radius > 0.0 && far_x * far_x + far_y * far_y <= radius * radius) on[t] = true;
    }
  }
  return on;
}

double contrast_of(const LumaView& part) {
  double darkest = INFINITY, lightest = -INFINITY;
  std::visit(
      [&](const auto& picture) {
        for (int y = 0; y < picture.height; ++y) {
          for (const auto grey : picture.row(y)) {
            darkest = std::min(darkest, static_cast<double>(grey));
            lightest = std::max(lightest, static_cast<double>(grey));
          }
        }
      },
      part);
  return lightest - darkest;
}

bool is_still(const std::vector<std::vector<ImagePoint>>& last) {
  return last.size() == 3 && largest_distance(last[0], last[1]) < kStill_px &&
         largest_distance(last[0], last[2]) < kStill_px;
}

// Returns u of the grain ratio, by its scatter between tiles and frames. A codec leaves a few coefficients of a tile, so
// its ratio scatters more than that of independent pixels, which is the least. Sums over frames scatter by 8 / 9 of the
// variance of their parts, because these share frames. That is neglected.
double u_of_ratio(const GrainSums& grain) {
  const double ratio = grain.one_apart / grain.two_apart;
  const auto& [aa, ab, bb] = grain.products;
  const double scatter = std::max(0.0, aa - 2.0 * ratio * ab + ratio * ratio * bb);
  const double square = grain.two_apart * grain.two_apart;
  // Behind a coarse codec the grain of few tiles decides. Each frame counts three times.
  const double few = enlargement_of_few(square / bb / 3.0);
  return std::sqrt(std::max(2.0 / grain.values, few * few * scatter / square));
}

// Returns true if the noise of consecutive frames is correlated.
bool is_alike(const GrainSums& grain, double independent) {
  if (grain.values < kMinValues) return false;
  const double limit = std::min(independent, 1.0 - kSureOfGrain * u_of_ratio(grain));
  return grain.one_apart < limit * grain.two_apart;
}

// Returns true if noise shows that no frames are averaged. A mean of two frames leaves half of the ratio, or 0.8 where
// whole grey levels hide the noise.
bool is_independent(const GrainSums& grain) {
  if (grain.values < kMinValues) return false;
  return grain.one_apart > (kKeepsNoise + kSureOfKept * u_of_ratio(grain)) * grain.two_apart;
}
bool excludes_equal_frames(const EchoShare& by_noise) {
  return by_noise.share + kSureOfEcho * by_noise.u < kEqualFrames;
}

// Returns true if a target moves significantly within a few samples.
bool moves_quickly(const std::vector<Sample*>& rows) {
  for (std::size_t n = 0; n < rows.size(); ++n) {
    for (std::size_t k = n + 1; k < std::min(rows.size(), n + 1 + kLagSamples); ++k) {
      const auto went = rows[k]->displacement - rows[n]->displacement;
      const double u_x = std::max(rows[n]->u.x, rows[k]->u.x), u_y = std::max(rows[n]->u.y, rows[k]->u.y);
      if (std::abs(went.x) > kMoves * u_x || std::abs(went.y) > kMoves * u_y) return true;
    }
  }
  return false;
}

// Marks one sample. Samples of the reference frame stay ok, because they are zero by definition. Returns true if the sample
// is untrusted, for this reason or for another.
bool distrust(Sample& sample) {
  const bool is_reference = sample.u.x == 0.0 && sample.u.y == 0.0;
  if (!is_reference && sample.status == Status::kOk) sample.status = Status::kUntrusted;
  return sample.status == Status::kUntrusted;
}

// Marks the samples of moving targets in frames for which `is_wrong(frame)` is true. Returns their number.
template <typename IsWrong>
long distrust_moving(Samples& samples, IsWrong is_wrong) {
  long count = 0;
  std::map<std::size_t, std::vector<Sample*>> by_target;
  for (Sample& sample : samples) {
    if (has_numbers(sample.status)) by_target[sample.marker].push_back(&sample);
  }
  for (const auto& [marker, rows] : by_target) {
    if (!moves_quickly(rows)) continue;
    for (Sample* row : rows) count += is_wrong(row->frame) && distrust(*row);
  }
  return count;
}

// Marks the samples up to one longest lag before and after a movement of the references. Returns their number.
long distrust_overlap(Samples& samples, const std::vector<FrameMovement>& movement, double limit) {
  std::set<long> frames;
  for (std::size_t n = 0; n < movement.size(); ++n) {
    const auto first = movement.begin() + static_cast<std::ptrdiff_t>(n);
    const auto last = movement.begin() + static_cast<std::ptrdiff_t>(std::min(movement.size(), n + 1 + kLagSamples));
    if (std::any_of(first, last, [&](const FrameMovement& m) { return m.pitches > limit; }))
      frames.insert(first->frame);
  }
  long count = 0;
  for (Sample& sample : samples) count += frames.contains(sample.frame) && distrust(sample);
  return count;
}

std::optional<ProcessingFault> enlarged_fault(const SlopeSteps& steps, Samples& samples) {
  if (steps.all < kMinSteps || static_cast<double>(steps.repeated) <= kRepeated * static_cast<double>(steps.all))
    return {};
  for (Sample& sample : samples) (void)distrust(sample);
  const std::string remedy = "record at the sensor's own size, or enlarge with interpolation";
  return ProcessingFault{
      fmt::format("no row is trusted: the image was enlarged by repeating pixels ({:.0f} % of its edge steps are "
                  "repeated). Remedy: {}",
                  100.0 * static_cast<double>(steps.repeated) / static_cast<double>(steps.all), remedy),
      remedy};
}

// Returns the share of the previous frame that the gratings show, if it is significant.
std::optional<EchoShare> echo_share(const EchoSums& echo, bool is_lossy) {
  const auto significant = [sure = is_lossy ? kSureOfEchoLossy : kSureOfEcho](double least, const EchoShare& by) {
    return by.share > std::max(least, sure * by.u) ? by : EchoShare{};
  };
  const EchoShare by =
      std::max({significant(kLeastEcho, share_by_edges(echo)), significant(kEchoByNoise, share_by_noise(echo)),
                significant(kEchoByNoise, share_by_both(echo))},
               [](const EchoShare& a, const EchoShare& b) { return a.share < b.share; });
  return by.share > 0.0 ? std::optional(by) : std::nullopt;
}

struct Averaging {
  std::string shown;   // what shows it
  std::string remedy;  // imperative
  double share = 1.0;  // share of the previous frame
};

// Returns what shows that the camera averages over time. Nothing: nothing does.
std::optional<Averaging> averaging_shown(const CameraProcessing& processing, bool is_lossy) {
  const std::string remedy = "switch the camera's temporal noise reduction off, or record raw";
  const GrainSums &still = processing.still, &moving = processing.moving;
  if (!is_lossy && still.values > kMinValues && still.two_apart < 2.0 * kNoGrain * still.values)
    return Averaging{"its still parts contain no noise", remedy, 1.0};
  const bool alike_still = is_alike(still, kIndependent);
  if (alike_still || is_alike(moving, is_lossy ? kIndependentMovingLossy : kIndependentMoving)) {
    const GrainSums& grain = alike_still ? still : moving;
    return Averaging{fmt::format("its noise is alike in successive frames, {:.2f} of independent noise, u {:.2g}",
                                 grain.one_apart / grain.two_apart, u_of_ratio(grain)),
                     remedy, grain.two_apart / grain.one_apart - 1.0};
  }
  // Slow movement in one direction looks most like a share. Other movement per frame is the better test.
  if (const auto by = echo_share(processing.echo, is_lossy))
    return Averaging{fmt::format("the gratings show {:.3f} of the previous frame, u {:.3f}", by->share, by->u),
                     remedy + "; if it was off, halve the camera's frame rate", by->share};
  // Long exposures of vibrations with few frames per period are blurred as much. So noise decides where there is any.
  if (is_independent(still) || is_independent(moving) || excludes_equal_frames(share_by_noise(processing.echo)))
    return {};
  const EchoShare& both = processing.echo.both_sides;
  if (both.share > std::max(kBothSides, kSureOfBothSides * both.u))
    return Averaging{
        fmt::format("the gratings show {:.2f} of the images before and after, u {:.2f}", both.share, both.u), remedy,
        1.0};
  const BlurSlope& blur = processing.echo.blur;
  const double sure = blur.u < kUnclearBlur ? kSureOfBlur : kSureOfUnclearBlur;
  if (blur.slope > kBlurOfExposure + std::max(kBlurOfCodec, sure * blur.u))
    return Averaging{
        fmt::format("blur grows with movement {:.1f} times as much as the longest exposure explains, u {:.1f}",
                    blur.slope / kBlurOfExposure, blur.u / kBlurOfExposure),
        remedy, 1.0};
  return {};
}

std::optional<ProcessingFault> stepped_tone_fault(const EdgeGap& gap, Samples& samples) {
  if (gap.all < kMinEdgePixels || static_cast<double>(gap.in_gap) >= kGapShare * static_cast<double>(gap.all))
    return {};
  for (Sample& sample : samples) (void)distrust(sample);
  const std::string remedy = "record without histogram equalisation or local contrast enhancement";
  return ProcessingFault{
      fmt::format(
          "no row is trusted: the tone curve has a step, which rounds edges to whole pixels (a third of the grey "
          "levels is missing at the edges of the circles: {} of {} pixels). Remedy: {}",
          gap.in_gap, gap.all, remedy),
      remedy};
}

}  // namespace

void ProcessingWatch::refer(const Reference& reference, const LumaView& luma) {
  sampler_ = {};
  echo_ = {};
  placed_.clear();
  is_referred_ = true;
  last_.clear();
  steps_ = {};
  EdgeLevels levels;
  for (const CirclePoint& point : reference.circles) {
    const ImagePoint at = reference.view(point.board);
    levels.add_disc(luma, at.x, at.y, reference.diameter_px(point, reference.view));
  }
  gap_ = {levels.all(), levels.in_emptiest_range()};
  for (const Marker& marker : reference.site.markers) {
    if (!marker.grating) continue;
    const PixelRectangle at = rectangle_round(marker, {}, reference.view);
    const auto part = part_of(luma, static_cast<int>(at.x0), static_cast<int>(at.y0), static_cast<int>(at.x1),
                              static_cast<int>(at.y1));
    const SlopeSteps found = count_slope_steps(part, kMinJump * contrast_of(part));
    steps_.all += found.all;
    steps_.repeated += found.repeated;
  }
}

// Adds the gratings of a frame.
void ProcessingWatch::listen(const Reference& reference, const Observation& seen, const Frame& frame,
                             const LightMap& light) {
  std::vector<SeenPrint> prints;
  for (std::size_t i = 0; i < seen.markers.size() && i < reference.prints.size(); ++i) {
    const MarkerObservation& marker = seen.markers[i];
    if (!marker.points || !reference.prints[i] || marker.loss != Loss::kNone || marker.occlusion != Occlusion::kNone)
      continue;
    prints.push_back({i, &*reference.prints[i], &*marker.points,
                      reference.light_per_grey.empty() ? 1.0 : reference.light_per_grey[i]});
  }
  const Quantiser& codec = frame.quantiser.whole;
  echo_.add({frame.luma, light.table(), codec.is_lossless(), codec.shows_other_frames()}, prints);
}

bool ProcessingWatch::needs_skipped_frames(const Observation& seen) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ImagePoint> markers(seen.markers.size(), ImagePoint{nan, nan});
  bool moves = false;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const MarkerObservation& marker = seen.markers[i];
    if (marker.points) markers[i] = marker.points->image[4];
    // Methods other than `precise` read the patch only.
    moves |= !marker.points && marker.patch.valid;
    moves |= i < markers_.size() && length(markers[i] - markers_[i]) > kMoved_px;
  }
  markers_ = std::move(markers);
  return moves && !echo_.is_finished();
}

void ProcessingWatch::add(const Reference& reference, const Observation& seen, const Frame& frame, int bits,
                          const LightMap& light) {
  if (newest_ && frame.number != *newest_ + 1) interrupt();
  newest_ = frame.number;
  is_testable_ = !frame.quantiser.whole.shows_other_frames();
  listen(reference, seen, frame, light);
  // A codec with prediction between frames repeats grain even without noise reduction. Its error has its own part in u.
  const Quantiser& codec = frame.quantiser.whole;
  if (!seen.references_seen || reference.circles.empty() || !is_testable_) return interrupt_grain();
  std::vector<ImagePoint> centres = reference_centres(reference, seen);
  const View view{seen.stage2, reference.lens};
  const double reach = kAnchor * reference.diameter_px(reference.circles.front(), view);
  if (placed_.size() != centres.size() || largest_distance(placed_, centres) > reach) {
    sampler_.place(tiles_of(reference, view));
    last_.clear();
    placed_ = centres;
  }
  last_.insert(last_.begin(), std::move(centres));
  if (last_.size() > 3) last_.pop_back();
  sampler_.add(
      frame.luma, (1 << bits) - 1,
      {.is_still = is_still(last_),
       .is_lossless = codec.is_lossless(),
       .is_uniform = lie_on_discs(sampler_.tiles(), reference, view, codec.is_lossless() ? kEdge_px : kCodedEdge_px)});
}

CameraProcessing ProcessingWatch::result(long since) const {
  const auto first = std::ranges::lower_bound(repeated_, since);
  return {sampler_.still(), sampler_.moving(), steps_, {first, repeated_.end()}, gap_, echo_.sums()};
}

void ProcessingWatch::repeat(long frame) {
  repeated_.push_back(frame);
  interrupt();
}

void ProcessingWatch::interrupt() {
  echo_.interrupt();
  interrupt_grain();
}

void ProcessingWatch::interrupt_grain() {
  sampler_.interrupt();
  last_.clear();
}

std::optional<ProcessingFault> distrust_processed(const CameraProcessing& processing, bool is_lossy,
                                                  const std::function<std::vector<FrameMovement>()>& movement,
                                                  Samples& samples) {
  if (auto fault = enlarged_fault(processing.steps, samples)) return fault;
  if (auto fault = stepped_tone_fault(processing.gap, samples)) return fault;
  std::optional<ProcessingFault> fault;
  const auto is_repeated = [&](long frame) {
    return std::binary_search(processing.repeated.begin(), processing.repeated.end(), frame);
  };
  const auto ok_before = std::ranges::count(samples, Status::kOk, &Sample::status);
  (void)distrust_moving(samples, is_repeated);
  if (std::ranges::count(samples, Status::kOk, &Sample::status) < ok_before)
    fault = {"", "record without dropped frames, because a repeated frame shows a moving target in the wrong position"};
  const auto averaging = averaging_shown(processing, is_lossy);
  if (!averaging) return fault;
  const bool is_strong = averaging->share > kStrong;
  const long overlapping = distrust_overlap(samples, movement(), is_strong ? kOverlapStrong : kOverlap);
  if (distrust_moving(samples, [](long) { return true; }) + overlapping == 0) return fault;
  const char* const which = overlapping == 0 ? "moving targets are"
                            : is_strong      ? "moving targets, and all targets while the camera moves, are"
                                             : "moving targets, and all targets while the camera moves quickly, are";
  return ProcessingFault{fmt::format("{} not trusted: the camera averages over time ({}). Remedy: {}", which,
                                     averaging->shown, averaging->remedy),
                         averaging->remedy};
}

}  // namespace moiregauge::internal
