// SPDX-License-Identifier: Apache-2.0
// Channel: a linear combination of displacements, rotations and functions of targets, with a name and a unit.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace moiregauge::internal {

// Values that a channel combines. All are changes since the reference frame; positions are those of the site.
enum class TermKind {
  kDx,        // displacement of one target, mm
  kDy,        // displacement of one target, mm
  kRotation,  // one target in its own plane, mrad, counter-clockwise
  kChord,     // distance of two targets, mm
  kSag,       // distance of the second target from the line through the first and the third, mm, positive on its left
  kLineRotation,  // line through two or more targets, mrad, counter-clockwise
  kStrain         // relative distance of two targets, um/m
};

struct ChannelTerm {
  TermKind kind = TermKind::kDx;
  std::vector<std::size_t> targets;  // indices in the list of targets
  double factor = 1.0;
};

struct Channel {
  std::string name;
  std::string unit;  // "mm", "mrad", "um/m", or as stated
  std::vector<ChannelTerm> terms;
  double constant = 0.0;
  std::string text;  // as written, without the name
};

// A channel as a site file states it.
struct ChannelText {
  std::string name;
  std::string unit;  // empty: that of the expression
  std::string expression;
};

}  // namespace moiregauge::internal
