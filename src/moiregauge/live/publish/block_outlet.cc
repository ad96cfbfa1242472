// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/block_outlet.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace moiregauge::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kBlock_ns = 1'000'000'000;  // chosen: brokers lose messages that come faster
constexpr auto kIdle = std::chrono::milliseconds(100);
constexpr auto kFirstRetry = std::chrono::milliseconds(250), kLastRetry = std::chrono::milliseconds(4000);

// Shared with the sending thread, which outlives the outlet if its receiver blocks it for ever.
struct Mailbox {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<RowBlock> waiting;
  std::size_t waiting_rows = 0;
  std::optional<LiveRun> run;  // until the sender has it
  bool is_closing = false;     // no further block comes
  bool is_abandoned = false;   // the time for sending is over
  bool is_done = false;        // the thread has ended
  std::string state;
  std::atomic<long> lost_rows = 0;
};

class Postman {
 public:
  Postman(std::shared_ptr<Mailbox> box, std::unique_ptr<BlockSender> sender)
      : box_(std::move(box)), sender_(std::move(sender)) {}

  void operator()() {
    while (!is_over()) {
      auto block = take();
      start_run();  // after take(), because the run may begin while it waits
      if (!block)
        sender_->idle();
      else
        deliver(*block);
      report();
    }
    sender_->stop();
    const std::lock_guard lock(box_->mutex);
    for (const RowBlock& block : box_->waiting) box_->lost_rows += static_cast<long>(block.rows.size());
    box_->is_done = true;
    box_->changed.notify_all();
  }

 private:
  [[nodiscard]] bool is_over() const {
    const std::lock_guard lock(box_->mutex);
    return box_->is_abandoned || (box_->is_closing && box_->waiting.empty());
  }
  void start_run() {
    std::optional<LiveRun> run;
    {
      const std::lock_guard lock(box_->mutex);
      run = std::exchange(box_->run, std::nullopt);
    }
    if (run) sender_->start(*run);
  }
  void report() const {
    std::string state = sender_->state();
    const std::lock_guard lock(box_->mutex);
    box_->state = std::move(state);
  }
  // Waits a moment for a block.
  [[nodiscard]] std::optional<RowBlock> take() const {
    std::unique_lock lock(box_->mutex);
    box_->changed.wait_for(lock, kIdle, [this] { return !box_->waiting.empty() || box_->is_closing; });
    if (box_->waiting.empty()) return std::nullopt;
    RowBlock block = std::move(box_->waiting.front());
    box_->waiting.pop_front();
    box_->waiting_rows -= block.rows.size();
    return block;
  }
  // Waits until the time is over or nothing more can be sent. Returns false then.
  [[nodiscard]] bool wait(std::chrono::milliseconds time) const {
    std::unique_lock lock(box_->mutex);
    return !box_->changed.wait_for(lock, time, [this] { return box_->is_abandoned; });
  }
  // Sends the block, however often that takes. Meanwhile the mailbox drops its own oldest blocks.
  void deliver(const RowBlock& block) const {
    auto pause = kFirstRetry;
    while (true) {
      const SendResult result = sender_->send(block);
      report();
      if (result == SendResult::kSent) return;
      if (result == SendResult::kRefused || !wait(pause)) break;
      pause = std::min(2 * pause, kLastRetry);
    }
    box_->lost_rows += static_cast<long>(block.rows.size());
  }

  std::shared_ptr<Mailbox> box_;
  std::unique_ptr<BlockSender> sender_;
};

class Outlet final : public BlockOutlet {
 public:
  Outlet(std::string name, std::unique_ptr<BlockSender> sender, std::size_t max_waiting_rows)
      : name_(std::move(name)),
        max_waiting_rows_(max_waiting_rows),
        box_(std::make_shared<Mailbox>()),
        thread_(Postman(box_, std::move(sender))) {}
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;
  ~Outlet() override { finish(0.0); }

  void start(const LiveRun& run) override {
    const std::lock_guard lock(box_->mutex);
    box_->run = run;
    box_->changed.notify_all();
    is_started_ = true;
  }

  void put(const PublishedFrame& frame) override {
    if (!is_started_) return;
    if (block_.rows.empty() && block_.alarms.empty()) began_ns_ = frame.host_ns;
    for (const Sample& row : frame.rows) block_.rows.push_back(outlet_row(frame, row));
    block_.health = frame.health;
    block_.utc_ns = frame.utc_ns;
    if (frame.host_ns - began_ns_ >= kBlock_ns || !block_.alarms.empty()) post();
  }

  void alarm(const AlarmEvent& event) override {
    block_.alarms.push_back(event);
    block_.utc_ns = event.utc_ns;
    post();
  }

  void finish(double seconds) override {
    if (!thread_.joinable()) return;
    if (!block_.rows.empty()) post();
    std::unique_lock lock(box_->mutex);
    box_->is_closing = true;
    box_->changed.notify_all();
    const auto until = Clock::now() + std::chrono::duration<double>(seconds);
    const auto is_done = [this] { return box_->is_done; };
    box_->changed.wait_until(lock, until, is_done);
    box_->is_abandoned = true;
    box_->changed.notify_all();
    // A sender between two attempts ends at once. One that its receiver blocks is left to the end of the program.
    constexpr auto kGrace = std::chrono::seconds(1);
    const bool has_ended = box_->changed.wait_for(lock, kGrace, is_done);
    lock.unlock();
    if (has_ended)
      thread_.join();
    else
      thread_.detach();
  }

  [[nodiscard]] long lost_rows() const override { return box_->lost_rows; }
  [[nodiscard]] std::pair<std::string, std::string> state() const override {
    const std::lock_guard lock(box_->mutex);
    return {name_, box_->state};
  }

 private:
  void post() {
    const std::lock_guard lock(box_->mutex);
    box_->waiting_rows += block_.rows.size();
    box_->waiting.push_back(std::exchange(block_, RowBlock{}));
    while (box_->waiting_rows > max_waiting_rows_ && box_->waiting.size() > 1) {
      const std::size_t rows = box_->waiting.front().rows.size();
      box_->lost_rows += static_cast<long>(rows);
      box_->waiting_rows -= rows;
      box_->waiting.pop_front();
    }
    box_->changed.notify_all();
  }

  std::string name_;
  std::size_t max_waiting_rows_;
  bool is_started_ = false;
  RowBlock block_;  // the block that fills
  std::int64_t began_ns_ = 0;
  std::shared_ptr<Mailbox> box_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<BlockOutlet> block_outlet(std::string name, std::unique_ptr<BlockSender> sender,
                                          std::size_t max_waiting_rows) {
  return std::make_unique<Outlet>(std::move(name), std::move(sender), max_waiting_rows);
}

}  // namespace moiregauge::internal
