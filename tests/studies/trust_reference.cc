// SPDX-License-Identifier: Apache-2.0
#include "studies/trust_reference.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "studies/in_parallel.h"
#include "studies/slipping_reference.h"

namespace moiregauge::internal::study {
namespace {

struct Outcome {
  bool measured = false, verified = false, alarmed = false, named = false, named_another = false;
};

Outcome outcome_of(const Slip& slip, const std::optional<Solution>& solution) {
  Outcome out;
  if (!solution) return out;
  out.measured = true;
  out.verified = solution->references_verified;
  for (const std::string& note : solution->notes) {
    const bool excluded = note.find("is not used, because it moves") != std::string::npos;
    out.alarmed |= excluded || note.find("one of the references moves") != std::string::npos;
    const bool right = note.find("'" + slip.who + "'") != std::string::npos;
    out.named |= excluded && right, out.named_another |= excluded && !right;
  }
  out.alarmed |= std::any_of(solution->samples.begin(), solution->samples.end(),
                             [](const Sample& s) { return s.status != Status::kOk; });
  return out;
}

struct ReferenceRow {
  std::string name;
  SlipKind kind;
  double draws = 1.0;  // share of the requested number of draws
};

std::vector<ReferenceRow> table() {
  std::vector<ReferenceRow> all;
  const auto add = [&](int references, Layout layout, bool lens_known, double slip_px, Footage footage, double draws) {
    all.push_back(
        {fmt::format("{} {}, lens {}{}{}", references, layout == Layout::kRows ? "in two rows" : "distributed",
                     lens_known ? "known" : "unknown", slip_px > 0.0 ? "" : ", none slips",
                     footage == Footage::kPictures ? ", pictures" : ""),
         {references, layout, lens_known, slip_px, footage},
         draws});
  };
  for (const double px : {0.2, 0.0}) {
    for (const Layout layout : {Layout::kRows, Layout::kScattered}) {
      for (const bool known : {false, true}) add(6, layout, known, px, Footage::kPoints, px > 0.0 ? 0.25 : 0.15);
    }
  }
  for (const double px : {0.2, 0.0}) add(6, Layout::kRows, false, px, Footage::kPictures, 0.05);
  for (const int n : {8, 5, 4}) {
    for (const bool known : {false, true}) add(n, Layout::kRows, known, 0.2, Footage::kPoints, 0.06);
  }
  return all;
}

}  // namespace

void print_reference_faults(int draws, const std::string& only, bool verbose) {
  fmt::print(
      "| references | draws | noticed, % | right one named, % | another named, % | \"verified\", % "
      "|\n|---|---|---|---|---|---|\n");
  for (const ReferenceRow& row : table()) {
    if (!row.name.starts_with(only)) continue;
    const int count = std::max(1, static_cast<int>(draws * row.draws));
    const auto outcomes = in_parallel(row.name.c_str(), count, [&](int n) {
      const Slip slip = drawn_slip(row.kind, n);
      const Outcome out = outcome_of(slip, measured(slip, row.kind.footage));
      if (verbose && (row.kind.slip_px > 0.0 ? !out.named : out.alarmed || !out.measured))
        std::fprintf(stderr, "  draw %d: %s from %ld on: measured %d noticed %d named %d another %d\n", n,
                     slip.who.c_str(), slip.when, out.measured, out.alarmed, out.named, out.named_another);
      return out;
    });
    const auto percent = [&](bool Outcome::*what) {
      const auto k = std::count_if(outcomes.begin(), outcomes.end(), [what](const Outcome& o) { return o.*what; });
      const auto n = std::count_if(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.measured; });
      return fmt::format("{:.1f}", 100.0 * double(k) / double(std::max<long>(1, n)));
    };
    const auto n = std::count_if(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.measured; });
    fmt::print("| {} | {} of {} | {} | {} | {} | {} |\n", row.name, n, count, percent(&Outcome::alarmed),
               percent(&Outcome::named), percent(&Outcome::named_another), percent(&Outcome::verified));
    std::fflush(stdout);
  }
}

}  // namespace moiregauge::internal::study
