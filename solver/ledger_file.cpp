// The ledger's file at the end of a run, its part of the restart files, and its totals for thermo output.

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_load_ledger.h"
#include "memory.h"
#include "universe.h"
#include "update.h"

using namespace LAMMPS_NS;

namespace load_ledger {

namespace {

constexpr int FORMAT = 2;  // of the file and of a ledger in a restart file; postproc/readers/load_ledger.py knows it

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter;
  }
  return result + "\"";
}

}  // namespace

std::vector<std::string> FixLoadLedger::column_names() const {
  std::vector<std::string> names = {"sliding_work_J",   "normal_impulse_N_s", "rolling_work_J",
                                    "impact_energy_J",  "contact_time_s",     "tangential_work_J",
                                    "drive_work_J",     "contact_radius_m",   "contact_weight_1",
                                    "contact_weight_2", "contact_weight_3"};
  struct Vector {
    const char *name, *unit;
  };
  for (const Vector& vector : {Vector{"impulse", "N_s"}, {"back_impulse", "N_s"}, {"moment", "N_m_s"}})
    for (const char* direction : {"along", "across", "normal"})
      names.push_back(std::string(vector.name) + '_' + direction + '_' + vector.unit);
  std::map<std::string, int> sets;
  for (const ChosenKernel& chosen : kernels_) {
    std::string column = chosen.kernel.column;
    if (const int number = ++sets[chosen.kernel.name]; number > 1)
      column.insert(std::strlen(chosen.kernel.name), '.' + std::to_string(number));
    names.push_back(column);
  }
  return names;
}

// One line of JSON: what the columns after it are, and how much of the run they hold.
std::string FixLoadLedger::header(double contacts) const {
  std::ostringstream text;
  text.precision(17);
  text << "{\"load_ledger\": " << FORMAT << ", \"mesh\": " << quoted(mesh_id_) << ", \"triangles\": " << triangles_
       << ", \"steps\": " << steps_ << ", \"time_s\": " << time_s_.value() << ", \"step\": " << update->ntimestep
       << ", \"contacts\": " << static_cast<std::int64_t>(contacts) << ", \"ranks\": " << comm->nprocs
       << ", \"solver\": " << quoted(universe->version) << ", \"columns\": [";
  const char* separator = "";
  for (const std::string& name : column_names()) {
    text << separator << quoted(name);
    separator = ", ";
  }
  text << "]}\n";
  return text.str();
}

// Sums as columns of the file. Radius and position are means weighted with sliding work, with normal impulse where a
// triangle was loaded without any sliding, and not a number where it was not loaded.
std::vector<std::vector<double>> FixLoadLedger::table(const LedgerSums& sums) const {
  std::vector<std::vector<double>> columns(column_names().size(), std::vector<double>(triangles_));
  for (int triangle = 0; triangle < triangles_; ++triangle) {
    const double work = sums.value(SLIDING_WORK, triangle), impulse = sums.value(NORMAL_IMPULSE, triangle);
    const double weight = work > 0.0 ? work : impulse;
    const int first = work > 0.0 ? BY_WORK : BY_IMPULSE;
    for (int column = SLIDING_WORK; column <= DRIVE_WORK; ++column)
      columns[column][triangle] = sums.value(column, triangle);
    for (int k = 0; k < 4; ++k)
      columns[BY_WORK + k][triangle] =
          weight > 0.0 ? sums.value(first + k, triangle) / weight : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = BY_WORK + 4; k < columns.size(); ++k)
      columns[k][triangle] = sums.value(IMPULSE + static_cast<int>(k) - (BY_WORK + 4), triangle);
  }
  return columns;
}

// Written under another name first, so that a reader never meets half a file.
void FixLoadLedger::write_file(const std::string& name) {
  const LedgerSums all = sums_.reduced(world);
  double contacts = 0.0;
  MPI_Reduce(&contacts_, &contacts, 1, MPI_DOUBLE, MPI_SUM, 0, world);
  if (comm->me != 0) return;
  const std::string unfinished = name + ".part";
  bool written = false;
  if (FILE* file = std::fopen(unfinished.c_str(), "wb")) {
    const std::string first_line = header(contacts);
    written = std::fwrite(first_line.data(), 1, first_line.size(), file) == first_line.size();
    for (const std::vector<double>& column : table(all))
      written = written && std::fwrite(column.data(), sizeof(double), column.size(), file) == column.size();
    written = std::fclose(file) == 0 && written;
  }
  if (!written || std::rename(unfinished.c_str(), name.c_str()) != 0)
    error->one(FLERR, ("fix load/ledger cannot write " + name + ": " + std::strerror(errno) + ".").c_str());
}

// ---------------------------------------------------------------- restart

// A stored ledger is taken up by a ledger of the same mesh and kernels, parameters included; any other starts empty.
std::string FixLoadLedger::identity() const {
  std::ostringstream text;
  text.precision(17);
  text << "load_ledger " << FORMAT << ' ' << mesh_id_ << ' ' << triangles_;
  for (const ChosenKernel& chosen : kernels_) {
    text << ' ' << chosen.kernel.name;
    for (int k = 0; k < parameter_count(chosen.kernel); ++k)
      text << ' ' << chosen.kernel.parameters[k] << ' ' << chosen.values[k];
  }
  return text.str();
}

// Layout: length of what follows (int); length of the identity (int), identity, steps (int64), time (a sum), contacts
// (double), the sums; a sum is two doubles.
void FixLoadLedger::write_restart(FILE* file) {
  const LedgerSums all = sums_.reduced(world);
  double contacts = 0.0;
  MPI_Reduce(&contacts_, &contacts, 1, MPI_DOUBLE, MPI_SUM, 0, world);
  if (comm->me != 0) return;
  const std::string whose = identity();
  const int letters = static_cast<int>(whose.size());
  const int bytes =
      static_cast<int>(sizeof letters + letters + sizeof steps_ + sizeof time_s_ + sizeof contacts + all.bytes());
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(&letters, sizeof letters, 1, file);
  std::fwrite(whose.data(), 1, letters, file);
  std::fwrite(&steps_, sizeof steps_, 1, file);
  std::fwrite(&time_s_, sizeof time_s_, 1, file);
  std::fwrite(&contacts, sizeof contacts, 1, file);
  std::fwrite(all.stored(), 1, all.bytes(), file);
}

void FixLoadLedger::restart(char* stored) {
  const auto take = [&stored](void* target, std::size_t bytes) {
    std::memcpy(target, stored, bytes);
    stored += bytes;
  };
  int letters = 0;
  take(&letters, sizeof letters);
  std::string whose(letters, ' ');
  take(&whose[0], letters);
  if (whose != identity()) {
    say("Load ledger " + std::string(id) + ": the restart file holds another ledger (" + whose +
        "), this one starts empty.");
    return;
  }
  take(&steps_, sizeof steps_);
  take(&time_s_, sizeof time_s_);
  take(&contacts_, sizeof contacts_);
  if (comm->me == 0)
    sums_.restore(stored);
  else
    contacts_ = 0.0;
  say("Load ledger " + std::string(id) + ": goes on after " + std::to_string(steps_) + " steps.");
}

// ---------------------------------------------------------------- totals

double FixLoadLedger::compute_scalar() { return compute_vector(SLIDING_WORK); }

double FixLoadLedger::compute_vector(int column) {
  double mine = sums_.column_total(column), all = 0.0;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

double FixLoadLedger::memory_usage() {
  return static_cast<double>(sums_.bytes()) + static_cast<double>(atom->nmax) * sizeof(double);
}

}  // namespace load_ledger
