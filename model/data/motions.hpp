// Readings along paths as sums of motions: one row for each sense and each moving axis, with the approach of that axis,
// so that every effect acts on it as on any reading; a reading is the sum of its rows, each with the share of its sense
// in the direction measured. What the set-up leaves free, the centre of each pass of a circle and the radius of each
// part of it, the zero of each run along a diagonal, is taken out of readings and sums alike (orthogonal projection:
// Seber and Lee 2003, Linear Regression Analysis, 3.3; error contrasts: Patterson and Thompson 1971).
#pragma once

#include <cstddef>
#include <vector>

#include "model/data/observations.hpp"

namespace ecs::model {

struct Motions {
  Observations rows;          ///< the readings that are on no path as they are; no paths of their own
  std::vector<bool> on_path;  ///< per row

  struct Share {
    std::size_t reading = 0, row = 0;
    double weight = 1.0;
  };
  std::vector<Share> shares;  ///< reading by reading
  std::size_t readings = 0;   ///< that the shares make up

  /// Readings of one pass and what is free in them.
  struct Free {
    std::vector<std::size_t> readings;
    std::vector<std::vector<double>> functions;  ///< orthonormal over the readings
  };
  std::vector<Free> free;

  /// Takes out what is free. @param column  one value for each of `readings`
  void take_out_free(double* column) const;
};

/// Makes rows of `data` whose `path` is set into sums of motions and takes out of their readings what is free.
void set_motions(Observations& data);

/// The rows on no path, paths forgotten: for work that knows lines only.
[[nodiscard]] Observations without_paths(const Observations& data);

}  // namespace ecs::model
