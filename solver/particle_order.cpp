// Takes the place of Atom::sort: the solver's shared library calls it through its symbol table, where a definition in
// the program comes first. The library goes through the cells of the domain along x, then y, then z: of a long bed a
// particle's neighbours in the next layer lie far off, and a bed that no cache holds waits for them. Ours takes cells
// along a curve that fills space (G. M. Morton, IBM, 1966), so that neighbours in all directions are mostly near.

#include "particle_order.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "atom.h"
#include "atom_vec.h"
#include "domain.h"
#include "neighbor.h"
#include "universe.h"
#include "update.h"

#ifndef LIGGGHTS_VERSION_BUILT_FOR
#error "build with make -C solver, which says for which version"
#endif

namespace particle_order {

namespace {

constexpr char SORT[] = "_ZN9LAMMPS_NS4Atom4sortEv";  // mangled name of what ours stands before
constexpr double CELL_OVER_REACH = 0.5;               // -, of a cell's edge over the reach of lists of neighbours
constexpr double MOST_CELLS = 1 << 21;                // along an axis: three times 21 bits are a number

bool stock = false;

// The 21 bits of a number with two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

// Where along the curve the cell of a place lies, counted from a corner of the domain.
std::uint64_t along_curve(const double* place, const double* corner, double cell) {
  std::uint64_t position = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::clamp((place[axis] - corner[axis]) / cell, 0.0, MOST_CELLS - 1.0);
    position |= spread(static_cast<std::uint64_t>(cells)) << axis;
  }
  return position;
}

}  // namespace

void use_stock() { stock = true; }

}  // namespace particle_order

namespace LAMMPS_NS {

// Between the exchange of particles and that of their copies, as in the library: maps and lists are made after it.
void Atom::sort() {
  using namespace particle_order;
  static const auto library = reinterpret_cast<void (*)(Atom*)>(dlsym(RTLD_NEXT, SORT));
  const double cell = CELL_OVER_REACH * neighbor->cutneighmax;
  if (stock || domain->triclinic || !(cell > 0.0) || !std::strstr(universe->version, LIGGGHTS_VERSION_BUILT_FOR))
    return library(this);
  nextsort = (update->ntimestep / sortfreq + 1) * sortfreq;

  std::vector<std::pair<std::uint64_t, int>> order(nlocal);  // place on the curve, where the particle lies now
  for (int particle = 0; particle < nlocal; ++particle)
    order[particle] = {along_curve(x[particle], domain->sublo, cell), particle};
  std::sort(order.begin(), order.end());

  // The first particle of each circle of moves waits behind the last one.
  if (nlocal == nmax) avec->grow(0);
  for (int first = 0; first < nlocal; ++first) {
    if (order[first].second == first) continue;
    avec->copy(first, nlocal, 0);
    int empty = first;
    while (order[empty].second != first) {
      const int next = order[empty].second;
      avec->copy(next, empty, 0);
      order[empty].second = empty;
      empty = next;
    }
    avec->copy(nlocal, empty, 0);
    order[empty].second = empty;
  }
}

}  // namespace LAMMPS_NS
