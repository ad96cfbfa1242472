// SPDX-License-Identifier: Apache-2.0
// numpy arrays as images, and results as numpy arrays, both without copies.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "moiregauge/image.h"

namespace moiregauge::python {

namespace py = pybind11;

// Returns a view of a grey image: two axes, uint8 or uint16, each row contiguous. `bits`: grey levels of uint16 are below
// 2^bits; 0: 8 or 16, by the type. The array must outlive the view.
// Throws UsageError: another array.
[[nodiscard]] ImageView image_of(const py::array& array, int bits);

// Returns a read-only array of one field of every item, which shares their memory. `owner` owns the items and stays
// alive with the array.
template <typename Shown, typename Item, typename Field>
[[nodiscard]] py::array field_view(const py::object& owner, const std::vector<Item>& items, const Field Item::*field) {
  static_assert(sizeof(Shown) == sizeof(Field));
  if (items.empty()) return py::array_t<Shown>(0);
  const auto* first = reinterpret_cast<const Shown*>(&(items.front().*field));
  py::array_t<Shown> view({items.size()}, {sizeof(Item)}, first, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

// Returns a read-only array that shares the memory of a vector. `owner` owns it and stays alive with the array.
template <typename Shown, typename Item>
[[nodiscard]] py::array vector_view(const py::object& owner, const std::vector<Item>& items) {
  static_assert(sizeof(Shown) == sizeof(Item));
  if (items.empty()) return py::array_t<Shown>(0);
  py::array_t<Shown> view({items.size()}, {sizeof(Item)}, reinterpret_cast<const Shown*>(items.data()), owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

}  // namespace moiregauge::python
