#include "modules/lengths/shared_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"

namespace ecs::model {
namespace {

constexpr double kNoPivot = 1e-9;      ///< of the greatest pivot of scaled columns: not determined
constexpr double kInNullSpace = 1e-5;  ///< share of a value that the lengths leave free

}  // namespace

Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& columns, Eigen::VectorXd& norm) {
  constexpr double kRounding = 1e-11;
  norm = columns.colwise().norm().transpose();
  const double longest = norm.maxCoeff();
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    if (norm(j) <= kRounding * longest) {
      norm(j) = 1.0;
      scaled.col(j).setZero();
    } else {
      scaled.col(j) /= norm(j);
    }
  }
  return scaled;
}

Eigen::VectorXd near_solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  constexpr double kRidge = 1e-12;
  Eigen::VectorXd norm;
  const Eigen::MatrixXd scaled = scaled_columns(columns, norm);
  Eigen::MatrixXd normal = kRidge * Eigen::MatrixXd::Identity(scaled.cols(), scaled.cols());
  add_gram(normal, scaled);
  return SymmetricSolver(normal).solve(scaled.transpose() * y).cwiseQuotient(norm);
}

LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  LengthSolution out;
  const Eigen::MatrixXd scaled = scaled_columns(columns, out.norm);
  RowSpace space = row_space_of(scaled, kNoPivot);
  out.rank = static_cast<int>(space.back.cols());
  out.back = out.norm.cwiseInverse().asDiagonal() * space.back;
  out.basis = scaled * space.back;
  out.x = out.back * (out.basis.transpose() * y);
  const Eigen::VectorXd left = y - columns * out.x;
  out.x += out.back * (out.basis.transpose() * left);  // once more, for what rounding lost
  out.covariance = out.back * out.back.transpose();
  out.free = std::move(space.free);
  out.squares = (y - columns * out.x).squaredNorm();
  return out;
}

bool is_free(const LengthSolution& solution, const Eigen::VectorXd& row, Eigen::Index first) {
  if (solution.free.cols() == 0) return false;
  const Eigen::VectorXd scaled = row.cwiseQuotient(solution.norm.segment(first, row.size()));
  const Eigen::VectorXd share = solution.free.middleRows(first, row.size()).transpose() * scaled;
  return share.norm() > kInNullSpace * std::max(scaled.norm(), 1e-30);
}

namespace {

/// A longer chain of readings is cut: the time of a block grows with the cube of its size, and what two distant parts
/// of a chain share is the shape of a pass at most.
constexpr std::size_t kMostInBlock = 600;

/// What a reading shares with others: the number of its stop and of its pass, axis by axis.
struct Sharing {
  PerAxis<int> stop{}, pass{};
  PerAxis<double> part{};  ///< of the travel
};

/// The shape of a pass, mean square 1: half of it an offset, half smooth over about a third of the travel.
double alike(double part_a, double part_b) {
  constexpr double kOffset = 0.5, kCorrelated = 0.3;
  const double apart = (part_a - part_b) / kCorrelated;
  return kOffset + (1.0 - kOffset) * std::exp(-0.5 * apart * apart);
}

/// How far a reading changes when a carriage moves by each of its components: um by um, um by um/m. What scatters is
/// the carriage, so an angle of a carriage that the tool travels over acts through the lever along its own axis as
/// well: the curves hold that lever within a straightness, but from one stop to the next it does not repeat.
Eigen::MatrixXd sensitivities(const LengthTest& test, const MachineCurves& curves, const Eigen::MatrixXd& direction) {
  const TermTable terms = *terms_of(curves.machine().chain, Convention::iso, CurveKind::carriage);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(direction.rows(), static_cast<Eigen::Index>(kCurves));
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
    for (const Term& term : terms) {
      if (is_squareness(term.component)) continue;
      const double lever =
          term.has_lever ? curves.lever_mm(term, r.position_mm, test.tools[r.tool].offset_mm) / kMmPerM : 1.0;
      out(i, static_cast<Eigen::Index>(index_of(term.component))) +=
          term.sign * lever * direction(i, static_cast<Eigen::Index>(index_of(term.observed)));
    }
  }
  return out;
}

/// Readings that are linked, directly or through others.
class Links {
 public:
  explicit Links(std::size_t count) : parent_(count), size_(count, 1) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void link(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    if (a == b || size_[a] + size_[b] > kMostInBlock) return;
    parent_[b] = a;
    size_[a] += size_[b];
  }

 private:
  std::vector<std::size_t> parent_, size_;
};

}  // namespace

SharedNoise::SharedNoise(const LengthTest& test, const MachineCurves& curves, const Eigen::MatrixXd& direction) {
  const std::size_t n = test.readings.size();
  std::map<std::tuple<std::size_t, int, std::size_t>, std::size_t> last;
  std::vector<Sharing> sharing(n);
  Links links(n);
  int next = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const LengthReading& r = test.readings[i];
    const auto before = last.find({r.set_up, r.run, r.tool});
    Sharing& own = sharing[i];
    for (std::size_t a = 0; a < kAxes; ++a) {
      const auto& [low, high] = curves.machine().travel_mm[a];
      own.part[a] = (r.position_mm[a] - low) / (high - low);
      own.stop[a] = own.pass[a] = ++next;
      if (before == last.end()) continue;
      const LengthReading& then = test.readings[before->second];
      const double moved = r.position_mm[a] - then.position_mm[a];
      if (r.approach[a] != then.approach[a] || moved * r.approach[a] < 0.0) continue;
      own.pass[a] = sharing[before->second].pass[a];
      if (moved == 0.0) own.stop[a] = sharing[before->second].stop[a];
      links.link(before->second, i);
    }
    last[{r.set_up, r.run, r.tool}] = i;
  }
  std::map<std::size_t, std::size_t> block_of_root;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t b = block_of_root.emplace(links.root(i), blocks_.size()).first->second;
    if (b == blocks_.size()) blocks_.emplace_back();
    blocks_[b].readings.push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd by_component = sensitivities(test, curves, direction);
  for (Block& block : blocks_) {
    const auto m = static_cast<Eigen::Index>(block.readings.size());
    for (auto& one : block.covariance) one = Eigen::MatrixXd::Zero(m, m);
    for (std::size_t a = 0; a < kAxes; ++a) {
      std::array<Eigen::MatrixXd, 2> own;
      const auto first = static_cast<Eigen::Index>(6 * a);  // three translations, three angles
      own[0] = rows_of(by_component.middleCols(first, 3), block.readings);
      own[1] = rows_of(by_component.middleCols(first + 3, 3), block.readings);
      for (Eigen::Index i = 0; i < m; ++i)
        for (Eigen::Index k = 0; k <= i; ++k) {
          const Sharing& one = sharing[static_cast<std::size_t>(block.readings[static_cast<std::size_t>(i)])];
          const Sharing& other = sharing[static_cast<std::size_t>(block.readings[static_cast<std::size_t>(k)])];
          if (one.pass[a] != other.pass[a]) continue;  // a stop lies within a pass
          const double shape = alike(one.part[a], other.part[a]);
          for (std::size_t angle = 0; angle < 2; ++angle) {
            const double product = own[angle].row(i).dot(own[angle].row(k));
            if (one.stop[a] == other.stop[a]) block.covariance[angle](i, k) += product;
            block.covariance[2 + angle](i, k) += product * shape;
          }
        }
    }
    for (auto& one : block.covariance) one.triangularView<Eigen::StrictlyUpper>() = one.transpose();
  }
}

Eigen::MatrixXd SharedNoise::covariance_of(const Block& block, const ScatterVariances& variances) {
  Eigen::MatrixXd out = variances[1] * block.covariance[0];
  for (std::size_t j = 2; j < kScatters; ++j)
    if (variances[j] > 0.0) out += variances[j] * block.covariance[j - 1];
  out.diagonal().array() += variances[index_of(Scatter::reading)];
  return out;
}

Eigen::MatrixXd SharedNoise::whitened(const Eigen::MatrixXd& rows, const ScatterVariances& variances) const {
  Eigen::MatrixXd out(rows.rows(), rows.cols());
  for (const Block& block : blocks_) {
    const Eigen::MatrixXd own = Cholesky(covariance_of(block, variances)).by_l(rows_of(rows, block.readings));
    for (std::size_t i = 0; i < block.readings.size(); ++i)
      out.row(block.readings[i]) = own.row(static_cast<Eigen::Index>(i));
  }
  return out;
}

double SharedNoise::mean_variance(const ScatterVariances& variances) const {
  double sum = 0.0, count = 0.0;
  for (const Block& block : blocks_) {
    count += static_cast<double>(block.readings.size());
    sum += variances[0] * static_cast<double>(block.readings.size());
    for (std::size_t j = 1; j < kScatters; ++j) sum += variances[j] * block.covariance[j - 1].trace();
  }
  return sum / count;
}

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& all, const std::vector<Eigen::Index>& readings) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(readings.size()), all.cols());
  for (std::size_t i = 0; i < readings.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = all.row(readings[i]);
  return out;
}

namespace {

constexpr int kMostNoiseSteps = 20;
constexpr double kLittleGain = 0.02;  ///< of the log likelihood: a step that promises less is not taken
constexpr double kLeastShare = 1e-6;  ///< of the variance of the readings: as good as nothing
constexpr double kMostShrink = 0.1;   ///< of a variance in one step
constexpr double kMostGrowth = 10.0;

using Scores = Eigen::Matrix<double, static_cast<int>(kScatters), 1>;
using Information = Eigen::Matrix<double, static_cast<int>(kScatters), static_cast<int>(kScatters)>;

/// The restricted likelihood at one choice of variances, with slopes and average information.
struct LikelihoodAt {
  ScatterVariances variances{};
  double half_deviance = std::numeric_limits<double>::max();  ///< −log likelihood, but for a constant
  Scores trace = Scores::Zero(), squares = Scores::Zero();    ///< tr(P·V_j), yᵀ·P·V_j·P·y
  Information average = Information::Zero();                  ///< ½·yᵀ·P·V_j·P·V_k·P·y
  Eigen::VectorXd x;
  [[nodiscard]] double slope(int j) const { return 0.5 * (trace(j) - squares(j)); }
};

class RestrictedLikelihood {
 public:
  RestrictedLikelihood(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                       const Eigen::VectorXd& precision)
      : shared_(shared), unknowns_(columns.cols()) {
    const Eigen::MatrixXd scaled = scaled_columns(columns, norm_);
    precision_ = precision.cwiseQuotient(norm_.cwiseAbs2());
    Eigen::MatrixXd both(columns.rows(), unknowns_ + 1);
    both << scaled, y;
    for (const auto& block : shared.blocks()) rows_.push_back(rows_of(both, block.readings));
  }

  [[nodiscard]] LikelihoodAt at(const ScatterVariances& variances) const {
    LikelihoodAt out;
    out.variances = variances;
    const Eigen::Index p = unknowns_;
    std::vector<Cholesky> factors;
    std::vector<Eigen::MatrixXd> white = rows_;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p + 1, p + 1);
    double half_log_determinant = 0.0;
    for (std::size_t b = 0; b < white.size(); ++b) {
      factors.emplace_back(SharedNoise::covariance_of(shared_.blocks()[b], variances));
      if (!factors.back().is_positive()) return out;
      white[b] = factors.back().by_l(std::move(white[b]));
      half_log_determinant += factors.back().half_ln_determinant();
      add_gram(normal, white[b]);
    }
    Eigen::MatrixXd inner = normal.topLeftCorner(p, p);
    inner.diagonal() += precision_;
    const double ridge = 1e-12 * inner.diagonal().maxCoeff();  // for what is not determined
    inner.diagonal().array() += ridge;
    const Cholesky factor(inner);
    const Eigen::VectorXd right = normal.row(p).head(p).transpose();
    const Eigen::VectorXd scaled_x = factor.solve(right);
    out.x = scaled_x.cwiseQuotient(norm_);
    out.half_deviance =
        half_log_determinant + factor.half_ln_determinant() + 0.5 * (normal(p, p) - right.dot(scaled_x));
    derive(out, white, factors, factor, scaled_x);
    return out;
  }

 private:
  void derive(LikelihoodAt& out, std::vector<Eigen::MatrixXd>& white, const std::vector<Cholesky>& factors,
              const Cholesky& factor, const Eigen::VectorXd& scaled_x) const {
    constexpr auto kCount = static_cast<Eigen::Index>(kScatters);
    const Eigen::Index p = unknowns_;
    Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(p, kCount);  // of V_j·P·y, what the unknowns take up
    for (std::size_t b = 0; b < white.size(); ++b) {
      const auto& block = shared_.blocks()[b];
      const auto m = white[b].rows();
      const Eigen::VectorXd residual = factors[b].by_l_transposed(white[b].col(p) - white[b].leftCols(p) * scaled_x);
      const Eigen::MatrixXd basis = factor.by_l(white[b].leftCols(p).transpose());  // of the unknowns, transposed
      Eigen::MatrixXd inside = Eigen::MatrixXd::Identity(m, m);  // L⁻¹ projects: P = L⁻ᵀ·(1 − basisᵀ·basis)·L⁻¹
      add_gram(inside, basis, -1.0);
      const Eigen::MatrixXd projection =
          factors[b].by_l_transposed(factors[b].by_l_transposed(std::move(inside)).transpose());
      Eigen::MatrixXd forces(m, kCount);
      forces.col(0) = residual;
      out.trace(0) += projection.trace();
      for (Eigen::Index j = 1; j < kCount; ++j) {
        const auto& unit = block.covariance[static_cast<std::size_t>(j - 1)];
        out.trace(j) += projection.cwiseProduct(unit).sum();
        forces.col(j) = unit * residual;
      }
      out.squares += forces.transpose() * residual;
      forces = factors[b].by_l(std::move(forces));
      out.average += 0.5 * forces.transpose() * forces;
      seen += basis * forces;
    }
    out.average -= 0.5 * seen.transpose() * seen;
  }

  const SharedNoise& shared_;
  Eigen::Index unknowns_;
  Eigen::VectorXd norm_, precision_;
  std::vector<Eigen::MatrixXd> rows_;  ///< by block: scaled columns and y
};

/// Newton's step by the average information, of those variances that are not at their least with the slope pressing.
ScatterVariances stepped(const LikelihoodAt& here, double least, double* promised) {
  std::vector<int> active;
  for (int j = 0; j < static_cast<int>(kScatters); ++j)
    if (here.trace(j) > 0.0 && (here.variances[static_cast<std::size_t>(j)] > least || here.slope(j) < 0.0))
      active.push_back(j);
  const auto count = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd information(count, count);
  Eigen::VectorXd slope(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    slope(i) = here.slope(active[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < count; ++k)
      information(i, k) = here.average(active[static_cast<std::size_t>(i)], active[static_cast<std::size_t>(k)]);
    constexpr double kMore = 1e-6;
    information(i, i) *= 1.0 + kMore;
  }
  const Eigen::VectorXd step = -SymmetricSolver(information).solve(slope);
  ScatterVariances out = here.variances;
  *promised = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    double& variance = out[static_cast<std::size_t>(active[static_cast<std::size_t>(i)])];
    const double from = variance;
    variance = std::max(least, std::clamp(from + step(i), kMostShrink * from, kMostGrowth * from));
    *promised += std::abs(slope(i) * (variance - from));
  }
  return out;
}

/// Each variance by the root of what the residuals show over what they should: the likelihood never falls.
ScatterVariances safely_stepped(const LikelihoodAt& here, double least) {
  ScatterVariances out = here.variances;
  for (std::size_t j = 0; j < kScatters; ++j)
    if (const auto i = static_cast<Eigen::Index>(j); here.trace(i) > 0.0)
      out[j] = std::max(least, out[j] * std::sqrt(here.squares(i) / here.trace(i)));
  return out;
}

}  // namespace

NoiseFit fitted_noise(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                      const Eigen::VectorXd& precision, const ScatterVariances& start) {
  const RestrictedLikelihood likelihood(shared, columns, y, precision);
  LikelihoodAt here = likelihood.at(start);
  NoiseFit out;
  for (; out.steps < kMostNoiseSteps; ++out.steps) {
    const double least = kLeastShare * shared.mean_variance(here.variances);
    double promised = 0.0;
    const ScatterVariances wanted = stepped(here, least, &promised);
    if (promised < kLittleGain) break;
    LikelihoodAt next = likelihood.at(wanted);
    if (!(next.half_deviance < here.half_deviance)) next = likelihood.at(safely_stepped(here, least));
    if (!(next.half_deviance < here.half_deviance)) break;
    here = std::move(next);
  }
  out.variances = here.variances;
  out.x = here.x;
  return out;
}

namespace {

/// Eigenvalues of the information, scaled to a diagonal of 1, below which two variances cannot be told apart: then
/// neither does their share change what is wanted.
constexpr double kNotTold = 1e-8;

/// Inverse of what the readings tell of the variances; nothing for what they do not tell.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& information) {
  const auto n = information.rows();
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (information(i, i) > 0.0) scale(i) = 1.0 / std::sqrt(information(i, i));
  const Spectrum eigen = spectrum_of(scale.asDiagonal() * information * scale.asDiagonal());
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (eigen.values(i) > kNotTold) inverse(i) = 1.0 / eigen.values(i);
  const Eigen::MatrixXd directions = scale.asDiagonal() * eigen.vectors;
  return directions * inverse.asDiagonal() * directions.transpose();
}

/// trace(a · b)
double trace_of_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b.transpose()).sum();
}

}  // namespace

// In coordinates in which the covariance of the unknowns is 1, B the orthonormal basis of the whitened columns, A_j the
// whitened share of variance j: T_j = Bᵀ·A_j·B, Q_jk = Bᵀ·A_j·A_k·B; with W the covariance of the estimated variances
// the covariance becomes 1 + 2·Σ W_jk·(Q_jk − T_j·T_k) (Kenward and Roger; V is linear in the variances).
NoiseCertainty::NoiseCertainty(const SharedNoise& shared, const Eigen::MatrixXd& basis, const Eigen::MatrixXd& back,
                               const ScatterVariances& variances, const std::array<bool, kScatters>& estimated) {
  std::vector<std::size_t> which;
  for (std::size_t j = 0; j < kScatters; ++j)
    if (estimated[j]) which.push_back(j);
  const std::size_t count = which.size();
  const Eigen::Index p = basis.cols();
  std::vector<Eigen::MatrixXd> inside(count, Eigen::MatrixXd::Zero(p, p));            // T_j
  std::vector<Eigen::MatrixXd> products(count * count, Eigen::MatrixXd::Zero(p, p));  // Q_jk, k ≤ j
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  for (const auto& block : shared.blocks()) {
    const Cholesky factor(SharedNoise::covariance_of(block, variances));
    const Eigen::MatrixXd inverse = factor.inverse();
    const Eigen::MatrixXd pushed = factor.by_l_transposed(rows_of(basis, block.readings));
    std::vector<Eigen::MatrixXd> shares, seen;  // V⁻¹·V_j, L⁻¹·V_j·L⁻ᵀ·B
    for (std::size_t j = 0; j < count; ++j) {
      Eigen::MatrixXd own = pushed;
      if (which[j] == 0) {
        shares.push_back(inverse);
      } else {
        const Eigen::MatrixXd& unit = block.covariance[which[j] - 1];
        shares.push_back(inverse * unit);
        own = unit * pushed;
      }
      inside[j] += pushed.transpose() * own;
      seen.push_back(factor.by_l(std::move(own)));
      for (std::size_t k = 0; k <= j; ++k) {
        products[j * count + k] += seen[j].transpose() * seen[k];
        information(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) +=
            0.5 * trace_of_product(shares[j], shares[k]);
      }
    }
  }
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      const auto row = static_cast<Eigen::Index>(j), column = static_cast<Eigen::Index>(k);
      information(row, column) += 0.5 * trace_of_product(inside[j], inside[k]) - products[j * count + k].trace();
      information(column, row) = information(row, column);
    }
  spread_ = inverse_of(information);
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      const double w = spread_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
      const Eigen::MatrixXd one = products[j * count + k] - inside[j] * inside[k];
      added += 2.0 * w * one;
      if (k < j) added += 2.0 * w * one.transpose();
    }
  plain_ = back * back.transpose();
  covariance_ = plain_ + back * added * back.transpose();
  for (const Eigen::MatrixXd& one : inside) change_.push_back(back * one * back.transpose());
}

double NoiseCertainty::freedom_of(double variance, const Eigen::VectorXd& slopes) const {
  const double of_variance = slopes.dot(spread_ * slopes);
  return of_variance > 0.0 ? 2.0 * variance * variance / of_variance : std::numeric_limits<double>::infinity();
}

double NoiseCertainty::degrees_of_freedom(const Eigen::MatrixXd& weights, Eigen::Index first) const {
  if (change_.empty()) return std::numeric_limits<double>::infinity();
  const auto n = weights.rows();
  Eigen::VectorXd slopes(static_cast<Eigen::Index>(change_.size()));
  for (std::size_t j = 0; j < change_.size(); ++j)
    slopes(static_cast<Eigen::Index>(j)) = weights.cwiseProduct(change_[j].block(first, first, n, n)).sum();
  return freedom_of(weights.cwiseProduct(plain_.block(first, first, n, n)).sum(), slopes);
}

double NoiseCertainty::degrees_of_freedom(const Eigen::VectorXd& row, Eigen::Index first) const {
  return degrees_of_freedom(Eigen::MatrixXd(row * row.transpose()), first);
}

}  // namespace ecs::model
