// SPDX-License-Identifier: Apache-2.0
// Decodes one video stream of one open file, frame by frame. Runs in the child only.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/decoder/headers/cluster_sums.h"
#include "moiregauge/decoder/headers/stated_size.h"
#include "moiregauge/decoder/headers/stream_quantiser.h"
#include "moiregauge/decoder/seek/seek_plan.h"
#include "moiregauge/decoder/stream/damage.h"
#include "moiregauge/decoder/stream/live_address.h"
#include "moiregauge/run/frame_source.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace moiregauge::internal {

struct VideoProblem {
  InputErrorKind kind = InputErrorKind::kUnsupported;
  std::string what;
  std::string advice;
};

enum class Decoded { kFrame, kLost, kEnd };

[[nodiscard]] VideoProblem too_many_pixels(int width, int height, std::int64_t max_pixels);
// Returns a function that reads `file` at an offset, independent of other readers.
[[nodiscard]] ReadAt reader_of(int file);

class VideoStream {
 public:
  // Opens a stream. libav gets no name and no protocol, so it reads `file` only, and cannot open other files. Images
  // above `max_pixels` are not decoded, and no memory is allocated for them.
  [[nodiscard]] static tl::expected<std::unique_ptr<VideoStream>, VideoProblem> open(int file, std::int64_t max_pixels);
  // Connects to a live stream: opens the connection, and for RTSP reads the description. Then begin_live() probes it.
  // Between both the process can be confined.
  [[nodiscard]] static tl::expected<std::unique_ptr<VideoStream>, VideoProblem> connect(const LiveAddress& address,
                                                                                        std::int64_t max_pixels);
  [[nodiscard]] tl::expected<void, VideoProblem> begin_live();
  VideoStream(const VideoStream&) = delete;
  VideoStream& operator=(const VideoStream&) = delete;
  ~VideoStream();

  // Decodes the next frame. kFrame: frame() holds it. kLost: a packet gave none, which would have been the next frame
  // if is_place_known().
  [[nodiscard]] Decoded next();
  [[nodiscard]] const AVFrame& frame() const { return *frame_; }
  // Returns notes of the packets that a plan for frame `wanted` needs, without decoding them. The stream is then used up.
  [[nodiscard]] std::vector<PacketNote> note_packets(long wanted);
  // Continues with this packet (SeekPlan). Returns false if it was read before, or does not exist.
  [[nodiscard]] bool skip_to(std::int64_t packet);
  // Returns the time of frame() in the stream's own count.
  [[nodiscard]] std::int64_t timestamp() const { return timestamp_; }
  [[nodiscard]] bool is_place_known() const { return decoder_->has_b_frames == 0; }
  [[nodiscard]] bool damaged() const { return damaged_; }
  [[nodiscard]] const StreamQuantiser& quantiser() const { return quantiser_; }  // for frame()
  [[nodiscard]] double time_s() const;  // s, time of the frame or the lost packet in the stream's own count; NaN: none
  // Returns the reason why the file is incomplete, or nothing. `shown` frames came out of it. Call it after kEnd. Some
  // truncated files cannot be detected.
  [[nodiscard]] std::optional<VideoProblem> end_problem(long shown) const;

  // Returns true if the frames of a live stream have times of the camera, and not of libav's guess of a frame rate.
  [[nodiscard]] bool has_camera_times() const;
  [[nodiscard]] long frames() const;  // -1: not stated
  [[nodiscard]] double fps() const;   // NaN: unknown
  [[nodiscard]] std::string codec() const;
  // Returns the creation time of the file as stated in it; empty: not stated.
  [[nodiscard]] std::string stated_start() const;
  // Returns the clockwise rotation (a multiple of 90) that shows the image upright. Fails if it is mirrored or oblique.
  [[nodiscard]] tl::expected<int, VideoProblem> rotation_deg() const;

 private:
  VideoStream() = default;
  [[nodiscard]] std::optional<VideoProblem> open_container();
  [[nodiscard]] std::optional<VideoProblem> choose_stream();
  [[nodiscard]] VideoProblem no_video_here() const;
  [[nodiscard]] bool open_decoder();
  [[nodiscard]] bool read_packet();
  [[nodiscard]] bool send_packet();
  void note_complaints(std::int64_t packet);
  void note_extent();
  void note_time();
  [[nodiscard]] bool note_count();
  void take_early_complaints();
  [[nodiscard]] bool is_cut() const;

  int file_ = -1;  // -1: a live stream
  std::int64_t max_pixels_ = 0;
  std::int64_t file_bytes_ = 0;
  std::int64_t position_ = 0;  // bytes; separate, because the descriptor's own may be shared
  AVFormatContext* container_ = nullptr;
  AVIOContext* bytes_ = nullptr;
  AVCodecContext* decoder_ = nullptr;
  AVStream* stream_ = nullptr;
  AVFrame* frame_ = nullptr;
  AVPacket* packet_ = nullptr;
  Damage damage_;
  std::optional<ClusterSums> sums_;
  bool sums_agree_ = true;
  std::vector<std::int64_t> early_complaints_;  // file positions of errors while probing
  bool header_complained_ = false;
  StreamQuantiser quantiser_;
  long errors_seen_ = 0;
  std::int64_t packets_ = 0;
  std::optional<std::int64_t> began_;    // in all packets, in the stream's own count: earliest time,
  std::optional<std::int64_t> reached_;  // end of the latest
  std::optional<std::int64_t> first_decoded_, last_decoded_;  // decode times: first, and end of the last
  std::int64_t chunk_end_ = 0;                                // AVI only: end of the last packet,
  std::int64_t count_shift_ = 0;                              // number of frames that libav missed,
  bool has_places_ = false;                                   // true if its index has positions
  std::optional<VideoProblem> tear_;                          // reading ended here
  bool draining_ = false;
  bool last_packet_corrupt_ = false;   // the reader's flag: usually truncated
  bool last_read_complained_ = false;  // error at the end
  bool damaged_ = false;
  std::int64_t timestamp_ = AV_NOPTS_VALUE;

  friend int read_bytes(void* self, std::uint8_t* out, int size);
  std::unique_ptr<LiveDeadline> deadline_;  // live streams only

  friend std::int64_t seek_bytes(void* self, std::int64_t offset, int whence);
};

}  // namespace moiregauge::internal
