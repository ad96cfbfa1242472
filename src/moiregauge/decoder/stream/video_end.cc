// SPDX-License-Identifier: Apache-2.0
// Is the end of the file the end of the film?
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

// The length of the film as its container states it; NaN where that is a guess of libav from the end of the file.
double stated_s(const AVFormatContext& container, const AVStream& stream) {
  if (container.duration_estimation_method == AVFMT_DURATION_FROM_STREAM) {
    if (stream.duration > 0) return static_cast<double>(stream.duration) * av_q2d(stream.time_base);
    if (container.duration > 0) return static_cast<double>(container.duration) / AV_TIME_BASE;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Matroska's writers count the stated length from 0 or from the first picture. A film that begins later, and does not
// reach beyond the stated length as counted from 0, is one of the former.
double stated_from_begin_s(const AVFormatContext& container, const AVStream& stream, double began_s, double end_s) {
  const double stated = stated_s(container, stream);
  constexpr double kMatroskaRounding = 2e-3;  // s
  const bool counts_from_zero = is_kind(container, "matroska") && began_s > 0.0 && stated >= began_s &&
                                began_s + end_s <= stated + kMatroskaRounding;
  return counts_from_zero ? stated - began_s : stated;
}

}  // namespace

bool VideoStream::is_cut() const {
  const auto stated = stated_size(reader_of(file_), static_cast<std::uint64_t>(file_bytes_));
  return stated && *stated > static_cast<std::uint64_t>(file_bytes_);
}

// Complete is a film with all the frames its container counts, or where it counts none, with all the time it states;
// what is missing behind that (an index) is no loss. Stated time is that of the longest stream, so beside sound, with
// nothing else amiss, too little of it proves nothing.
std::optional<VideoProblem> VideoStream::end_problem(long shown) const {
  if (tear_)
    return VideoProblem{tear_->kind, fmt::format("input ends at frame {}: {}", shown, tear_->what), tear_->advice};
  const double rate = fps();
  const double frame_s = rate > 0.0 ? 1.0 / rate : 0.0;
  constexpr double kRounding = 2e-3;  // s: Matroska counts milliseconds
  const double end_s = reached_ ? static_cast<double>(*reached_ - *began_) * av_q2d(stream_->time_base) : 0.0;
  const double began_s = reached_ ? static_cast<double>(*began_) * av_q2d(stream_->time_base) : 0.0;
  const double stated = stated_from_begin_s(*container_, *stream_, began_s, end_s);
  const long counted = frames();
  // An AVI numbers its frames by their time, and leaves out those that repeat the one before.
  const bool by_time = is_kind(*container_, "avi") && reached_.has_value();
  const bool frames_missing = counted >= 0 && std::max(by_time ? *reached_ : 0, packets_) < counted;
  const bool complete = counted >= 0 ? !frames_missing : end_s + 0.5 * frame_s + kRounding >= stated;
  const bool complained = last_read_complained_ || !early_complaints_.empty();
  const bool too_short = container_->nb_streams == 1 && counted < 0 && end_s + 1.5 * frame_s + kRounding < stated;
  if (last_packet_corrupt_ || frames_missing || too_short || (!complete && (complained || is_cut()))) {
    const long of = counted >= 0 ? counted : frame_s > 0.0 && stated > 0.0 ? std::lround(stated * rate) : -1;
    std::string text = fmt::format("input ends at frame {}", shown);
    if (of >= shown) text += fmt::format(" of {}{}", counted >= 0 ? "" : "about ", of);
    const double of_s =
        counted >= 0 && frame_s > 0.0 ? std::max(stated, static_cast<double>(counted) * frame_s) : stated;
    text += of_s >= end_s ? fmt::format(" ({:.2f} s of {:.2f} s)", end_s, of_s) : fmt::format(" ({:.2f} s)", end_s);
    return VideoProblem{InputErrorKind::kDamaged, text, "copy it again; what came before counts"};
  }
  if (!sums_agree_) {
    return VideoProblem{InputErrorKind::kDamaged, "a check sum of the video is wrong: its data is damaged",
                        "copy it again; frames may be wrong that are not marked"};
  }
  if (header_complained_ || (complained && !is_cut())) {
    return VideoProblem{InputErrorKind::kDamaged, "the container of the video is damaged",
                        "copy it again; doubt the times of its frames"};
  }
  // An mp4 states its length twice: of the stream, and as an edit list shows it; its times must add up to one of them.
  const double edited = static_cast<double>(container_->duration) / AV_TIME_BASE;
  const double slack = 1.5 * frame_s + kRounding;
  if (is_kind(*container_, "mp4") && stated > 0.0 && counted == packets_ && std::fabs(end_s - stated) > slack &&
      std::fabs(end_s - edited) > slack) {
    return VideoProblem{
        InputErrorKind::kDamaged,
        fmt::format("the times of the frames end at {:.2f} s, the video states {:.2f} s", end_s, stated),
        "copy it again; doubt the times of its frames"};
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
