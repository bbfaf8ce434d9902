// Particles and triangles of one mesh that may touch before the solver's next neighbour list, and when each pair has to
// be looked at again.
//
// A pair whose surfaces are a gap apart cannot touch before particle and mesh together have moved by that gap. So each
// pair keeps the path at which it is due: the path of its particle and of the mesh so far, plus the gap. Paths are
// summed from positions as they are found at every step, whatever moved particle or mesh.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace LAMMPS_NS {
class FixNeighlistMesh;
class TriMesh;
}  // namespace LAMMPS_NS

namespace wall_search {

// What a list was made from; another one asks for another list.
struct Origin {
  std::uint64_t build;            // of the mesh's neighbour list, by our count
  std::int64_t neighbour_builds;  // of all neighbour lists, by the solver's count
  int particles, triangles;       // on this rank
  bool operator==(const Origin& other) const {
    return build == other.build && neighbour_builds == other.neighbour_builds && particles == other.particles &&
           triangles == other.triangles;
  }
};

class Candidates {
 public:
  struct Pair {
    int particle, triangle;  // local indices
    int place;               // into the particles that have candidates
    double due;              // m, path of particle and mesh at which it has to be looked at
  };

  bool made_from(const Origin& origin) const { return made_ && origin_ == origin; }
  // Takes all pairs of the solver's neighbour list, in its order; all of them are due.
  void make(const Origin& origin, const LAMMPS_NS::FixNeighlistMesh& list, LAMMPS_NS::TriMesh* mesh, double** position,
            const double* radius);
  // Adds what particles and mesh have moved since the last call, m.
  void move(LAMMPS_NS::TriMesh* mesh, double** position, const double* radius, bool mesh_moves);
  // Indices of the pairs that are due, in the order of the solver's list; all: of every pair.
  const std::vector<int>& due(bool all);

  const Pair& pair(int index) const { return pairs_[index]; }
  bool is_due(int index) const { return pairs_[index].due <= path_of(pairs_[index].place); }
  void touches(int index) { pairs_[index].due = -std::numeric_limits<double>::infinity(); }
  // The surfaces of a pair are this far apart, m.
  void is_apart(int index, double gap) { pairs_[index].due = path_of(pairs_[index].place) + gap; }
  // After all pairs that were due: when each particle has to be looked at next.
  void settle();

  int size() const { return static_cast<int>(pairs_.size()); }
  int triangles() const { return static_cast<int>(triangles_.size()); }

 private:
  // A particle that has candidates.
  struct Neighbour {
    int particle;
    double position[3], radius;  // m, at the last step
    double path;                 // m, since the list was made
    double due;                  // m, the first of its pairs
    bool looked_at;              // in this step
  };

  double path_of(int place) const { return neighbours_[place].path + mesh_path_; }

  bool made_ = false;
  Origin origin_{};
  std::vector<Pair> pairs_;                // by triangle, then as the solver lists them
  std::vector<Neighbour> neighbours_;      // particles that have pairs
  std::vector<int> first_, pairs_of_;      // pairs of neighbour k: pairs_of_[first_[k]] to [first_[k + 1] - 1]
  std::vector<int> triangles_;             // those that have pairs
  std::vector<double> corners_;            // m, of these at the last step, nine each; only where the mesh moves
  double mesh_path_ = 0.0;                 // m, the largest of these corners in each step, summed
  std::vector<std::uint64_t> marked_;      // a bit per pair
  std::vector<int> due_;
};

}  // namespace wall_search
