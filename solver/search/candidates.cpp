#include "candidates.h"

#include <algorithm>
#include <cmath>

#include "fix_neighlist_mesh.h"
#include "tri_mesh.h"

namespace wall_search {

namespace {

constexpr int BITS = 64;

double distance(const double* a, const double* b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

void Candidates::make(const Origin& origin, const LAMMPS_NS::FixNeighlistMesh& list, LAMMPS_NS::TriMesh* mesh,
                      double** position, const double* radius) {
  made_ = true;
  origin_ = origin;
  pairs_.clear();
  neighbours_.clear();
  triangles_.clear();
  std::vector<int> place_of(origin.particles, -1);
  for (int triangle = 0; triangle < origin.triangles; ++triangle) {
    const std::size_t before = pairs_.size();
    for (const int particle : list.get_contact_list(triangle)) {
      if (particle >= origin.particles) continue;  // a ghost: the rank that owns it looks at it
      if (place_of[particle] < 0) {
        place_of[particle] = static_cast<int>(neighbours_.size());
        const double* at = position[particle];
        neighbours_.push_back({particle, {at[0], at[1], at[2]}, radius[particle], 0.0, 0.0, false});
      }
      pairs_.push_back({particle, triangle, place_of[particle], 0.0});
    }
    if (pairs_.size() > before) triangles_.push_back(triangle);
  }
  first_.assign(neighbours_.size() + 1, 0);
  for (const Pair& pair : pairs_) ++first_[pair.place + 1];
  for (std::size_t k = 0; k < neighbours_.size(); ++k) first_[k + 1] += first_[k];
  pairs_of_.resize(pairs_.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int index = 0; index < size(); ++index) pairs_of_[next[pairs_[index].place]++] = index;
  marked_.assign((pairs_.size() + BITS - 1) / BITS, 0);
  mesh_path_ = 0.0;
  corners_.clear();
  if (mesh->isMoving() || mesh->isDeforming()) move(mesh, position, radius, true);
}

void Candidates::move(LAMMPS_NS::TriMesh* mesh, double** position, const double* radius, bool mesh_moves) {
  for (Neighbour& each : neighbours_) {
    const double* at = position[each.particle];
    const double size = radius[each.particle];
    each.path += distance(at, each.position) + std::abs(size - each.radius);
    std::copy(at, at + 3, each.position);
    each.radius = size;
  }
  if (!mesh_moves) return;
  const bool known = !corners_.empty();
  corners_.resize(9 * triangles_.size());
  double farthest = 0.0;
  double* stored = corners_.data();
  for (const int triangle : triangles_) {
    for (int k = 0; k < 3; ++k, stored += 3) {
      double corner[3];
      mesh->node(triangle, k, corner);
      if (known) farthest = std::max(farthest, distance(corner, stored));
      std::copy(corner, corner + 3, stored);
    }
  }
  mesh_path_ += farthest;
}

const std::vector<int>& Candidates::due(bool all) {
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    Neighbour& each = neighbours_[k];
    const double path = path_of(static_cast<int>(k));
    each.looked_at = all || each.due <= path;
    if (!each.looked_at) continue;
    for (int at = first_[k]; at < first_[k + 1]; ++at) {
      const int index = pairs_of_[at];
      if (all || pairs_[index].due <= path) marked_[index / BITS] |= std::uint64_t{1} << (index % BITS);
    }
  }
  due_.clear();
  for (std::size_t word = 0; word < marked_.size(); ++word) {
    for (std::uint64_t bits = marked_[word]; bits; bits &= bits - 1)
      due_.push_back(static_cast<int>(word) * BITS + __builtin_ctzll(bits));
    marked_[word] = 0;
  }
  return due_;
}

void Candidates::settle() {
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    Neighbour& each = neighbours_[k];
    if (!each.looked_at) continue;
    each.due = std::numeric_limits<double>::infinity();
    for (int at = first_[k]; at < first_[k + 1]; ++at) each.due = std::min(each.due, pairs_[pairs_of_[at]].due);
  }
}

}  // namespace wall_search
