// SPDX-License-Identifier: Apache-2.0
// Runs a measurement: reads frames, stores observations, computes samples. It opens no files: frames come from a
// FrameSource.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/observation/reference/site_from_picture.h"
#include "moiregauge/results/derived/channel.h"
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
  Site site;                       // not used if pitch_mm is given
  std::optional<double> pitch_mm;  // no site file: the site is detected in the reference frame
  PrintScale print_scale;          // print scale of the rulers; `site` and `pitch_mm` already include it
  BoardAxes axes = BoardAxes::kPrint;
  std::optional<Camera> camera;
  FrameRange frames;
  SolveOptions solve;
  std::optional<long> reference_frame;  // none: the first selected frame that can be measured
  ObserveOptions observe;
  std::optional<FrameRange>
      zero;                       // displacements are relative to the mean over these frames; none: the reference frame
  MarkerChoice choice;            // `site` already follows it; for a site that is detected
  std::optional<ToneCurve> tone;  // none: the input's curve, or the one that its gratings show
  std::vector<ChannelText> channels;  // those of the site file, for `derive`
};

// Copy of the reference frame for the overlay, 8 bits. If no frame could be measured, it is the first one that was
// tried.
struct KeptPicture {
  Image<std::uint8_t> grey;
};

// Observations of all frames: enough to solve again without the video.
struct ObservationLog {
  InputInfo input;
  std::optional<Reference> reference;  // none: refused before anything was measured
  Observations observations;
  std::vector<std::string> notes;  // notes for the user on input and reference frame
  std::string refusal;             // reason why nothing can be measured; empty otherwise
  CameraProcessing processing;     // evidence of processing inside the camera
  bool input_damaged = false;
  bool interrupted = false;
};

struct Measurement : ObservationLog {
  Samples samples;
  std::vector<double> chi2_dof;   // chi-squared per degree of freedom by observation; NaN: not fitted; empty: no scene
  std::optional<Scene> scene;     // none: the method solves no scene
  std::vector<CameraPose> poses;  // by observation; empty: no scene was solved
  bool references_verified = false;
  std::vector<TargetSummary> targets;
  std::vector<TargetSpectra> spectra;  // in the order of `targets`
  KeptPicture picture;
  std::string remedy;                 // action for the user if samples are untrusted, imperative; empty: none known
  std::vector<std::string> warnings;  // notes and warnings of the solution
  // Statement of the user that the input contradicts, as "what happened: where"; empty otherwise. Such a run has no
  // results. Its samples, if any, were computed without the statement.
  std::string contradiction;
  Exit exit = Exit::kInternalError;
};

// Returns the solved scene if its values are trustworthy. Returns nothing if no scene was solved or the run was
// refused.
[[nodiscard]] const std::optional<Scene>& stated_scene(const Measurement& measurement);

// Returns the site of the reference frame if there is one, otherwise the user's site.
[[nodiscard]] const Site& site_of(const Measurement& measurement, const MeasureOptions& options);

// Receives the number of frames done and expected (-1: unknown) after every frame. Returns false to stop (Ctrl-C).
using OnProgress = std::function<bool(long done, long expected)>;
using OpenInput = std::function<tl::expected<std::unique_ptr<FrameSource>, InputError>()>;

// Sinks for results during a run, and the observations of an unfinished run.
struct RunHooks {
  FrameSink* frames = nullptr;     // receives every selected frame with its observation
  JournalSink* journal = nullptr;  // receives observations that `so_far` does not contain
  ObservationLog so_far = {};      // journaled observations, from the first selected frame on
};

// Observes all selected frames. A resumed run gives the same result as an uninterrupted one: it skips observed frames,
// but replays them to the Follower.
// Fails only if the input has no image, or if it is not the input of `so_far`. All other problems are part of the
// Measurement.
[[nodiscard]] tl::expected<Measurement, InputError> observe_all(const OpenInput& open, const MeasureOptions& options,
                                                                const OnProgress& on_progress, RunHooks doors = {});

// Returns the contradiction of options that need times with an input without them, as "what happened: where".
[[nodiscard]] std::optional<std::string> time_problem(const MeasureOptions& options, const InputInfo& input);

// Note on a run without times.
inline constexpr char kNoTimesNote[] =
    "note: time_s is NaN and there are no spectra, because the images have no times. Give --fps";

// Completes frames before the reference frame, when the number of markers was unknown: all their markers become not
// seen.
void complete_markers(ObservationLog& seen);

// Computes samples, summaries and the exit code from the observations. Image and reference frame stay unchanged.
// `solve` uses it again.
// `joint`: if not null, receives the joint errors of the samples, as they are without options.zero.
void evaluate(const MeasureOptions& options, Measurement& out, JointErrors* joint = nullptr);

// Calls observe_all and evaluate.
[[nodiscard]] tl::expected<Measurement, InputError> measure(const OpenInput& open, const MeasureOptions& options,
                                                            const OnProgress& on_progress, FrameSink* frames = nullptr);

}  // namespace moiregauge::internal
