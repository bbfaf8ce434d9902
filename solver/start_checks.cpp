// What must hold before a ledger may be trusted: the deck's words, the solver's version and class layout, and that the
// solver calls us. Whatever does not hold stops the run with one sentence.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "atom.h"
#include "comm.h"
#include "contact_hook.h"
#include "error.h"
#include "fix_load_ledger.h"
#include "fix_mesh_surface.h"
#include "fix_property_global.h"
#include "library.h"
#include "modify.h"
#include "own_kernels.h"
#include "properties.h"
#include "tri_mesh.h"
#include "universe.h"
#include "update.h"

#ifndef LIGGGHTS_VERSION_BUILT_FOR
#error "build with make -C solver, which says for which version"
#endif

using namespace LAMMPS_NS;

namespace load_ledger {

namespace {

constexpr double AREA_TOLERANCE = 1e-9;             // relative; rounding of a cross product
constexpr std::size_t LARGEST_RECORD = 2000000000;  // bytes; restart files count them in an int
constexpr int PROOF_INTERVAL = 1000;                // steps between two looks for a first contact

std::string kernel_names() {
  std::string names;
  for (const Kernel& kernel : kernels()) names += (names.empty() ? "" : ", ") + std::string(kernel.name);
  return names;
}

std::string parameter_names(const Kernel& kernel) {
  std::string names;
  for (int k = 0; k < parameter_count(kernel); ++k) names += (k ? ", " : "") + std::string(kernel.parameters[k]);
  return names;
}

}  // namespace

void FixLoadLedger::parse(int narg, char** arg) {
  const auto stop = [this](const std::string& sentence) {
    error->all(FLERR, ("fix load/ledger: " + sentence).c_str());
  };
  for (int k = 3; k < narg;) {
    const std::string key = arg[k++];
    if ((key == "mesh" || key == "file") && k < narg) {
      (key == "mesh" ? mesh_id_ : file_) = arg[k++];
    } else if (key == "history" && k < narg) {
      char* end = nullptr;
      history_ = std::strtoll(arg[k], &end, 10);
      if (history_ < 1 || *end != '\0')
        stop("found history '" + std::string(arg[k]) + "', allowed is a whole number of steps from 1.");
      ++k;
    } else if (key == "kernels") {
      parse_kernels(narg, arg, k);
      k = narg;
    } else {
      stop("found '" + key + "', allowed are mesh MESH_ID, file FILE, history STEPS and kernels NAME ...");
    }
  }
  if (mesh_id_.empty() || file_.empty()) stop("it needs mesh MESH_ID and file FILE.");
  if (!atom->sphere_flag && !atom->radius_flag) stop("it needs spheres or multispheres.");
  if (atom->superquadric_flag || atom->shapetype_flag)
    stop("found particles that are not spheres; allowed are spheres and multispheres.");
}

// All words from `first` on: kernels, each followed by all of its parameters with their values, in any order.
void FixLoadLedger::parse_kernels(int narg, char** arg, int first) {
  const auto stop = [this](const std::string& sentence) {
    error->all(FLERR, ("fix load/ledger: " + sentence).c_str());
  };
  for (int k = first; k < narg;) {
    const std::string name = arg[k++];
    const Kernel* found = nullptr;
    for (const Kernel& kernel : kernels())
      if (name == kernel.name) found = &kernel;
    if (!found) stop("found kernel '" + name + "', allowed are " + kernel_names() + ".");
    const int count = parameter_count(*found);
    ChosenKernel chosen{*found, {}};
    std::vector<bool> given(count, false);
    for (int pair = 0; pair < count; ++pair, k += 2) {
      int at = 0;
      while (at < count && (k >= narg || std::strcmp(found->parameters[at], arg[k]))) ++at;
      if (at == count || given[at] || k + 1 >= narg)
        stop("found " + (k < narg ? "'" + std::string(arg[k]) + "'" : "nothing") + " after " + std::to_string(pair) +
             " parameters of the kernel " + name + ", allowed are " + parameter_names(*found) +
             ", each once and with its value.");
      char* end = nullptr;
      chosen.values[at] = std::strtod(arg[k + 1], &end);
      if (end == arg[k + 1] || *end != '\0' || !std::isfinite(chosen.values[at]))
        stop("found " + std::string(arg[k]) + " '" + arg[k + 1] + "' of the kernel " + name + ", allowed is a number.");
      given[at] = true;
    }
    kernels_.push_back(chosen);
  }
}

void FixLoadLedger::find_mesh() {
  Fix* found = modify->find_fix_id(mesh_id_.c_str());
  mesh_ = dynamic_cast<FixMeshSurface*>(found);
  if (!mesh_) error->all(FLERR, ("fix load/ledger: found no mesh/surface fix with the id '" + mesh_id_ + "'.").c_str());
  if (!mesh_->contactHistory())
    error->all(FLERR, ("fix load/ledger: no wall/gran fix before it uses the mesh '" + mesh_id_ +
                       "', so nothing can touch it.")
                          .c_str());
}

// A ledger belongs to the mesh that it was defined for, and its file to nobody else.
void FixLoadLedger::check_deck() {
  const auto stop = [this](const std::string& sentence) {
    error->all(FLERR, ("fix load/ledger " + std::string(id) + ": " + sentence).c_str());
  };
  if (mesh_->triMesh() != triangles_of_)
    stop("the mesh '" + mesh_id_ + "' was defined again after it; unfix the ledger before, and define it anew.");
  for (int k = 0; k < modify->nfix; ++k) {
    const auto* other = dynamic_cast<FixLoadLedger*>(modify->fix[k]);
    if (other && other != this && other->file_ == file_)
      stop("fix " + std::string(other->id) + " writes to " + file_ + " as well.");
  }
  if (sums_.bytes() > LARGEST_RECORD) stop("the mesh has too many triangles for a restart file.");
}

// Fields read through our headers are compared with what the solver's own compiled code gives for them.
void FixLoadLedger::check_layout() {
  if (!std::strstr(universe->version, LIGGGHTS_VERSION_BUILT_FOR)) {
    error->all(FLERR, (std::string("fix load/ledger was built for ") + LIGGGHTS_VERSION_BUILT_FOR + " and runs with '" +
                       universe->version + "'; build it for that version (make -C solver).")
                          .c_str());
  }
  std::string wrong;
  const auto same = [&wrong](bool equal, const char* what) {
    if (!equal) wrong += (wrong.empty() ? "" : ", ") + std::string(what);
  };
  same(lammps_extract_global(lmp, "dt") == &update->dt, "update");
  same(lammps_extract_global(lmp, "nlocal") == &atom->nlocal, "atom");
  same(lammps_extract_atom(lmp, "x") == atom->x && lammps_extract_atom(lmp, "v") == atom->v, "motion of particles");
  same(lammps_extract_atom(lmp, "omega") == atom->omega, "spin of particles");
  same(lammps_extract_atom(lmp, "radius") == atom->radius && lammps_extract_atom(lmp, "rmass") == atom->rmass,
       "size of particles");
  same(lammps_extract_atom(lmp, "type") == atom->type && lammps_extract_atom(lmp, "mask") == atom->mask,
       "type of particles");
  same(mesh_id_ == mesh_->id, "fix");
  if (*hook_fault()) same(false, hook_fault());
  if (!wrong.empty()) misfit(wrong);
}

void FixLoadLedger::misfit(const std::string& what) {
  error->one(FLERR, ("fix load/ledger does not fit this LIGGGHTS (" + what +
                     "); build it against the headers of the solver in use "
                     "(make -C solver).")
                        .c_str());
}

// The same for the mesh, once the set-up has shared it out between the ranks: areas and ids as the solver keeps them.
void FixLoadLedger::check_triangles() {
  TriMesh* mesh = mesh_->triMesh();
  if (mesh->sizeGlobal() != triangles_) misfit("number of triangles");
  for (int triangle = 0; triangle < mesh->sizeLocal(); ++triangle) {
    double corner[3][3], along[3], across[3], normal[3];
    for (int k = 0; k < 3; ++k) mesh->node(triangle, k, corner[k]);
    for (int axis = 0; axis < 3; ++axis) {
      along[axis] = corner[1][axis] - corner[0][axis];
      across[axis] = corner[2][axis] - corner[0][axis];
    }
    cross(along, across, normal);
    const double area = mesh->areaElem(triangle);
    const bool known = mesh->id(triangle) >= 0 && mesh->id(triangle) < triangles_;
    if (!known || std::abs(0.5 * length(normal) - area) > AREA_TOLERANCE * area) misfit("triangles");
  }
}

// Effective modulus of each particle type and the wall: 1/E* = sum of (1 - nu^2)/E (Hertz 1882).
void FixLoadLedger::check_materials() {
  const int types = atom->get_properties()->max_type();
  const auto property = [&](const char* name) {
    return static_cast<FixPropertyGlobal*>(
        modify->find_fix_property(name, "property/global", "peratomtype", types, 0, style));
  };
  FixPropertyGlobal *modulus = property("youngsModulus"), *ratio = property("poissonsRatio");
  const auto compliance = [&](int type) {
    const double nu = ratio->compute_vector(type - 1);
    return (1.0 - nu * nu) / modulus->compute_vector(type - 1);
  };
  modulus_of_type_.clear();
  for (int type = 1; type <= types; ++type)
    modulus_of_type_.push_back(1.0 / (compliance(type) + compliance(mesh_->atomTypeWall())));
}

// The solver must call us for every contact that it sees. Without a contact there is nothing to prove yet: the first
// one is looked for now and then, and at the end of the run.
void FixLoadLedger::prove_called(bool last) {
  const bool starting = phase_ == Phase::set_up;
  if (!starting && !last && update->ntimestep % PROOF_INTERVAL) return;
  int touching = 0;
  mesh_->contactHistory()->n_contacts(touching);
  double local[2] = {static_cast<double>(touching), static_cast<double>(reported_)}, all[2];
  MPI_Allreduce(local, all, 2, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] > 0 && all[1] == 0)
    error->all(FLERR,
               "fix load/ledger: the solver sees contacts with meshes and reports none of them to the ledger; build it "
               "against the solver in use (make -C solver).");
  std::ostringstream text;
  text << "Load ledger " << id << ": mesh " << mesh_id_ << " with " << triangles_ << " triangles, "
       << LIGGGHTS_VERSION_BUILT_FOR << " and its class layout as built for, ";
  if (all[1] > 0) {
    if (!proven_) say(text.str() + "every contact is reported to it.");
    proven_ = true;
  } else if (starting) {
    say(text.str() + "no contact yet.");
  }
}

void FixLoadLedger::say(const std::string& sentence) {
  if (comm->me != 0) return;
  if (screen) fprintf(screen, "%s\n", sentence.c_str());
  if (logfile) fprintf(logfile, "%s\n", sentence.c_str());
}

}  // namespace load_ledger
