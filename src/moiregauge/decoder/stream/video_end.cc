// SPDX-License-Identifier: Apache-2.0
// Decides whether the video is complete at the end of the file.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/decoder/headers/stated_size.h"
#include "moiregauge/decoder/stream/video_stream.h"

namespace moiregauge::internal {
namespace {

bool is_kind(const AVFormatContext& container, std::string_view name) {
  return std::string_view(container.iformat->name).find(name) != std::string_view::npos;
}

// Returns the length of the video as stated by its container. Returns NaN if libav estimated it from the end of the
// file.
double stated_s(const AVFormatContext& container, const AVStream& stream) {
  if (container.duration_estimation_method == AVFMT_DURATION_FROM_STREAM) {
    if (stream.duration > 0) return static_cast<double>(stream.duration) * av_q2d(stream.time_base);
    if (container.duration > 0) return static_cast<double>(container.duration) / AV_TIME_BASE;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Returns the stated length from the first image on. Matroska writers count it from 0 or from the first image. It is
// counted from 0 if the video starts later and its end is within the stated length.
double stated_from_begin_s(const AVFormatContext& container, const AVStream& stream, double began_s, double end_s) {
  const double stated = stated_s(container, stream);
  constexpr double kMatroskaRounding = 2e-3;  // s: time stamps in Matroska are rounded to 1 ms
  const bool counts_from_zero = is_kind(container, "matroska") && began_s > 0.0 && stated >= began_s &&
                                began_s + end_s <= stated + kMatroskaRounding;
  return counts_from_zero ? stated - began_s : stated;
}

}  // namespace

bool VideoStream::is_cut() const {
  const auto stated = stated_size(reader_of(file_), static_cast<std::uint64_t>(file_bytes_));
  return stated && *stated > static_cast<std::uint64_t>(file_bytes_);
}

// A video is complete if it has all frames that its container counts, or all of the stated time if it counts none.
// Missing data after that (an index) is no loss.
// The stated time is that of the longest stream. If there is sound and no other sign of damage, a shorter video proves
// nothing.
std::optional<VideoProblem> VideoStream::end_problem(long shown) const {
  if (tear_)
    return VideoProblem{tear_->kind, fmt::format("the input ends at frame {} ({})", shown, tear_->what), tear_->advice};
  const double rate = fps();
  const double frame_s = rate > 0.0 ? 1.0 / rate : 0.0;
  constexpr double kRounding = 2e-3;  // s: time stamps in Matroska are rounded to 1 ms
  const double end_s = reached_ ? static_cast<double>(*reached_ - *began_) * av_q2d(stream_->time_base) : 0.0;
  const double began_s = reached_ ? static_cast<double>(*began_) * av_q2d(stream_->time_base) : 0.0;
  const double stated = stated_from_begin_s(*container_, *stream_, began_s, end_s);
  const long counted = frames();
  // An AVI numbers frames by their time, and omits frames that repeat the previous one.
  const bool by_time = is_kind(*container_, "avi") && reached_.has_value();
  const bool frames_missing = counted >= 0 && std::max(by_time ? *reached_ : 0, packets_) < counted;
  const bool complete = counted >= 0 ? !frames_missing : end_s + 0.5 * frame_s + kRounding >= stated;
  const bool complained = last_read_complained_ || !early_complaints_.empty();
  const bool too_short = container_->nb_streams == 1 && counted < 0 && end_s + 1.5 * frame_s + kRounding < stated;
  if (last_packet_corrupt_ || frames_missing || too_short || (!complete && (complained || is_cut()))) {
    const long of = counted >= 0 ? counted : frame_s > 0.0 && stated > 0.0 ? std::lround(stated * rate) : -1;
    std::string text = fmt::format("the input ends at frame {}", shown);
    if (of >= shown) text += fmt::format(" of {}{}", counted >= 0 ? "" : "about ", of);
    const double of_s =
        counted >= 0 && frame_s > 0.0 ? std::max(stated, static_cast<double>(counted) * frame_s) : stated;
    text += of_s >= end_s ? fmt::format(" ({:.2f} s of {:.2f} s)", end_s, of_s) : fmt::format(" ({:.2f} s)", end_s);
    return VideoProblem{InputErrorKind::kDamaged, text, "copy it again (earlier frames are valid)"};
  }
  if (!sums_agree_) {
    return VideoProblem{InputErrorKind::kDamaged,
                        "frames may be wrong without a mark, because a checksum of the video is wrong",
                        "copy it again"};
  }
  if (header_complained_ || (complained && !is_cut())) {
    return VideoProblem{InputErrorKind::kDamaged,
                        "the times may be wrong, because the container of the video is damaged", "copy it again"};
  }
  // An mp4 states its length twice: the stream's, and that of its edit list. The times must match one of them. FFmpeg 7
  // states the length of the decode times, which is shorter if the last frames are reordered and a gap is among them.
  const double edited = static_cast<double>(container_->duration) / AV_TIME_BASE;
  const double decoded =
      last_decoded_ ? static_cast<double>(*last_decoded_ - *first_decoded_) * av_q2d(stream_->time_base) : 0.0;
  const double slack = 1.5 * frame_s + kRounding;
  const bool states_decoded = decoder_->has_b_frames > 0 && end_s > stated && std::fabs(decoded - stated) <= slack;
  if (is_kind(*container_, "mp4") && stated > 0.0 && counted == packets_ && std::fabs(end_s - stated) > slack &&
      std::fabs(end_s - edited) > slack && !states_decoded) {
    return VideoProblem{
        InputErrorKind::kDamaged,
        fmt::format("the times may be wrong, because they end at {:.2f} s and the video states {:.2f} s", end_s,
                    stated),
        "copy it again"};
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
