// Hands out private members of the solver's classes, which it offers no call for. An explicit instantiation may name
// private members (C++ standard, [temp.spec]), so the solver's headers stay untouched. In the global namespace:
//   struct FixMap { friend auto member(FixMap); };
//   template struct PrivateMember<FixMap, &Modify::fix_map>;
//   modify->*member(FixMap{})
#pragma once

template <class Name, auto pointer>
struct PrivateMember {
  friend auto member(Name) { return pointer; }
};
