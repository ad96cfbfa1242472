// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/open_live.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/open_input.h"
#include "moiregauge/live/paced_source.h"

namespace moiregauge::internal {
namespace {

using Failed = tl::unexpected<RunFailure>;

// A camera of a resumed run: numbers and times continue.
class ContinuedSource final : public LiveSource {
 public:
  ContinuedSource(std::unique_ptr<LiveSource> source, const PassedFrames& passed)
      : source_(std::move(source)), passed_(passed) {}
  [[nodiscard]] const InputInfo& info() const override { return source_->info(); }
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds timeout) override {
    auto frame = source_->next(timeout);
    if (frame && *frame) {
      (*frame)->frame.number += passed_.last + 1;
      (*frame)->frame.time_s += passed_.time_s;
    }
    return frame;
  }
  [[nodiscard]] LostFrames lost() const override { return source_->lost(); }
  [[nodiscard]] bool is_frame_whole() const override { return source_->is_frame_whole(); }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const override {
    return source_->settings();
  }

 private:
  std::unique_ptr<LiveSource> source_;
  PassedFrames passed_;
};

}  // namespace

tl::expected<OpenedSource, RunFailure> open_recording(const std::string& source, const InputOptions& options,
                                                      std::optional<double> pace) {
  if (!pace)
    return Failed(RunFailure{
        Exit::kUsage,
        fmt::format("the source is not a camera: {}: give --pace 1 to replay a recording, or --pace max", source)});
  auto opened = open_input(source, options);
  if (!opened) return Failed(RunFailure{Exit::kInputUnreadable, opened.error().message});
  if (*pace > 0.0 && std::isnan((*opened)->info().fps))
    return Failed(RunFailure{Exit::kUsage,
                             fmt::format("the frames of the recording have no times: --pace {}: give --fps", *pace)});
  return OpenedSource{*std::move(opened), nullptr};
}

tl::expected<OpenedSource, RunFailure> open_live_camera(const CameraArgs& args, std::optional<double> pace) {
  if (pace)
    return Failed(
        RunFailure{Exit::kUsage, fmt::format("--pace applies to recordings only: {}: remove --pace", args.source)});
  auto opened = open_camera(args);
  if (!opened) return Failed(RunFailure{Exit::kInputUnreadable, opened.error().message});
  return OpenedSource{nullptr, *std::move(opened)};
}

std::unique_ptr<LiveSource> started(OpenedSource opened, double pace, const PassedFrames& passed) {
  if (opened.recording && pace > 0.0)
    return std::make_unique<PacedSource>(std::move(opened.recording), pace, passed.last);
  if (opened.recording) return std::make_unique<UnpacedSource>(std::move(opened.recording));
  if (passed.last < 0) return std::move(opened.camera);
  return std::make_unique<ContinuedSource>(std::move(opened.camera), passed);
}

}  // namespace moiregauge::internal
