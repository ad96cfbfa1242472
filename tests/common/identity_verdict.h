// SPDX-License-Identifier: Apache-2.0
// Comparison of an identification in a crowded scene with the simulator's truth.
#pragma once

#include <string>

#include "common/crowded_scene.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::test {

enum class Verdict {
  // The four references are references, each with its own grating. The target is a target. No other marker counts but
  // the spare one.
  kRight,
  kRefused,  // no reference frame, with the reason
  // As kRight, but a fixed false candidate counts as a fifth reference. The displacement is right.
  kExtra,
  kWrong  // anything else, without an error
};
[[nodiscard]] const char* word_for(Verdict verdict);

struct IdentityVerdict {
  Verdict verdict = Verdict::kRefused;
  std::string words;      // text of the refusal or of the errors
  double error_mm = 0.0;  // error of the target's displacement in the moved frame; NaN: not measured
  double u_mm = 0.0;
};

enum class Knowledge { kSite, kPitchOnly };

struct Shots {
  Image<std::uint8_t> at_rest, moved;
};
[[nodiscard]] Shots shots_of(const CrowdedScene& scene);

[[nodiscard]] IdentityVerdict judged(const CrowdedScene& scene, const Shots& shots, Knowledge knowledge);

}  // namespace moiregauge::internal::test
