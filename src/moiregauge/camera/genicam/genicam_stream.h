// SPDX-License-Identifier: Apache-2.0
// One connection to a GenICam camera: camera, stream and buffers.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/camera/genicam/genicam_settings.h"

namespace moiregauge::internal {

// A received frame. It belongs to the stream and must be given back.
struct ReceivedFrame {
  ArvBuffer* buffer = nullptr;
  bool is_complete = false;
  std::int64_t host_ns = 0;  // steady_clock at its last packet
};

class GenicamStream {
 public:
  // Connects to a camera, sets it up and starts it. `id` is empty for the first camera.
  // Fails: no such camera (kUnreadable), a refused setting (kUnsupported).
  [[nodiscard]] static tl::expected<std::unique_ptr<GenicamStream>, InputError> start(const std::string& id,
                                                                                      const GenicamSettings& settings);
  GenicamStream(const GenicamStream&) = delete;
  GenicamStream& operator=(const GenicamStream&) = delete;
  ~GenicamStream();

  [[nodiscard]] ArvCamera& camera() const { return *camera_; }
  // Waits for a frame. Returns null if none came.
  [[nodiscard]] ReceivedFrame receive(std::chrono::milliseconds timeout);
  void give_back(ArvBuffer* buffer) { arv_stream_push_buffer(stream_.get(), buffer); }
  [[nodiscard]] bool is_control_lost() const { return is_control_lost_; }
  // Makes the destructor not wait for answers of the camera.
  void abandon() { is_control_lost_ = true; }
  // Returns the packets that came while no buffer was free.
  [[nodiscard]] long underruns() const;
  // Returns the frames that wait.
  [[nodiscard]] int queued() const;

 private:
  GenicamStream() = default;
  [[nodiscard]] tl::expected<void, std::string> run();

  GlibObject<ArvCamera> camera_;
  GlibObject<ArvStream> stream_;
  gulong signal_ = 0;
  std::atomic<bool> is_control_lost_ = false;
};

}  // namespace moiregauge::internal
