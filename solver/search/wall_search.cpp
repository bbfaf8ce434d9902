// Takes the place of FixWallGran::post_force_mesh, FixNeighlistMesh::pre_force and MeshModuleStress::calc_total_force:
// the solver's shared library calls them through its symbol table, where a definition in the program comes first.

#include "wall_search.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "../private_member.h"
#include "atom.h"
#include "candidates.h"
#include "comm.h"
#include "error.h"
#include "fix_contact_history_mesh.h"
#include "fix_neighlist_mesh.h"
#include "fix_wall_gran.h"
#include "gap.h"
#include "library.h"
#include "mesh_module_stress.h"
#include "neighbor.h"
#include "tri_mesh.h"
#include "universe.h"
#include "update.h"

#ifndef LIGGGHTS_VERSION_BUILT_FOR
#error "build with make -C solver, which says for which version"
#endif

using namespace LAMMPS_NS;

struct KeepFlags {
  friend auto member(KeepFlags);
};
struct IntersectFlags {
  friend auto member(IntersectFlags);
};
template struct PrivateMember<KeepFlags, &FixContactHistoryMesh::keepflag_>;
template struct PrivateMember<IntersectFlags, &FixContactHistoryMesh::intersectflag_>;

namespace wall_search {

namespace {

// Mangled names of what ours stands before.
constexpr char POST_FORCE_MESH[] = "_ZN9LAMMPS_NS11FixWallGran15post_force_meshEi";
constexpr char PRE_FORCE[] = "_ZN9LAMMPS_NS16FixNeighlistMesh9pre_forceEi";
constexpr char CALC_TOTAL_FORCE[] = "_ZN9LAMMPS_NS16MeshModuleStress16calc_total_forceEv";

constexpr int FACE = 7;                // the solver's word for a contact with the inside of a triangle
constexpr double MARGIN = 1e-3;        // -, of the radius: covers rounding, and points 1e-8 m off a face that the solver
                                       // takes for its
constexpr int PROOF_INTERVAL = 10000;  // steps between two looks at all pairs

std::string left;  // why all is left to the library; empty where it is not

// Every list of neighbours that was made gets a number of its own; a list that lies where another lay has another.
std::uint64_t builds = 0;
std::map<const FixNeighlistMesh*, std::uint64_t> build_of;

template <typename Function>
Function original(const char* symbol) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, symbol));
}

// The contact history of a mesh, of which only particles that touch, or did in the step before, are gone through.
class Touching {
 public:
  // Marks what is known of contacts as of the step before; all: of every particle.
  void begin(FixContactHistoryMesh* history, bool all) {
    all_ = all;
    ++turn_;
    previous_.swap(particles_);
    particles_.clear();
    if (all) {
      history->markAllContacts();
      return;
    }
    bool **keep = history->*member(KeepFlags{}), **intersect = history->*member(IntersectFlags{});
    for (const int particle : previous_) {
      const int count = history->nneighs(particle);
      std::fill_n(keep[particle], count, false);
      std::fill_n(intersect[particle], count, false);
    }
  }

  // A large particle touches many triangles at once, and to go through its history takes as long as its list is.
  void add(int particle) {
    if (is_in(particle)) return;
    if (last_turn_.size() <= static_cast<std::size_t>(particle)) last_turn_.resize(particle + 1, 0);
    last_turn_[particle] = turn_;
    particles_.push_back(particle);
  }

  // Forgets contacts that are over.
  void end(FixContactHistoryMesh* history) {
    if (all_) {
      history->cleanUpContacts();
      return;
    }
    for (const int particle : particles_) history->cleanUpContacts(particle, particle + 1);
    for (const int particle : previous_)
      if (!is_in(particle)) history->cleanUpContacts(particle, particle + 1);
  }

 private:
  // Whether a particle has a contact in this step.
  bool is_in(int particle) const {
    return static_cast<std::size_t>(particle) < last_turn_.size() && last_turn_[particle] == turn_;
  }

  bool all_ = true;
  std::uint64_t turn_ = 0;
  std::vector<std::uint64_t> last_turn_;   // by particle: the last step in which it had a contact
  std::vector<int> particles_, previous_;  // with contacts in this step and the one before
};

struct Search {
  Candidates pairs;
  Touching touching;
};

std::map<const FixNeighlistMesh*, Search> searches;

// How the solver sees a pair.
struct Seen {
  double gap, offset[3], weight[3];  // m, m from the centre to the contact point, - of the triangle's corners
  int feature;                       // face, edge or corner
};

// Looks at a pair as the solver does; returns whether it touches, and keeps when it has to be looked at again. reach: m,
// gap up to which models act without a touch.
bool look(Candidates& pairs, int index, TriMesh* mesh, double* position, double radius, double reach, Seen& seen) {
  const Candidates::Pair& pair = pairs.pair(index);
  seen.gap = mesh->resolveTriSphereContactBary(pair.particle, pair.triangle, radius, position, seen.offset, seen.weight,
                                               seen.feature, true);
  if (seen.gap <= 0.0 || seen.gap < reach) {
    pairs.touches(index);
    return true;
  }
  // The solver's gap may jump, at edges that it leaves to a neighbour; the distance never does.
  double corner[3][3];
  for (int k = 0; k < 3; ++k) mesh->node(pair.triangle, k, corner[k]);
  const double apart = distance_to_triangle(position, corner) - radius;
  pairs.is_apart(index, std::max(0.0, apart - std::max(reach, 0.0) - MARGIN * radius));
  return false;
}

// Velocity of the wall at a contact, m/s; velocity: of the corners of its triangle.
void wall_velocity_at(const Seen& seen, double** velocity, double* result) {
  for (int axis = 0; axis < 3; ++axis)
    result[axis] =
        seen.weight[0] * velocity[0][axis] + seen.weight[1] * velocity[1][axis] + seen.weight[2] * velocity[2][axis];
}

void say(LAMMPS* lammps, const std::string& sentence) {
  if (lammps->comm->me != 0) return;
  for (FILE* to : {lammps->screen, lammps->logfile})
    if (to) fprintf(to, "%s\n", sentence.c_str());
}

// Fields that are read through the solver's headers are where its compiled code has them.
bool laid_out(LAMMPS* lammps) {
  const Atom* atom = lammps->atom;
  return lammps_extract_atom(lammps, "x") == atom->x && lammps_extract_atom(lammps, "radius") == atom->radius &&
         lammps_extract_global(lammps, "nlocal") == &atom->nlocal &&
         lammps_extract_global(lammps, "dt") == &lammps->update->dt;
}

// Once per wall.
void tell(LAMMPS* lammps, const FixWallGran* wall, const std::string& sentence) {
  static std::map<const FixWallGran*, std::string> told;
  std::string& last = told[wall];
  if (last != sentence) say(lammps, "Wall search of " + std::string(wall->id) + ": " + sentence);
  last = sentence;
}

}  // namespace

void use_stock() { left = "as asked"; }

void prove(LAMMPS* lammps) {
  if (!left.empty()) return;
  if (!std::strstr(lammps->universe->version, LIGGGHTS_VERSION_BUILT_FOR))
    left = std::string("this program was built for ") + LIGGGHTS_VERSION_BUILT_FOR;
  for (const char* symbol : {POST_FORCE_MESH, PRE_FORCE, CALC_TOTAL_FORCE})
    if (dlsym(RTLD_DEFAULT, symbol) == dlsym(RTLD_NEXT, symbol)) left = "the library calls functions of its own";
  if (!left.empty()) say(lammps, "Wall search: " + std::string(STOCK) + ", " + left + ".");
}

}  // namespace wall_search

namespace LAMMPS_NS {

using namespace wall_search;

void FixNeighlistMesh::pre_force(int vflag) {
  static const auto library = original<void (*)(FixNeighlistMesh*, int)>(PRE_FORCE);
  if (buildNeighList) build_of[this] = ++builds;
  library(this, vflag);
}

void FixWallGran::post_force_mesh(int vflag) {
  static const auto library = original<void (*)(FixWallGran*, int)>(POST_FORCE_MESH);
  static const bool fits = laid_out(lmp);
  std::string other = left;
  if (other.empty() && !(fits && x_ == atom->x && radius_ == atom->radius && nlocal_ == atom->nlocal))
    other = "the library has its fields elsewhere than this program was built for";
  if (other.empty() && (!impl || !radius_ || atom->shapetype_flag))
    other = "particles are no spheres of a radius of their own";
  for (int index = 0; index < n_FixMesh_; ++index) {
    if (FixMesh_list_[index]->meshMulticontactData()) other = "the contact model lets contacts act on each other";
    if (!FixMesh_list_[index]->contactHistory()) other = "a mesh keeps no contacts";
    if (!build_of.count(FixMesh_list_[index]->meshNeighlist())) other = "when lists of neighbours are made is not seen";
  }
  if (!other.empty()) {
    tell(lmp, this, std::string(STOCK) + ", " + other + ".");
    return library(this, vflag);
  }
  tell(lmp, this, std::string(OURS) + ", pairs are looked at when they may touch.");

  LCM::SurfacesIntersectData contact;
  contact.is_wall = true;
  for (int index = 0; index < n_FixMesh_; ++index) {
    FixMeshSurface* fix_mesh = FixMesh_list_[index];
    TriMesh* mesh = fix_mesh->triMesh();
    FixContactHistoryMesh* history = fix_mesh->contactHistory();
    FixNeighlistMesh* list = fix_mesh->meshNeighlist();
    if (store_force_contact_) fix_wallforce_contact_ = fix_mesh->meshforceContact();
    if (store_force_contact_stress_) fix_wallforce_contact_stress_ = fix_mesh->meshforceContactStress();
    fix_store_multicontact_data_ = nullptr;
    atom_type_wall_ = fix_mesh->atomTypeWall();
    auto* velocities = mesh->prop().getElementProperty<MultiVectorContainer<double, 3, 3> >("v");
    double wall_velocity[3] = {0.0, 0.0, 0.0};
    contact.mesh = mesh;
    contact.fix_mesh = fix_mesh;

    auto& [pairs, touching] = searches[list];
    const Origin origin{build_of[list], neighbor->ncalls, nlocal_, mesh->sizeLocal() + mesh->sizeGhost()};
    const bool anew = !pairs.made_from(origin);
    if (anew) pairs.make(origin, *list, mesh, x_, radius_);
    else pairs.move(mesh, x_, radius_, mesh->isMoving() || mesh->isDeforming());
    touching.begin(history, anew);
    for (const int at : pairs.due(anew || update->ntimestep % PROOF_INTERVAL == 0)) {
      const bool due = pairs.is_due(at);
      const int particle = pairs.pair(at).particle, triangle = pairs.pair(at).triangle;
      const double reach = (neighbor->contactDistanceFactor - 1.0) * radius_[particle];
      Seen seen;
      if (!look(pairs, at, mesh, x_[particle], radius_[particle], reach, seen) || seen.gap > cutneighmax_) continue;
      if (!due) error->one(FLERR, "wall search: found a contact before it was due; run with -search stock and tell of it");
      touching.add(particle);
      contact.i = particle;
      contact.radi = radius_[particle];
      const bool intersects = seen.gap <= 0.0;
      if (!history->handleContact(particle, mesh->id(triangle), contact.contact_history, intersects,
                                  seen.feature == FACE))
        continue;
      if (velocities) wall_velocity_at(seen, velocities->begin()[triangle], wall_velocity);
      contact.deltan = -seen.gap;
      for (int axis = 0; axis < 3; ++axis) contact.delta[axis] = -seen.offset[axis];
      impl->compute_force(this, contact, intersects, wall_velocity, fix_mesh, index, mesh, triangle);
    }
    pairs.settle();
    touching.end(history);
  }
}

// Wear of the step, and stresses of triangles from their forces, without the arithmetic where there are none.
void MeshModuleStress::calc_total_force() {
  static const auto library = original<void (*)(MeshModuleStress*)>(CALC_TOTAL_FORCE);
  if (!left.empty() || !stress_flag_) return library(this);
  for (int triangle = 0; wear_flag_ && triangle < mesh->size(); ++triangle) {
    if (wear_step(triangle) == 0.0) continue;
    wear(triangle) += wear_step(triangle);
    wear_step(triangle) = 0.0;
  }
  MPI_Sum_Vector(f_total_, 3, world);
  MPI_Sum_Vector(torque_total_, 3, world);
  updatedStresses_ = true;
  for (int triangle = 0; triangle < mesh->size(); ++triangle) {
    const double* force = f(triangle);
    if (force[0] == 0.0 && force[1] == 0.0 && force[2] == 0.0) {
      if (sigma_n(triangle) != 0.0 || sigma_t(triangle) != 0.0) sigma_n(triangle) = sigma_t(triangle) = 0.0;
      continue;
    }
    double normal[3], tangential[3];
    mesh->surfaceNorm(triangle, normal);
    const double along = vectorDot3D(force, normal), per_area = 1.0 / mesh->areaElem(triangle);
    for (int axis = 0; axis < 3; ++axis) tangential[axis] = force[axis] - normal[axis] * along;
    sigma_n(triangle) = std::abs(along) * per_area;
    sigma_t(triangle) = vectorMag3D(tangential) * per_area;
  }
}

}  // namespace LAMMPS_NS
