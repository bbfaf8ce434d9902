// LIGGGHTS with a load ledger and rolling models: the solver of the shared library, unchanged, plus a fix style
// (load/ledger), two models of rolling friction (own_spin, rvd), and functions that stand before the library's: a search
// for contacts with meshes, an order of particles, the start of a run.
// Used like the plain program: liggghts-ledger -in deck.in; -search stock leaves the search for contacts with meshes to
// the library, -order stock the order of particles in memory; -own-kernels FILE adds contact kernels that a project has
// compiled of its own.
// liggghts-ledger -kernels lists its contact kernels: name, column of the ledger, parameters; -rolling its models of
// rolling friction.

#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "fix_load_ledger.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "own_kernels.h"
#include "particle_order.h"
#include "private_member.h"
#include "rolling/fix_spin_friction.h"
#include "rolling/fix_turning_friction.h"
#include "rolling/rolling_models.h"
#include "search/wall_search.h"
#include "signal_handling.h"

// The solver offers no call to add a fix style.
struct FixMap {
  friend auto member(FixMap);
};
template struct PrivateMember<FixMap, &LAMMPS_NS::Modify::fix_map>;

namespace {

using LAMMPS_NS::Fix;
using LAMMPS_NS::LAMMPS;

Fix* create_load_ledger(LAMMPS* lammps, int narg, char** arg) {
  return new load_ledger::FixLoadLedger(lammps, narg, arg);
}

template <typename Friction>
Fix* create_friction(LAMMPS* lammps, int narg, char** arg) {
  return new Friction(lammps, narg, arg);
}

void list_kernels() {
  for (const load_ledger::Kernel& kernel : load_ledger::kernels()) {
    std::printf("%s %s", kernel.name, kernel.column);
    for (int k = 0; k < load_ledger::parameter_count(kernel); ++k) std::printf(" %s", kernel.parameters[k]);
    std::printf("\n");
  }
}

// Takes "NAME ours" or "NAME stock" out of the words, which the solver would not know. Returns whether they are well.
bool take_choice(const char* name, void (*use_stock)(), int& argc, char** argv) {
  for (int k = 1; k + 1 < argc; ++k) {
    if (std::strcmp(argv[k], name)) continue;
    const bool stock = !std::strcmp(argv[k + 1], wall_search::STOCK);
    if (!stock && std::strcmp(argv[k + 1], wall_search::OURS)) {
      std::fprintf(stderr, "%s: found %s, allowed are %s and %s.\n", name, argv[k + 1], wall_search::OURS,
                   wall_search::STOCK);
      return false;
    }
    if (stock) use_stock();
    std::copy(argv + k + 2, argv + argc, argv + k);
    argc -= 2;
    return true;
  }
  return true;
}

// Takes "-own-kernels FILE" out of the words likewise and loads these. Returns whether they are well.
bool take_own_kernels(int& argc, char** argv) {
  for (int k = 1; k + 1 < argc; ++k) {
    if (std::strcmp(argv[k], "-own-kernels")) continue;
    if (const char* fault = load_ledger::load_own_kernels(argv[k + 1])) {
      std::fprintf(stderr, "-own-kernels: found %s: %s; allowed is a library of contact kernels.\n", argv[k + 1], fault);
      return false;
    }
    std::copy(argv + k + 2, argv + argc, argv + k);
    argc -= 2;
    return true;
  }
  return true;
}

void say(int where, const char* text) {
  if (write(where, text, std::strlen(text)) < 0) return;  // nothing else can be done in a handler
}

// As the plain program does: a first signal ends the run after the next step, with a restart file if the deck asks for
// one. The library's handlers allocate memory: where the signal interrupts an allocation they wait for ever.
void end_soon(int) {
  using namespace LAMMPS_NS::SignalHandler;
  if (request_quit) {
    say(STDERR_FILENO, "\nSecond SIGINT/SIGTERM caught - Force quitting.\n");
    std::_Exit(EXIT_FAILURE);
  }
  request_write_restart = enable_restart_writing;
  request_quit = true;
  say(STDOUT_FILENO, enable_restart_writing
                         ? "\nSIGINT/SIGTERM caught - Writing restart on next occasion and quitting after that.\n"
                         : "\nSIGINT/SIGTERM caught - quitting on first occasion.\n");
}

void write_restart_soon(int) {
  using namespace LAMMPS_NS::SignalHandler;
  if (enable_restart_writing) request_write_restart = true;
}

void handle_signals() {
  std::signal(SIGINT, end_soon);
  std::signal(SIGTERM, end_soon);
  std::signal(SIGUSR1, write_restart_soon);
}

}  // namespace

int main(int argc, char** argv) {
  if (!take_own_kernels(argc, argv)) return 1;
  if (argc == 2 && !std::strcmp(argv[1], "-kernels")) {
    list_kernels();
    return 0;
  }
  if (argc == 2 && !std::strcmp(argv[1], "-rolling")) {
    for (const char* name : rolling::MODELS) std::printf("%s\n", name);
    return 0;
  }
  if (!take_choice("-search", wall_search::use_stock, argc, argv)) return 1;
  if (!take_choice("-order", particle_order::use_stock, argc, argv)) return 1;
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // or a fatal message would vanish in a pipe
  handle_signals();
  MPI_Init(&argc, &argv);
  LAMMPS* lammps = new LAMMPS(argc, argv, MPI_COMM_WORLD);
  auto& styles = *(lammps->modify->*member(FixMap{}));
  styles["load/ledger"] = create_load_ledger;
  styles["rolling/own_spin"] = create_friction<rolling::FixSpinFriction>;
  styles["rolling/rvd"] = create_friction<rolling::FixTurningFriction>;
  rolling::add_rolling_models();
  wall_search::prove(lammps);
  lammps->input->file();
  delete lammps;
  MPI_Finalize();
  return 0;
}
