// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/damage.h"

#include <atomic>

extern "C" {
#include <libavutil/log.h>
}

namespace moiregauge {
namespace {

std::atomic<long> errors{0};  // libav has one log for the whole process, and the process is the child's own

void count(void* /*source*/, int level, const char* /*format*/, va_list /*values*/) {
  if (level <= AV_LOG_ERROR) ++errors;
}

}  // namespace

long errors_logged() { return errors; }

void count_log_errors() { av_log_set_callback(&count); }

}  // namespace moiregauge
