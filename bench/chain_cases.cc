// SPDX-License-Identifier: Apache-2.0
// Cases of our methods for one frame, as run by `measure`.
#include "cases.h"
#include "moiregauge/detection/circles/circles.h"
#include "product_chain.h"

namespace moiregauge::internal::bench {
namespace {

using Look = void (ProductChain::*)(const Shot&);

// Returns the case of a method. Its error is that of the displacement.
std::shared_ptr<Work> chain_work(const Recording& recording, const char* method, Look look, bool solves) {
  const auto chain = std::make_shared<ProductChain>(recording, *method_named(method));
  auto work = std::make_shared<Work>();
  work->bytes = recording.window_bytes();
  work->error_unit = "mm";
  work->frame = [=](const Shot& shot) {
    ((*chain).*look)(shot);
    if (solves) benchmark::DoNotOptimize(chain->solve());
    return !chain->is_lost();
  };
  work->error = [=, &recording](const Shot& shot) {
    ((*chain).*look)(shot);
    return recording.error(chain->target(), chain->solve().displacement, shot.frame);
  };
  return work;
}

std::shared_ptr<Work> detection_work(const Recording& recording) {
  const std::size_t least = recording.reference().circles.size();
  return detection_of(recording, [least](const Shot& shot) -> std::optional<std::vector<ImagePoint>> {
    std::vector<ImagePoint> found;
    for (const DetectedCircle& circle : find_circles(shot.picture, {}).circles) found.push_back(circle.centre);
    if (found.size() < least) return std::nullopt;
    return found;
  });
}

}  // namespace

void add_chain_cases() {
  using enum Memory;
  add_cases("detection", {kHot, kRing}, detection_work);
  // "tracking" is the first part of a frame of `precise`. The methods include displacement and u.
  add_cases("tracking", {kHot, kRing, kCold},
            [](const Recording& r) { return chain_work(r, "precise", &ProductChain::track, false); });
  add_cases("two-stage", {kRing},
            [](const Recording& r) { return chain_work(r, "two-stage", &ProductChain::observe, true); });
  add_cases("precise", {kHot, kRing, kCold},
            [](const Recording& r) { return chain_work(r, "precise", &ProductChain::observe, true); });
}

}  // namespace moiregauge::internal::bench
