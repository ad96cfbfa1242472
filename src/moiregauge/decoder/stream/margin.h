// SPDX-License-Identifier: Apache-2.0
// Marks frames near a damaged one. Frames are displayed and stored in different order, so a decoder's error may concern
// a frame displayed slightly earlier or later.
#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace moiregauge::internal {

// Delays every frame until the next three have arrived. A damaged frame spoils three on either side.
template <typename Item>
class DamageMargin {
 public:
  static constexpr int kFrames = 3;

  // Adds the next frame. Returns the oldest one, once four wait, and true if it is spoilt.
  [[nodiscard]] std::optional<std::pair<Item, bool>> put(Item item, bool damaged) {
    if (damaged) spoil_around();
    const bool spoilt = damaged || to_spoil_ > 0;
    if (!damaged && to_spoil_ > 0) --to_spoil_;
    waiting_.emplace_back(std::move(item), spoilt);
    if (waiting_.size() <= kFrames) return std::nullopt;
    auto oldest = std::move(waiting_.front());
    waiting_.pop_front();
    return oldest;
  }

  // Marks damage between the last frame and the next one, such as data that gave no frame.
  void spoil_around() {
    for (auto& [waiting, spoilt] : waiting_) spoilt = true;
    to_spoil_ = kFrames;
  }

  // Returns all waiting frames in order. Call it at the end.
  [[nodiscard]] std::vector<std::pair<Item, bool>> rest() {
    std::vector<std::pair<Item, bool>> all(std::make_move_iterator(waiting_.begin()),
                                           std::make_move_iterator(waiting_.end()));
    waiting_.clear();
    return all;
  }

 private:
  std::deque<std::pair<Item, bool>> waiting_;
  int to_spoil_ = 0;
};

}  // namespace moiregauge::internal
