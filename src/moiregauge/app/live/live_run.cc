// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/live_run.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/fingerprint.h"
#include "moiregauge/app/live/live_json.h"
#include "moiregauge/app/live/open_live.h"
#include "moiregauge/app/live/utc_time.h"
#include "moiregauge/app/measure_options.h"
#include "moiregauge/base/file_hash.h"
#include "moiregauge/io/pictures/picture_source.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/live/clocks.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Failed = tl::unexpected<RunFailure>;
using Step = tl::expected<void, RunFailure>;

// Age of key frames at which the scene forgets them. A lens needs about an hour to follow the temperature (chosen).
constexpr double kSceneMemory_s = 3600.0;

Failed unusable_request(std::string message) { return Failed(RunFailure{Exit::kUsage, std::move(message)}); }

// Returns the exit code of a run whose segments were solved one by one.
Exit exit_of_rows(const LiveStored& stored) {
  if (stored.ok_rows == 0) return Exit::kRefused;
  const auto bad = static_cast<double>(stored.rows - stored.ok_rows);
  return bad > kNotOkShare * static_cast<double>(stored.rows) ? Exit::kIncomplete : Exit::kMeasured;
}

class LiveMeasurement {
 public:
  LiveMeasurement(const LiveRequest& request, const LiveCallbacks& callbacks)
      : request_(request), callbacks_(callbacks), begin_utc_ns_(utc_ns()) {}

  tl::expected<FinishedLive, RunFailure> run() {
    if (const auto opened = open(); !opened) return Failed(opened.error());
    if (const auto stored = open_store(); !stored) return Failed(stored.error());
    end_ = run_live_loop(*source_, *tracker_, hooks());
    if (callbacks_.on_solving) callbacks_.on_solving();
    for (Publisher* publisher : request_.publishers) publisher->finish(kPublishersEnd_s);
    return finished();
  }

 private:
  static constexpr double kPublishersEnd_s = 5.0;  // time for the last rows (chosen)

  Step open() {
    auto opened = is_camera_source(request_.source)
                      ? open_live_camera(camera_args(), request_.pace)
                      : open_recording(request_.source, request_.input_options, request_.pace);
    if (!opened) return Failed(opened.error());
    opened_ = *std::move(opened);
    input_ = opened_.info();
    if (opened_.camera && input_.start_utc.empty()) input_.start_utc = text_of_utc(begin_utc_ns_);
    const InputInfo& input = input_;
    if (const auto problem = camera_problem(request_.options.camera.value_or(Camera{}), input))
      return unusable_request(*problem);
    if (const auto problem = readout_problem(request_.options, input)) return unusable_request(*problem);
    return {};
  }

  [[nodiscard]] CameraArgs camera_args() const {
    CameraArgs args = request_.camera;
    args.source = request_.source;
    args.fps = request_.input_options.fps;
    args.max_pixels = request_.input_options.max_pixels;
    return args;
  }

  [[nodiscard]] RunStart start() const {
    std::string fingerprint = "live " + input_.path;  // without passwords
    if (opened_.recording) {
      const auto files = files_of_input(request_.source, request_.input_options);
      fingerprint = files ? quick_fingerprint(*files) : std::string{};
    }
    return {kVersion, fingerprint, request_.input_options.fps, request_.input_options.sequence, input_};
  }

  // A run of a camera never replaces an earlier one. A run of a recording replaces one of the same recording.
  Step check_folder() {
    if (request_.store.has_segments()) return {};
    const RunPlace place = place_of_run(request_.store.folder);
    std::error_code error;
    if (!opened_.recording && fs::exists(place.results / "run.json", error))
      return unusable_request(
          fmt::format("the output folder holds a finished run: {}: choose another with -o", place.shown));
    if (opened_.recording) fingerprint_.emplace(request_.source, request_.input_options);
    const RunDirectory directory(place, {}, {});
    const auto free = directory.check([this] { return fingerprint_ ? fingerprint_->hex() : std::string{}; });
    if (!free) return unusable_request(free.error().message);
    return {};
  }

  Step open_store() {
    if (auto checked = check_folder(); !checked) return checked;
    LiveStoreOptions options = request_.store;
    options.may_wait = request_.pace == 0.0;
    store_.emplace(std::move(options), start(), request_.options, [this] { return segment_end("running"); });
    auto so_far = store_->open();
    if (!so_far) return Failed(so_far.error());
    const PassedFrames passed = passed_in(*so_far);
    const bool is_replayed = opened_.recording && !request_.store.has_segments();
    if (passed.last >= 0) {
      resumed_at_ = passed.last + 1;
      input_.start_utc = so_far->input.start_utc;
    }
    RunHooks hooks{request_.recorder, &*store_, *std::move(so_far)};
    tracker_.emplace(request_.options, input_, std::move(hooks), KeyFrameLimits{.max_age_s = kSceneMemory_s});
    if (!is_replayed) tracker_->pass_over_kept();
    source_ = started(std::move(opened_), request_.pace.value_or(0.0), passed);
    return {};
  }

  // A camera's time continues by the host's clock.
  [[nodiscard]] PassedFrames passed_in(const ObservationLog& so_far) const {
    if (!so_far.reference || so_far.observations.empty()) return {};
    constexpr double kNsPerS = 1e9;
    const Observation last = so_far.observations.back();
    const auto start_ns = utc_of_text(so_far.input.start_utc);
    const double now_s = start_ns ? static_cast<double>(begin_utc_ns_ - *start_ns) / kNsPerS : last.time_s;
    return {last.frame, std::max(last.time_s, now_s)};
  }

  LiveLoopHooks hooks() {
    LiveLoopHooks hooks;
    hooks.publishers.push_back(&*store_);
    hooks.publishers.insert(hooks.publishers.end(), request_.publishers.begin(), request_.publishers.end());
    hooks.should_stop = callbacks_.should_stop;
    hooks.before_frame = [this](const LiveFrame& frame) { store_->begin_frame(frame.frame.time_s); };
    hooks.on_reference = [this] { store_->show_reference(tracker_->log()); };
    hooks.max_s = request_.max_s;
    return hooks;
  }

  [[nodiscard]] LiveFacts facts(const std::string& end) const {
    LiveFacts facts;
    facts.source = input_.path;
    facts.end = end;
    facts.begin_utc = text_of_utc(begin_utc_ns_);
    facts.resumed_at = resumed_at_;
    if (source_) facts.settings = source_->settings();
    if (tracker_) facts.health = tracker_->health();
    std::vector<const Publisher*> publishers{&*store_};
    publishers.insert(publishers.end(), request_.publishers.begin(), request_.publishers.end());
    for (const Publisher* publisher : publishers) {
      const auto [name, state] = publisher->state();
      if (!name.empty() && !state.empty()) facts.outlets.push_back({name, state, publisher->lost_rows()});
    }
    return facts;
  }

  [[nodiscard]] SegmentEnd segment_end(const std::string& why) const {
    SegmentEnd end;
    end.live_json = live_json(facts(why));
    if (!tracker_) return end;
    const Measurement& log = tracker_->log();
    end.log.input = input_of_end();
    end.log.input_damaged = log.input_damaged;
    end.log.processing = tracker_->processing();
    end.refusal = log.refusal;
    end.contradiction = log.contradiction;
    return end;
  }

  // The number of a recording's frames may be known only at its end.
  [[nodiscard]] InputInfo input_of_end() const {
    InputInfo input = source_->info();
    input.start_utc = input_.start_utc;
    return input;
  }

  [[nodiscard]] std::string end_text() const {
    switch (end_.why) {
      case LiveStop::kLost:
        return "source lost";
      case LiveStop::kFinished:
        return "finished";
      default:
        return "stopped";
    }
  }

  tl::expected<FinishedLive, RunFailure> finished() {
    if (end_.why == LiveStop::kNoFrames)
      return Failed(RunFailure{Exit::kInputUnreadable,
                               end_.message.empty()
                                   ? "the source has no frames: " + request_.source + ": give a recording with frames"
                                   : end_.message});
    SegmentEnd last = segment_end(end_text());
    if (end_.why == LiveStop::kFinished && !end_.message.empty()) note_damage(last.log, end_.message);
    if (fingerprint_) last.log.input.sha256 = fingerprint_->hex();
    last.overlay = [this](const Measurement&) { return run_overlay(tracker_->log(), request_.options); };
    FinishedLive done;
    done.stored = store_->finish_all(std::move(last));
    done.end = end_;
    done.health = tracker_->health();
    if (tracker_->log().reference) done.run = tracker_->description();
    if (done.stored.trouble && (!done.stored.run || request_.store.has_segments())) return Failed(*done.stored.trouble);
    done.exit = done.stored.run ? done.stored.run->measurement.exit : exit_of_rows(done.stored);
    if (end_.why == LiveStop::kLost) done.exit = Exit::kSourceLost;
    return done;
  }

  const LiveRequest& request_;
  const LiveCallbacks& callbacks_;
  const std::int64_t begin_utc_ns_;
  OpenedSource opened_;
  InputInfo input_;
  long resumed_at_ = -1;
  std::optional<Fingerprint> fingerprint_;
  std::optional<LiveStore> store_;
  std::unique_ptr<LiveSource> source_;
  std::optional<LiveTracker> tracker_;  // journals to `store_`
  LiveEnd end_;
};

}  // namespace

tl::expected<FinishedLive, RunFailure> run_live(const LiveRequest& request, const LiveCallbacks& callbacks) {
  return LiveMeasurement(request, callbacks).run();
}

}  // namespace moiregauge::internal
