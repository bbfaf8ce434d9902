// LIGGGHTS with a load ledger and rolling models: the solver of the shared library, unchanged, plus a fix style
// (load/ledger) and two models of rolling friction (own_spin, rvd).
// Used like the plain program: liggghts-ledger -in deck.in
// liggghts-ledger -kernels lists its contact kernels: name, column of the ledger, parameters; -rolling its models of
// rolling friction.

#include <mpi.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

#include "fix_load_ledger.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "rolling/fix_spin_friction.h"
#include "rolling/rolling_models.h"
#include "signal_handling.h"

namespace {

using LAMMPS_NS::Fix;
using LAMMPS_NS::LAMMPS;
using LAMMPS_NS::Modify;
using FixStyles = std::map<std::string, Fix* (*)(LAMMPS*, int, char**)>;

// The solver offers no call to add a fix style, and its list of styles is a private member. An explicit instantiation
// may name private members (C++ standard, [temp.spec]), which hands the list out without touching the solver's headers.
template <FixStyles* Modify::* list>
struct StyleListAccess {
  friend FixStyles* style_list(Modify* modify) { return modify->*list; }
};
FixStyles* style_list(Modify* modify);
template struct StyleListAccess<&Modify::fix_map>;

Fix* create_load_ledger(LAMMPS* lammps, int narg, char** arg) {
  return new load_ledger::FixLoadLedger(lammps, narg, arg);
}

Fix* create_spin_friction(LAMMPS* lammps, int narg, char** arg) {
  return new rolling::FixSpinFriction(lammps, narg, arg);
}

void list_kernels() {
  for (const load_ledger::Kernel& kernel : load_ledger::KERNELS) {
    std::printf("%s %s", kernel.name, kernel.column);
    for (int k = 0; k < load_ledger::parameter_count(kernel); ++k) std::printf(" %s", kernel.parameters[k]);
    std::printf("\n");
  }
}

// As the plain program does: a first signal ends the run after the next step, with a restart file if the deck asks for
// one.
void handle_signals() {
  std::signal(SIGINT, LAMMPS_NS::SignalHandler::int_handler);
  std::signal(SIGTERM, LAMMPS_NS::SignalHandler::int_handler);
  std::signal(SIGUSR1, LAMMPS_NS::SignalHandler::usr1_handler);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && !std::strcmp(argv[1], "-kernels")) {
    list_kernels();
    return 0;
  }
  if (argc == 2 && !std::strcmp(argv[1], "-rolling")) {
    for (const char* name : rolling::MODELS) std::printf("%s\n", name);
    return 0;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // or a fatal message would vanish in a pipe
  handle_signals();
  MPI_Init(&argc, &argv);
  LAMMPS* lammps = new LAMMPS(argc, argv, MPI_COMM_WORLD);
  (*style_list(lammps->modify))["load/ledger"] = create_load_ledger;
  (*style_list(lammps->modify))["rolling/own_spin"] = create_spin_friction;
  rolling::add_rolling_models();
  lammps->input->file();
  delete lammps;
  MPI_Finalize();
  return 0;
}
