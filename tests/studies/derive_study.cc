// SPDX-License-Identifier: Apache-2.0
// Coverage of u of derived channels over simulated runs, one row per channel.
#include <cmath>
#include <cstdio>
#include <string>

#include <fmt/format.h>

#include "studies/derive_cases.h"
#include "studies/in_parallel.h"

namespace moiregauge::internal::study {
namespace {

constexpr double kInterval = 1.96;  // coverage factor k for 95 % of a normal distribution

struct ChannelTally {
  std::vector<double> error, u, by_hand, share;
};

void print_rows(const std::vector<DerivedRun>& runs) {
  std::map<std::string, ChannelTally> tallies;
  int lost = 0;
  for (const DerivedRun& run : runs) {
    lost += !run.problem.empty();
    for (const auto& [name, channel] : run.channels) {
      ChannelTally& tally = tallies[name];
      int inside = 0;
      for (std::size_t k = 0; k < channel.error.size(); ++k)
        inside += std::abs(channel.error[k]) < kInterval * channel.u[k];
      if (!channel.error.empty()) tally.share.push_back(inside / static_cast<double>(channel.error.size()));
      tally.error.insert(tally.error.end(), channel.error.begin(), channel.error.end());
      tally.u.insert(tally.u.end(), channel.u.begin(), channel.u.end());
      tally.by_hand.insert(tally.by_hand.end(), channel.u_by_hand.begin(), channel.u_by_hand.end());
    }
  }
  for (const std::string& text : study_channels()) {
    const ChannelTally& t = tallies[text.substr(0, text.find(' '))];
    double coverage = 0.0;
    for (const double share : t.share) coverage += share / static_cast<double>(t.share.size());
    const double of_mean = test::scatter(t.share) / std::sqrt(static_cast<double>(t.share.size()));
    fmt::print("| `{}` | {} | {:.1f} +- {:.1f} | {:.4g} | {:.4g} | {:.2f} | {:.2f} |\n", text, t.error.size(),
               100.0 * coverage, 100.0 * of_mean, test::rms(t.error), test::rms(t.u),
               test::rms(t.u) / test::rms(t.error), test::rms(t.by_hand) / test::rms(t.error));
  }
  if (lost > 0) fmt::print("\n{} runs had no values.\n", lost);
}

}  // namespace
}  // namespace moiregauge::internal::study

int main(int argc, char** argv) {
  using namespace moiregauge::internal::study;
  const int count = argc > 1 ? std::stoi(argv[1]) : 200;
  fmt::print(
      "| channel | rows | coverage, % | scatter | u | u / scatter | by hand / scatter "
      "|\n|---|---|---|---|---|---|---|\n");
  const auto runs =
      in_parallel("derived channels", count, [](int n) { return derived_run(static_cast<std::uint64_t>(n) + 1); });
  print_rows(runs);
}
