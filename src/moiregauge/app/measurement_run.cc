// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/measurement_run.h"

#include <algorithm>
#include <future>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/fingerprint.h"
#include "moiregauge/app/frame_times.h"
#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/open_input.h"
#include "moiregauge/app/provisional_samples.h"
#include "moiregauge/app/run_figures.h"
#include "moiregauge/app/stabilised_video.h"
#include "moiregauge/base/file_hash.h"
#include "moiregauge/drawing/overlays/overlay.h"
#include "moiregauge/drawing/overlays/overlay_inspection.h"
#include "moiregauge/io/pictures/picture_source.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/io/run_dir/stabilised_folder.h"
#include "moiregauge/report/report_page.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using Failed = tl::unexpected<RunFailure>;

Failed usage_failure(std::string message) { return Failed(RunFailure{Exit::kUsage, std::move(message)}); }

std::vector<std::uint8_t> overlay_of(const ImageView<std::uint8_t>& picture, const Reference& reference) {
  return draw_overlay({picture, &reference,
                       fmt::format("reference frame {}; blue: references, fixed; orange: targets, may move; "
                                   "inner frames: where the phase is averaged",
                                   reference.seen.frame)});
}

// For a refused run, draws everything that was detected, as `inspect` does, so that the user sees what is missing.
std::vector<std::uint8_t> overlay_of_refusal(const Measurement& m, const MeasureOptions& options) {
  const ImageView<std::uint8_t> picture = m.picture.grey.view();
  if (picture.width == 0) return {};
  InspectOptions looked_at;
  if (options.pitch_mm)
    looked_at.pitch_mm = options.pitch_mm;
  else
    looked_at.site = options.site;
  looked_at.axes = options.axes;
  looked_at.lens = options.camera.value_or(Camera{});
  looked_at.observe = options.observe;
  Inspection seen = inspect_picture({picture, 8}, looked_at);
  seen.missing = m.refusal;
  return draw_inspection({picture, seen, {}, "not measured: " + m.input.path});
}

using Overlay = std::future<std::vector<std::uint8_t>>;

// Draws and compresses overlay.png while the scene is solved, because neither needs the other. With --threads 1, and for
// a refused run, it is drawn at the end.
Overlay overlay_in_background(const Measurement& seen, const MeasureOptions& options, int threads) {
  const auto draw = [&] { return run_overlay(seen, options); };
  if (seen.reference && threads != 1) {
    try {
      return std::async(std::launch::async, draw);
    } catch (const std::system_error&) {  // no thread can start: it is drawn at the end
    }
  }
  return std::async(std::launch::deferred, draw);
}

// The two folders are each published as a whole: neither may contain the other.
std::optional<std::string> stabilised_problem(const RunRequest& request) {
  if (request.stabilised.empty() || !overlaps(request.stabilised, request.output)) return std::nullopt;
  return fmt::format("the folder overlaps the results: --stabilised {} and {}: choose a folder outside the results",
                     request.stabilised, request.output);
}

// A statement that the frames contradict gives no results. The frames are kept: `solve` and --resume use them.
RunFailure kept_without_results(const Measurement& measured, MeasureOptions options, UnfinishedRun& journal,
                                const RunPlace& place) {
  if (measured.observations.empty() || !measured.reference) return {Exit::kUsage, measured.contradiction};
  options.solve.rest.reset();
  options.zero.reset();
  if (const auto ended = journal.end(measured, options); !ended) return failure_of(ended.error());
  return {Exit::kUsage,
          fmt::format("{}: give other frames or remove the option (all {} frames are kept: `moiregauge solve "
                      "{}.unfinished -o {}` needs no video)",
                      measured.contradiction, measured.observations.size(), place.shown, place.shown)};
}

// Runs the steps of one measurement in order.
class MeasurementRun {
 public:
  MeasurementRun(const RunRequest& request, const RunCallbacks& callbacks)
      : request_(request),
        options_(request.options),
        callbacks_(callbacks),
        place_(place_of_run(request.output)),
        directory_(
            place_, [this](const Measurement&) { return overlay_.get(); }, report_page),
        journal_(place_) {}

  tl::expected<FinishedRun, RunFailure> run() {
    if (const auto opened = open(); !opened) return Failed(opened.error());
    // A folder in use is noticed before, not after, hours of measuring.
    if (const auto prepared = prepare(); !prepared) return Failed(prepared.error());
    if (const auto observed = observe_and_solve(); !observed) return Failed(observed.error());
    measured_->input.sha256 = fingerprint_->hex();
    if (!measured_->contradiction.empty()) return Failed(kept_without_results(*measured_, options_, journal_, place_));
    return write();
  }

 private:
  using Step = tl::expected<void, RunFailure>;

  Step open() {
    if (const auto problem = stabilised_problem(request_)) return usage_failure(*problem);
    opened_ = open_input(request_.input, request_.input_options);
    if (!opened_) return Failed(RunFailure{Exit::kInputUnreadable, opened_.error().message});
    const InputInfo& input = (*opened_)->info();
    if (const auto problem = camera_problem(options_.camera.value_or(Camera{}), input)) return usage_failure(*problem);
    if (const auto problem = readout_problem(options_, input)) return usage_failure(*problem);
    return {};
  }

  Step prepare() {
    fingerprint_.emplace(request_.input, request_.input_options);
    directory_.also(put_figures(request_.figures, callbacks_));
    if (const auto free = directory_.check([this] { return fingerprint_->hex(); }); !free)
      return usage_failure(free.error().message);
    if (!request_.stabilised.empty()) {
      stabilised_.emplace(request_.stabilised);
      if (const auto begun = stabilised_->open(); !begun) return Failed(failure_of(begun.error()));
    }
    auto so_far = journal_.begin(start(), options_, request_.earlier);
    if (!so_far) return Failed(failure_of(so_far.error()));
    so_far_ = *std::move(so_far);
    if (request_.video) directory_.also(put_video(request_.video_exaggeration, open_again_, options_, callbacks_));
    return {};
  }

  [[nodiscard]] RunStart start() const {
    const auto files = files_of_input(request_.input, request_.input_options);
    return {kVersion, files ? quick_fingerprint(*files) : std::string{}, request_.input_options.fps,
            request_.input_options.sequence, (*opened_)->info()};
  }

  Step observe_and_solve() {
    FrameTimes times;
    // The source that was opened to check the input is measured; --reference-frame needs the input a second time.
    const auto source = [&]() -> tl::expected<std::unique_ptr<FrameSource>, InputError> {
      auto next = opened_ && *opened_ ? std::move(opened_) : open_input(request_.input, request_.input_options);
      if (!next) return next;
      return timed(std::move(*next), times);
    };
    std::optional<ProvisionalSamples> provisional;
    FrameSink* sink = stabilised_ ? &*stabilised_ : nullptr;
    if (callbacks_.on_samples) sink = &provisional.emplace(sink, options_, callbacks_.on_samples);
    measured_ =
        observe_all(source, options_,
                    [&](long done, long expected) {
                      return callbacks_.may_continue({Stage::kMeasuring, done, expected, times.waiting_share()});
                    },
                    {sink, &journal_, std::move(so_far_)});
    provisional.reset();
    if (const auto closed = journal_.close(); !closed) return Failed(failure_of(closed.error()));
    if (!measured_) return Failed(RunFailure{Exit::kInputUnreadable, measured_.error().message});
    const long frames = static_cast<long>(measured_->observations.size());
    (void)callbacks_.may_continue({Stage::kSolving, frames, frames, std::nullopt});
    overlay_ = overlay_in_background(*measured_, options_, request_.input_options.threads);
    evaluate(options_, *measured_);
    return {};
  }

  tl::expected<FinishedRun, RunFailure> write() {
    // The stabilised markers of a stopped run are written when it is resumed: then they are complete.
    std::optional<RunFailure> trouble;
    if (stabilised_ && !measured_->interrupted) {
      if (const auto finished = stabilised_->finish(); !finished) trouble = failure_of(finished.error());
    }
    if (trouble) measured_->exit = Exit::kOutputUnwritable;  // the results are kept
    const auto written =
        journal_.end(*measured_, options_).and_then([this] { return directory_.write(*measured_, options_); });
    if (!written) return Failed(failure_of(written.error()));
    return FinishedRun{*std::move(measured_), directory_.results(), std::move(trouble)};
  }

  const RunRequest& request_;
  const MeasureOptions& options_;
  const RunCallbacks& callbacks_;
  const OpenInput open_again_ = [this] { return open_input(request_.input, request_.input_options); };
  tl::expected<std::unique_ptr<FrameSource>, InputError> opened_;
  std::optional<Fingerprint> fingerprint_;
  tl::expected<Measurement, InputError> measured_;
  Overlay overlay_;  // refers to `measured_`, so it must not outlive it
  RunPlace place_;
  RunDirectory directory_;
  std::optional<StabilisedFolder> stabilised_;
  UnfinishedRun journal_;
  ObservationLog so_far_;
};

}  // namespace

std::optional<std::string> readout_problem(const MeasureOptions& options, const InputInfo& input) {
  constexpr double kRounding = 1.01;
  if (!options.solve.readout_s || !(input.fps > 0.0) || *options.solve.readout_s * input.fps <= kRounding)
    return std::nullopt;
  return fmt::format(
      "the readout time is longer than a frame: --readout {:.4g}ms of {:.4g} ms: give a shorter time, or the right "
      "--fps",
      1e3 * *options.solve.readout_s, 1e3 / input.fps);
}

std::vector<std::uint8_t> run_overlay(const Measurement& seen, const MeasureOptions& options) {
  return seen.reference ? overlay_of(seen.picture.grey.view(), *seen.reference) : overlay_of_refusal(seen, options);
}

RunFailure failure_of(const OutputError& error) {
  return {error.usage ? Exit::kUsage : Exit::kOutputUnwritable, error.message};
}

tl::expected<FinishedRun, RunFailure> run_measurement(const RunRequest& request, const RunCallbacks& callbacks) {
  return MeasurementRun(request, callbacks).run();
}

}  // namespace moiregauge::internal
