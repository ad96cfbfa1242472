// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/video_stream.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>

#include <fmt/format.h>

extern "C" {
#include <libavutil/display.h>
}

#include "moiregauge/decoder/stream/ffmpeg_version.h"

namespace moiregauge::internal {

ReadAt reader_of(int file) {
  return [file](std::uint64_t offset, std::span<std::uint8_t> out) {
    const ssize_t read = ::pread(file, out.data(), out.size(), static_cast<off_t>(offset));
    return read > 0 ? static_cast<std::size_t>(read) : std::size_t{0};
  };
}

VideoProblem too_many_pixels(int width, int height, std::int64_t max_pixels) {
  return {InputErrorKind::kUnsupported,
          fmt::format("the frame size {}x{} exceeds the limit of {:g} Mpx", width, height,
                      static_cast<double>(max_pixels) / 1e6),
          "raise --max-pixels if the size is correct"};
}

namespace {

// Containers that consist of one file. Playlists, concatenations and image sequences are excluded, because they name
// other files.
constexpr const char* kContainers = "mov,matroska,avi,mpegts,yuv4mpegpipe";
constexpr int kReadBlock = 1 << 18;  // bytes (chosen)

// Returns libav's guess of the file's format by its first bytes, or an empty text.
std::string found_instead(int file) {
  std::array<std::uint8_t, 2048 + AVPROBE_PADDING_SIZE> bytes{};
  const std::size_t size = reader_of(file)(0, std::span(bytes).first(2048));
  const AVProbeData probe{"", bytes.data(), static_cast<int>(size), nullptr};
  int score = AVPROBE_SCORE_RETRY;
  const AVInputFormat* format = av_probe_input_format2(&probe, 1, &score);
  if (format != nullptr) return format->name;
  const bool is_text = std::all_of(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size),
                                   [](std::uint8_t c) { return c >= 0x20 || (c >= 0x09 && c <= 0x0d); });
  return is_text ? "text" : "";
}

VideoProblem no_video(int file) {
  const std::string found = found_instead(file);
  if (found.starts_with("mov,mp4")) {
    return {InputErrorKind::kDamaged, "the video has no index (the recording was cut off)",
            "try a repair tool for this kind of file"};
  }
  const std::string first = found.substr(0, found.find(','));  // libav lists all names of a format
  const bool is_allowed = std::string_view(kContainers).find(first) != std::string_view::npos;
  return {InputErrorKind::kUnsupported,
          first.empty()     ? "the input is not a video"
          : found == "text" ? "the input is not a video (it is text)"
          : is_allowed      ? fmt::format("the input contains no video (it is {})", first)
                            : fmt::format("the input type '{}' is not allowed", first),
          "give a complete mp4, mov, mkv, webm, avi, ts or y4m file, or a folder of images"};
}

// Decoders count whole blocks, and an image need not fill the last one.
std::int64_t decoders_limit(std::int64_t max_pixels) { return 2 * max_pixels + 65536; }

std::optional<VideoProblem> size_problem(const AVFormatContext& container, std::int64_t max_pixels) {
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    const AVCodecParameters& codec = *container.streams[i]->codecpar;
    if (codec.codec_type != AVMEDIA_TYPE_VIDEO || std::int64_t{codec.width} * codec.height <= max_pixels) continue;
    return too_many_pixels(codec.width, codec.height, max_pixels);
  }
  return std::nullopt;
}

bool look_into_streams(AVFormatContext* container, std::int64_t max_pixels) {
  std::vector<AVDictionary*> wishes(container->nb_streams, nullptr);
  for (AVDictionary*& wish : wishes) av_dict_set_int(&wish, "max_pixels", decoders_limit(max_pixels), 0);
  const int found = avformat_find_stream_info(container, wishes.empty() ? nullptr : wishes.data());
  for (AVDictionary*& wish : wishes) av_dict_free(&wish);
  return found >= 0;
}

int refuse_to_open(AVFormatContext* /*container*/, AVIOContext** /*bytes*/, const char* /*url*/, int /*flags*/,
                   AVDictionary** /*options*/) {
  return AVERROR(EPERM);
}

}  // namespace

int read_bytes(void* self, std::uint8_t* out, int size) {
  auto& stream = *static_cast<VideoStream*>(self);
  const ssize_t read = ::pread(stream.file_, out, static_cast<std::size_t>(size), stream.position_);
  if (read < 0) return AVERROR(errno);
  stream.position_ += read;
  return read == 0 ? AVERROR_EOF : static_cast<int>(read);
}

std::int64_t seek_bytes(void* self, std::int64_t offset, int whence) {
  auto& stream = *static_cast<VideoStream*>(self);
  whence &= ~AVSEEK_FORCE;
  if (whence == AVSEEK_SIZE) return stream.file_bytes_;
  const std::int64_t from = whence == SEEK_CUR ? stream.position_ : whence == SEEK_END ? stream.file_bytes_ : 0;
  if (offset < 0 ? from < -offset : from > std::numeric_limits<std::int64_t>::max() - offset) return AVERROR(EINVAL);
  return stream.position_ = from + offset;
}

tl::expected<std::unique_ptr<VideoStream>, VideoProblem> VideoStream::open(int file, std::int64_t max_pixels) {
  std::unique_ptr<VideoStream> stream(new VideoStream);
  stream->file_ = file;
  stream->max_pixels_ = max_pixels;
  // The parent reads at offsets too, so the descriptor's own position is unused.
  stream->file_bytes_ = ::lseek(file, 0, SEEK_END);
  if (auto problem = stream->open_container()) return tl::unexpected(std::move(*problem));
  if (!stream->open_decoder()) {
    return tl::unexpected(VideoProblem{InputErrorKind::kUnsupported, "there is no decoder for " + stream->codec(),
                                       "convert the video to H.264 or FFV1"});
  }
  // FFV1 has its own check sums in every slice.
  if (stream->stream_->codecpar->codec_id != AV_CODEC_ID_FFV1) stream->sums_.emplace(reader_of(file));
  stream->errors_seen_ = errors_logged();
  return stream;
}

VideoStream::~VideoStream() {
  avcodec_free_context(&decoder_);
  AVIOContext* connection =
      file_ < 0 && container_ != nullptr && (container_->flags & AVFMT_FLAG_CUSTOM_IO) != 0 ? container_->pb : nullptr;
  avformat_close_input(&container_);
  if (connection != nullptr) avio_closep(&connection);
  if (bytes_ != nullptr) av_freep(&bytes_->buffer);
  avio_context_free(&bytes_);
  av_frame_free(&frame_);
  av_packet_free(&packet_);
}

std::optional<VideoProblem> VideoStream::open_container() {
  frame_ = av_frame_alloc();
  packet_ = av_packet_alloc();
  auto* buffer = static_cast<unsigned char*>(av_malloc(kReadBlock));
  bytes_ = avio_alloc_context(buffer, kReadBlock, 0, this, &read_bytes, nullptr, &seek_bytes);
  container_ = avformat_alloc_context();
  container_->pb = bytes_;
  container_->flags |= AVFMT_FLAG_CUSTOM_IO;
  container_->io_open = &refuse_to_open;
  container_->error_recognition = AV_EF_CRCCHECK;
  container_->format_whitelist = av_strdup(kContainers);
  container_->protocol_whitelist = av_strdup("");
  if (avformat_open_input(&container_, "", nullptr, nullptr) < 0) return no_video(file_);
  // Read before libav adds its own count to the index of an AVI.
  has_places_ = container_->nb_streams > 0 && avformat_index_get_entries_count(container_->streams[0]) > 0;
  header_complained_ = !places_of_complaints().empty();
  return choose_stream();
}

VideoProblem VideoStream::no_video_here() const {
  if (file_ >= 0) return no_video(file_);
  return {InputErrorKind::kUnsupported, "the stream contains no video that can be decoded",
          "check the camera's settings"};
}

std::optional<VideoProblem> VideoStream::choose_stream() {
  // Some containers state the size in their header, others in the stream, which probing partly decodes.
  if (auto problem = size_problem(*container_, max_pixels_)) return problem;
  if (!look_into_streams(container_, max_pixels_)) return no_video_here();
  if (auto problem = size_problem(*container_, max_pixels_)) return problem;
  early_complaints_ = places_of_complaints();
  const int best = av_find_best_stream(container_, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (best < 0) return no_video_here();
  stream_ = container_->streams[best];
  for (unsigned i = 0; i < container_->nb_streams; ++i) {
    if (container_->streams[i] != stream_) container_->streams[i]->discard = AVDISCARD_ALL;
  }
  if ((stream_->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0)
    return no_video_here();  // cover image of an audio file
  return std::nullopt;
}

bool VideoStream::open_decoder() {
  const AVCodec* codec = avcodec_find_decoder(stream_->codecpar->codec_id);
  decoder_ = codec == nullptr ? nullptr : avcodec_alloc_context3(codec);
  if (decoder_ == nullptr || avcodec_parameters_to_context(decoder_, stream_->codecpar) < 0) return false;
  decoder_->pkt_timebase = stream_->time_base;
  // Threads share slices, not frames, so that an error belongs to the packet just sent.
  // H.264 has one thread. With more, libav does not check for undecoded macroblocks, which reveal most damaged images.
  // Cameras write one slice per image anyway.
  decoder_->thread_type = FF_THREAD_SLICE;
  decoder_->thread_count = codec->id == AV_CODEC_ID_H264 ? 1 : 0;
  decoder_->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_AGGRESSIVE;
  decoder_->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;  // output and marked here, so that other frames keep their numbers
  StreamQuantiser::ask(*decoder_);
  decoder_->max_pixels = decoders_limit(max_pixels_);
  copy_packet_numbers(*decoder_);
  if (avcodec_open2(decoder_, codec, nullptr) < 0) return false;
  quantiser_.begin(*decoder_);
  return true;
}

void VideoStream::note_complaints(std::int64_t packet) {
  const long now = errors_logged();
  if (now != errors_seen_) damage_.complaint(packet);
  errors_seen_ = now;
}

bool VideoStream::read_packet() {
  const long before = errors_logged();
  int read = 0;
  do {
    av_packet_unref(packet_);
    if (deadline_) deadline_->restart();
    read = av_read_frame(container_, packet_);
  } while (read >= 0 && packet_->stream_index != stream_->index);
  if (read < 0) {  // an error at the end says nothing about earlier packets
    last_read_complained_ = read != AVERROR_EOF || errors_logged() != before;
    errors_seen_ = errors_logged();
    return false;
  }
  ++packets_;
  if ((packet_->flags & AV_PKT_FLAG_KEY) != 0) damage_.key_packet(packets_);
  if (file_ < 0 && is_place_known()) damage_.forget();
  last_packet_corrupt_ = (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0;
  if (last_packet_corrupt_) damage_.complaint(packets_);
  note_complaints(packets_);
  take_early_complaints();
  if (!note_count()) return false;
  note_extent();
  if (sums_ && packet_->pos >= 0) sums_agree_ = sums_->agree_up_to(static_cast<std::uint64_t>(packet_->pos));
  return true;
}

// Assigns an error of the probe to the first packet after its file position.
void VideoStream::take_early_complaints() {
  if (early_complaints_.empty() || packet_->pos < 0) return;
  const auto behind = std::remove_if(early_complaints_.begin(), early_complaints_.end(),
                                     [this](std::int64_t place) { return place <= packet_->pos; });
  if (behind != early_complaints_.end()) damage_.complaint(packets_);
  early_complaints_.erase(behind, early_complaints_.end());
}

void VideoStream::note_extent() {
  const std::int64_t time = packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts;
  if (time == AV_NOPTS_VALUE || (packet_->flags & AV_PKT_FLAG_DISCARD) != 0) return;
  const std::int64_t duration = std::max<std::int64_t>(packet_->duration, 0);
  const std::int64_t decoded = packet_->dts != AV_NOPTS_VALUE ? packet_->dts : time;
  first_decoded_ = std::min(first_decoded_.value_or(decoded), decoded);
  last_decoded_ = std::max(last_decoded_.value_or(decoded), decoded + duration);
  began_ = std::min(began_.value_or(time), time);
  reached_ = std::max(reached_.value_or(time), time + duration);
}

bool VideoStream::send_packet() {
  set_packet_number(*decoder_, *packet_, packets_);
  quantiser_.note_packet(*decoder_, *packet_, packets_);
  const int sent = avcodec_send_packet(decoder_, packet_);
  note_complaints(packets_);
  if (sent >= 0) return true;
  damage_.complaint(packets_);
  return false;
}

// Reads the time of a frame. An AVI has no times but the frame count, which libav loses for frames that wait in the
// decoder at the end.
void VideoStream::note_time() {
  const bool is_counted = std::strcmp(container_->iformat->name, "avi") == 0 && timestamp_ != AV_NOPTS_VALUE;
  const bool is_timeless = frame_->best_effort_timestamp == AV_NOPTS_VALUE;
  timestamp_ = is_timeless && is_counted ? timestamp_ + 1 : frame_->best_effort_timestamp;
}

Decoded VideoStream::next() {
  while (true) {
    const int received = avcodec_receive_frame(decoder_, frame_);
    note_complaints(packets_);
    if (received >= 0) {
      const std::int64_t packet = packet_number(*frame_).value_or(packets_);
      if ((frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0) damage_.complaint(packet);
      damaged_ =
          damage_.touches(packet) || (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0;
      note_time();
      quantiser_.note_frame(*decoder_, *frame_, packet);
      return Decoded::kFrame;
    }
    if (received == AVERROR_EOF) return Decoded::kEnd;
    if (received != AVERROR(EAGAIN)) damage_.complaint(packets_);
    if (draining_ && received != AVERROR(EAGAIN)) continue;
    if (!read_packet()) {
      draining_ = true;
      avcodec_send_packet(decoder_, nullptr);
    } else if (!send_packet()) {
      damaged_ = true;
      timestamp_ = packet_->pts;
      return Decoded::kLost;
    }
  }
}

long VideoStream::frames() const {
  const bool is_mov = std::strncmp(container_->iformat->name, "mov", 3) == 0;
  if (is_mov && avformat_index_get_entries_count(stream_) > 0) return avformat_index_get_entries_count(stream_);
  return stream_->nb_frames > 0 ? static_cast<long>(stream_->nb_frames) : -1;
}

double VideoStream::time_s() const {
  if (timestamp_ == AV_NOPTS_VALUE) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(timestamp_) * stream_->time_base.num / stream_->time_base.den;
}

double VideoStream::fps() const {
  const AVRational rate = stream_->avg_frame_rate.num > 0 ? stream_->avg_frame_rate : stream_->r_frame_rate;
  return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : std::numeric_limits<double>::quiet_NaN();
}

std::string VideoStream::stated_start() const {
  for (const AVDictionary* of : {container_->metadata, stream_->metadata}) {
    const AVDictionaryEntry* entry = av_dict_get(of, "creation_time", nullptr, 0);
    if (entry != nullptr && entry->value != nullptr) return entry->value;
  }
  return {};
}

std::string VideoStream::codec() const { return avcodec_get_name(stream_->codecpar->codec_id); }

tl::expected<int, VideoProblem> VideoStream::rotation_deg() const {
  const std::span<const std::uint8_t> stored = display_matrix(*stream_);
  std::int32_t matrix[9];
  if (stored.size() < sizeof matrix) return 0;
  std::memcpy(matrix, stored.data(), sizeof matrix);
  const double mirror = double{1} * matrix[0] * matrix[4] - double{1} * matrix[1] * matrix[3];
  const double clockwise = -av_display_rotation_get(matrix);
  const double quarters = std::round(clockwise / 90.0);
  if (!(mirror > 0.0) || !(std::fabs(clockwise - 90.0 * quarters) < 0.5)) {
    return tl::unexpected(VideoProblem{InputErrorKind::kUnsupported,
                                       "the display tag mirrors the image, or rotates it by other than 90 degrees",
                                       "store the video upright or rotated by multiples of 90 degrees"});
  }
  return ((static_cast<int>(quarters) % 4 + 4) % 4) * 90;
}

}  // namespace moiregauge::internal
