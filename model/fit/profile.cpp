// Profile likelihood (Bates and Watts 1988, Nonlinear Regression Analysis and Its Applications, 6.1; Venzon and
// Moolgavkar 1988, Applied Statistics 37, 87).
#include "model/fit/profile.hpp"

#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/fit/search.hpp"
#include "model/linear/decompositions.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rise of χ² at three standard deviations; a third of the way there is one.
constexpr double kRise = 9.0, kSigmas = 3.0;
/// Above so many readings the curvature is exact enough.
constexpr std::size_t kMostProfiled = 4000;
constexpr int kDoublings = 6, kProfileHalvings = 8;
constexpr double kSlopeStep = 1e-5;

/// Contribution of a slot at a value of its searched parameter: the columns of its fitted sizes, and what is held.
struct Contribution {
  MatrixXd columns;
  VectorXd held;
};
Contribution at_value(const Slot& slot, const Regressors& regressors, double value) {
  const Columns all = regressors.columns(slot.effect, value, slot.acting);
  const auto n = static_cast<Index>(regressors.data().size());
  Contribution at{MatrixXd(n, static_cast<Index>(slot.used.size())),
                  all.fixed.size() > 0 ? all.fixed : VectorXd(VectorXd::Zero(n))};
  for (Index j = 0; j < slot.held_sizes.size(); ++j)
    if (slot.held_sizes(j) != 0.0) at.held += slot.held_sizes(j) * all.of.col(j);
  for (std::size_t i = 0; i < slot.used.size(); ++i) at.columns.col(static_cast<Index>(i)) = all.of.col(slot.used[i]);
  return at;
}

/// What all other slots can make of the readings: their columns, and the slopes of their searched parameters.
MatrixXd columns_beside(const Assembly& assembly, const Regressors& regressors, const CoreFit& core, std::size_t own) {
  MatrixXd columns(static_cast<Index>(regressors.data().size()), 0);
  const auto add = [&](const MatrixXd& more) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
    columns.rightCols(more.cols()) = more;
  };
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (s == own) continue;
    add(slot.columns);
    if (slot.formulas || slot.nonlinear.empty() || !slot.nonlinear_free.front() || !slot.has_slope()) continue;
    const VectorXd sizes = core.sizes.segment(assembly.first_column(s), slot.columns.cols());
    const double step = std::max(kSlopeStep * std::abs(slot.nonlinear.front()), kSlopeStep);
    const auto value_at = [&](double value) {
      const Contribution at = at_value(slot, regressors, value);
      return VectorXd(at.held + at.columns * sizes);
    };
    add(value_at(slot.nonlinear.front() + step) - value_at(slot.nonlinear.front() - step));
  }
  return columns;
}

class SlotProfile {
 public:
  SlotProfile(const Assembly& assembly, const Regressors& regressors, const CoreFit& core, std::size_t s)
      : slot_(assembly.slots[s]), regressors_(regressors), whitener_(regressors.data(), core.noise, core.left_out) {
    const Observations& data = regressors.data();
    VectorXd rest = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
    for (std::size_t other = 0; other < assembly.slots.size(); ++other)
      if (other != s) rest -= assembly.slots[other].fixed;
    beside_.y = whitener_(rest);
    beside_.q.resize(beside_.y.size(), 0);
    absorb(beside_, whitener_(columns_beside(assembly, regressors, core, s)));
    const double freedom = std::max(1.0, static_cast<double>(data.size()) - static_cast<double>(core.rank));
    scale_ = std::max(1.0, core.chi2 / freedom);
    best_ = at(slot_.nonlinear.front()).chi2;
  }

  struct Fitted {
    double chi2 = 0.0;
    VectorXd sizes;
  };
  [[nodiscard]] Fitted at(double value) const {
    const Contribution own = at_value(slot_, regressors_, value);
    const MatrixXd columns = beyond(own.columns);
    const VectorXd y = beside_.y - beyond(own.held);
    Fitted fitted;
    fitted.sizes = PivotedQr(columns).solve(y);
    fitted.chi2 = (y - columns * fitted.sizes).squaredNorm();
    return fitted;
  }
  [[nodiscard]] bool far(double value) const { return (at(value).chi2 - best_) / scale_ > kRise; }

  /// Where χ² has risen by kRise on one side, at most `end`.
  [[nodiscard]] double edge(double step, double end) const {
    const double best = slot_.nonlinear.front();
    const auto within = [&](double value) { return step > 0.0 ? std::min(value, end) : std::max(value, end); };
    double inside = best, outside = within(best + step);
    for (int i = 0; i < kDoublings && !far(outside); ++i) {
      inside = outside;
      step *= 2.0;
      outside = within(best + step);
      if (outside == inside) return outside;
    }
    for (int i = 0; i < kProfileHalvings; ++i) {
      const double middle = 0.5 * (inside + outside);
      (far(middle) ? outside : inside) = middle;
    }
    return outside;
  }

 private:
  [[nodiscard]] MatrixXd beyond(const MatrixXd& raw) const {
    MatrixXd white = whitener_(raw);
    white -= beside_.q * (beside_.q.transpose() * white).eval();
    return white;
  }

  const Slot& slot_;
  const Regressors& regressors_;
  Whitener whitener_;
  Space beside_;
  double scale_ = 1.0, best_ = 0.0;
};

}  // namespace

std::optional<ProfileSigma> profile_sigma(const Assembly& assembly, const Regressors& regressors, const CoreFit& core,
                                          std::size_t s, double sigma) {
  const Slot& slot = assembly.slots[s];
  const EffectDefinition& definition = slot.effect.definition();
  if (slot.formulas || slot.nonlinear.size() != 1 || !slot.nonlinear_free.front() || !slot.has_slope() ||
      definition.traits.periodic || slot.columns.cols() == 0 || slot.acting.rows.empty() ||
      definition.search.limits == nullptr || regressors.data().size() > kMostProfiled || !(sigma > 0.0))
    return std::nullopt;
  const double best = slot.nonlinear.front();
  const ValueRange range = definition.search.limits(regressors.motions(), slot.effect, slot.acting, best);
  const SlotProfile profile(assembly, regressors, core, s);
  const VectorXd sizes = profile.at(best).sizes;
  ProfileSigma result{0.0, VectorXd::Zero(sizes.size())};
  for (const double step : {-kSigmas * sigma, kSigmas * sigma}) {
    const double edge = profile.edge(step, step < 0.0 ? std::min(best, range.least) : std::max(best, range.greatest));
    result.searched = std::max(result.searched, std::abs(edge - best) / kSigmas);
    result.sizes = result.sizes.cwiseMax((profile.at(edge).sizes - sizes).cwiseAbs() / kSigmas);
  }
  return result;
}

}  // namespace ecs::model
