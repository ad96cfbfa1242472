// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/damaged_pictures.h"

#include <algorithm>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxEntries = 6;  // keeps the line readable (chosen)

}  // namespace

void DamagedPictures::add(long frame, const std::string& problem, const std::string& place) {
  ++frames_;
  const auto next =
      std::find_if(stretches_.begin(), stretches_.end(), [&](const Stretch& s) { return s.first > frame; });
  if (next != stretches_.begin()) {
    Stretch& last = *(next - 1);
    if (last.last + 1 == frame && last.problem == problem) {
      last.last = frame;
      last.last_place = place;
      return;
    }
  }
  stretches_.insert(next, {frame, frame, problem, place, place});
}

std::string DamagedPictures::text() const {
  if (stretches_.empty()) return "";
  std::string list;
  for (std::size_t i = 0; i < std::min(kMaxEntries, stretches_.size()); ++i) {
    const Stretch& s = stretches_[i];
    const bool is_one = s.first == s.last;
    list += fmt::format("{}{}{}: {}", i == 0 ? "" : "; ",
                        is_one ? fmt::format("frame {}", s.first) : fmt::format("frames {} to {}", s.first, s.last),
                        frames_ == 1 ? " has no values" : "", s.problem);
    if (!s.first_place.empty()) list += ": " + s.first_place;
    if (!is_one && !s.last_place.empty()) list += " to " + s.last_place;
  }
  if (stretches_.size() > kMaxEntries) list += fmt::format("; and {} more", stretches_.size() - kMaxEntries);
  return frames_ == 1 ? list : fmt::format("{} frames have no values: {}", frames_, list);
}

}  // namespace moiregauge::internal
