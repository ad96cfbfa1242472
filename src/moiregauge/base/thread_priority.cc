// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/thread_priority.h"

#include <sys/resource.h>
#include <unistd.h>

namespace moiregauge::internal {

void lower_thread_priority() {
  constexpr int kNiceness = 10;
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);  // Linux: the calling thread only
}

}  // namespace moiregauge::internal
