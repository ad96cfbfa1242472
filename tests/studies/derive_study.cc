// SPDX-License-Identifier: Apache-2.0
// Coverage of u of derived channels over simulated runs, one row per channel.
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "studies/derive_cases.h"
#include "studies/in_parallel.h"

namespace moiregauge::internal::study {
namespace {

constexpr double kInterval = 1.96;  // coverage factor k for 95 % of a normal distribution

struct ChannelTally {
  std::vector<double> error, u, by_hand, share;
  [[nodiscard]] double coverage() const {
    double sum = 0.0;
    for (const double of_run : share) sum += of_run / static_cast<double>(share.size());
    return 100.0 * sum;
  }
  // Standard error from the scatter between runs, whose frames share errors.
  [[nodiscard]] double of_coverage() const {
    return 100.0 * test::scatter(share) / std::sqrt(static_cast<double>(share.size()));
  }
};

std::map<std::string, ChannelTally> tallies_of(const std::vector<DerivedRun>& runs) {
  std::map<std::string, ChannelTally> tallies;
  for (const DerivedRun& run : runs) {
    if (!run.problem.empty()) std::fprintf(stderr, "a run has no values: %s\n", run.problem.c_str());
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
  return tallies;
}

void print_channels(const std::vector<DerivedRun>& runs) {
  fmt::print(
      "| channel | rows | coverage, % | scatter | u | u / scatter | by hand / scatter |\n"
      "|---|---|---|---|---|---|---|\n");
  auto tallies = tallies_of(runs);
  for (const std::string& text : study_channels()) {
    const ChannelTally& t = tallies[text.substr(0, text.find(' '))];
    // A function also has the u of positions, which no sum of displacements' variances contains.
    const bool is_sum = text.find('.') != std::string::npos && text.find(".rotation") == std::string::npos;
    fmt::print("| `{}` | {} | {:.1f} +- {:.1f} | {:.4g} | {:.4g} | {:.2f} | {} |\n", text, t.error.size(), t.coverage(),
               t.of_coverage(), test::rms(t.error), test::rms(t.u), test::rms(t.u) / test::rms(t.error),
               is_sum ? fmt::format("{:.2f}", test::rms(t.by_hand) / test::rms(t.error)) : "-");
  }
}

void print_zeros(const std::vector<DerivedRun>& runs) {
  auto tallies = tallies_of(runs);
  const ChannelTally alone = tallies["reference frame"];
  // Independent noise of equal size: sqrt(1 + 1/N) instead of sqrt(2).
  const double theory = std::sqrt((1.0 + 1.0 / kZeroFrames) / 2.0);
  fmt::print(
      "\n| `mid.dy` relative to | rows | coverage, % | scatter, um | u, um | u / scatter | u / u of the first row | "
      "theory |\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, shown] :
       {std::pair{"reference frame", "the reference frame"}, {"zero", "the mean of 30 frames"}}) {
    const ChannelTally& t = tallies[name];
    fmt::print("| {} | {} | {:.1f} +- {:.1f} | {:.3f} | {:.3f} | {:.2f} | {:.3f} | {:.3f} |\n", shown, t.error.size(),
               t.coverage(), t.of_coverage(), 1000.0 * test::rms(t.error), 1000.0 * test::rms(t.u),
               test::rms(t.u) / test::rms(t.error), test::rms(t.u) / test::rms(alone.u),
               name == std::string("zero") ? theory : 1.0);
  }
}

}  // namespace
}  // namespace moiregauge::internal::study

// The first argument is the number of runs, 200 without it.
int main(int argc, char** argv) {
  using namespace moiregauge::internal::study;
  const int count = argc > 1 ? std::stoi(argv[1]) : 200;
  const auto seed = [](int n) { return static_cast<std::uint64_t>(n) + 1; };
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // a killed study keeps its first table
  print_channels(in_parallel("derived channels", count, [&](int n) { return derived_run(seed(n)); }));
  print_zeros(in_parallel("zeros", count, [&](int n) { return zeroed_run(seed(n)); }));
}
