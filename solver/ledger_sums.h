// Sums per triangle that keep their digits over millions of steps, and over any number of ranks.
#pragma once

#include <mpi.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

namespace load_ledger {

// A sum and what it lost to rounding (Neumaier 1974): its error does not grow with the number of terms.
struct CompensatedSum {
  double sum = 0.0, lost = 0.0;

  void add(double value) {
    const double next = sum + value;
    lost += std::abs(sum) >= std::abs(value) ? (sum - next) + value : (value - next) + sum;
    sum = next;
  }
  double value() const { return sum + lost; }
};

// Such sums for every triangle of a mesh. The sums of a triangle lie beside each other: a contact adds to most of them.
class LedgerSums {
 public:
  LedgerSums(int columns, int triangles)
      : columns_(columns), triangles_(triangles), sums_(static_cast<std::size_t>(columns) * triangles) {}

  void add(int column, int triangle, double value) { sums_[index(column, triangle)].add(value); }
  double value(int column, int triangle) const { return sums_[index(column, triangle)].value(); }

  double column_total(int column) const {
    CompensatedSum total;
    for (int triangle = 0; triangle < triangles_; ++triangle) total.add(value(column, triangle));
    return total.value();
  }

  // The sums of all ranks; whole on rank 0 only.
  LedgerSums reduced(MPI_Comm ranks) const {
    LedgerSums all(*this);
    const int numbers = static_cast<int>(bytes() / sizeof(double));
    MPI_Reduce(sums_.data(), all.sums_.data(), numbers, MPI_DOUBLE, MPI_SUM, 0, ranks);
    return all;
  }

  std::size_t bytes() const { return sums_.size() * sizeof(CompensatedSum); }
  const void* stored() const { return sums_.data(); }
  void restore(const char* stored) { std::memcpy(static_cast<void*>(sums_.data()), stored, bytes()); }

 private:
  std::size_t index(int column, int triangle) const { return static_cast<std::size_t>(triangle) * columns_ + column; }

  int columns_, triangles_;
  std::vector<CompensatedSum> sums_;
};

static_assert(sizeof(CompensatedSum) == 2 * sizeof(double), "a sum is sent between ranks as two numbers");

}  // namespace load_ledger
