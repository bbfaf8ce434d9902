// Contact kernels: what a wear law that is not linear in force and speed needs summed over time, or over impacts, one
// function and one line each.
// Python has the same registry under the same names (postproc/wear/kernels.py), for contacts sampled into dumps; the
// program tells its own when it is called with -kernels.
#pragma once

#include <algorithm>
#include <cmath>

namespace load_ledger {

// One contact between a particle and a triangle in one time step; SI units, vectors in the simulation's frame.
struct Contact {
  double normal[3];           // -, from the contact point to the particle's centre
  double triangle_normal[3];  // -, of the triangle itself
  double force[3];            // N, on the particle, all of it
  double velocity[3];         // m/s, of the particle's centre against the wall, at the instant of the force
  double velocity_before[3];  // m/s, the same half a step earlier, before this force: what the contact law sees
  double normal_force;        // N, zero where the contact pulls
  double approach_speed;      // m/s, of the centre along the normal before this force, without sign
  double sliding_speed;       // m/s, at the contact point, spin included
  double rolling_speed;       // m/s, radius times the spin across the normal, against the wall's
  double radius;              // m, of the particle
  double mass;                // kg, of the particle or of the body it belongs to
};

inline double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline double length(const double* a) { return std::sqrt(dot(a, a)); }

inline void cross(const double* a, const double* b, double* result) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

// Power (W) of Finnie's impact wear (Finnie 1960) as LIGGGHTS evaluates it for `wear finnie`, also at its velocities: a
// function of the angle between velocity and surface times speed and contact force, and only while the particle
// approaches. Times its coefficient k (1/Pa) and summed over time it is the worn volume.
inline double finnie_work(const Contact& contact, const double*) {
  const double slowest = 1e-7;       // m/s, the solver's own threshold
  const double one_third = 0.33333;  // the solver's own digits
  const double* velocity = contact.velocity_before;
  const double speed = length(velocity);
  if (speed < slowest || dot(contact.normal, velocity) > 0.0) return 0.0;
  double along[3];
  cross(velocity, contact.triangle_normal, along);
  const double sine = std::min(1.0, std::abs(dot(velocity, contact.triangle_normal)) / speed);
  const double cosine = std::min(1.0, length(along) / speed);
  const bool steep = 3.0 * sine > cosine;
  const double angle_function = steep ? one_third * cosine * cosine : 2.0 * sine * cosine - 3.0 * sine * sine;
  return 2.0 * angle_function * speed * length(contact.force);
}

// Energy (J) of an impact above a threshold (Bitter 1963), m (v_n - K)^2 / 2 where v_n is above K. given: K (m/s)
inline double impact_above_threshold(const Contact& contact, const double* given) {
  const double above = std::max(contact.approach_speed - given[0], 0.0);
  return 0.5 * contact.mass * above * above;
}

// Energy (J) of an impact at the angle a and the speed v by the law of Oka (Oka et al. 2005), m V^2 / 2 (v / V)^k2 times
// sin^n1 a (1 + H (1 - sin a))^n2. given: n1, n2 (-), H (Pa, which the law takes in GPa), k2 (-), V (m/s)
inline double oka_energy(const Contact& contact, const double* given) {
  const double speed = length(contact.velocity_before), hardness = 1e-9 * given[2];
  if (speed == 0.0) return 0.0;
  const double sine = std::min(1.0, contact.approach_speed / speed);
  const double angle_function = std::pow(sine, given[0]) * std::pow(1.0 + hardness * (1.0 - sine), given[1]);
  return 0.5 * contact.mass * given[4] * given[4] * std::pow(speed / given[4], given[3]) * angle_function;
}

constexpr int MOST_PARAMETERS = 8;

struct Kernel {
  const char* name;                                           // in the deck, after `kernels`
  const char* column;                                         // in the ledger, with its unit
  double (*value)(const Contact&, const double* parameters);  // per unit time, or of an impact
  const char* parameters[MOST_PARAMETERS];                    // in the deck after the name, with values; SI
  bool per_impact = false;                                    // summed over impacts, not over time
};

constexpr Kernel KERNELS[] = {
    {"finnie_work", "finnie_work_J", finnie_work, {}},
    {"impact_above_threshold", "impact_above_threshold_J", impact_above_threshold, {"threshold_velocity_m_per_s"}, true},
    {"oka_energy", "oka_energy_J", oka_energy,
     {"angle_exponent", "hardness_exponent", "hardness_pa", "velocity_exponent", "reference_velocity_m_per_s"}, true},
};

inline int parameter_count(const Kernel& kernel) {
  int count = 0;
  while (count < MOST_PARAMETERS && kernel.parameters[count]) ++count;
  return count;
}

}  // namespace load_ledger
