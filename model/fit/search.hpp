// The search for missing effects in the whitened space of a data set: what every candidate gains beyond what the model
// absorbs, at what cost in free parameters. Internal to model/ (Eigen).
// Does not live here: which effects there are (model/regression/candidates.hpp), the verdict (model/diagnosis).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "model/fit/noise.hpp"
#include "model/regression/regressors.hpp"

namespace ecs::model {

/// A whitened problem: what has been absorbed, and what is left.
struct Space {
  Eigen::MatrixXd q;  ///< orthonormal (readings × rank)
  Eigen::VectorXd y;  ///< whitened readings, absorbed part removed
  [[nodiscard]] double chi2() const { return y.squaredNorm(); }
};

[[nodiscard]] inline bool same_matrix(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                      const Eigen::Ref<const Eigen::MatrixXd>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

/// Adds whitened columns to what is absorbed; columns that are (nearly) absorbed already do not count.
void absorb(Space& space, const Eigen::MatrixXd& white_columns);

/// The same apart: the directions that are added, and what is left beside all.
[[nodiscard]] Space added_by(const Space& space, const Eigen::MatrixXd& white_columns);

/// How many times as probable as errors of single targets an effect of the library is, before any reading: an
/// assumption. Screws, scales and guides make shapes over the travel, and a wave shorter than the distance of the
/// targets looks like such errors; of the likely effects one in a hundred may be false.
inline constexpr double kShapeBeforehand = 100.0;

/// Price of free coefficients and of having chosen where they are.
struct Price {
  double each = 0.0, once = 0.0;
  [[nodiscard]] double of(std::size_t coefficients) const { return each * static_cast<double>(coefficients) + once; }
};

/// A candidate with the values that its nonlinear parameter is tried at.
struct Family {
  EffectInstance effect;
  Acting acting;
  std::vector<double> grid;           ///< nonlinear parameter; one value 0 where there is none
  std::vector<double> facts;          ///< of them those that the machine's facts suggest
  double search_cost = 0.0;           ///< price of the freedom to choose among the grid
  double fact_cost = 0.0;             ///< price of choosing among the facts
  double shape_cost = 0.0;            ///< price of choosing which of its sizes are used
  double ln_readings = 0.0;           ///< price of one free coefficient
  std::optional<double> far{};        ///< values below are far from likely
  double shortest_seen = 0.0;         ///< periods below are seen only as something slower, two targets a turn
  double travel = 0.0;                ///< of a periodic effect, from the first to the last position
  bool lever_varies = false;          ///< an angular error that its levers tell from other shapes of position
  std::optional<ValueRange> range{};  ///< physical range of the single coefficient
};

/// Whether a period is that of a fact: to a percent, and in step with it over the whole travel.
[[nodiscard]] bool is_in_step(const Family& family, double fact, double period);
/// The same of any of the facts.
[[nodiscard]] bool is_fact(const Family& family, double period);

/// One family at its best.
struct Choice {
  std::size_t family = 0;
  double nonlinear = 0.0;
  std::vector<Eigen::Index> columns;  ///< which of the effect's columns are used
  double gain = 0.0;                  ///< fall of χ²
  double cost = 0.0;
  std::size_t parameters = 0;  ///< free ones, the nonlinear included
  [[nodiscard]] double score() const { return gain - cost; }
};

/// Effects that nearly cancel each other have half of their squares in common.
inline constexpr double kAlikeOfPair = 0.5;

/// A set of effects added to the model.
struct Solution {
  std::vector<Choice> chosen;
  std::vector<Choice> own;  ///< terms of the model whose searched parameter is free, each at its value beside `chosen`
  Space space;
  double chi2_before = 0.0;
  double cost = 0.0;
  [[nodiscard]] double score() const { return chi2_before - space.chi2() - cost; }
};

/// Thrown by a Search whose flag is set; diagnose() turns it into a problem.
struct SearchStopped {};

/// From which square on what is left of a column counts.
struct Precision {
  double absorbed = 0.0;  ///< share of the column's own square
  /// Share of the square of its error in units of rounding. What is taken off a column has errors of its own, which
  /// grow from one to the next where they nearly depend on one another, as the functions of a curve may.
  double grown = 0.0;
};

class Search {
 public:
  static constexpr auto kAllPeaks = static_cast<std::size_t>(-1);

  /// @param base      columns that the model absorbs (not whitened), without those of `own`
  /// @param residual  readings less what the model holds fixed (not whitened)
  /// @param own       terms of the model whose searched parameter is free: it is searched again beside every set of
  /// effects
  /// @param cancelled  looked at from family to family; null: nobody stops it
  Search(const Regressors& regressors, const Whitener& whitener, const Eigen::MatrixXd& base,
         const Eigen::VectorXd& residual, const std::vector<EffectInstance>& candidates,
         const std::vector<EffectInstance>& own = {}, const std::atomic<bool>* cancelled = nullptr);

  /// Of the candidates, then of the model's own terms.
  [[nodiscard]] const std::vector<Family>& families() const { return families_; }
  [[nodiscard]] std::size_t candidates() const { return candidates_; }
  /// What is absorbed whatever the model's own terms do.
  [[nodiscard]] const Space& base() const { return base_; }
  /// The model as it is, its own terms at their best.
  [[nodiscard]] const Solution& alone() const { return alone_; }
  /// Number of different targets of an axis while it moves.
  [[nodiscard]] std::size_t targets(Axis axis) const { return targets_[index_of(axis)]; }

  /// The problem with these effects added, sizes fitted together, nonlinear parameters as they are.
  [[nodiscard]] Solution solution(const std::vector<Choice>& chosen, const std::vector<Choice>& own) const;
  [[nodiscard]] Solution solution(const std::vector<Choice>& chosen) const { return solution(chosen, alone_.own); }
  /// The same, nonlinear parameters refined together; all are sought over their whole range, but for the last period
  /// (it comes from such a search).
  /// @param far  own terms also at values far from likely
  [[nodiscard]] Solution refined(const std::vector<Choice>& chosen, const std::vector<Choice>& own,
                                 bool far = true) const;
  [[nodiscard]] Solution refined(const std::vector<Choice>& chosen) const { return refined(chosen, alone_.own); }

  /// Best choice of every family that gains anything beyond `space`, best score first. The `exact` best are refined.
  [[nodiscard]] std::vector<Choice> expand(const Space& space, std::size_t exact = 8) const;

  /// Pairs of effects, best score first; not of waves, curves and effects of a fixed size.
  /// @param alike  the least square of what both have in common, 0 to 1: where they nearly cancel each other, neither
  ///     gains much alone
  [[nodiscard]] std::vector<std::pair<Choice, Choice>> pairs_of(const Space& space, std::size_t most,
                                                                double alike) const;

  /// Columns of a choice in readings' units: fitted part and fixed part.
  [[nodiscard]] Columns columns_of(const Choice& choice) const;

  /// The fitted part whitened. @pre not of fixed size
  [[nodiscard]] Eigen::MatrixXd white_columns_of(const Choice& choice) const {
    return whitener_(columns_of(choice).of);
  }

  /// Scores of all values of a family beyond `space`, best first, at most this many.
  [[nodiscard]] std::vector<Choice> peaks_of(const Space& space, std::size_t family,
                                             std::size_t most = kAllPeaks) const;
  [[nodiscard]] const Observations& data() const { return regressors_.data(); }
  [[nodiscard]] const Observations& motions() const { return regressors_.motions(); }

  /// For noise alone (columns of `blanks`: independent, of size one, base removed): best score of each column.
  /// @param dearer  price of each coefficient beside its usual one
  [[nodiscard]] std::vector<double> best_scores(const Eigen::MatrixXf& blanks, double dearer = 0.0) const;

  /// Whether each effect with a physical range may have a size inside it beside the others.
  [[nodiscard]] bool in_ranges(const std::vector<Choice>& chosen) const;

  /// Whether a wave or a step is more probable than values of their own for each of a few targets, beside what `space`
  /// absorbs, by Schwarz's criterion and kShapeBeforehand: with a period, sizes and harmonics a wave takes on any
  /// values of five or six, and so does a step beside a curve of the model. True of every other effect.
  [[nodiscard]] bool beats_free_values(const Space& space, const Choice& choice) const;

  /// Fall of χ² that the noise of its sensor takes from a choice, by what that leaves unknown of its temperature: the
  /// true cause explains this much less than a sensor without noise would let it.
  [[nodiscard]] double hidden_by_sensor(const Space& space, const Choice& choice) const;

  /// Exact choice of a family at one value of its nonlinear parameter.
  [[nodiscard]] Choice choice_at(const Space& space, std::size_t family, double nonlinear) const;
  /// The same with the nonlinear parameter moved to the best value nearby.
  [[nodiscard]] Choice refined_choice(const Space& space, std::size_t family, double nonlinear) const;

 private:
  static constexpr std::size_t kMostPeaks = 6;  ///< of a scan that are looked at

  /// One value of a family's nonlinear parameter in the bank.
  struct Item {
    std::size_t family = 0;
    double nonlinear = 0.0;
    Eigen::Index start = 0, count = 0;  ///< columns of the family's shapes
    std::size_t gram = 0;  ///< place of its products in `grams_`: count × count, then the original squares
    bool coarse = false;   ///< part of the thinner grid that the blanks use
    Price price{};
  };
  struct FamilyBank {
    std::vector<Eigen::Index> node_of;  ///< per acting row
    Eigen::Index nodes = 0;
    std::shared_ptr<const Shapes> shapes;
    std::size_t like = 0;    ///< first family of the same nodes: it has the weight, and sums over nodes are the same
    Eigen::MatrixXd weight;  ///< whitened node indicators, multiplied out, of white noise the diagonal; few places only
    Eigen::MatrixXd base_q;  ///< the base seen from the nodes (nodes × rank)
    std::vector<std::vector<Eigen::Index>> variants;  ///< sets of columns that may be used
    std::size_t first = 0, last = 0;                  ///< its items
  };
  /// A space as the nodes of a family see it: enough for products with any shape over them, and so for every answer.
  struct View {
    Eigen::MatrixXd q;  ///< absorbed beyond the base; columns that are zero there left out
    Eigen::VectorXd y;
    std::pair<std::size_t, std::size_t> hash{};  ///< of both
  };
  /// What was found for a family in a view. An effect of another line does not change what a family sees.
  struct Answers {
    std::optional<std::vector<Choice>> peaks;    ///< the best of a scan
    std::map<double, Choice> refined;            ///< by the value where the refinement starts
    std::array<std::optional<Choice>, 2> own{};  ///< of a term of the model, without and with values far from likely
  };
  void heed_cancel() const {
    if (cancelled_ != nullptr && *cancelled_) throw SearchStopped{};
  }
  void build_families(const std::vector<EffectInstance>& candidates, bool of_model);
  void build_bank();
  void build_shapes(std::size_t family);
  void build_grams(std::size_t family);
  void store_own_grams(const FamilyBank& bank, Eigen::Index from, const Eigen::MatrixXd& white);
  void store_grams(const FamilyBank& bank, Eigen::Index from, const Eigen::MatrixXf& left, const Eigen::MatrixXf& right,
                   const Eigen::MatrixXf& absorbed);
  /// Values for products with whitened readings as values for products with motions (Regressors::motions()).
  [[nodiscard]] Eigen::MatrixXd at_motions(const Eigen::MatrixXd& white) const;
  /// Shapes at the nodes of a family as whitened readings.
  [[nodiscard]] Eigen::MatrixXd white_of(std::size_t family, const Eigen::MatrixXd& shapes) const;
  /// Sums of values of motions over the nodes of a family.
  [[nodiscard]] Eigen::MatrixXd gathered(std::size_t family, const Eigen::MatrixXd& rows) const;
  [[nodiscard]] Precision precision_of_screening(std::size_t family) const;
  [[nodiscard]] bool has_places(std::size_t family) const {
    return !banks_[family].shapes->place_mm.empty() && banks_[banks_[family].like].weight.size() > 0;
  }
  /// Of the space that was looked at last; until another one is.
  [[nodiscard]] const View& latest_view(std::size_t family) const;
  [[nodiscard]] const View& view_of(const Space& space, std::size_t family) const;
  /// @return valid until it is asked for again
  [[nodiscard]] Answers& answers_in(const View& view, std::size_t family) const;
  [[nodiscard]] Choice choice_in(const View& view, std::size_t family, double nonlinear) const;
  /// Raises the best score of every blank (column of z: products with this item) by what this item scores there.
  void raise_by(const Item& item, const Eigen::Ref<const Eigen::MatrixXf>& z, double dearer,
                std::vector<double>& top) const;
  [[nodiscard]] Price price_of(const Family& family, double nonlinear) const;
  [[nodiscard]] Choice completed(Choice choice, std::size_t family, double nonlinear) const;
  /// Scores of all values of a family, best first, at most this many; those that gain nothing left out.
  [[nodiscard]] std::vector<Choice> scores_of(std::size_t family, const View& seen, std::size_t most) const;
  /// At a limit of its range: it is another effect under its name.
  [[nodiscard]] bool at_limit(std::size_t family, double nonlinear) const;
  [[nodiscard]] bool too_steep(const Space& space, const Choice& choice) const;
  /// A period refined, its double, its half and other peaks tried as well.
  [[nodiscard]] Choice best_period(const Space& space, const std::vector<Choice>& peaks) const;
  /// An effect at the best value beside what `space` absorbs, near the present one or anywhere.
  /// @param all_periods  also of a wave, of which otherwise only double and half are tried
  [[nodiscard]] Choice best_value(const Space& space, const Choice& now, bool all_periods) const;
  /// An own term at the best of all its values beside what `space` absorbs, with all its columns.
  /// @param far  values far from likely as well
  [[nodiscard]] Choice best_own(const Space& space, std::size_t family, bool far) const;
  /// best_own() and refined_choice() where the answer is not known yet.
  [[nodiscard]] Choice sought_own(const Space& space, std::size_t family, bool far) const;
  [[nodiscard]] Choice sought_nearby(const Space& space, std::size_t family, double nonlinear) const;
  [[nodiscard]] Solution best_alone() const;
  /// The best of all values for each own term in turn, then of all together.
  [[nodiscard]] Solution alone_with(bool far) const;
  /// Columns of a family at one value, whitened, what the base spans taken off; an effect of fixed size has one.
  struct BesideBase {
    Eigen::MatrixXd columns;
    Eigen::VectorXd squares;  ///< before it was taken off
  };
  /// The latest are kept: every space is an extension of the base, and most effects are looked at beside many of them.
  [[nodiscard]] const BesideBase& beside_base(std::size_t family, double nonlinear) const;
  /// Columns of beside_base() less what `space` has absorbed since. @param used  columns of `space.q` that are in use
  [[nodiscard]] Eigen::MatrixXd left_beside(const Space& space, Eigen::Index used, Eigen::MatrixXd beside_base) const;
  /// @param used  as above; there is room for the columns of the choice. Returns how many are in use then.
  [[nodiscard]] Eigen::Index absorb_choice(Space& space, Eigen::Index used, const Choice& choice) const;
  /// What a space has absorbed beyond the base, and what is left there, is then seen for products with motions.
  void look_at(const Space& space) const;

  const Regressors& regressors_;
  const Whitener& whitener_;
  const std::atomic<bool>* cancelled_;
  Space base_;
  Solution alone_;
  std::size_t candidates_ = 0;  ///< families before those of the model's own terms
  std::vector<Family> families_;
  PerAxis<std::size_t> targets_{};
  std::vector<FamilyBank> banks_;
  std::vector<Item> items_;
  std::vector<double> grams_;
  mutable std::map<std::pair<std::size_t, double>, BesideBase> beside_base_;
  mutable Space seen_, seen_at_motions_;       ///< looked at last: beyond the base, and for motions
  mutable std::map<std::size_t, View> views_;  ///< of it, by the first family of the same nodes
  mutable std::map<std::tuple<std::size_t, std::size_t, std::size_t>, Answers> answers_;  ///< by family and view
};

/// Sets of columns of an effect that may be used, cheapest first; curves: see the implementation.
/// @param natural  the axis is the natural one of the sense
[[nodiscard]] std::vector<std::vector<Eigen::Index>> variants_of(const EffectInstance& effect, const Columns& columns,
                                                                 bool natural);

/// A choice as it enters a model: columns not used held at zero, the nonlinear value as a start.
[[nodiscard]] EffectInstance effect_of(EffectInstance effect, const Choice& choice);
/// The same with the columns not used free again.
[[nodiscard]] EffectInstance with_all_sizes(EffectInstance effect, const Choice& choice);

/// A column of which less than this share (of its square) is left is taken as absorbed: half the digits of a double.
inline constexpr double kAbsorbed = 1e-8;
/// The same in the single precision of the screening (2⁻²⁴ = 6e-8 for one product, summed over the readings).
inline constexpr double kAbsorbedScreening = 1e-5;
/// For products of columns in double precision; in single precision, as of the places in the screening; in double
/// precision but multiplied with readings in single precision.
inline constexpr Precision kExact{kAbsorbed, 1e-15}, kScreening{kAbsorbedScreening, kAbsorbedScreening},
    kScreeningOfDouble{kAbsorbedScreening, 1e-8};

/// The same for periods: a wave that the targets see as (nearly) what is absorbed already has any amplitude.
/// A choice: a fiftieth of the square makes amplitudes sevenfold uncertain.
inline constexpr double kAbsorbedPeriod = 0.02;

/// What one set of columns gains, without saying which columns they are.
struct Gain {
  double gain = -1.0;  ///< fall of χ²; below 0: nothing is left of the columns
  double cost = 0.0;
  std::size_t parameters = 0;  ///< independent columns; of a wave all
  std::size_t variant = 0;     ///< place in the list of variants
  [[nodiscard]] double score() const { return gain - cost; }
};

/// Best of the variants by score: of a curve a leading set, else any, a single coefficient kept inside its physical
/// range.
/// @param gram      products of the columns, what is absorbed taken off (columns × columns), whitened
/// @param z         products with what is left
/// @param original  squares of the columns before anything was absorbed
[[nodiscard]] Gain best_gain(const Family& family, const std::vector<std::vector<Eigen::Index>>& variants,
                             const Eigen::Ref<const Eigen::MatrixXd>& gram, const Eigen::Ref<const Eigen::VectorXd>& z,
                             const Eigen::Ref<const Eigen::VectorXd>& original, Precision precision, Price price);

/// The same as a choice, its family and nonlinear parameter still to be set.
[[nodiscard]] Choice choice_of(const Gain& gain, const std::vector<std::vector<Eigen::Index>>& variants);

}  // namespace ecs::model
