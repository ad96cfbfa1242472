// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace moiregauge::internal {

// Lowers the priority of the calling thread, for work that no frame waits for. It has no effect where the system forbids
// that.
void lower_thread_priority();

}  // namespace moiregauge::internal
