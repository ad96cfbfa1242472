// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/python/numpy_image.h"

#include <cstdint>

#include "moiregauge/python/errors.h"

namespace moiregauge::python {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& remedy) {
  raise({ErrorKind::kUsage, what + ": " + where + ": " + remedy});
}

}  // namespace

ImageView image_of(const py::array& array, int bits) {
  const std::string shape = "array of shape " + std::string(py::str(array.attr("shape")));
  if (array.ndim() != 2) refuse("the image is not grey", shape, "give one plane with two axes, e.g. image[..., 1]");
  const bool is_byte = py::isinstance<py::array_t<std::uint8_t>>(array);
  if (!is_byte && !py::isinstance<py::array_t<std::uint16_t>>(array))
    refuse("the grey levels have an unsupported type", std::string(py::str(array.dtype())),
           "convert the image to uint8 or uint16");
  const auto item = static_cast<py::ssize_t>(array.itemsize());
  const py::ssize_t row = array.strides(0);
  if (array.shape(0) == 0 || array.shape(1) == 0) refuse("the image is empty", shape, "give at least one pixel");
  if (array.strides(1) != item || row < item * array.shape(1) || row % item != 0)
    refuse("the rows of the image are not contiguous", shape, "pass numpy.ascontiguousarray(image)");
  const int depth = bits != 0 ? bits : is_byte ? 8 : 16;
  if (is_byte ? depth != 8 : depth < 9 || depth > 16)
    refuse("the bits do not fit the type", "bits=" + std::to_string(depth), "give 8 for uint8, or 9 to 16 for uint16");
  const int height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
  if (is_byte) return {static_cast<const std::uint8_t*>(array.data()), width, height, row};
  return {static_cast<const std::uint16_t*>(array.data()), width, height, depth, row / item};
}

}  // namespace moiregauge::python
