// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/damage.h"

#include <atomic>
#include <utility>

extern "C" {
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace moiregauge::internal {
namespace {

// libav has one log per process, and this process only decodes.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<long> errors{0};

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
thread_local std::vector<std::int64_t> places;

// Returns the container reader if it logged the message. `source` is null or a struct that begins with a pointer to its
// class.
const AVFormatContext* demuxer_behind(void* source) {
  if (source == nullptr || *static_cast<const AVClass**>(source) != avformat_get_class()) return nullptr;
  const auto* container = static_cast<const AVFormatContext*>(source);
  return container->iformat != nullptr && container->pb != nullptr ? container : nullptr;
}

void count(void* source, int level, const char* /*format*/, va_list /*values*/) {
  if (level > AV_LOG_ERROR) return;
  ++errors;
  const AVFormatContext* container = demuxer_behind(source);
  if (container != nullptr && places.size() < 10000) places.push_back(avio_tell(container->pb));
}

}  // namespace

long errors_logged() { return errors; }

std::vector<std::int64_t> places_of_complaints() { return std::exchange(places, {}); }

void count_log_errors() { av_log_set_callback(&count); }

}  // namespace moiregauge::internal
