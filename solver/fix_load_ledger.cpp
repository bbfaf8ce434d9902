// What a contact adds to the ledger, step by step. Files and restart: ledger_file.cpp. Checks at the start:
// start_checks.cpp.

#include "fix_load_ledger.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "atom.h"
#include "comm.h"
#include "contact_hook.h"
#include "error.h"
#include "facet.h"
#include "fix_mesh_surface.h"
#include "fix_multisphere.h"
#include "memory.h"
#include "modify.h"
#include "tri_mesh.h"
#include "update.h"

using namespace LAMMPS_NS;

namespace load_ledger {

namespace {

// Radius (m) of the contact circle of a sphere on a flat (Hertz 1882).
double hertz_radius(double force, double radius, double effective_modulus) {
  return std::cbrt(0.75 * force * radius / effective_modulus);
}

}  // namespace

FixLoadLedger::FixLoadLedger(LAMMPS* lammps, int narg, char** arg) : Fix(lammps, narg, arg) {
  parse(narg, arg);
  find_mesh();
  // Until the first set-up every rank holds the whole mesh, afterwards its share.
  triangles_ = std::max(mesh_->triMesh()->sizeLocal(), mesh_->triMesh()->sizeGlobal());
  triangles_of_ = mesh_->triMesh();
  sums_ = LedgerSums(FIRST_KERNEL + static_cast<int>(kernels_.size()), triangles_);
  nevery = 1;
  restart_global = 1;
  create_attribute = 1;
  scalar_flag = vector_flag = 1;
  size_vector = DRIVE_WORK + 1;
  extscalar = extvector = 1;
  global_freq = 1;
  grow_arrays(atom->nmax);
  std::fill_n(touched_, atom->nmax, 0.0);
  atom->add_callback(0);
}

FixLoadLedger::~FixLoadLedger() {
  forget(this);
  atom->delete_callback(id, 0);
  memory->destroy(touched_);
}

int FixLoadLedger::setmask() { return FixConst::INITIAL_INTEGRATE | FixConst::END_OF_STEP; }

void FixLoadLedger::init() {
  find_mesh();
  check_deck();
  check_layout();
  check_materials();
  multisphere_ = static_cast<FixMultisphere*>(modify->find_fix_style("multisphere", 0));
  listen(mesh_, this);
  observed_.clear();
  phase_ = Phase::set_up;
}

// A run begins: the file of an earlier one goes, and this one writes its own when it is complete. Writing a restart file
// initialises the solver as well, but begins no run.
void FixLoadLedger::setup(int) {
  if (comm->me == 0) std::remove(file_.c_str());
}

// ---------------------------------------------------------------- one contact

// The force is that of this instant, the velocities still those of half a step before; the rest follows at the end of
// the step.
void FixLoadLedger::observe(int particle, const double* force, const double* offset, int triangle,
                            const double* wall_velocity) {
  ++reported_;
  // A compute that asks for contacts makes the solver evaluate them once more, without a force.
  const bool evaluated_for_output = length(force) == 0.0;
  if (phase_ == Phase::between || evaluated_for_output || !(atom->mask[particle] & groupbit)) return;
  const double distance = length(offset);
  const bool apart = distance > atom->radius[particle];  // held by a liquid bridge, for example
  if (distance == 0.0 || apart) return;

  TriMesh* mesh = mesh_->triMesh();
  const Facet facet(mesh, triangle);
  Observed seen;
  Contact& contact = seen.contact;
  double point[3], on_mesh[3], arm[3], moment[3];
  for (int axis = 0; axis < 3; ++axis) {
    contact.normal[axis] = -offset[axis] / distance;
    contact.force[axis] = force[axis];
    contact.velocity_before[axis] = atom->v[particle][axis] - wall_velocity[axis];
    seen.wall_velocity[axis] = wall_velocity[axis];
    point[axis] = atom->x[particle][axis] + offset[axis];
    on_mesh[axis] = -force[axis];
  }
  mesh->surfaceNorm(triangle, contact.triangle_normal);
  facet.weights(point, seen.weights);
  facet.spin(corner_velocities(triangle), seen.wall_spin);
  facet.from_centroid(point, arm);
  cross(arm, on_mesh, moment);
  facet.components(on_mesh, seen.force_on_facet);
  facet.components(moment, seen.moment_on_facet);
  seen.on_back = facet.on_back(contact.normal);
  seen.drive_power = dot(force, wall_velocity);

  contact.radius = atom->radius[particle];
  contact.mass = atom->rmass[particle];
  // The solver's own lever arm, radius less half the overlap: with it pure rolling leaves no sliding.
  seen.lever = 0.5 * (contact.radius + distance);
  seen.signed_force = dot(force, contact.normal);
  contact.approach_speed = std::abs(dot(contact.velocity_before, contact.normal));
  contact.normal_force = std::max(seen.signed_force, 0.0);
  seen.particle = particle;
  seen.triangle = mesh->id(triangle);
  seen.effective_modulus = modulus_of_type_[atom->type[particle] - 1];
  seen.touch = -1;
  observed_.push_back(seen);
}

// Force times velocity is power when both are of one instant. Half a step before, a particle at rest whose spin a
// friction law turns over in every step would seem to slide.
void FixLoadLedger::add_motion(Observed& seen) const {
  Contact& contact = seen.contact;
  const double *velocity = atom->v[seen.particle], *spin = atom->omega[seen.particle];
  double across[3], sliding[3], relative_spin[3], rolling[3];
  for (int axis = 0; axis < 3; ++axis) {
    contact.velocity[axis] = velocity[axis] - seen.wall_velocity[axis];
    relative_spin[axis] = spin[axis] - seen.wall_spin[axis];
  }
  const double approach = dot(contact.velocity, contact.normal);
  cross(spin, contact.normal, across);
  for (int axis = 0; axis < 3; ++axis)
    sliding[axis] = contact.velocity[axis] - approach * contact.normal[axis] - seen.lever * across[axis];
  contact.sliding_speed = length(sliding);
  seen.friction_power = -dot(contact.force, sliding);  // sliding lies in the surface: only the tangential part counts
  cross(relative_spin, contact.normal, rolling);
  contact.rolling_speed = contact.radius * length(rolling);
}

// Velocities (m/s) of a triangle's corners, also those of a surface that moves by itself; null on a mesh at rest.
double** FixLoadLedger::corner_velocities(int triangle) const {
  auto* velocities = mesh_->triMesh()->prop().getElementProperty<MultiVectorContainer<double, 3, 3> >("v");
  return velocities ? velocities->begin()[triangle] : nullptr;
}

// ---------------------------------------------------------------- one step

// Contacts seen while the run was set up are those of its first instant: they count as touching before, not as loads.
void FixLoadLedger::initial_integrate(int) {
  if (phase_ == Phase::set_up) {
    check_triangles();
    prove_called(false);
    gather_touches();
    seed_touching();
  }
  observed_.clear();
  phase_ = Phase::step;
}

void FixLoadLedger::end_of_step() {
  phase_ = Phase::between;
  for (Observed& seen : observed_) add_motion(seen);
  gather_touches();
  sum_loads();
  if (multisphere_)
    sum_body_impacts();
  else
    sum_impacts();
  remember_touching();
  ++steps_;
  time_s_.add(update->dt);
  contacts_ += static_cast<double>(observed_.size());
  const bool last = update->ntimestep == update->laststep;
  if (!proven_) prove_called(last);
  if (last)
    write_file(file_);
  else if (history_ > 0 && steps_ % history_ == 0)
    write_file(file_ + '.' + std::to_string(steps_));
}

// Gathers the contacts of each particle: a sphere can touch several triangles at once.
void FixLoadLedger::gather_touches() {
  touches_.clear();
  touch_of_particle_.assign(atom->nlocal, -1);
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    Observed& seen = observed_[k];
    int& touch = touch_of_particle_[seen.particle];
    if (touch < 0) {
      touch = static_cast<int>(touches_.size());
      touches_.push_back({seen.particle, {0.0, 0.0, 0.0}, static_cast<int>(k)});
    }
    seen.touch = touch;
    Touch& whole = touches_[touch];
    for (int axis = 0; axis < 3; ++axis) whole.force[axis] += seen.contact.normal_force * seen.contact.normal[axis];
    if (seen.signed_force > observed_[whole.strongest].signed_force) whole.strongest = static_cast<int>(k);
  }
}

void FixLoadLedger::sum_loads() {
  const double dt = update->dt;
  for (const Observed& seen : observed_) {
    const Contact& contact = seen.contact;
    const int triangle = seen.triangle;
    const double impulse = contact.normal_force * dt, work = impulse * contact.sliding_speed;
    sums_.add(SLIDING_WORK, triangle, work);
    sums_.add(NORMAL_IMPULSE, triangle, impulse);
    sums_.add(ROLLING_WORK, triangle, impulse * contact.rolling_speed);
    sums_.add(CONTACT_TIME, triangle, dt);
    sums_.add(TANGENTIAL_WORK, triangle, seen.friction_power * dt);
    sums_.add(DRIVE_WORK, triangle, seen.drive_power * dt);
    for (int k = 0; k < 3; ++k) {
      sums_.add(IMPULSE + k, triangle, seen.force_on_facet[k] * dt);
      if (seen.on_back) sums_.add(BACK_IMPULSE + k, triangle, seen.force_on_facet[k] * dt);
      sums_.add(MOMENT + k, triangle, seen.moment_on_facet[k] * dt);
    }
    const double total_force = length(touches_[seen.touch].force);
    const double radius = hertz_radius(total_force, contact.radius, seen.effective_modulus);
    const double means[4] = {radius, seen.weights[0], seen.weights[1], seen.weights[2]};
    for (int k = 0; k < 4; ++k) {
      sums_.add(BY_WORK + k, triangle, work * means[k]);
      sums_.add(BY_IMPULSE + k, triangle, impulse * means[k]);
    }
    add_kernels(seen, false, dt);
  }
}

// Adds the values of the kernels that are summed over time, or over impacts.
void FixLoadLedger::add_kernels(const Observed& seen, bool per_impact, double weight) {
  int column = FIRST_KERNEL;
  for (const ChosenKernel& chosen : kernels_) {
    if (chosen.kernel.per_impact == per_impact)
      sums_.add(column, seen.triangle, chosen.kernel.value(seen.contact, chosen.values) * weight);
    ++column;
  }
}

void FixLoadLedger::add_impact(const Observed& strongest) {
  const Contact& contact = strongest.contact;
  sums_.add(IMPACT_ENERGY, strongest.triangle, 0.5 * contact.mass * contact.approach_speed * contact.approach_speed);
  add_kernels(strongest, true, 1.0);
}

// The first touch of an episode brings its energy, to the triangle that carries most of the particle's force.
void FixLoadLedger::sum_impacts() {
  for (const Touch& touch : touches_)
    if (touched_[touch.particle] == 0.0) add_impact(observed_[touch.strongest]);
}

void FixLoadLedger::remember_touching() {
  std::fill_n(touched_, atom->nlocal, 0.0);
  for (const Touch& touch : touches_) touched_[touch.particle] = 1.0;
}

void FixLoadLedger::seed_touching() {
  remember_touching();
  bodies_.clear();
  if (!multisphere_) return;
  for (const BodyTouch& touch : body_touches_of_all_ranks()) bodies_.push_back(touch.body);
}

// ---------------------------------------------------------------- multisphere bodies

// The spheres of a body may lie on several ranks, so an episode of a body is everybody's business. Spheres without a
// body are bodies of their own, told apart by negative numbers.
void FixLoadLedger::sum_body_impacts() {
  const std::vector<BodyTouch> all = body_touches_of_all_ranks();
  std::vector<double> now;
  for (const BodyTouch& touch : all) {
    now.push_back(touch.body);
    const bool lasting = std::binary_search(bodies_.begin(), bodies_.end(), touch.body);
    if (!lasting && touch.rank == comm->me) add_impact(observed_[static_cast<int>(touch.strongest)]);
  }
  bodies_ = now;
}

// One touch per body, that of the largest normal force, sorted by body; the same on every rank.
std::vector<FixLoadLedger::BodyTouch> FixLoadLedger::body_touches_of_all_ranks() const {
  constexpr int fields = sizeof(BodyTouch) / sizeof(double);
  std::vector<BodyTouch> mine;
  for (const Touch& touch : touches_) {
    const Observed& strongest = observed_[touch.strongest];
    const int body = multisphere_->belongs_to(touch.particle);
    mine.push_back({body >= 0 ? static_cast<double>(body) : -1.0 - static_cast<double>(atom->tag[touch.particle]),
                    strongest.signed_force, static_cast<double>(touch.strongest), static_cast<double>(comm->me)});
  }
  const int count = static_cast<int>(mine.size()) * fields;
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int rank = 1; rank < comm->nprocs; ++rank) starts[rank] = starts[rank - 1] + counts[rank - 1];
  std::vector<BodyTouch> all((starts.back() + counts.back()) / fields);
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, world);
  std::sort(all.begin(), all.end(), [](const BodyTouch& a, const BodyTouch& b) {
    if (a.body != b.body) return a.body < b.body;
    return a.signed_force != b.signed_force ? a.signed_force > b.signed_force : a.rank < b.rank;
  });
  const auto same_body = [](const BodyTouch& a, const BodyTouch& b) { return a.body == b.body; };
  all.erase(std::unique(all.begin(), all.end(), same_body), all.end());
  return all;
}

// ---------------------------------------------------------------- what travels with a particle

void FixLoadLedger::grow_arrays(int particles) { memory->grow(touched_, particles, "load_ledger:touched"); }
void FixLoadLedger::copy_arrays(int from, int to, int) { touched_[to] = touched_[from]; }
void FixLoadLedger::set_arrays(int particle) { touched_[particle] = 0.0; }

int FixLoadLedger::pack_exchange(int particle, double* buffer) {
  buffer[0] = touched_[particle];
  return 1;
}

int FixLoadLedger::unpack_exchange(int particle, double* buffer) {
  touched_[particle] = buffer[0];
  return 1;
}

}  // namespace load_ledger
