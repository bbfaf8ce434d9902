// One triangle of a mesh as it stands at an instant: its own frame, and what follows from its corners.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels.h"
#include "tri_mesh.h"

namespace load_ledger {

constexpr double STRAIGHT = 0.999;  // -, cosine, 2.6 degrees: over the facet itself contacts are square to it

inline void subtract(const double* a, const double* b, double* result) {
  for (int axis = 0; axis < 3; ++axis) result[axis] = a[axis] - b[axis];
}

// A vector in the frame of a facet turns with the mesh, wherever the mesh has gone: along the edge from corner 0 to
// corner 1, across it in the facet, and normal to the facet, right-handed.
class Facet {
 public:
  Facet(LAMMPS_NS::TriMesh* mesh, int triangle) {
    for (int k = 0; k < 3; ++k) mesh->node(triangle, k, corner_[k]);
    subtract(corner_[1], corner_[0], edge_);
    subtract(corner_[2], corner_[0], side_);
    cross(edge_, side_, normal_);
    cross(normal_, edge_, in_plane_);
    const double edge = length(edge_), area = length(normal_);
    for (int axis = 0; axis < 3; ++axis) {
      frame_[0][axis] = edge_[axis] / edge;
      frame_[1][axis] = in_plane_[axis] / (edge * area);
      frame_[2][axis] = normal_[axis] / area;
    }
  }

  // Components of a vector along, across and normal.
  void components(const double* vector, double* result) const {
    for (int k = 0; k < 3; ++k) result[k] = dot(frame_[k], vector);
  }

  // Whether something that lies in that direction of its contact, a unit vector, lies straight behind the facet. A
  // sphere on an edge lies beside it, on an acute one also behind: that says nothing of the side that is touched.
  bool on_back(const double* direction) const { return dot(direction, frame_[2]) < -STRAIGHT; }

  void from_centroid(const double* point, double* result) const {
    for (int axis = 0; axis < 3; ++axis)
      result[axis] = point[axis] - (corner_[0][axis] + corner_[1][axis] + corner_[2][axis]) / 3.0;
  }

  // Weights of the corners at a point, which is projected on to the facet's plane.
  void weights(const double* point, double* result) const {
    double to_point[3];
    subtract(point, corner_[0], to_point);
    const double aa = dot(edge_, edge_), ac = dot(edge_, side_), cc = dot(side_, side_);
    const double pa = dot(to_point, edge_), pc = dot(to_point, side_), scale = aa * cc - ac * ac;
    result[1] = (cc * pa - ac * pc) / scale;
    result[2] = (aa * pc - ac * pa) / scale;
    result[0] = 1.0 - result[1] - result[2];
  }

  // Angular velocity from the velocities of the corners (rigid motion: v_k - v_0 = spin x edge_k); null: at rest.
  void spin(double** velocity, double* result) const {
    std::fill_n(result, 3, 0.0);
    if (!velocity) return;
    double turn_edge[3], turn_side[3];
    subtract(velocity[1], velocity[0], turn_edge);
    subtract(velocity[2], velocity[0], turn_side);
    const double squared = dot(normal_, normal_);
    const double about_normal = dot(turn_edge, in_plane_) / (dot(edge_, edge_) * squared);
    for (int axis = 0; axis < 3; ++axis)
      result[axis] = (dot(turn_side, normal_) * edge_[axis] - dot(turn_edge, normal_) * side_[axis]) / squared +
                     about_normal * normal_[axis];
  }

 private:
  double corner_[3][3];       // m
  double edge_[3], side_[3];  // m, from corner 0 to corners 1 and 2
  double normal_[3];          // m2, twice the area
  double in_plane_[3];        // m3, across the edge
  double frame_[3][3];        // -, unit vectors along, across, normal
};

}  // namespace load_ledger
