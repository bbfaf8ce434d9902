// Takes the place of Modify::setup_pre_force, which comes before the forces that a run starts with: the solver's shared
// library calls it through its table of virtual functions, where a definition in the program comes first. The library
// evaluates these forces without moving the tangential springs on. A sliding contact's spring then stands at its limit
// of friction, by rounding often just below it, where the contact counts as sticking and the damping of its sliding is
// added without any limit: gamma_t times 2 m/s were 53 times the friction of a bed. Half a step of it kicks the particles
// that slide, and the load on the wall is wrong by up to a third for some forty steps. With the springs moved on by
// one step, as in every other evaluation, they slide at their limit.

#include <dlfcn.h>

#include <cstdio>
#include <cstring>

#include "comm.h"
#include "modify.h"
#include "universe.h"
#include "update.h"

#ifndef LIGGGHTS_VERSION_BUILT_FOR
#error "build with make -C solver, which says for which version"
#endif

namespace {

constexpr char SETUP_PRE_FORCE[] = "_ZN9LAMMPS_NS6Modify15setup_pre_forceEi";  // mangled name of what ours stands before
constexpr char TOLD[] = "Start of runs: contacts that slide keep to their limit of friction.\n";

}  // namespace

namespace LAMMPS_NS {

void Modify::setup_pre_force(int vflag) {
  static const auto library = reinterpret_cast<void (*)(Modify*, int)>(dlsym(RTLD_NEXT, SETUP_PRE_FORCE));
  library(this, vflag);
  if (!std::strstr(universe->version, LIGGGHTS_VERSION_BUILT_FOR)) return;
  update->setupflag = 0;  // read by pairs and walls alone, to hold their springs
  static bool told = false;
  if (!told && comm->me == 0)
    for (FILE* to : {screen, logfile})
      if (to) std::fputs(TOLD, to);
  told = true;
}

}  // namespace LAMMPS_NS
