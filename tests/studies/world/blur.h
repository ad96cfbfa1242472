// SPDX-License-Identifier: Apache-2.0
// Separable blur of a picture.
#pragma once

#include <vector>

namespace world {

struct Picture;

// Returns a normalised kernel of odd length: a Gaussian, and with the share |skew| a wider one to its side (coma).
[[nodiscard]] std::vector<float> skewed_kernel(double sigma, double skew);

// Convolves rows with one kernel and columns with the other. Beyond the rim the picture repeats its last value.
void blur(Picture& picture, const std::vector<float>& along_x, const std::vector<float>& along_y);

// Convolves a picture of `samples` x `samples` values per pixel, then averages over the area of each pixel.
[[nodiscard]] Picture blurred_to_pixels(const Picture& fine, int samples, const std::vector<float>& along_x,
                                        const std::vector<float>& along_y);

}  // namespace world
