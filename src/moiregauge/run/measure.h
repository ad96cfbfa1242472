// SPDX-License-Identifier: Apache-2.0
// A whole run: frames in, observations kept, samples out. No files here: pictures come through a FrameSource.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/observation/reference/site_from_picture.h"
#include "moiregauge/results/peaks.h"
#include "moiregauge/results/summary.h"
#include "moiregauge/run/camera_processing.h"
#include "moiregauge/run/frame_sink.h"
#include "moiregauge/run/frame_source.h"
#include "moiregauge/run/journal_sink.h"
#include "moiregauge/site/print_scale.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

struct MeasureOptions {
  const Method* method = nullptr;
  Site site;                       // not used when pitch_mm is given
  std::optional<double> pitch_mm;  // no site file: the site is made from the reference frame
  PrintScale print_scale;          // of the rulers; site and pitch_mm have it in them already
  BoardAxes axes = BoardAxes::kPrint;
  std::optional<Camera> camera;
  FrameRange frames;
  SolveOptions solve;
  std::optional<long> reference_frame;  // empty: the first frame of the selection that can be measured
  ObserveOptions observe;
  std::optional<ToneCurve> tone;  // empty: as the input says, or as its prints show
};

// A copy of the reference frame (or of the first frame looked at, when none could be measured), 8 bits, for the
// overlay.
struct KeptPicture {
  Image<std::uint8_t> grey;
};

// What the frames told, before anything is concluded from it: all that is needed to solve again without them.
struct ObservationLog {
  InputInfo input;
  std::optional<Reference> reference;  // empty: refused before anything was measured
  Observations observations;
  std::vector<std::string> notes;  // what the user should know about input and reference frame
  std::string refusal;             // why nothing is or can be measured, in words; empty otherwise
  CameraProcessing processing;     // what the pixels show of the camera's own
  bool input_damaged = false;
  bool interrupted = false;
};

struct Measurement : ObservationLog {
  Samples samples;
  std::vector<double> chi2_dof;  // as Solution has it
  std::optional<Scene> scene;    // of a method that solves one
  bool references_verified = false;
  std::vector<TargetSummary> targets;
  std::vector<TargetSpectra> spectra;  // in the order of targets
  KeptPicture picture;
  std::string remedy;  // where rows are not trusted: what to do, as an order; empty where the pictures must show it
  std::vector<std::string> warnings;  // the notes, and those of the solution
  // "what: where" of a statement of the user that the input contradicts, empty otherwise: there are no results then.
  // Samples, where there are any, are made without it.
  std::string contradiction;
  Exit exit = Exit::kInternalError;
};

// The solved scene where its numbers may be stated; nothing where none was solved, or of a refused run.
[[nodiscard]] const std::optional<Scene>& stated_scene(const Measurement& measurement);

// The site measured by: the reference frame's, where there is one; otherwise what the user gave.
[[nodiscard]] const Site& site_of(const Measurement& measurement, const MeasureOptions& options);

// Called after every frame: frames done, frames expected (-1: unknown). Returns false to stop (Ctrl-C).
using OnProgress = std::function<bool(long done, long expected)>;
using OpenInput = std::function<tl::expected<std::unique_ptr<FrameSource>, InputError>()>;

// Where a run's findings go while it is under way, and what an earlier, unfinished one found.
struct RunHooks {
  FrameSink* frames = nullptr;     // handed every selected frame with what was seen in it
  JournalSink* journal = nullptr;  // handed what was seen in frames that `so_far` does not hold
  ObservationLog so_far = {};      // frames from the beginning of the selection on, as the journal was given them
};

// What is seen in all frames. Fails only when the input gives no picture at all, or is not the one that `so_far` is of;
// every other trouble is part of the Measurement. A run that goes on gives what it would have given in one piece:
// frames that were seen are passed over, and the Follower is told of them.
[[nodiscard]] tl::expected<Measurement, InputError> observe_all(const OpenInput& open, const MeasureOptions& options,
                                                                const OnProgress& on_progress, RunHooks doors = {});

// Frames that went by before the reference frame told how many markers there are: their markers, all of them not seen.
void complete_markers(ObservationLog& seen);

// The end of every run: what was seen turned into samples, summaries and an exit code; picture and reference frame stay
// as they are. Used again by `solve`.
void evaluate(const MeasureOptions& options, Measurement& out);

// Both.
[[nodiscard]] tl::expected<Measurement, InputError> measure(const OpenInput& open, const MeasureOptions& options,
                                                            const OnProgress& on_progress, FrameSink* frames = nullptr);

}  // namespace moiregauge::internal
