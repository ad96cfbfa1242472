// SPDX-License-Identifier: Apache-2.0
// Our chains, as `measure` runs them for one frame.
#include "cases.h"
#include "moiregauge/markers/circles.h"
#include "product_chain.h"

namespace moiregauge::bench {
namespace {

// With everything up to millimetres and their u.
std::shared_ptr<Work> chain_work(const Recording& recording, const Method& method) {
  const auto chain = std::make_shared<ProductChain>(recording, method);
  auto work = std::make_shared<Work>();
  work->bytes = recording.window_bytes();
  work->error_unit = "mm";
  work->frame = [chain](const Shot& shot) {
    chain->observe(shot);
    benchmark::DoNotOptimize(chain->solve());
    return !chain->is_lost();
  };
  work->error = [chain, &recording](const Shot& shot) {
    chain->observe(shot);
    return recording.error(chain->target(), chain->solve().displacement, shot.frame);
  };
  return work;
}

// What a frame of `precise` begins with: where everything is. Its error is that of the displacement that follows.
std::shared_ptr<Work> tracking_work(const Recording& recording) {
  const auto chain = std::make_shared<ProductChain>(recording, *method_named("precise"));
  auto work = std::make_shared<Work>();
  work->bytes = recording.window_bytes();
  work->error_unit = "mm";
  work->frame = [chain](const Shot& shot) {
    chain->track(shot);
    return !chain->is_lost();
  };
  work->error = [chain, &recording](const Shot& shot) {
    chain->track(shot);
    return recording.error(chain->target(), chain->solve().displacement, shot.frame);
  };
  return work;
}

std::shared_ptr<Work> detection_work(const Recording& recording) {
  const std::size_t least = recording.reference().circles.size();
  return detection_of(recording, [least](const Shot& shot) -> std::optional<std::vector<ImagePoint>> {
    std::vector<ImagePoint> found;
    for (const SeenCircle& circle : find_circles(shot.picture, {}).circles) found.push_back(circle.centre);
    if (found.size() < least) return std::nullopt;
    return found;
  });
}

}  // namespace

void add_chain_cases() {
  using enum Memory;
  add_cases("detection", {kHot, kRing}, detection_work);
  add_cases("tracking", {kHot, kRing, kCold}, tracking_work);
  add_cases("two-stage", {kRing}, [](const Recording& r) { return chain_work(r, *method_named("two-stage")); });
  add_cases("precise", {kHot, kRing, kCold},
            [](const Recording& r) { return chain_work(r, *method_named("precise")); });
}

}  // namespace moiregauge::bench
