// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

namespace moiregauge::internal::study {

using Dice = std::mt19937_64;

inline double uniform(Dice& dice, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(dice);
}

}  // namespace moiregauge::internal::study
