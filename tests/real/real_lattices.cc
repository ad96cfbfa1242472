// SPDX-License-Identifier: Apache-2.0
#include "real/real_lattices.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Dense>

#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_list.h"

namespace moiregauge::internal::test {
namespace {

using Marks = std::vector<Eigen::Vector2d>;  // columns and rows of landmarks in a defined order

Eigen::Vector2d quarter_turns(Eigen::Vector2d p, int turns) {
  for (int i = 0; i < turns; ++i) p = Eigen::Vector2d(-p.y(), p.x());
  return p;
}

// Returns start and end of a side, clockwise, with an odd number of points and a dark square at its start. Only one
// side of a board with an odd and an even side has both.
Marks marks_of_colours(const IndexedLattice& lattice) {
  const int c = lattice.columns - 1, r = lattice.rows - 1;
  const std::vector<Eigen::Vector2d> corners{{0, 0}, {c, 0}, {c, r}, {0, r}};
  // Colour of the square inside each corner. It changes along a side with an even number of squares.
  const bool dark[] = {lattice.dark, lattice.dark == (c % 2 != 0), lattice.dark == ((c + r) % 2 == 0),
                       lattice.dark == (r % 2 != 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d side = corners[(i + 1) % 4] - corners[i];
    if (dark[i] && std::lround(side.norm()) % 2 == 0) return {corners[i], corners[(i + 1) % 4]};
  }
  return {};
}

double median_size(const IndexedLattice& lattice) {
  std::vector<double> sizes;
  for (const LatticePoint& p : lattice.points) sizes.push_back(p.size_px);
  std::sort(sizes.begin(), sizes.end());
  return sizes[sizes.size() / 2];
}

Marks marks_of_large_dot(const IndexedLattice& lattice) {
  for (const LatticePoint& p : lattice.points) {
    if (p.size_px < 1.6 * median_size(lattice)) continue;
    return {{p.column, p.row}, {0.5 * (lattice.columns - 1), 0.5 * (lattice.rows - 1)}};
  }
  return {};
}

// Returns the rings row by row. The board rotates by a few degrees only, so this order is the same in all views.
Marks marks_of_rings(const IndexedLattice& lattice, const CircleSearch& circles) {
  Marks marks;
  for (const LatticePoint& p : lattice.points) {
    const auto in_it = [&](const DetectedCircle& c) {
      return c.contrast > 0.0 && length(c.centre - p.at) < 0.1 * p.size_px && c.diameter_px < 0.6 * p.size_px;
    };
    if (std::any_of(circles.circles.begin(), circles.circles.end(), in_it)) marks.emplace_back(p.column, p.row);
  }
  return marks;
}

Homography<frame::Image, frame::Board> image_from_index(const std::vector<std::pair<Place, ImagePoint>>& points) {
  std::vector<BoardPoint> from;
  std::vector<ImagePoint> to;
  for (const auto& [place, at] : points) {
    from.push_back({static_cast<double>(place.first), static_cast<double>(place.second)});
    to.push_back(at);
  }
  const auto h = fit_homography<frame::Image, frame::Board>(from, to);
  if (!h) throw std::runtime_error("points on a line");
  return *h;
}

Discs discs_round(const CircleSearch& circles, const Site& site) {
  Discs discs;
  const auto who = identify_first(site, circles);
  if (!who) return discs;
  for (const int circle : who->circle_of_marker) {
    if (circle >= 0) discs.push_back(circles.circles[static_cast<std::size_t>(circle)].centre);
  }
  return discs;
}

Marks marks_of_discs(const IndexedLattice& lattice, const Discs& discs) {
  std::vector<std::pair<Place, ImagePoint>> points;
  for (const LatticePoint& p : lattice.points) points.push_back({{p.column, p.row}, p.at});
  const auto index_from_image = image_from_index(points).inverse();
  Marks marks;
  for (const ImagePoint& disc : discs) {
    const BoardPoint p = index_from_image(disc);
    marks.emplace_back(p.x, p.y);
  }
  return marks;
}

struct Change {
  int turns = 0;
  Eigen::Vector2d offset{0, 0};
};

// Returns the quarter turns and the whole steps that map the marks of one view to those of another.
std::optional<Change> change_between(const Marks& from, const Marks& to) {
  if (from.size() < 2 || from.size() != to.size()) return std::nullopt;
  for (int turns = 0; turns < 4; ++turns) {
    Eigen::Vector2d offset = to[0] - quarter_turns(from[0], turns);
    offset = offset.array().round();
    double most = 0.0;
    for (std::size_t i = 0; i < to.size(); ++i)
      most = std::max(most, (quarter_turns(from[i], turns) + offset - to[i]).norm());
    if (most < 0.4) return Change{turns, offset};
  }
  return std::nullopt;
}

Places places_of(const IndexedLattice& lattice, const Change& change) {
  Places places;
  for (const LatticePoint& p : lattice.points) {
    const Eigen::Vector2d to = quarter_turns(Eigen::Vector2d(p.column, p.row), change.turns) + change.offset;
    places[{static_cast<int>(std::lround(to.x())), static_cast<int>(std::lround(to.y()))}] = p.at;
  }
  return places;
}

Marks marks_of(const LatticeView& view, Landmarks landmarks) {
  const IndexedLattice& lattice = view.lattices.front();
  switch (landmarks) {
    case Landmarks::kColours:
      return marks_of_colours(lattice);
    case Landmarks::kLargeDot:
      return marks_of_large_dot(lattice);
    case Landmarks::kRings:
      return marks_of_rings(lattice, view.circles);
    case Landmarks::kDiscs:
      break;
  }
  return marks_of_discs(lattice, view.discs);
}

template <typename Value, typename Error>
Value value_of(tl::expected<Value, Error> read, const std::string& what) {
  if (!read) throw std::runtime_error("cannot read " + what);
  return std::move(*read);
}

LatticeView look_at(const std::string& file, const PhotoSet& set) {
  LatticeView view;
  view.file = file.substr(file.rfind('/') + 1);
  view.picture = value_of(read_picture(file), file);
  const LumaView luma = view_of(view.picture);
  CircleOptions options;
  options.min_diameter_px = DotSearchOptions{}.min_diameter_px;
  view.circles = find_circles(luma, options);
  view.lattices = set.kind == LatticeKind::kDots ? find_dot_lattices(luma, view.circles.circles)
                                                 : find_checker_lattices(luma, view.picture.bits);
  return view;
}

LatticeNull null_of(const Places& first, const Places& view, const std::vector<ImagePoint>& from,
                    const std::vector<ImagePoint>& to, const std::vector<Place>& targets) {
  const auto h = fit_homography<frame::Image, frame::Image>(from, to);
  if (!h || targets.empty()) return {};
  double squares = 0.0;
  for (const Place& place : targets) squares += std::pow(length(view.at(place) - (*h)(first.at(place))), 2);
  const auto n = static_cast<int>(targets.size());
  return {n, std::sqrt(squares / n)};
}

std::vector<Place> common_places(const Places& first, const Places& view) {
  std::vector<Place> common;
  for (const auto& [place, at] : first) {
    if (view.contains(place)) common.push_back(place);
  }
  return common;
}

double area_of(const std::vector<Place>& corners, const Places& view) {
  double area = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImagePoint p = view.at(corners[i]), q = view.at(corners[(i + 1) % corners.size()]);
    area += 0.5 * (p.x * q.y - p.y * q.x);
  }
  return std::abs(area);
}

// Returns the corners of the lattice, or the points nearest to the image's corners if they span more. The latter
// applies to an oblique lattice that ends at the image's edges.
std::vector<Place> select_references(const std::vector<Place>& places, const Places& view) {
  const auto extremes = [&](const auto& x_of, const auto& y_of) {
    std::vector<Place> corners;
    for (const auto& [across, down] : {Place{-1, -1}, Place{1, -1}, Place{1, 1}, Place{-1, 1}}) {
      const auto further = [&, a = across, d = down](const Place& p, const Place& q) {
        return a * x_of(p) + d * y_of(p) < a * x_of(q) + d * y_of(q);
      };
      corners.push_back(*std::max_element(places.begin(), places.end(), further));
    }
    return corners;
  };
  const auto of_lattice = extremes([](const Place& p) { return p.first; }, [](const Place& p) { return p.second; });
  const auto of_picture =
      extremes([&](const Place& p) { return view.at(p).x; }, [&](const Place& p) { return view.at(p).y; });
  return area_of(of_lattice, view) >= area_of(of_picture, view) ? of_lattice : of_picture;
}

}  // namespace

const PhotoSet& photo_set(const std::string& name) {
  for (const PhotoSet& set : kPhotoSets) {
    if (set.name == name) return set;
  }
  throw std::runtime_error("no set " + name);
}

std::vector<LatticeView> lattice_views(const std::string& data, const PhotoSet& set) {
  const std::string folder = data + "/" + set.name;
  std::vector<LatticeView> views;
  Marks first;
  for (const std::string& file : value_of(pictures_in_folder(folder), folder)) {
    LatticeView view = look_at(file, set);
    if (set.landmarks == Landmarks::kDiscs)
      view.discs = discs_round(view.circles, value_of(read_site(folder + "/site.toml"), folder + "/site.toml"));
    if (!view.lattices.empty()) {
      const Marks marks = marks_of(view, set.landmarks);
      if (first.empty()) first = marks;
      if (const auto change = change_between(marks, first)) view.places = places_of(view.lattices.front(), *change);
    }
    views.push_back(std::move(view));
  }
  return views;
}

LatticeNull null_between(const Places& first, const Places& view) {
  std::vector<Place> targets = common_places(first, view);
  if (targets.size() < 5) return {};
  const std::vector<Place> corners = select_references(targets, first);
  std::vector<ImagePoint> from, to;
  for (const Place& corner : corners) {
    from.push_back(first.at(corner));
    to.push_back(view.at(corner));
  }
  std::erase_if(targets, [&](const Place& p) { return std::find(corners.begin(), corners.end(), p) != corners.end(); });
  return null_of(first, view, from, to, targets);
}

LatticeNull null_by_discs(const Places& first, const Places& view, const Discs& discs_then, const Discs& discs_now) {
  return null_of(first, view, discs_then, discs_now, common_places(first, view));
}

}  // namespace moiregauge::internal::test
