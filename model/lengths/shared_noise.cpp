#include "model/lengths/shared_noise.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "base/units.hpp"

namespace ecs::model {
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
    Eigen::MatrixXd own = rows_of(rows, block.readings);
    Eigen::LLT<Eigen::MatrixXd>(covariance_of(block, variances)).matrixL().solveInPlace(own);
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

}  // namespace ecs::model
