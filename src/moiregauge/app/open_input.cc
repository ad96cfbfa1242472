// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/open_input.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "moiregauge/decoder/video_source.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_source.h"

namespace moiregauge::internal {
namespace {

// Frames of a slow-motion file, with the times of the scene.
class SlowMotionSource final : public FrameSource {
 public:
  SlowMotionSource(std::unique_ptr<FrameSource> source, double factor) : source_(std::move(source)), factor_(factor) {
    update();
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] bool is_frame_whole() const override { return source_->is_frame_whole(); }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    auto frame = source_->next();
    update();
    if (frame && *frame) (*frame)->time_s /= factor_;
    return frame;
  }

 private:
  void update() {
    info_ = source_->info();
    info_.fps *= factor_;
    info_.slow_motion = factor_;
  }
  std::unique_ptr<FrameSource> source_;
  double factor_;
  InputInfo info_;
};

}  // namespace

tl::expected<std::unique_ptr<FrameSource>, InputError> open_input(const std::string& path,
                                                                  const InputOptions& options) {
  return open_input_from(0, path, options);
}

tl::expected<std::unique_ptr<FrameSource>, InputError> open_input_from(long first_frame, const std::string& path,
                                                                       const InputOptions& options) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(path, ignored);
  const bool is_video = !options.sequence && is_file && picture_kind(path) == PictureKind::kNone;
  auto source = is_video ? open_video(path, options, {.first_frame = first_frame}) : open_pictures(path, options);
  if (!source || !options.slow_motion) return source;
  return std::make_unique<SlowMotionSource>(*std::move(source), *options.slow_motion);
}

}  // namespace moiregauge::internal
