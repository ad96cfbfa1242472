// SPDX-License-Identifier: Apache-2.0
// Cases of the stages of a frame of `precise`, one by one. Each uses the ring's frames and the known results of the
// stages before it.
#include <map>
#include <vector>

#include "cases.h"
#include "moiregauge/detection/circles/circles.h"
#include "product_chain.h"

namespace moiregauge::internal::bench {
namespace {

// Observations of `precise` in all frames of the ring.
struct SeenRing {
  std::unique_ptr<ProductChain> chain;
  std::map<long, Observations> seen;  // by frame, one observation each

  [[nodiscard]] Observation at(const Shot& shot) const { return seen.at(shot.frame).front(); }
  [[nodiscard]] View view(const Shot& shot) const { return {at(shot).stage2, chain->reference().lens}; }
  [[nodiscard]] Extent<frame::Board> moved(const Shot& shot, std::size_t i) const {
    if (i != chain->target()) return {};
    return displacement_at(chain->reference().plans[i], chain->reference().seen.markers[i].patch,
                           at(shot).markers[i].patch, at(shot).markers[i].window_shift);
  }
};

const SeenRing& seen_ring(const Recording& recording) {
  static std::map<const Recording*, SeenRing> rings;
  SeenRing& ring = rings[&recording];
  if (ring.chain) return ring;
  ring.chain = std::make_unique<ProductChain>(recording, *method_named("precise"));
  for (const Shot& shot : recording.shots(Memory::kRing)) {
    ring.chain->observe(shot);
    ring.seen[shot.frame] = ring.chain->seen();
  }
  return ring;
}

using Stage = bool (*)(const SeenRing&, const Shot&);

bool circles(const SeenRing& ring, const Shot& shot) {
  constexpr double kReachDiameters = 0.75;
  bool all = true;
  for (const CirclePoint& point : ring.chain->reference().circles) {
    const DetectedCircle& then = *ring.at(shot).markers[point.marker].circle;
    all &=
        !find_circles_near(shot.picture, then.centre, then.diameter_px, kReachDiameters * then.diameter_px, {}).empty();
  }
  return all;
}

bool rasters(const SeenRing& ring, const Shot& shot) {
  const Reference& reference = ring.chain->reference();
  bool all = true;
  for (std::size_t i = 0; i < reference.plans.size(); ++i)
    all &= read_patch(shot.picture, 8, ring.view(shot), reference.plans[i], ring.moved(shot, i)).valid;
  return all;
}

bool templates(const SeenRing& ring, const Shot& shot) {
  const Reference& reference = ring.chain->reference();
  bool all = true;
  for (std::size_t i = 0; i < reference.prints.size(); ++i)
    all &= read_points(shot.picture, ring.view(shot), {*reference.site.markers[i].grating, ring.moved(shot, i)},
                       *reference.prints[i])
               .has_value();
  return all;
}

bool outline(const SeenRing& ring, const Shot& shot) {
  const Reference& reference = ring.chain->reference();
  const std::size_t i = ring.chain->target();
  const auto never = [](Extent<frame::Board>) { return false; };
  return verify_fringe_order(shot.picture, ring.view(shot), {*reference.site.markers[i].grating, ring.moved(shot, i)},
                             *reference.prints[i]->outline, never)
             .order == Order::kProven;
}

bool fit_ring(const SeenRing& ring, const Shot& shot) {
  const auto reading = ring.chain->solve(ring.seen.at(shot.frame));
  benchmark::DoNotOptimize(reading);
  return reading.u.y > 0.0;
}

// This stage and the next one are done once per run, not once per frame.
bool reference(const SeenRing& ring, const Shot& shot) {
  auto made = make_reference({shot.picture, 8}, ring.chain->reference().site, Camera{}, {});
  if (made) method_named("precise")->prepare({shot.picture, 8}, *made);
  return made.has_value();
}

bool scene(const SeenRing& ring, const Shot&) {
  Observations run(ring.chain->reference());
  for (const auto& [frame, one] : ring.seen) run.append(one, 0, 1);
  return method_named("precise")->solve(ring.chain->reference(), run, {}).scene->solved;
}

void add(const char* name, Stage stage) {
  add_cases(std::string("stage ") + name, {Memory::kRing}, [stage](const Recording& recording) {
    const SeenRing& ring = seen_ring(recording);
    auto work = std::make_shared<Work>();
    work->bytes = recording.window_bytes();
    work->frame = [stage, &ring](const Shot& shot) { return stage(ring, shot); };
    return work;
  });
}

}  // namespace

void add_stage_cases() {
  add("circles", circles);
  add("rasters", rasters);
  add("templates", templates);
  add("outline", outline);
  add("fit and u", fit_ring);
  add("reference", reference);
  add("scene", scene);
}

}  // namespace moiregauge::internal::bench
