// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stored/stored_source.h"

#include <bit>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are read as little-endian words");

class StoredSource final : public FrameSource {
 public:
  StoredSource(MappedVideo video, InputInfo info, std::optional<double> fps)
      : mapped_(std::move(video)), info_(std::move(info)), fps_(fps) {}

  [[nodiscard]] const InputInfo& info() const override { return info_; }

  [[nodiscard]] bool is_frame_whole() const override { return mapped_.file->is_whole(); }

  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    const auto at = static_cast<std::size_t>(number_);
    if (!mapped_.file->is_whole()) {
      return tl::unexpected(InputError{
          InputErrorKind::kDamaged,
          fmt::format("the file became shorter during the measurement: {} at frame {}: measure it when it is complete",
                      info_.path, number_)});
    }
    if (at > 0) mapped_.let_go(at - 1);
    if (at >= mapped_.video.frames.size()) return std::optional<Frame>();
    const double time_s = fps_ ? static_cast<double>(number_) / *fps_ : seconds(at) - seconds(0);
    return Frame{number_++, time_s, false, mapped_.luma(at)};
  }

 private:
  [[nodiscard]] double seconds(std::size_t frame) const {
    const StoredVideo& video = mapped_.video;
    return static_cast<double>(video.ticks[frame]) * static_cast<double>(video.tick_numerator) /
           static_cast<double>(video.tick_denominator);
  }

  MappedVideo mapped_;
  InputInfo info_;
  std::optional<double> fps_;
  long number_ = 0;
};

}  // namespace

LumaView MappedVideo::luma(std::size_t frame) const {
  const std::byte* pixels = file->bytes().data() + video.frames[frame];
  const auto row_bytes = static_cast<std::ptrdiff_t>(video.row_bytes);
  if (video.bits == 8)
    return ImageView<std::uint8_t>{reinterpret_cast<const std::uint8_t*>(pixels), video.width, video.height, row_bytes};
  return ImageView<std::uint16_t>{reinterpret_cast<const std::uint16_t*>(pixels), video.width, video.height,
                                  row_bytes / 2};
}

void MappedVideo::let_go(std::size_t frame) const {
  file->let_go(file->bytes().subspan(video.frames[frame], video.row_bytes * static_cast<std::size_t>(video.height)));
}

std::optional<MappedVideo> map_video(const std::string& path) {
  auto file = MappedFile::open(path);
  if (!file) return std::nullopt;
  auto video = stored_video(file->bytes());
  if (!video || !file->is_whole()) return std::nullopt;
  file->let_go(file->bytes());  // releases the headers of all frames
  return MappedVideo{std::move(file), std::move(*video)};
}

std::unique_ptr<FrameSource> stored_source(MappedVideo video, InputInfo info, const InputOptions& options) {
  info.frames = static_cast<long>(video.video.frames.size());
  return std::make_unique<StoredSource>(std::move(video), std::move(info), options.fps);
}

}  // namespace moiregauge::internal
