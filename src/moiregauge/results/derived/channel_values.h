// SPDX-License-Identifier: Apache-2.0
// Values of a channel in all frames of a run, with their joint errors.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "moiregauge/displacement/joint_errors.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/results/derived/channel.h"

namespace moiregauge::internal {

// One value per observation. Its error is the sum of noise, independent from frame to frame, of a part with an unknown
// correlation between frames, and of shared factors.
struct ChannelSeries {
  using Loadings = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<long> frame;
  std::vector<double> time_s;
  std::vector<Status> status;  // the first that is not `ok` among the channel's targets
  Eigen::VectorXd value;       // in the channel's unit; NaN if not measured
  Eigen::VectorXd noise;       // variance
  Eigen::VectorXd bounded;     // u of a part that is equal in all frames, independent, or anything between
  Loadings loadings;           // one row per observation, one column per shared factor
  [[nodiscard]] Eigen::Index size() const { return value.size(); }
  // Returns true if the row has a value and is `ok`.
  [[nodiscard]] bool is_ok(Eigen::Index n) const;
  // Returns the standard uncertainty of one value.
  [[nodiscard]] double u(Eigen::Index n) const;
};

// Returns the values of a channel. `samples`: by observation, then by target, as the joint errors.
// Functions of several targets are evaluated exactly. Their u is linear about the value, with the u of the positions.
// Fails (reason): targets of a function have the same position, or the channel has several values and the method does
// not know what they share.
[[nodiscard]] tl::expected<ChannelSeries, std::string> channel_values(const Channel& channel, const Samples& samples,
                                                                      const JointErrors& joint);

}  // namespace moiregauge::internal
