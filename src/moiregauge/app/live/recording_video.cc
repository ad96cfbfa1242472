// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/recording_video.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/encoder/video_writer.h"

namespace moiregauge::internal {
namespace {

using Made = tl::expected<std::unique_ptr<RecordingWriter>, std::string>;

class VideoRecording final : public RecordingWriter {
 public:
  explicit VideoRecording(std::unique_ptr<VideoWriter> video) : video_(std::move(video)) {}
  [[nodiscard]] tl::expected<void, std::string> add(const LumaView& luma, double time_s) override {
    if (!begin_s_) begin_s_ = time_s;
    return video_->add(luma, time_s - *begin_s_);
  }
  [[nodiscard]] tl::expected<void, std::string> finish() override { return video_->finish(); }

 private:
  std::unique_ptr<VideoWriter> video_;
  std::optional<double> begin_s_;
};

Made make(const std::string& folder, const RecordingFormat& format) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return tl::unexpected(fmt::format("{}: {}", folder, error.message()));
  VideoFormat video;
  video.codec = VideoCodec::kFfv1;
  video.width = format.width;
  video.height = format.height;
  video.bits = format.bits;
  if (const auto problem = problem_with(video)) return tl::unexpected(fmt::format("{}: {}", folder, *problem));
  auto writer = VideoWriter::create(fmt::format("{}/{}.mkv", folder, format.name), video);
  if (!writer) return tl::unexpected(writer.error());
  return std::make_unique<VideoRecording>(std::move(*writer));
}

}  // namespace

MakeRecordingWriter recording_videos(std::string folder) {
  return [folder = std::move(folder)](const RecordingFormat& format) { return make(folder, format); };
}

}  // namespace moiregauge::internal
