// SPDX-License-Identifier: Apache-2.0
// Frames near a damaged one. What a decoder complains about may sit in a picture shown a little earlier or later than
// the one it was decoding, because pictures are shown in another order than they are stored.
#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace moiregauge::internal {

// Holds every frame back until the three after it have come; a damaged one spoils three on either side.
template <typename Item>
class DamageMargin {
 public:
  static constexpr int kFrames = 3;

  // Takes the next frame; gives the one that is old enough, if there is one, with its verdict.
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

  // Damage between the frame before and the one to come, such as data that gave no frame at all.
  void spoil_around() {
    for (auto& [waiting, spoilt] : waiting_) spoilt = true;
    to_spoil_ = kFrames;
  }

  // At the end: all that wait, in order.
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
