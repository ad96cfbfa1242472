// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/stabilised_video.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/drawing/surface/side_by_side.h"
#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/image/upper_bits.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Written = tl::expected<void, std::string>;

constexpr double kUsualFps = 25.0;  // frame rate for images without times
constexpr int kRateFactor = 18;     // x264: no visible blocks

std::vector<std::size_t> targets_of(const Reference& reference) {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i)
    if (reference.site.markers[i].role == Role::kTarget && reference.site.markers[i].grating) targets.push_back(i);
  return targets;
}

// Largest displacement of all targets over the measured samples. An axis that a grating cannot show counts as 0.
struct Travel {
  double longest_mm = 0.0, u_mm = 0.0, size_mm = 1e9;
};

Extent<frame::Board> numbers_of(const Extent<frame::Board>& e) {
  return {std::isfinite(e.x) ? e.x : 0.0, std::isfinite(e.y) ? e.y : 0.0};
}

Travel travel_of(const Measurement& m) {
  Travel travel;
  for (const Sample& s : m.samples) {
    if (s.status != Status::kOk) continue;
    travel.longest_mm = std::max(travel.longest_mm, length(numbers_of(s.displacement)));
    travel.u_mm = std::max(travel.u_mm, length(numbers_of(s.u)));
  }
  for (const std::size_t t : targets_of(*m.reference)) {
    const Grating& g = *m.reference->site.markers[t].grating;
    travel.size_mm = std::min({travel.size_mm, g.width_mm, g.height_mm});
  }
  return travel;
}

using BySample = std::map<std::pair<long, std::size_t>, const Sample*>;

BySample by_frame_and_marker(const Samples& samples) {
  BySample all;
  for (const Sample& s : samples) all[{s.frame, s.marker}] = &s;
  return all;
}

class Film {
 public:
  Film(const Measurement& m, const MeasureOptions& options, double exaggeration)
      : m_(m),
        targets_(targets_of(*m.reference)),
        picture_(*m.reference, exaggeration, travel_of(m).longest_mm),
        measured_(by_frame_and_marker(m.samples)) {
    // The motion visible after the references' homography is that of `two-stage`.
    if (options.method->needs_circles)
      apparent_samples_ = method_named("two-stage")->solve(*m.reference, m.observations, {}).samples;
    apparent_ = by_frame_and_marker(apparent_samples_.empty() ? m.samples : apparent_samples_);
    for (std::size_t n = 0; const Observation& seen : m.observations) place_[seen.frame] = n++;
  }

  [[nodiscard]] const SideBySide& picture() const { return picture_; }

  [[nodiscard]] Image<std::uint8_t> frame(const Frame& shot, int bits) const {
    const auto found = place_.find(shot.number);
    const Observation seen = found == place_.end() ? Observation{} : m_.observations[found->second];
    const bool is_seen = seen.references_seen && !seen.decode_error;
    std::vector<DrawnMotion> moves;
    std::string words = fmt::format("without camera motion, targets' motion x {:g}:", picture_.exaggeration());
    for (const std::size_t target : targets_) {
      moves.push_back(move_of(shot.number, target));
      words += words_for(moves.back(), m_.reference->site.markers[target].name);
    }
    const View view{is_seen ? seen.stage2 : m_.reference->seen.stage2, m_.reference->lens};
    const std::string when = std::isfinite(shot.time_s) ? fmt::format(", {:.2f} s", shot.time_s) : "";
    return picture_.draw(upper_bits(shot.luma, bits).view(), is_seen ? &view : nullptr, moves,
                         fmt::format("as filmed: frame {}{}", shot.number, when),
                         is_seen ? words : "references not found");
  }

 private:
  [[nodiscard]] DrawnMotion move_of(long frame, std::size_t target) const {
    const auto measured = measured_.find({frame, target}), apparent = apparent_.find({frame, target});
    if (measured == measured_.end() || apparent == apparent_.end()) return {};
    const Extent<internal::frame::Board>& d = measured->second->displacement;
    const Extent<internal::frame::Board>& a = apparent->second->displacement;
    if (!std::isfinite(d.x) && !std::isfinite(d.y)) return {};
    // If only one of both is known, it also replaces the other.
    return {
        true, numbers_of(d), {std::isfinite(a.x) ? a.x : numbers_of(d).x, std::isfinite(a.y) ? a.y : numbers_of(d).y}};
  }
  [[nodiscard]] static std::string words_for(const DrawnMotion& move, const std::string& name) {
    if (!move.is_known) return fmt::format("  {} not measured", name);
    return fmt::format("  {} dx {:+.3f}, dy {:+.3f} mm", name, move.displacement.x, move.displacement.y);
  }

  const Measurement& m_;
  std::vector<std::size_t> targets_;
  SideBySide picture_;
  Samples apparent_samples_;
  BySample measured_, apparent_;
  std::map<long, std::size_t> place_;  // index of a frame among the observations
};

// Returns the time stamp of a frame. Images without times get the usual rate; times must rise.
double stamp_of(const Frame& shot, long count, const InputInfo& info, double last) {
  const double fps = info.fps > 0.0 ? info.fps : kUsualFps;
  const double wanted = std::isfinite(shot.time_s) ? shot.time_s : static_cast<double>(count) / fps;
  return std::max(wanted, last + 0.1 / fps);
}

// Returns whether all frames were drawn: not, if the callback stopped it.
tl::expected<bool, std::string> write_film(FrameSource& source, const Film& film, const FrameRange& frames,
                                           VideoWriter& writer, const RunCallbacks& callbacks) {
  const InputInfo info = source.info();
  FrameSelector selector(frames);
  long count = 0;
  double last = -1e9;
  while (true) {
    const auto shot = source.next();
    if (!shot || !*shot) break;  // `measure` has reported an input that ends early
    if (!selector.holds((*shot)->number, (*shot)->time_s)) continue;
    last = stamp_of(**shot, count, info, last);
    const auto page = film.frame(**shot, info.bits);
    if (auto added = writer.add(page.view(), last); !added) return tl::unexpected(added.error());
    if (!callbacks.may_continue({Stage::kDrawingVideo, ++count, info.frames, std::nullopt})) return false;
  }
  if (auto finished = writer.finish(); !finished) return tl::unexpected(finished.error());
  return true;
}

VideoFormat format_of(const Film& film, double fps) {
  VideoFormat format{VideoCodec::kX264, kRateFactor};
  format.width = film.picture().width();
  format.height = film.picture().height();
  format.fps = fps > 0.0 ? fps : kUsualFps;
  format.faststart = true;
  return format;
}

}  // namespace

PutMore put_video(std::optional<double> exaggeration, const OpenInput& open, const MeasureOptions& options,
                  const RunCallbacks& callbacks) {
  return [exaggeration, &open, &options, &callbacks](const fs::path& folder, const Measurement& m) -> Written {
    if (!m.reference || m.interrupted || targets_of(*m.reference).empty()) return {};
    const Travel travel = travel_of(m);
    const Film film(m, options,
                    exaggeration.value_or(best_exaggeration(travel.longest_mm, travel.u_mm, travel.size_mm)));
    const auto source = open();
    if (!source) {  // the results are kept
      callbacks.note("note: stabilised.mp4 was not made: " + source.error().message);
      return {};
    }
    const std::string path = (folder / "stabilised.mp4").string();
    auto writer = VideoWriter::create(path, format_of(film, (*source)->info().fps));
    if (!writer) return tl::unexpected(writer.error());
    const auto is_whole = write_film(**source, film, options.frames, **writer, callbacks);
    if (!is_whole) return tl::unexpected(is_whole.error());
    if (!*is_whole) {
      std::error_code ignored;
      fs::remove(path, ignored);
      callbacks.note("note: stabilised.mp4 was not made, because drawing was stopped. Measure again with --video");
      return {};
    }
    return sync_file(path) ? Written{} : tl::unexpected(path + " (it could not be saved to the disk)");
  };
}

}  // namespace moiregauge::internal
