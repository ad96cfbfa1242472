// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/channel_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kMilli = 1e3, kMicro = 1e6;  // mrad per rad, um/m per 1
constexpr double kMinDistance_mm = 1e-6;      // least distance of two targets of a function

// Targets of one frame: positions in the reference frame and what was measured.
struct TargetsNow {
  std::vector<Vector2d> position, displacement;  // mm
  VectorXd rotation_rad;
  [[nodiscard]] Vector2d now(std::size_t t) const { return position[t] + displacement[t]; }
};

// Value with its derivatives by the quantities (quantity_row) and by the positions (x and y of every target).
struct Gradient {
  double value = 0.0;
  VectorXd by_quantity, by_position;

  void add_displacement(std::size_t t, const Vector2d& g) {
    by_quantity(quantity_row(t, Quantity::kDx)) += g.x();
    by_quantity(quantity_row(t, Quantity::kDy)) += g.y();
  }
  void add_position(std::size_t t, const Vector2d& g) { by_position.segment<2>(2 * static_cast<Index>(t)) += g; }
};

Vector2d left_of(const Vector2d& v) { return {-v.y(), v.x()}; }

// L = |p_b + d_b - p_a - d_a| minus the same at rest. Strain is this relative to the distance at rest.
void add_distance(const ChannelTerm& term, const TargetsNow& at, Gradient& sum) {
  const std::size_t a = term.targets[0], b = term.targets[1];
  const Vector2d rest = at.position[b] - at.position[a], moved = at.now(b) - at.now(a);
  const double length = rest.norm(), now = moved.norm();
  const bool is_strain = term.kind == TermKind::kStrain;
  const double scale = term.factor * (is_strain ? kMicro / length : 1.0);
  const Vector2d by_moved = now > 0.0 ? Vector2d(moved / now) : Vector2d(rest / length);
  Vector2d by_rest = by_moved - rest / length;
  if (is_strain) by_rest -= (now - length) / length * rest / length;
  sum.value += scale * (now - length);
  sum.add_displacement(b, scale * by_moved);
  sum.add_displacement(a, -scale * by_moved);
  sum.add_position(b, scale * by_rest);
  sum.add_position(a, -scale * by_rest);
}

// n . (d_b - (1 - s) d_a - s d_c): n is the left normal of the line from a to c, s the place of b along it.
void add_sag(const ChannelTerm& term, const TargetsNow& at, Gradient& sum) {
  const std::size_t a = term.targets[0], b = term.targets[1], c = term.targets[2];
  const Vector2d line = at.position[c] - at.position[a], to_b = at.position[b] - at.position[a];
  const double length = line.norm();
  const Vector2d e = line / length, n = left_of(e);
  const double s = e.dot(to_b) / length;
  const Vector2d off = at.displacement[b] - (1.0 - s) * at.displacement[a] - s * at.displacement[c];
  sum.value += term.factor * n.dot(off);
  sum.add_displacement(b, term.factor * n);
  sum.add_displacement(a, -term.factor * (1.0 - s) * n);
  sum.add_displacement(c, -term.factor * s * n);
  // Derivatives by s, and by a rotation of the line, which turns n by -e and s by n . to_b / length.
  const double by_s = term.factor * n.dot(at.displacement[a] - at.displacement[c]);
  const double by_angle = by_s * n.dot(to_b) / length - term.factor * e.dot(off);
  const Vector2d by_b = by_s / length * e, by_c = by_angle / length * n - by_s * s / length * e;
  sum.add_position(b, by_b);
  sum.add_position(c, by_c);
  sum.add_position(a, -by_b - by_c);
}

// Angle from sum w_i p_i to sum w_i (p_i + d_i). The weights are the places along the line about their mean. For two
// targets it is the angle of the line through them.
void add_line_rotation(const ChannelTerm& term, const TargetsNow& at, Gradient& sum) {
  const Vector2d e = (at.position[term.targets.back()] - at.position[term.targets.front()]).normalized();
  double mean = 0.0;
  for (const std::size_t t : term.targets) mean += e.dot(at.position[t]) / static_cast<double>(term.targets.size());
  Vector2d rest = Vector2d::Zero(), moved = Vector2d::Zero();
  for (const std::size_t t : term.targets) {
    const double w = e.dot(at.position[t]) - mean;
    rest += w * at.position[t];
    moved += w * at.now(t);
  }
  const double scale = kMilli * term.factor;
  sum.value += scale * std::atan2(rest.x() * moved.y() - rest.y() * moved.x(), rest.dot(moved));
  const Vector2d by_moved = left_of(moved) / moved.squaredNorm(), by_rest = left_of(rest) / rest.squaredNorm();
  for (const std::size_t t : term.targets) {
    const double w = e.dot(at.position[t]) - mean;
    sum.add_displacement(t, scale * w * by_moved);
    sum.add_position(t, scale * w * (by_moved - by_rest));
  }
}

void add_term(const ChannelTerm& term, const TargetsNow& at, Gradient& sum) {
  const std::size_t first = term.targets.front();
  switch (term.kind) {
    case TermKind::kDx:
      sum.value += term.factor * at.displacement[first].x();
      return sum.add_displacement(first, {term.factor, 0.0});
    case TermKind::kDy:
      sum.value += term.factor * at.displacement[first].y();
      return sum.add_displacement(first, {0.0, term.factor});
    case TermKind::kRotation:
      sum.value += kMilli * term.factor * at.rotation_rad(static_cast<Index>(first));
      sum.by_quantity(quantity_row(first, Quantity::kRotation)) += kMilli * term.factor;
      return;
    case TermKind::kChord:
    case TermKind::kStrain:
      return add_distance(term, at, sum);
    case TermKind::kSag:
      return add_sag(term, at, sum);
    case TermKind::kLineRotation:
      return add_line_rotation(term, at, sum);
  }
}

bool is_function(TermKind kind) {
  return kind != TermKind::kDx && kind != TermKind::kDy && kind != TermKind::kRotation;
}

bool is_of_one_value(const Channel& channel) {
  return channel.terms.size() == 1 && !is_function(channel.terms.front().kind);
}

// A function needs a line of some length, from its first target to its last one.
bool has_line(const ChannelTerm& term, const JointErrors& joint) {
  if (!is_function(term.kind)) return true;
  return length(joint.positions[term.targets.back()] - joint.positions[term.targets.front()]) > kMinDistance_mm;
}

Status worst(const Channel& channel, const Sample* frame) {
  for (const ChannelTerm& term : channel.terms) {
    for (const std::size_t t : term.targets) {
      if (frame[t].status != Status::kOk) return frame[t].status;
    }
  }
  return Status::kOk;
}

class ChannelEvaluator {
 public:
  ChannelEvaluator(const Channel& channel, const JointErrors& joint) : channel_(channel), joint_(joint) {
    for (const BoardPoint p : joint.positions) at_.position.emplace_back(p.x, p.y);
    at_.displacement.resize(joint.positions.size());
  }

  // Returns the channel's value and derivatives. `frame`: samples of all targets.
  const Gradient& gradient(const Sample* frame, const FrameErrors& errors) {
    const auto targets = static_cast<Index>(at_.position.size());
    for (std::size_t t = 0; t < at_.position.size(); ++t)
      at_.displacement[t] = {frame[t].displacement.x, frame[t].displacement.y};
    at_.rotation_rad = errors.rotation_rad;
    out_.value = channel_.constant;
    out_.by_quantity.setZero(kQuantities * targets);
    out_.by_position.setZero(2 * targets);
    for (const ChannelTerm& term : channel_.terms) add_term(term, at_, out_);
    return out_;
  }

 private:
  const Channel& channel_;
  const JointErrors& joint_;
  TargetsNow at_;
  Gradient out_;
};

void put_errors(const Gradient& g, const FrameErrors& errors, const JointErrors& joint, Index n, ChannelSeries& out) {
  const VectorXd& w = g.by_quantity;
  const double all = std::max(0.0, w.dot(errors.noise * w));
  const double bounded = errors.bounded.size() > 0 ? std::clamp(w.dot(errors.bounded * w), 0.0, all) : 0.0;
  out.noise(n) = all - bounded;
  out.bounded(n) = std::sqrt(bounded);
  const Index constant = joint.constant.cols(), varying = errors.varying.cols();
  out.loadings.row(n).head(constant) = errors.constant_share * (joint.constant.transpose() * w).transpose();
  out.loadings.row(n).segment(constant, varying) = (errors.varying.transpose() * w).transpose();
  out.loadings.row(n).tail(g.by_position.size()) = joint.u_position_mm * g.by_position.transpose();
}

}  // namespace

bool ChannelSeries::is_ok(Index n) const {
  return status[static_cast<std::size_t>(n)] == Status::kOk && std::isfinite(value(n));
}

double ChannelSeries::u(Index n) const {
  return std::sqrt(noise(n) + bounded(n) * bounded(n) + loadings.row(n).squaredNorm());
}

tl::expected<ChannelSeries, std::string> channel_values(const Channel& channel, const Samples& samples,
                                                        const JointErrors& joint) {
  if (!joint.knows_common_errors && !is_of_one_value(channel))
    return tl::unexpected(std::string("the method does not know the errors that several values share"));
  for (const ChannelTerm& term : channel.terms) {
    if (!has_line(term, joint)) return tl::unexpected(std::string("two targets of a function have the same position"));
  }
  const auto frames = static_cast<Index>(joint.frames.size());
  const auto targets = joint.targets.size();
  const Index varying = frames > 0 ? joint.frames.front().varying.cols() : 0;
  const Index factors = joint.constant.cols() + varying + 2 * static_cast<Index>(targets);
  ChannelSeries out;
  out.value = VectorXd::Constant(frames, kNotMeasured);
  out.noise = out.bounded = VectorXd::Zero(frames);
  out.loadings.setZero(frames, factors);
  ChannelEvaluator evaluator(channel, joint);
  for (Index n = 0; n < frames; ++n) {
    const Sample* frame = samples.data() + static_cast<std::size_t>(n) * targets;
    const FrameErrors& errors = joint.frames[static_cast<std::size_t>(n)];
    out.frame.push_back(frame->frame);
    out.time_s.push_back(frame->time_s);
    out.status.push_back(worst(channel, frame));
    const Gradient& g = evaluator.gradient(frame, errors);
    if (!std::isfinite(g.value)) continue;
    out.value(n) = g.value;
    put_errors(g, errors, joint, n, out);
  }
  return out;
}

}  // namespace moiregauge::internal
