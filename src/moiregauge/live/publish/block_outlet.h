// SPDX-License-Identifier: Apache-2.0
// Publisher for slow outlets: collects rows into blocks of one second and sends them on its own thread.
#pragma once

#include <memory>
#include <string>

#include "moiregauge/live/publisher.h"
#include "moiregauge/live/row_block.h"

namespace moiregauge::internal {

enum class SendResult {
  kSent,     // the receiver has it
  kRetry,    // the receiver is absent: try again later
  kRefused,  // the receiver will never take it
};

// Sends the blocks of one run. One thread, the outlet's own, calls all functions. They may block for seconds.
class BlockSender {
 public:
  virtual ~BlockSender() = default;
  virtual void start(const LiveRun& run) = 0;
  [[nodiscard]] virtual SendResult send(const RowBlock& block) = 0;
  // Keeps a connection alive while there is nothing to send. Called about ten times a second.
  virtual void idle() {}
  // Says goodbye. No call comes after it.
  virtual void stop() {}
  // Returns the state for the user, e.g. "connected".
  [[nodiscard]] virtual std::string state() const = 0;
};

// Most rows that wait for an absent receiver (chosen): a minute of 300 frames/s with 10 targets, in 14 MB. Then the
// oldest block is dropped and its rows are counted.
inline constexpr std::size_t kMaxWaitingRows = 180'000;

// Returns a publisher named `name` for the user. The object is also an AlarmListener: an alarm ends the present block,
// so that it is sent at once.
class BlockOutlet : public Publisher, public AlarmListener {};
[[nodiscard]] std::unique_ptr<BlockOutlet> block_outlet(std::string name, std::unique_ptr<BlockSender> sender,
                                                        std::size_t max_waiting_rows = kMaxWaitingRows);

}  // namespace moiregauge::internal
