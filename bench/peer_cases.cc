// SPDX-License-Identifier: Apache-2.0
// Cases of OpenCV's pyramidal Lucas-Kanade tracker on the five gratings, and of a whole frame of `precise`, with the error
// of both in the image. The tracker starts within half a pixel of the truth, because a grating repeats.
#include <array>
#include <cmath>
#include <vector>

#include "cases.h"
#include "product_chain.h"
#ifdef MOIREGAUGE_BENCH_LUCAS_KANADE
#include <opencv2/video/tracking.hpp>
#endif

namespace moiregauge::internal::bench {
namespace {

ImagePoint true_middle(const Recording& recording, std::size_t marker, long frame) {
  const Marker& m = recording.reference().site.markers[marker];
  const auto* who = simulator::find_marker(recording.scenario(), m.name);
  return simulator::project(recording.scenario(), frame, *who, m.grating->centre);
}

// Map from grating coordinates to pixels about the middle of nine points.
struct LocalMap {
  Eigen::Vector2d image, print;
  Eigen::Matrix2d px_per_pitch;
  explicit LocalMap(const PatchFit& fit) {
    const auto at = [&](std::size_t n) { return Eigen::Vector2d(fit.image[n].x, fit.image[n].y); };
    const auto on = [&](std::size_t n) { return Eigen::Vector2d(fit.print[n].x, fit.print[n].y); };
    image = at(4), print = on(4);
    Eigen::Matrix2d px, pitches;
    px << at(5) - at(3), at(7) - at(1);
    pitches << on(5) - on(3), on(7) - on(1);
    px_per_pitch = px * pitches.inverse();
  }
};

// Root mean square of the patches' errors in one frame, with the sign of the first, so that the scatter is theirs, too.
Error pooled(const std::vector<Error>& errors) {
  Error out{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double sum = 0.0;
    for (const Error& e : errors) sum += e[axis] * e[axis];
    out[axis] = std::copysign(std::sqrt(sum / static_cast<double>(errors.size())), errors.front()[axis]);
  }
  return out;
}

// A whole frame of `precise` without u. Each grating is followed at the point that its middle has in the reference frame.
std::shared_ptr<Work> precise_patches(const Recording& recording) {
  const auto chain = std::make_shared<ProductChain>(recording, *method_named("precise"));
  std::vector<Eigen::Vector2d> followed;
  for (std::size_t i = 0; i < recording.reference().site.markers.size(); ++i) {
    const LocalMap then(*chain->reference().seen.markers[i].points);
    const ImagePoint middle = true_middle(recording, i, 0);
    followed.push_back(then.print + then.px_per_pitch.inverse() * (Eigen::Vector2d(middle.x, middle.y) - then.image));
  }
  auto work = std::make_shared<Work>();
  work->bytes = recording.window_bytes();
  work->error_unit = "px";
  work->frame = [chain](const Shot& shot) {
    chain->observe(shot);
    return !chain->is_lost();
  };
  work->error = [chain, followed, &recording](const Shot& shot) {
    chain->observe(shot);
    std::vector<Error> errors;
    for (std::size_t i = 0; i < followed.size(); ++i) {
      const LocalMap now(*chain->seen().front().markers[i].points);
      const Eigen::Vector2d found = now.image + now.px_per_pitch * (followed[i] - now.print);
      const ImagePoint truth = true_middle(recording, i, shot.frame);
      errors.push_back({found.x() - truth.x, found.y() - truth.y});
    }
    return pooled(errors);
  };
  return work;
}

#ifdef MOIREGAUGE_BENCH_LUCAS_KANADE
std::shared_ptr<Work> lucas_kanade(const Recording& recording) {
  constexpr int kWindow = 101;  // px, nearly the whole grating
  const auto as_mat = [](const ImageView<std::uint8_t>& p) {
    return cv::Mat(p.height, p.width, CV_8U, const_cast<std::uint8_t*>(p.data), static_cast<std::size_t>(p.stride));
  };
  const std::size_t patches = recording.reference().site.markers.size();
  const auto tracked = [as_mat, patches, &recording](const Shot& shot) {
    std::vector<cv::Point2f> found;
    for (std::size_t i = 0; i < patches; ++i) {
      const ImagePoint then = true_middle(recording, i, 0), now = true_middle(recording, i, shot.frame);
      // A window of its own spares the pyramid of the whole frame.
      const cv::Point from(static_cast<int>(then.x) - kWindow, static_cast<int>(then.y) - kWindow);
      const cv::Point to(static_cast<int>(now.x) - kWindow, static_cast<int>(now.y) - kWindow);
      const cv::Size size(2 * kWindow, 2 * kWindow);
      const std::vector<cv::Point2f> start{{static_cast<float>(then.x - from.x), static_cast<float>(then.y - from.y)}};
      std::vector<cv::Point2f> end{
          {std::round(static_cast<float>(now.x - to.x)), std::round(static_cast<float>(now.y - to.y))}};
      std::vector<std::uint8_t> status;
      cv::calcOpticalFlowPyrLK(
          as_mat(recording.reference_frame().view())(cv::Rect(from, size)), as_mat(shot.picture)(cv::Rect(to, size)),
          start, end, status, cv::noArray(), cv::Size(kWindow, kWindow), 0,
          cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.001), cv::OPTFLOW_USE_INITIAL_FLOW);
      found.emplace_back(end.front().x + static_cast<float>(to.x), end.front().y + static_cast<float>(to.y));
    }
    return found;
  };
  auto work = std::make_shared<Work>();
  work->bytes = recording.window_bytes();
  work->error_unit = "px";
  work->frame = [tracked](const Shot& shot) {
    benchmark::DoNotOptimize(tracked(shot));
    return true;
  };
  work->error = [tracked, &recording](const Shot& shot) {
    const auto found = tracked(shot);
    std::vector<Error> errors;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const ImagePoint truth = true_middle(recording, i, shot.frame);
      errors.push_back({static_cast<double>(found[i].x) - truth.x, static_cast<double>(found[i].y) - truth.y});
    }
    return pooled(errors);
  };
  return work;
}
#endif

}  // namespace

void add_peer_cases() {
  using enum Memory;
  add_cases("patches precise", {kRing}, precise_patches);
#ifdef MOIREGAUGE_BENCH_LUCAS_KANADE
  add_cases("patches lucas-kanade", {kRing}, lucas_kanade);
#endif
}

}  // namespace moiregauge::internal::bench
