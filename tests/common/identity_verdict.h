// SPDX-License-Identifier: Apache-2.0
// Who was taken for what in a crowded scene, against the simulator's truth.
#pragma once

#include <string>

#include "common/crowded_scene.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::test {

enum class Verdict {
  kRight,    // the four references are references, each with its own grating; the target is a target; nothing else but
             // the spare
  kRefused,  // no reference frame, and words why
  kExtra,    // as right, but a look-alike that stands still counts as a fifth reference; the displacement is right
  kWrong     // anything else: silently wrong
};
[[nodiscard]] const char* word_for(Verdict verdict);

struct IdentityVerdict {
  Verdict verdict = Verdict::kRefused;
  std::string words;      // the refusal, or what is wrong
  double error_mm = 0.0;  // of the target's displacement in the moved frame; NaN: not measured
  double u_mm = 0.0;
};

enum class Knowledge { kSite, kPitchOnly };

struct Shots {
  Image<std::uint8_t> at_rest, moved;
};
[[nodiscard]] Shots shots_of(const CrowdedScene& scene);

[[nodiscard]] IdentityVerdict judged(const CrowdedScene& scene, const Shots& shots, Knowledge knowledge);

}  // namespace moiregauge::internal::test
