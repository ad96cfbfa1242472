// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/rolling_shutter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/model/fast_vibration.h"
#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kReadoutRounds = 10;       // chosen
constexpr int kTiltRounds = 2;           // more rounds, with the tilts of prints; chosen
constexpr double kConvergedShare = 0.1;  // readout converged: change relative to its own u; chosen
// Largest factor between the readout times of two rounds. The scene of the first round assumes the prior's readout time
// and can be far off, and so can the step from it. Chosen.
constexpr double kMaxReadoutFactor = 3.0;
// Largest chi2/dof of a scene whose slope counts. Above it Huber's loss shaped the scene, and its slope of chi2 is no
// measure of the distance from the minimum. Chosen.
constexpr double kScenesFit = 2.0;
// Change of the readout time, in u, after which the process noise is estimated again. The earlier estimate contains the
// error of the earlier scene, and the wide prior would keep that error. Chosen.
constexpr double kMovedReadout = 3.0;
// Prior of an unknown readout time, that of a phone: s, and relative u. For motion faster than half the frame rate only
// this prior determines it. Chosen.
constexpr double kUsual = 0.018, kUsualWithin = 0.5;
constexpr double kSureReadout = 3.0;  // least readout time that counts, in u; chosen
// Readout time, in u, and share of the chi2/dof without readout. Beyond the first and below the second no other start is
// tried, although errors of the scene remain, for example tilts of the prints. Chosen.
constexpr double kVerySureReadout = 30.0, kNearlyAll = 0.1;
constexpr double kShortest = 0.01;  // least readout time: relative to the frame interval or 0.1 s, the smaller; chosen
// Relative u from the splines. In simulated runs the error is a thousandth.
constexpr double kReadoutOfPath = 0.002;
// Round after which a search without gain ends, and the share of the chi2/dof without readout that then remains. The
// second share counts if the readout time is clear. A simulated rolling shutter leaves less than a tenth after two
// rounds. Two moving references leave more than half, a creeping one nine tenths. Chosen.
constexpr int kFairTrial = 2;
constexpr double kNoGain = 0.5, kNoGainIfClear = 0.75;
constexpr double kMaxWidening = 1e6;  // limit of the factor on the process noise; chosen

// Frames corrected to frame time, one at a time.
struct SetBack {
  const Site& site;
  FrameSeries given;
  Scene scene;
  std::vector<FrameStart> read;  // poses and shifts that the correction used
  std::vector<FrameMotion> motions;
  double readout_s = 0.0;
  ReadoutDirection run = ReadoutDirection::kDown;

  [[nodiscard]] BundleFrame frame(std::size_t k) const {
    BundleFrame seen = given[k];
    // The fit starts from the pose that the prior's camera gives, so restore it afterwards.
    const Pose pose = std::exchange(seen.pose, read[k].pose);
    const auto shift = std::exchange(seen.shift, read[k].shift);
    seen.time_s = read[k].time_s;
    BundleFrame out = to_frame_time(site, scene, seen, {motions[k], read.front().pose}, {readout_s, run});
    out.pose = pose;
    out.shift = shift;
    return out;
  }
};

// Part of a frame fit that is kept for all frames.
struct FitSummary {
  bool ok = false;
  Pose pose;
  PathPlace path_variance = PathPlace::Zero();
  std::vector<std::optional<Extent<frame::Board>>> shift;  // one per site marker; empty if not fitted
  std::vector<Extent<frame::Board>> variance;              // variances of the shifts, mm^2
  double chi2_sum = 0.0;
  long dof = 0;
  Motion motion = Motion::Zero();
  std::optional<Motion> motion_variance;
};

FitSummary summary_of(const FrameFit& fit, bool has_motion) {
  FitSummary out;
  out.ok = fit.ok;
  out.pose = fit.pose;
  out.shift.resize(fit.shift_row.size());
  out.variance.resize(fit.shift_row.size());
  out.chi2_sum = fit.chi2_sum, out.dof = fit.dof;
  if (!fit.ok) return out;
  out.path_variance = path_variance(fit.pose, fit.pose_covariance);
  for (std::size_t i = 0; i < fit.shift_row.size(); ++i) {
    const int row = fit.shift_row[i];
    if (row < 0) continue;
    out.shift[i] = fit.shift[i];
    out.variance[i] = {fit.variance(row), fit.variance(row + 1)};
  }
  out.motion = fit.motion;
  if (has_motion) out.motion_variance = fit.variance.tail<kMotionParameters>();
  return out;
}

// Returns true if the readout time is clearly above zero and below its limit.
bool is_clear(const Shutter& s) { return !s.bounded && std::abs(s.readout_s) > kSureReadout * s.u_readout_s; }

class RollingShutterSolver {
 public:
  RollingShutterSolver(const ShutterTask& task, double side, double start)
      : site_(task.site),
        as_given_(task.frames),
        read_(task.frames.starts().begin(), task.frames.starts().end()),
        key_(task.key),
        prior_(task.prior),
        movements_(task.movements),
        chi2_dof_at_once_(task.chi2_dof_at_once),
        is_given_(task.readout_s.has_value()),
        side_(side),
        known_to_(is_given_ ? kGivenReadout : kUsualWithin) {
    scene_.camera = prior_.camera;
    scene_.markers = prior_.markers;
    order_.resize(read_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const bool timed = std::ranges::all_of(read_, [](const auto& f) { return std::isfinite(f.time_s); });
    for (FrameStart& f : read_) f.time_s = timed ? f.time_s : static_cast<double>(f.frame);
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return read_[a].time_s < read_[b].time_s; });
    std::vector<double> steps;
    for (std::size_t k = 1; k < order_.size(); ++k)
      steps.push_back(read_[order_[k]].time_s - read_[order_[k - 1]].time_s);
    if (steps.empty()) return;
    std::nth_element(steps.begin(), steps.begin() + static_cast<long>(steps.size() / 2), steps.end());
    out_.interval_s = steps[steps.size() / 2];
    expected_s_ = task.readout_s.value_or(side * std::min(kUsual, 0.5 * out_.interval_s));
    out_.readout_s = start * expected_s_;
    out_.u_readout_s = known_to_ * std::abs(expected_s_);
  }

  Shutter solved() {
    if (!(out_.interval_s > 0.0)) return without("there are too few frames to determine the camera's motion");
    note_rows();
    fits_ = fits_of(as_given_);
    take_poses();
    bool is_last = false, tilts = false;
    int last = kReadoutRounds;
    for (int round = 0;; ++round) {
      is_last = is_last || round == last;
      follow_path();
      const double before = out_.readout_s;
      // Poses of the first round assume a global shutter. They fit any readout time.
      if (round > 0) solve_readout();
      set_all_back();
      // Earlier rounds only improve the path, so they need no full convergence. Tilts would follow what is left of the
      // readout.
      out_.calibration =
          calibrate(site_, out_.frames.without_flawed_targets(key_), prior_,
                    {.until = is_last ? Until::kConverged : Until::kChi2Converged, .tilts = is_last || tilts});
      if (!out_.calibration.bundle.scene.solved) return without(out_.calibration.bundle.scene.problem);
      if (round == 0 && !(chi2_dof_at_once_ > 0.0)) chi2_dof_at_once_ = out_.calibration.shutter.chi2_dof;
      if (is_stuck(round)) return without("no readout time explains the frames");
      scene_ = out_.calibration.bundle.scene;
      fits_ = fits_of(out_.frames);
      take_poses();
      if (std::abs(out_.readout_s - before) > kMovedReadout * out_.u_readout_s) wider_.fill(1.0);
      widen();
      if (is_last && (tilts || !scene_.model.tilts)) break;
      if (is_last) {
        tilts = true;  // the path has yet to follow the scene with them
        last = round + kTiltRounds;
      }
      is_last = !is_last && round >= 2 && std::abs(out_.readout_s - before) < kConvergedShare * out_.u_readout_s;
    }
    count_cost();
    allow_for_fast_vibration();
    return std::move(out_);
  }

 private:
  Shutter without(std::string why) {
    out_.problem = std::move(why);
    return std::move(out_);
  }

  // Returns true if the search is stuck: the frames contradict the scene almost as without a readout time. References
  // that move do this. Each round then costs twenty times as much.
  [[nodiscard]] bool is_stuck(int round) const {
    const double chi2_dof = out_.calibration.shutter.chi2_dof;
    const double share = is_clear(out_) ? kNoGainIfClear : kNoGain;
    return !is_given_ && round >= kFairTrial && chi2_dof > std::max(kScenesFit, share * chi2_dof_at_once_);
  }

  // Stores the share of the readout time at which the middle of each grating is read.
  void note_rows() {
    for (std::size_t k = 0; k < as_given_.size(); ++k) {
      const BundleFrame frame = as_given_[k];
      row_share_.emplace_back(site_.markers.size(), 0.0);
      for (std::size_t i = 0; i < frame.points.size(); ++i) {
        if (frame.points[i])
          row_share_[k][i] = share_of_row(frame.points[i]->image[kPatchPoints / 2], prior_.camera, prior_.rows_run);
      }
    }
  }

  [[nodiscard]] FrameFit fit_of(BundleFrame frame) const {
    // Another focal length gives another pose, so start from the solved camera.
    frame.pose = pose_of(site_, scene_, frame).value_or(frame.pose);
    return fit_frame(site_, scene_, frame);
  }

  [[nodiscard]] std::vector<FitSummary> fits_of(const FrameSeries& frames) const {
    std::vector<FitSummary> fits;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const BundleFrame frame = frames.without_flawed_targets(k);
      fits.push_back(summary_of(fit_of(frame), frame.rows.has_value()));
    }
    return fits;
  }

  // Takes poses and shifts from the latest fits.
  void take_poses() {
    for (std::size_t k = 0; k < read_.size(); ++k) {
      if (!fits_[k].ok) continue;
      read_[k].pose = fits_[k].pose;
      for (std::size_t i = 0; i < site_.markers.size(); ++i) {
        if (fits_[k].shift[i]) read_[k].shift[i] = *fits_[k].shift[i];
      }
    }
  }

  void follow_path() {
    std::vector<std::size_t> known;
    for (const std::size_t k : order_)
      if (fits_[k].ok) known.push_back(k);
    motions_.assign(read_.size(), FrameMotion{{}, std::vector<TargetMotion>(site_.markers.size())});
    out_.u_target.assign(read_.size(), std::vector<Extent<frame::Board>>(site_.markers.size()));
    std::vector<double> time;
    std::vector<PathPlace> places, variances;
    for (const std::size_t k : known) {
      time.push_back(read_[k].time_s);
      places.push_back(path_place(fits_[k].pose, read_.front().pose));
      const double excess =
          fits_[k].dof > 0 ? std::max(1.0, fits_[k].chi2_sum / static_cast<double>(fits_[k].dof)) : 1.0;
      variances.push_back(excess * fits_[k].path_variance);
    }
    for (int c = 0; c < kPathParameters; ++c) {
      std::vector<double> value, variance;
      for (std::size_t n = 0; n < known.size(); ++n) {
        const double last = n > 0 ? value.back() : places[n](c);
        value.push_back(c < 3 ? last + std::remainder(places[n](c) - last, kTwoPi) : places[n](c));
        variance.push_back(variances[n](c));
      }
      const auto path = smooth_path(time, value, variance);
      for (std::size_t n = 0; n < known.size(); ++n) motions_[known[n]].camera[static_cast<std::size_t>(c)] = path[n];
    }
    for (FrameMotion& motion : motions_) widened(motion);
    for (std::size_t i = 0; i < site_.markers.size(); ++i) follow_target(i);
  }

  void follow_target(std::size_t i) {
    std::vector<std::size_t> known;
    for (const std::size_t k : order_)
      if (fits_[k].ok && fits_[k].shift[i]) known.push_back(k);
    std::vector<double> time;
    time.reserve(known.size());
    for (const std::size_t k : known) time.push_back(read_[k].time_s);
    for (const auto axis : {&Extent<frame::Board>::x, &Extent<frame::Board>::y}) {
      std::vector<double> value, variance;
      for (const std::size_t k : known) {
        value.push_back((*fits_[k].shift[i]).*axis);
        variance.push_back(fits_[k].variance[i].*axis);
      }
      const auto path = smooth_path(time, value, variance);
      for (std::size_t n = 0; n < known.size(); ++n) {
        TargetMotion& t = motions_[known[n]].targets[i];
        t.rate.*axis = path[n].rate;
        t.acceleration.*axis = path[n].acceleration;
        const double delay = out_.readout_s * row_share_[known[n]][i];
        const auto& c = path[n].covariance;
        out_.u_target[known[n]][i].*axis =
            std::abs(delay) * std::sqrt(std::max(0.0, c(0, 0) + 0.25 * delay * delay * c(1, 1)));
      }
    }
  }

  void widened(FrameMotion& motion) const {
    // Assume that motion missed by the spline varies at the frame rate: omega = 2 pi / interval.
    const double quick = kTwoPi / out_.interval_s;
    for (std::size_t c = 0; c < motion.camera.size(); ++c) {
      auto& p = motion.camera[c].covariance;
      const double rate = (wider_[c] - 1.0) * p(0, 0);
      p(0, 0) += rate;
      p(1, 1) = p(1, 1) * wider_[c + kPathParameters] + quick * quick * rate;
    }
  }

  void set_all_back() {
    auto set = std::make_shared<const SetBack>(
        SetBack{site_, as_given_, scene_, read_, motions_, out_.readout_s, prior_.rows_run});
    out_.with_movements = as_given_.with([set = std::move(set)](std::size_t k) { return set->frame(k); });
    out_.frames = only_displaced(out_.with_movements, movements_);
  }

  // Returns half the derivative of the prior's chi2 by each scene parameter.
  [[nodiscard]] Eigen::VectorXd slope_of_prior(const ScenePrior& prior) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(scene_parameters(site_.markers.size()));
    const auto take = [&](int row, double value, double mean, double u) {
      if (u > 0.0) out(row) = (value - mean) / (u * u);
    };
    const CommonNumbers now = numbers_of(scene_), mean = numbers_of(prior.camera, prior.stretch);
    const auto u = uncertainties_of(prior);
    for (std::size_t k = 0; k < now.size(); ++k) take(static_cast<int>(k), now[k], mean[k], u[k]);
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      for (std::size_t k = 0; k < kShapeParameters; ++k)
        take(shape_row(i, static_cast<int>(k)), scene_.markers[i].value[k], prior.markers[i].value[k],
             prior.u_markers[i].value[k]);
    }
    return out;
  }

  // Takes the readout time's part of a Gauss-Newton step of readout time and scene together. The paths are fixed.
  void solve_readout() {
    set_all_back();
    std::vector<FrameFit> fits;
    const double prior = 1.0 / std::pow(known_to_ * expected_s_, 2);
    double information = prior, slope = prior * (out_.readout_s - expected_s_);
    const ScenePrior& known = out_.calibration.prior;
    Eigen::VectorXd scene_slope = slope_of_prior(known);
    Eigen::VectorXd with_scene = Eigen::VectorXd::Zero(scene_slope.size());
    for (const std::size_t k : key_) {
      FrameFit f = fit_of(out_.frames.without_flawed_targets(k));
      if (!f.ok) continue;
      // A frame with residuals beyond noise has less weight.
      const double weight = f.dof > 0 ? 1.0 / std::max(1.0, f.chi2_sum / static_cast<double>(f.dof)) : 1.0;
      information += weight * f.readout_information;
      slope += weight * f.readout_slope;
      with_scene += weight * f.scene_by_readout;
      scene_slope += weight * f.scene_slope;
      f.by_scene *= weight;
      for (OwnInformation& own : f.own_scene) own.information *= weight;
      fits.push_back(std::move(f));
    }
    const Eigen::VectorXd follows = scene_covariance(site_, fits, known, scene_.model) * with_scene;
    information = std::max(information - with_scene.dot(follows), prior);
    if (out_.calibration.shutter.chi2_dof < kScenesFit) slope -= follows.dot(scene_slope);
    const double now = std::abs(out_.readout_s);
    const double next =
        std::clamp(side_ * (out_.readout_s - slope / information), now / kMaxReadoutFactor, now * kMaxReadoutFactor);
    const double shortest = kShortest * std::min(out_.interval_s, 0.1);
    out_.bounded = !(next > shortest && next < out_.interval_s);
    out_.readout_s = side_ * std::clamp(next, shortest, out_.interval_s);
    out_.u_readout_s = std::hypot(1.0 / std::sqrt(information), kReadoutOfPath * out_.readout_s);
  }

  // Returns the mean of what the frames' points show beyond the path. No camera moves so in every frame, so it is an
  // error of the scene. A tilted print, for example, looks like a rotation that accelerates during each readout.
  [[nodiscard]] Motion mean_motion() const {
    Motion sum = Motion::Zero();
    int frames = 0;
    for (const FitSummary& fit : fits_) {
      if (!fit.ok || !fit.motion_variance) continue;
      sum += fit.motion;
      ++frames;
    }
    return sum / std::max(1, frames);
  }

  // Inflates the process noise by expectation maximisation, component by component. The mean does not count: it would
  // free every frame's motion to follow errors of the scene.
  void widen() {
    const Motion mean = mean_motion();
    for (std::size_t c = 0; c < wider_.size(); ++c) {
      double found = 0.0, expected = 0.0;
      const auto at = static_cast<Eigen::Index>(c);
      for (std::size_t k = 0; k < fits_.size(); ++k) {
        if (!fits_[k].ok || !fits_[k].motion_variance) continue;
        found += std::pow(fits_[k].motion(at) - mean(at), 2) + (*fits_[k].motion_variance)(at);
        const auto& p = motions_[k].camera[c % kPathParameters].covariance;
        expected += c < kPathParameters ? p(0, 0) : p(1, 1);
      }
      if (expected > 0.0) wider_[c] = std::clamp(wider_[c] * found / expected, 1.0, kMaxWidening);
    }
  }

  // Widens u_target by vibration that rate and acceleration do not describe.
  void allow_for_fast_vibration() {
    const Motion mean = mean_motion();
    std::vector<MotionBeyondPath> motions;
    for (const std::size_t k : key_) {
      if (fits_[k].ok && fits_[k].motion_variance) motions.push_back({out_.frames[k], fits_[k].motion - mean});
    }
    out_.vibration = fast_vibration(site_, motions, out_.calibration.shutter.chi2_dof);
    const auto& u = out_.vibration.u_mm;
    for (auto& frame : out_.u_target) {
      for (auto& target : frame) target = {std::hypot(target.x, u.x), std::hypot(target.y, u.y)};
    }
  }

  void count_cost() {
    for (const std::size_t k : key_) {
      if (fits_[k].ok) out_.motion_cost += fits_[k].motion.dot(out_.frames[k].rows->information * fits_[k].motion);
    }
  }

  const Site& site_;
  const FrameSeries& as_given_;
  std::vector<FrameStart> read_;                // with the latest poses and shifts
  std::vector<std::vector<double>> row_share_;  // by frame, then site marker
  std::span<const std::size_t> key_;
  const ScenePrior& prior_;
  std::shared_ptr<const MovementRemoval> movements_;
  double chi2_dof_at_once_;  // chi2/dof without a readout time; if not known, that of the first round
  bool is_given_;
  double side_, known_to_, expected_s_ = 0.0;
  std::vector<std::size_t> order_;  // frame indices by time
  Scene scene_;
  std::vector<FitSummary> fits_;
  std::vector<FrameMotion> motions_;
  std::array<double, kMotionParameters> wider_ = [] {
    std::array<double, kMotionParameters> one{};
    one.fill(1.0);
    return one;
  }();
  Shutter out_;
};

double chi2_of(const ShutterTest& t) { return t.chi2_dof * static_cast<double>(t.dof); }

double cost_of(const Shutter& s) { return chi2_of(s.calibration.shutter) + s.motion_cost; }

// Returns true if no other start needs to be tried. Then the frames fit with a clear readout time, or a very clear one
// explains nearly all that noise does not.
bool is_convincing(const Shutter& s, double chi2_dof_at_once) {
  if (!s.problem.empty() || !is_clear(s)) return false;
  const double chi2_dof = s.calibration.shutter.chi2_dof;
  const bool is_very_clear = std::abs(s.readout_s) > kVerySureReadout * s.u_readout_s;
  return chi2_dof < kScenesFit || (is_very_clear && chi2_dof < kNearlyAll * chi2_dof_at_once);
}

// Returns true if the search ended at the shortest readout time, and noise explains the frames and their motion. Another
// start or direction has nothing left to explain.
bool is_hopeless(const Shutter& s) {
  return s.problem.empty() && s.bounded && s.readout_s < 0.5 * s.interval_s &&
         cost_of(s) < chi2_upper_quantile(static_cast<double>(s.calibration.shutter.dof));
}

bool is_better(const Shutter& a, const Shutter& b) {
  return a.problem.empty() && (!b.problem.empty() || cost_of(a) < cost_of(b));
}

}  // namespace

Shutter solve_shutter(const ShutterTask& task) {
  const auto solved = [&](double side, double start) { return RollingShutterSolver(task, side, start).solved(); };
  if (task.readout_s) return solved(1.0, 1.0);
  Shutter down = solved(1.0, 1.0);
  if (is_hopeless(down)) return down;
  // The scene that the expected readout time gives can be far off if the true one is much shorter.
  constexpr double kStarts[] = {1.0 / 3.0, 1.0 / 9.0};  // relative to the expected readout time; chosen
  for (const double start : kStarts) {
    if (is_convincing(down, task.chi2_dof_at_once)) break;
    if (Shutter one = solved(1.0, start); is_better(one, down)) down = std::move(one);
  }
  if (is_convincing(down, task.chi2_dof_at_once)) return down;
  Shutter up = solved(-1.0, 1.0);
  // Fall of the cost that the opposite direction needs: about the evidence of one frame. Sensors are rarely upside
  // down. Chosen.
  constexpr double kClearly = 100.0;
  if (!up.problem.empty()) return down;
  return down.problem.empty() && cost_of(down) < cost_of(up) + kClearly ? down : up;
}

bool is_justified(const Shutter& shutter, const Calibration& at_once) {
  if (!shutter.problem.empty()) return false;
  // A slipped reference can also lower chi2, along a path bent to it. Then the readout time is not above its noise.
  if (!is_clear(shutter)) return false;
  constexpr double kGoodPart = 0.25;  // least share of the excess over noise that the solution explains; chosen
  const ShutterTest &before = at_once.shutter, &after = shutter.calibration.shutter;
  const double gain = chi2_of(before) - cost_of(shutter);
  const double taken = 1.0 + static_cast<double>(before.dof - after.dof);
  return gain > bic_penalty(before.dof) * taken &&
         gain > kGoodPart * (chi2_of(before) - static_cast<double>(before.dof));
}

}  // namespace moiregauge::internal
