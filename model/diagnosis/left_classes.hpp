// The readings that most is left of, and the table of conditions that this may depend on. Internal to model/ (Eigen).
// Does not live here: which of them is told (left.hpp).
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "model/diagnosis/trial.hpp"

namespace ecs::model {

/// A number for each reading: those of one number are together.
using Cells = std::vector<std::size_t>;

/// What a space of functions takes beside the model.
struct Weight {
  double gain = 0.0, freedom = 0.0;
  Eigen::VectorXd taken;
};

/// All products of their columns.
[[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// Legendre polynomials of the degrees from … to.
[[nodiscard]] Eigen::MatrixXd legendre(const Eigen::VectorXd& u, Eigen::Index from, Eigen::Index to,
                                       Eigen::Index step = 1);
/// Cosine and sine of `waves` of an angle.
[[nodiscard]] Eigen::MatrixXd turning(const Eigen::VectorXd& deg, int waves);

/// Readings of one sense along one axis, those with most above noise. All columns have a row for each of them.
struct LeftReadings {
  /// @param problem  of the model with every effect of the answer  @param with  its fit
  LeftReadings(const Observations& all, const LinearProblem& problem, const FittedWith& with);

  /// What columns that are free in each cell take of `of`, um².
  [[nodiscard]] Weight weight(const Eigen::VectorXd& of, const Cells& cells, const Eigen::MatrixXd& columns) const;
  /// A value for each of them. @param f  of the number of an observation
  template <class F>
  [[nodiscard]] Eigen::VectorXd column(const F& f) const {
    Eigen::VectorXd values(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) values(static_cast<Eigen::Index>(i)) = f(rows[i]);
    return values;
  }
  /// Parts of cells that are of one run, and of one direction: what changes from run to run is the same in them.
  [[nodiscard]] Cells in_runs(const Cells& cells, bool each_way) const;
  /// Numbers of the values, those within `apart` the same.
  [[nodiscard]] static Cells levels(const Eigen::VectorXd& values, double apart);

  const Observations& data;
  const Fit& fit;
  std::vector<std::size_t> rows;  ///< none: nothing to ask
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Eigen::MatrixXd base;  ///< orthonormal
  Eigen::VectorXd y;     ///< what is left
  Eigen::VectorXd reading;
  double variance = 1.0;    ///< of the noise
  Eigen::VectorXd p, u, d;  ///< position; the same from -1 to 1; direction
  double middle = 0.0;      ///< of the travel measured; of rotary axes 0
  double half = 1.0, step = 1.0, apart = kSamePlace_mm;
  Eigen::Index distinct_targets = 0;
  Cells one_cell, targets, mirrored;  ///< mirrored: both sides of the middle at the same distance
  bool is_symmetric = false;          ///< nearly all targets have one on the other side
  bool both_ways = false;
  Eigen::MatrixXd ways;  ///< 1, and where both directions were measured the direction
};

/// A condition that what is left may depend on, beside direction and position.
struct Condition {
  std::string property, is;   ///< that it tells; `is` "": what is left is the same in all conditions
  Eigen::MatrixXd functions;  ///< of the condition, 1 among them
  bool is_flat = false;       ///< multiplied by 1 and the position only, not by any function of it
  bool is_shape = false;      ///< the functions are all of it: no function of position or direction is multiplied
  std::string says{};         ///< of a shape: what is told if it is chosen
  Cells targets{};            ///< in place of the targets in machine coordinates
  bool set_by_hand = false;   ///< people choose its values from run to run
  bool is_sure = false;       ///< established by a test of its own, whatever else would explain as much
  [[nodiscard]] bool tells_the_same(const Condition& other) const {
    return property == other.property && is == other.is;
  }
};
/// The one that changes nothing comes first.
[[nodiscard]] std::vector<Condition> conditions_of(const LeftReadings& readings);

}  // namespace ecs::model
