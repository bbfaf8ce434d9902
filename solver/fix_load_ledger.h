// fix ID group load/ledger mesh MESH_ID file FILE [history STEPS] [kernels NAME [PARAMETER VALUE ...] ...]
//
// Sums, per triangle of one mesh and at every time step, what particles do to it: the load ledger. The sums are written
// to FILE at the end of every run and are part of every restart file; history writes those so far every so many steps to
// FILE.<steps>. Definitions: README.md beside this file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fix.h"
#include "kernels.h"
#include "ledger_sums.h"

namespace LAMMPS_NS {
class FixMeshSurface;
class FixMultisphere;
class TriMesh;
}  // namespace LAMMPS_NS

namespace load_ledger {

// Columns that are sums of a contact's contributions; those of the kernels follow.
enum Column {
  SLIDING_WORK,              // J
  NORMAL_IMPULSE,            // N s
  ROLLING_WORK,              // J
  IMPACT_ENERGY,             // J
  CONTACT_TIME,              // s
  TANGENTIAL_WORK,           // J
  DRIVE_WORK,                // J
  BY_WORK,                   // contact radius (m) and weights of the three corners (-), each times sliding work
  BY_IMPULSE = BY_WORK + 4,  // the same times normal impulse, for triangles that are loaded without any sliding
  // Vectors on the mesh in the facet's own frame: along, across, normal.
  IMPULSE = BY_IMPULSE + 4,    // N s
  BACK_IMPULSE = IMPULSE + 3,  // N s, the part of particles that lie straight behind the facet
  MOMENT = BACK_IMPULSE + 3,   // N m s, about the facet's centroid
  FIRST_KERNEL = MOMENT + 3
};

class FixLoadLedger : public LAMMPS_NS::Fix {
 public:
  FixLoadLedger(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  ~FixLoadLedger() override;

  // Called for every contact of the mesh. offset: from the centre to the contact point, m
  void observe(int particle, const double* force, const double* offset, int triangle, const double* wall_velocity);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void end_of_step() override;
  double compute_scalar() override;
  double compute_vector(int column) override;
  double memory_usage() override;

  void write_restart(FILE* file) override;
  void restart(char* stored) override;

  // Whether a particle touched the mesh in the step before travels with it from rank to rank.
  void grow_arrays(int particles) override;
  void copy_arrays(int from, int to, int) override;
  void set_arrays(int particle) override;
  int pack_exchange(int particle, double* buffer) override;
  int unpack_exchange(int particle, double* buffer) override;

 private:
  struct Observed {
    Contact contact;
    int particle, triangle;     // local index of the particle, id of the triangle
    double weights[3];          // -, of the triangle's corners at the contact point
    double lever;               // m, from the centre to where the solver takes the surfaces to meet
    double wall_velocity[3];    // m/s, at the contact point
    double wall_spin[3];        // rad/s
    double force_on_facet[3];   // N, on the mesh: along, across, normal
    double moment_on_facet[3];  // N m, on the mesh about the facet's centroid: along, across, normal
    bool on_back;               // the particle lies straight behind the facet
    double friction_power;      // W, that the tangential force takes from the sliding
    double drive_power;         // W, that the moving mesh gives to the particle
    double signed_force;        // N, along the normal, negative where the contact pulls
    double effective_modulus;   // Pa
    int touch;                  // index into touches_
  };
  // All contacts of one particle with the mesh in one step.
  struct Touch {
    int particle;     // local index
    double force[3];  // N, vector sum of its normal forces
    int strongest;    // index into observed_ of its largest normal force
  };
  // The touch of a multisphere body, as every rank knows it.
  struct BodyTouch {
    double body, signed_force, strongest, rank;  // strongest: index into observed_ of its rank
  };
  // A kernel that the deck asks for, with the values of its parameters.
  struct ChosenKernel {
    Kernel kernel;
    double values[MOST_PARAMETERS];
  };
  enum class Phase { set_up, step, between };

  void parse(int narg, char** arg);
  void parse_kernels(int narg, char** arg, int first);
  void find_mesh();
  void check_deck();
  void check_layout();
  void check_triangles();
  void check_materials();
  void misfit(const std::string& what);
  void prove_called(bool last);
  void say(const std::string& sentence);

  void seed_touching();
  void gather_touches();
  void add_motion(Observed& seen) const;
  void sum_loads();
  void add_kernels(const Observed& seen, bool per_impact, double weight);
  void add_impact(const Observed& strongest);
  void sum_impacts();
  void sum_body_impacts();
  void remember_touching();
  std::vector<BodyTouch> body_touches_of_all_ranks() const;
  double** corner_velocities(int triangle) const;

  std::vector<std::string> column_names() const;
  std::string header(double contacts) const;
  std::string identity() const;
  std::vector<std::vector<double>> table(const LedgerSums& sums) const;
  void write_file(const std::string& name);

  std::string mesh_id_, file_;
  std::vector<ChosenKernel> kernels_;
  int triangles_ = 0;
  std::int64_t history_ = 0;  // steps between two files of the sums so far, 0 without

  LAMMPS_NS::FixMeshSurface* mesh_ = nullptr;
  LAMMPS_NS::TriMesh* triangles_of_ = nullptr;  // the mesh that the sums belong to
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  std::vector<double> modulus_of_type_;  // Pa, effective modulus of each particle type and the wall

  LedgerSums sums_{0, 0};
  std::int64_t steps_ = 0;
  CompensatedSum time_s_;
  double contacts_ = 0.0;  // on this rank

  Phase phase_ = Phase::between;
  bool proven_ = false;
  std::int64_t reported_ = 0;  // contacts that the solver has told this ledger of, on this rank
  std::vector<Observed> observed_;
  std::vector<Touch> touches_;
  std::vector<int> touch_of_particle_;  // local index of a particle -> touches_, -1 without one
  std::vector<double> bodies_;          // sorted tags of the bodies that touched in the step before
  double* touched_ = nullptr;           // per particle: 1 when it touched in the step before
};

}  // namespace load_ledger
