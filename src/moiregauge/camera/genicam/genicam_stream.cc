// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/genicam/genicam_stream.h"

#include <algorithm>

#include <fmt/format.h>

#include "moiregauge/camera/common/host_time.h"

namespace moiregauge::internal {
namespace {

// Buffers of one camera (chosen): 0.4 s of the paper's camera, in 142 MB.
constexpr int kBuffers = 16;
// Frames that the socket holds while the receiving thread waits for a processor. One is not enough: the system counts up
// to twice a packet's size, and the next frame follows at once. Chosen; the system limits it to net.core.rmem_max.
constexpr guint kSocketFrames = 4;

gint socket_bytes(guint frame_bytes) {
  constexpr guint kMost = G_MAXINT / kSocketFrames;
  return static_cast<gint>(kSocketFrames * std::min(frame_bytes, kMost));
}

using Completion = std::atomic<std::int64_t>;  // ns, steady_clock; user data of every buffer

void delete_completion(void* completion) { delete static_cast<Completion*>(completion); }

// Aravis calls it on its receiving thread.
void note_completion(void* /*unused*/, ArvStreamCallbackType type, ArvBuffer* buffer) {
  if (type != ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE || buffer == nullptr) return;
  auto* completion = static_cast<Completion*>(const_cast<void*>(arv_buffer_get_user_data(buffer)));
  if (completion != nullptr) completion->store(host_ns());
}

// Aravis calls it on the thread of its heartbeat.
void note_lost_control(ArvDevice* /*device*/, void* is_lost) { static_cast<std::atomic<bool>*>(is_lost)->store(true); }

InputError no_camera(const std::string& id, const std::string& reason) {
  return {
      InputErrorKind::kUnreadable,
      id.empty()
          ? fmt::format("no camera was found ({}): camera: check cable, power and network, or `moiregauge live --list`",
                        reason)
          : fmt::format("the camera cannot be opened ({}): camera:{}: see `moiregauge live --list`", reason, id)};
}

}  // namespace

tl::expected<std::unique_ptr<GenicamStream>, InputError> GenicamStream::start(const std::string& id,
                                                                              const GenicamSettings& settings) {
  std::unique_ptr<GenicamStream> stream(new GenicamStream);
  GlibError error;
  stream->camera_.reset(arv_camera_new(id.empty() ? nullptr : id.c_str(), error.out()));
  if (stream->camera_ == nullptr) return tl::unexpected(no_camera(id, error ? error.text() : "none answers"));
  const std::string name = id.empty() ? "camera" : "camera:" + id;
  auto done = apply_settings(*stream->camera_, settings, name);
  if (done) done = stream->run();
  if (!done) return tl::unexpected(InputError{InputErrorKind::kUnsupported, done.error()});
  return stream;
}

tl::expected<void, std::string> GenicamStream::run() {
  GlibError error;
  // As root Aravis would read packets from the network device, where none arrive from the loopback interface.
  if (arv_camera_is_gv_device(camera_.get()))
    arv_camera_gv_set_stream_options(camera_.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  const guint bytes = arv_camera_get_payload(camera_.get(), error.out());
  if (!error && bytes > 0)
    stream_.reset(arv_camera_create_stream(camera_.get(), note_completion, nullptr, error.out()));
  if (stream_ != nullptr && arv_camera_is_gv_device(camera_.get()))
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 socket_bytes(bytes), nullptr);
  if (stream_ == nullptr)
    return tl::unexpected(fmt::format("the camera sends no frames ({}): camera: close other programs that use it",
                                      error ? error.text() : "no image size"));
  for (int i = 0; i < kBuffers; ++i)
    give_back(arv_buffer_new_full(bytes, nullptr, new Completion(0), delete_completion));
  signal_ = g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(note_lost_control),
                             &is_control_lost_);
  arv_camera_start_acquisition(camera_.get(), error.out());
  if (error)
    return tl::unexpected(
        fmt::format("the camera does not start ({}): camera: close other programs that use it", error.text()));
  return {};
}

GenicamStream::~GenicamStream() {
  if (camera_ == nullptr) return;
  GlibError ignored;
  if (stream_ != nullptr && !is_control_lost_) arv_camera_stop_acquisition(camera_.get(), ignored.out());
  stream_.reset();
  if (signal_ != 0) g_signal_handler_disconnect(arv_camera_get_device(camera_.get()), signal_);
}

ReceivedFrame GenicamStream::receive(std::chrono::milliseconds timeout) {
  ReceivedFrame received;
  const auto us = std::chrono::microseconds(std::max(timeout, std::chrono::milliseconds(0))).count();
  received.buffer = arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(us));
  if (received.buffer == nullptr) return received;
  received.is_complete = arv_buffer_get_status(received.buffer) == ARV_BUFFER_STATUS_SUCCESS;
  const auto* completion = static_cast<const Completion*>(arv_buffer_get_user_data(received.buffer));
  received.host_ns = completion != nullptr && *completion > 0 ? completion->load() : host_ns();
  return received;
}

long GenicamStream::underruns() const {
  guint64 completed = 0, failures = 0, underruns = 0;
  arv_stream_get_statistics(stream_.get(), &completed, &failures, &underruns);
  return static_cast<long>(underruns);
}

int GenicamStream::queued() const {
  int in = 0, out = 0;
  arv_stream_get_n_buffers(stream_.get(), &in, &out);
  return out;
}

}  // namespace moiregauge::internal
