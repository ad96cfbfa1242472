// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/block_outlet.h"

#include <chrono>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/live/publish/rows_for_tests.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;

// Behaviour of a receiver, and the blocks that it has. The sender shares it.
struct Receiver {
  std::mutex mutex;
  std::vector<RowBlock> blocks;
  bool is_absent = false;
  bool refuses = false;
  std::chrono::milliseconds delay{0};

  [[nodiscard]] std::vector<long> frames() {
    const std::lock_guard lock(mutex);
    std::vector<long> all;
    for (const RowBlock& block : blocks)
      for (const OutletRow& row : block.rows) all.push_back(row.frame);
    return all;
  }
  void set_absent(bool absent) {
    const std::lock_guard lock(mutex);
    is_absent = absent;
  }
};

class Sender final : public BlockSender {
 public:
  explicit Sender(std::shared_ptr<Receiver> receiver) : receiver_(std::move(receiver)) {}
  void start(const LiveRun& /*run*/) override { is_started_ = true; }
  SendResult send(const RowBlock& block) override {
    EXPECT_TRUE(is_started_) << "rows came before the run";
    std::this_thread::sleep_for(receiver_->delay);
    const std::lock_guard lock(receiver_->mutex);
    if (receiver_->is_absent) return SendResult::kRetry;
    if (receiver_->refuses) return SendResult::kRefused;
    receiver_->blocks.push_back(block);
    return SendResult::kSent;
  }
  [[nodiscard]] std::string state() const override { return "connected"; }

 private:
  std::shared_ptr<Receiver> receiver_;
  bool is_started_ = false;
};

struct Set {
  std::shared_ptr<Receiver> receiver = std::make_shared<Receiver>();
  std::unique_ptr<BlockOutlet> outlet;
  explicit Set(std::size_t max_rows = kMaxWaitingRows)
      : outlet(block_outlet("test", std::make_unique<Sender>(receiver), max_rows)) {
    outlet->start(test::two_targets());
  }
};

std::vector<long> twice_each(long count) {
  std::vector<long> all;
  for (long i = 0; i < count; ++i) all.insert(all.end(), {i, i});
  return all;
}

TEST(BlockOutlet, EveryRowArrivesOnceInBlocksOfASecond) {
  Set set;
  for (long frame = 0; frame < 250; ++frame) set.outlet->put(test::frame_with_rows(frame, 50.0));
  set.outlet->finish(5.0);
  EXPECT_EQ(set.receiver->frames(), twice_each(250));
  EXPECT_EQ(set.receiver->blocks.size(), 5U) << "250 frames of 20 ms";
  EXPECT_EQ(set.outlet->lost_rows(), 0);
}

TEST(BlockOutlet, ARunThatBeginsLaterIsKnownBeforeItsRows) {
  const auto receiver = std::make_shared<Receiver>();
  const auto outlet = block_outlet("test", std::make_unique<Sender>(receiver));
  std::this_thread::sleep_for(milliseconds(30));  // the thread waits for a block
  outlet->start(test::two_targets());
  for (long frame = 0; frame < 100; ++frame) outlet->put(test::frame_with_rows(frame, 50.0));
  outlet->finish(5.0);
  EXPECT_EQ(receiver->frames(), twice_each(100));
}

TEST(BlockOutlet, AnAlarmIsSentAtOnce) {
  Set set;
  set.outlet->put(test::frame_with_rows(0, 50.0));
  AlarmEvent event;
  event.rule = "T1.dy > 2 mm";
  set.outlet->alarm(event);
  for (int i = 0; i < 200; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    const std::lock_guard lock(set.receiver->mutex);
    if (!set.receiver->blocks.empty()) break;
  }
  const std::lock_guard lock(set.receiver->mutex);
  ASSERT_EQ(set.receiver->blocks.size(), 1U);
  EXPECT_EQ(set.receiver->blocks[0].alarms.at(0).rule, "T1.dy > 2 mm");
}

TEST(BlockOutlet, AnAbsentReceiverGetsEverythingLater) {
  Set set;
  set.receiver->set_absent(true);
  for (long frame = 0; frame < 150; ++frame) set.outlet->put(test::frame_with_rows(frame, 50.0));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_TRUE(set.receiver->frames().empty());
  set.receiver->set_absent(false);
  set.outlet->finish(5.0);
  EXPECT_EQ(set.receiver->frames(), twice_each(150));
  EXPECT_EQ(set.outlet->lost_rows(), 0);
}

TEST(BlockOutlet, TheQueueIsBoundedAndItsLossesAreCounted) {
  Set set(1000);
  set.receiver->set_absent(true);
  constexpr long kFrames = 50 * 60;
  for (long frame = 0; frame < kFrames; ++frame) set.outlet->put(test::frame_with_rows(frame, 50.0));
  EXPECT_GT(set.outlet->lost_rows(), 4000);
  set.receiver->set_absent(false);
  set.outlet->finish(5.0);
  const auto frames = set.receiver->frames();
  EXPECT_EQ(static_cast<long>(frames.size()) + set.outlet->lost_rows(), 2 * kFrames) << "every row is sent or counted";
  EXPECT_EQ(frames.back(), kFrames - 1) << "the newest rows are kept";
}

TEST(BlockOutlet, RefusedRowsAreCountedAndDoNotBlockTheNext) {
  Set set;
  set.receiver->refuses = true;
  for (long frame = 0; frame < 100; ++frame) set.outlet->put(test::frame_with_rows(frame, 50.0));
  set.outlet->finish(5.0);
  EXPECT_EQ(set.outlet->lost_rows(), 200);
}

TEST(BlockOutlet, ASlowReceiverNeverDelaysTheMeasurement) {
  Set set;
  set.receiver->delay = milliseconds(300);
  const auto before = std::chrono::steady_clock::now();
  for (long frame = 0; frame < 500; ++frame) set.outlet->put(test::frame_with_rows(frame, 50.0));
  // Ten blocks would take 3 s. Copying 500 frames takes milliseconds.
  EXPECT_LT(std::chrono::steady_clock::now() - before, milliseconds(1000));
  const auto finishing = std::chrono::steady_clock::now();
  set.outlet->finish(0.2);
  EXPECT_LT(std::chrono::steady_clock::now() - finishing, milliseconds(1500));
}

TEST(BlockOutlet, RowsBeforeTheReferenceFrameAreIgnored) {
  const auto receiver = std::make_shared<Receiver>();
  const auto outlet = block_outlet("test", std::make_unique<Sender>(receiver));
  for (long frame = 0; frame < 100; ++frame) outlet->put(PublishedFrame{});
  outlet->finish(1.0);
  EXPECT_TRUE(receiver->blocks.empty());
}

}  // namespace
}  // namespace moiregauge::internal
