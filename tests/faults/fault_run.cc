// SPDX-License-Identifier: Apache-2.0
#include "faults/fault_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/decoder/video_source.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/run/measure.h"
#include "moiregauge/simulator/recorder.h"

namespace moiregauge::internal::faults {
namespace {

using simulator::Scenario;

constexpr simulator::RenderOptions kMarkers{.threads = 1, .area = simulator::Area::kMarkersOnly};

// Frames as the sensor stores them, without a file.
class SimulatedSource : public FrameSource {
 public:
  explicit SimulatedSource(const Scenario& scenario) : scenario_(scenario), recorder_(scenario, kMarkers) {
    info_.path = scenario.name;
    info_.frames = scenario.frames;
    info_.width = scenario.camera.width;
    info_.height = scenario.camera.height;
    info_.bits = scenario.sensor.bits;
    info_.fps = scenario.sensor.fps;
    info_.codec = "simulated";
    info_.time_source = "stream";
    // As an 8-bit image: with a tag if it stores light, otherwise without one.
    info_.tone = simulator::stores_light(scenario) ? Tone{{}, ToneSource::kTag}
                                                   : Tone{{.kind = ToneCurve::Kind::kSrgb}, ToneSource::kAssumed};
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (next_ >= scenario_.frames) return std::nullopt;
    picture_ = recorder_.frame(next_);
    const double time = simulator::stamp_of(scenario_, next_) - simulator::stamp_of(scenario_, 0);
    return Frame{next_++, time, false, simulator::view_of(picture_)};
  }

 private:
  const Scenario& scenario_;
  simulator::Recorder recorder_;
  InputInfo info_;
  long next_ = 0;
  simulator::Picture picture_;
};

// A recording in a file, which is deleted with the object.
class Recording {
 public:
  Recording(const Sequence& sequence, const std::string& folder) {
    static std::atomic<int> count{0};
    path_ = fmt::format("{}/{}-{}", folder, count++, file_name_for(sequence.video->codec));
    VideoFormat format = *sequence.video;
    format.is_linear = simulator::stores_light(sequence.scenario);
    auto writer = VideoWriter::create(path_, format);
    simulator::Recorder recorder(sequence.scenario, kMarkers);
    for (long frame = 0; writer && frame < sequence.scenario.frames; ++frame) {
      const auto picture = recorder.frame(frame);
      if (auto added = (*writer)->add(simulator::view_of(picture), simulator::stamp_of(sequence.scenario, frame));
          !added)
        problem_ = added.error();
    }
    if (!writer) problem_ = writer.error();
    if (problem_.empty()) {
      if (auto finished = (*writer)->finish(); !finished) problem_ = finished.error();
    }
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  ~Recording() { std::remove(path_.c_str()); }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string path_, problem_;
};

struct Axis {
  double error_um, u_um;
  [[nodiscard]] bool is_lie() const { return std::abs(error_um) > std::max(5.0 * u_um, 0.5); }
  [[nodiscard]] double in_u() const { return u_um > 0.0 ? std::abs(error_um) / u_um : 0.0; }
};

void judge(const Scenario& scenario, const Measurement& seen, Verdict& verdict) {
  const long reference_frame = seen.reference->seen.frame;
  std::vector<double> u;
  for (const Sample& sample : seen.samples) {
    const Marker& listed = seen.reference->site.markers[sample.marker];
    if (listed.role != Role::kTarget || sample.frame == reference_frame) continue;
    ++verdict.rows;
    const bool is_refused = seen.exit == Exit::kRefused;
    if (is_refused || sample.status != Status::kOk) {
      ++verdict.statuses[is_refused ? "refused" : word_for(sample.status)];
      continue;
    }
    ++verdict.ok;
    const auto* marker = simulator::find_marker(scenario, listed.name);
    const auto now = truth(scenario, sample.frame, *marker), then = truth(scenario, reference_frame, *marker);
    bool is_lie = false;
    for (const Axis& axis : {Axis{1000.0 * (sample.displacement.x - (now.dx_mm - then.dx_mm)), 1000.0 * sample.u.x},
                             Axis{1000.0 * (sample.displacement.y - (now.dy_mm - then.dy_mm)), 1000.0 * sample.u.y}}) {
      if (std::isnan(axis.error_um)) continue;  // an axis that the grating does not show
      is_lie |= axis.is_lie();
      verdict.worst_u = std::max(verdict.worst_u, axis.in_u());
      verdict.worst_um = std::max(verdict.worst_um, std::abs(axis.error_um));
    }
    verdict.lies += is_lie;
    u.push_back(1000.0 * sample.u.y);
  }
  if (u.empty()) return;
  std::nth_element(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(u.size() / 2), u.end());
  verdict.median_u_um = u[u.size() / 2];
}

Verdict nothing_measured(const Scenario& scenario, std::string why) {
  Verdict verdict;
  verdict.rows = static_cast<int>(scenario.frames - 1);
  verdict.statuses["refused"] = verdict.rows;
  verdict.refusal = std::move(why);
  return verdict;
}

Verdict measured(const Scenario& scenario, const OpenInput& open) {
  MeasureOptions options;
  options.method = method_named("precise");
  options.site = simulator::site_of(scenario);
  const auto seen = measure(open, options, {});
  if (!seen) return nothing_measured(scenario, seen.error().message);
  if (!seen->reference) return nothing_measured(scenario, seen->refusal);
  Verdict verdict;
  verdict.warnings = seen->warnings;
  judge(scenario, *seen, verdict);
  return verdict;
}

}  // namespace

Verdict verdict_on(const Sequence& sequence, const std::string& folder) {
  const Scenario& scenario = sequence.scenario;
  if (!sequence.video) {
    return measured(scenario, [&]() -> tl::expected<std::unique_ptr<FrameSource>, InputError> {
      return std::make_unique<SimulatedSource>(scenario);
    });
  }
  const Recording recording(sequence, folder);
  if (!recording.problem().empty()) return nothing_measured(scenario, recording.problem());
  return measured(scenario, [&] { return open_video(recording.path(), {}); });
}

}  // namespace moiregauge::internal::faults
