// Distance of a point from a triangle.
#pragma once

#include <algorithm>
#include <cmath>

#include "../kernels.h"

namespace wall_search {

// Square of the distance of a point from the segment a b.
inline double square_to_segment(const double* point, const double* a, const double* b) {
  double along[3], from_a[3];
  for (int axis = 0; axis < 3; ++axis) {
    along[axis] = b[axis] - a[axis];
    from_a[axis] = point[axis] - a[axis];
  }
  const double square = load_ledger::dot(along, along);
  const double share = square > 0.0 ? std::clamp(load_ledger::dot(from_a, along) / square, 0.0, 1.0) : 0.0;
  double offset[3];
  for (int axis = 0; axis < 3; ++axis) offset[axis] = from_a[axis] - share * along[axis];
  return load_ledger::dot(offset, offset);
}

// Distance of a point from a triangle: that of its plane where the point stands over it, else of its nearest edge.
// It changes by no more than the point or a corner moves.
inline double distance_to_triangle(const double* point, const double (*corner)[3]) {
  double along[3], across[3], normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    along[axis] = corner[1][axis] - corner[0][axis];
    across[axis] = corner[2][axis] - corner[0][axis];
  }
  load_ledger::cross(along, across, normal);
  const double square = load_ledger::dot(normal, normal);
  bool over = square > 0.0;
  double from_plane = 0.0, nearest = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const double *start = corner[k], *end = corner[(k + 1) % 3];
    double edge[3], inward[3], from_start[3];
    for (int axis = 0; axis < 3; ++axis) {
      edge[axis] = end[axis] - start[axis];
      from_start[axis] = point[axis] - start[axis];
    }
    load_ledger::cross(normal, edge, inward);
    over = over && load_ledger::dot(inward, from_start) >= 0.0;
    if (k == 0) from_plane = load_ledger::dot(normal, from_start);
    nearest = std::min(nearest, square_to_segment(point, start, end));
  }
  return over ? std::abs(from_plane) / std::sqrt(square) : std::sqrt(nearest);
}

}  // namespace wall_search
