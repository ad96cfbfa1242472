// SPDX-License-Identifier: Apache-2.0
// Measures all figures of the section "Real photographs" of docs/accuracy.md and prints it. Uses the photographs of the
// folder in the first argument, by default tests/real/data.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "real/real_calibration.h"
#include "real/real_lattices.h"
#include "real/real_pictures.h"

namespace moiregauge::internal {
namespace {

using test::Landmarks;
using test::LatticeNull;
using test::LatticeView;
using test::PhotoSet;

std::string indexed(const std::vector<LatticeView>& views) {
  std::size_t lattices = 0, whole = 0, fewest = 0, most = 0;
  for (const LatticeView& view : views) {
    if (view.lattices.empty()) continue;
    const IndexedLattice& largest = view.lattices.front();
    fewest = lattices == 0 ? largest.points.size() : std::min(fewest, largest.points.size());
    most = std::max(most, largest.points.size());
    ++lattices;
    whole += largest.whole() ? 1 : 0;
  }
  const std::string points = fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most);
  return fmt::format("{} of {} | {} | {}", lattices, views.size(), points, whole);
}

void print_null(const std::string& name, const std::string& targets, const std::string& references,
                std::vector<LatticeNull> nulls) {
  std::erase_if(nulls, [](const LatticeNull& n) { return n.targets == 0; });
  if (nulls.empty()) return;
  std::sort(nulls.begin(), nulls.end(), [](const auto& a, const auto& b) { return a.rms_px < b.rms_px; });
  const double median = 0.5 * (nulls[(nulls.size() - 1) / 2].rms_px + nulls[nulls.size() / 2].rms_px);
  fmt::print("| {} | {} | {} | {} | {:.3f} | {:.3f} |\n", name, targets, references, nulls.size(), median,
             nulls.back().rms_px);
}

struct SetViews {
  PhotoSet set;
  std::vector<LatticeView> views;
};

// Returns true if all points are at least one pitch from the edge of the image, where the distortion is largest.
bool clear_of_frame(const LatticeView& view) {
  if (view.lattices.empty()) return false;
  const IndexedLattice& lattice = view.lattices.front();
  const double right = width_of(view_of(view.picture)) - 1, low = height_of(view_of(view.picture)) - 1;
  return std::all_of(lattice.points.begin(), lattice.points.end(), [&](const LatticePoint& p) {
    return std::min({p.at.x, p.at.y, right - p.at.x, low - p.at.y}) - 0.5 * p.size_px >= lattice.pitch_px;
  });
}

void print_nulls(const SetViews& s) {
  const std::string by = s.set.kind == LatticeKind::kDots ? "dots" : "corners";
  const LatticeView& first = s.views.front();
  std::vector<LatticeNull> all, clear;
  for (std::size_t i = 1; i < s.views.size(); ++i) {
    all.push_back(test::null_between(first.places, s.views[i].places));
    if (clear_of_frame(s.views[i])) clear.push_back(all.back());
  }
  print_null(s.set.name, by, "outermost points", all);
  if (s.set.landmarks == Landmarks::kLargeDot)
    print_null(s.set.name, by + ", a pitch clear of the frame", "outermost points", clear);
  if (s.set.landmarks != Landmarks::kDiscs) return;  // other lattices have too few periods for a phase
  const LatticeView& second = s.views[1];
  const auto phases = test::phase_places(first, second, s.set.kind);
  print_null(s.set.name, "lattice phase", "outermost patches", {test::null_between(phases.first, phases.second)});
  print_null(s.set.name, by, "discs", {test::null_by_discs(first.places, second.places, first.discs, second.discs)});
  print_null(s.set.name, "lattice phase", "discs",
             {test::null_by_discs(phases.first, phases.second, first.discs, second.discs)});
}

// Prints the lens solved from the set's views, and the set's nulls with and without it.
void print_lens(const SetViews& s) {
  const BoardCalibration solved = test::calibrated(s.views);
  const auto row = [&](const std::string& targets, double raw, double raw_worst, double null, double worst) {
    fmt::print("| {} | {:.1f} | {:.1f} | {:.3f} | {:.3f} | {} of {} | {} | {:.3f} / {:.3f} | {:.3f} / {:.3f} |\n",
               s.set.name, solved.camera.fx, solved.u[0], solved.rms_px, solved.point_px, solved.matched,
               s.views.size(), targets, raw, raw_worst, null, worst);
  };
  row(s.set.kind == LatticeKind::kDots ? "dots" : "corners", test::median_null(s.views, {}),
      test::worst_null(s.views, {}), test::median_null(s.views, solved.camera),
      test::worst_null(s.views, solved.camera));
  if (s.set.landmarks != Landmarks::kDiscs) return;
  const auto phases = test::phase_places(s.views[0], s.views[1], s.set.kind);
  const double raw = test::null_between(phases.first, phases.second).rms_px;
  const double null = test::null_between(test::without_lens(phases.first, solved.camera),
                                         test::without_lens(phases.second, solved.camera))
                          .rms_px;
  row("lattice phase", raw, raw, null, null);
}

void print_measured(const char* method) {
  const Measurement centre = test::real_run("board-checker", method);
  const Measurement nine = test::real_run("board-checker", method, test::nine_patches("board-checker"));
  const double px = centre.reference->view.mm_per_px({0, 0});
  const Sample& sample = test::second_view(centre);
  fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} / {:.3f} | {} |\n", method, test::null_px(centre),
             test::rms_null_px(nine), sample.u.x / px, sample.u.y / px, word_for(sample.status));
}

void print_acceptance(const SetViews& s) {
  const bool dots = s.set.kind == LatticeKind::kDots;
  const auto a = dots ? test::dots_accepted(s.views) : test::squares_accepted(s.views);
  fmt::print("| {} | {} | {:.0f} | {} | {} | {:.2f} % |\n", s.set.name, dots ? "dots" : "squares", a.median_diameter_px,
             a.there, a.accepted, 100.0 * a.share());
}

}  // namespace
}  // namespace moiregauge::internal

int main(int argc, char** argv) {
  using namespace moiregauge::internal;
  const std::string data = argc > 1 ? argv[1] : MOIREGAUGE_SOURCE_DIR "/tests/real/data";
  std::vector<SetViews> sets;
  for (const PhotoSet& set : test::kPhotoSets) sets.push_back({set, test::lattice_views(data, set)});
  fmt::print(
      "Made by `tools/real-study` from the photographs of tests/real/data, without a lens model. The boards are rigid, "
      "so every figure is an error.\n\n"
      "Lattices: the largest of each view. Whole: every place of its rectangle was seen; some views cut the board off, "
      "and `board-dots` lies at 45 degrees.\n\n"
      "| set | views indexed | points | whole |\n|---|---|---|---|\n");
  for (const SetViews& s : sets) fmt::print("| {} | {} |\n", s.set.name, indexed(s.views));
  fmt::print(
      "\nNulls: the rms length, in px, of the difference between a view and the first one mapped by the homography of "
      "four references. Outermost points or patches: all the others are targets. Discs: those round the lattice.\n\n"
      "| set | targets | references | views | median | worst |\n|---|---|---|---|---|---|\n");
  for (const SetViews& s : sets) print_nulls(s);
  fmt::print(
      "\nThe lens of each set, solved by the functions of `calibrate` from the set's own views alone. Scatter: the "
      "scatter of a point, without the print's own errors, in the views that were recognised by these. Nulls as above "
      "(outermost points), median / worst, with and without lens correction.\n\n"
      "| set | f, px | u | rms, px | scatter, px | recognised | targets | lens in | lens out |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const SetViews& s : sets) print_lens(s);
  if (argc <= 1) {
    fmt::print(
        "\n`board-checker` measured as a recording of two frames, lens unknown: the null of its centre, and the rms of "
        "nine patches of two periods each, px.\n\n"
        "| method | centre | nine patches | u of the centre, x / y | status |\n|---|---|---|---|---|\n");
    for (const char* method : {"two-stage", "precise"}) print_measured(method);
  }
  fmt::print(
      "\nThe circle test (W > 0.84 and the ellipse test) on real prints, in the whole picture, from {:.0f} px upwards. "
      "What is "
      "there is said by the neighbours on the lattice, never by the circle itself.\n\n"
      "| set | what | size, px | there | accepted as circles | share |\n|---|---|---|---|---|---|\n",
      DotSearchOptions{}.min_diameter_px);
  for (const SetViews& s : sets) print_acceptance(s);
}
