#include "model/diagnosis/apart.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "model/diagnosis/trial.hpp"
#include "model/diagnosis/visits.hpp"
#include "model/diagnosis/weighing.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {

using Rows = std::vector<std::size_t>;

/// "Z:EZ": as effects of the line end.
std::string line_of_reading(const Observations& data, std::size_t k) {
  return fmt::format("{}:{}", data.letter(data.axis[k]), name_of(data.sense[k]));
}

bool includes(const Rows& all, const Rows& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

/// What is judged on some of the readings.
struct Part {
  Answer answer;
  std::vector<OwnTerm> own;
  std::string line{};  ///< alone; "": several
};

/// @return nothing where the readings are too few to say anything
Result<std::optional<Part>> judged_alone(const ReportInput& whole, const Rows& rows, const std::string& line) {
  const Observations& all = whole.regressors.data();
  const Observations data = subset(all, rows);
  const Regressors regressors(data);
  ECS_TRY(base, base_of(whole.model, regressors, whole.options.plain));
  if (static_cast<double>(data.size()) - static_cast<double>(base.core.rank) < kFewestSpare)
    return std::optional<Part>();
  DiagnoseOptions options = whole.options;
  options.most_effects = options.most_effects / axes_moved(all) * axes_moved(data);
  ECS_TRY(found, found_in(whole.model, regressors, base, options));
  const std::vector<OwnTerm> own = own_terms_of(found, base);
  Part part{answer_of({whole.model, regressors, base, own, problem_with_own(whole.model, base, regressors, own), found,
                       options}),
            own, line};
  // a wander of all lines can look like an effect on one of them
  for (RankedCandidate& one : part.answer.order)
    if (one.standing == Standing::likely &&
        (is_like_wander(one.effect) || one.alias == Alias::wander || one.e_value.value_or(kSpeaksFor) < kSpeaksFor))
      one.standing = Standing::possible;
  return std::optional(std::move(part));
}

std::map<std::string, Rows> lines_of(const Observations& data) {
  std::map<std::string, Rows> lines;
  for (std::size_t k = 0; k < data.size(); ++k) lines[line_of_reading(data, k)].push_back(k);
  return lines;
}

/// Lines whose readings effects do not explain, each judged alone, by name; nothing of lines with too few readings.
Result<std::map<std::string, Part>> lines_not_explained(const ReportInput& whole) {
  const std::map<std::string, Rows> lines = lines_of(whole.regressors.data());
  std::map<std::string, Part> not_explained;
  if (lines.size() < 2) return not_explained;
  for (const auto& [name, rows] : lines) {
    ECS_TRY(alone, judged_alone(whole, rows, name));
    if (alone && !alone->answer.explained) not_explained.emplace(name, std::move(*alone));
  }
  if (not_explained.size() == lines.size()) not_explained.clear();
  return not_explained;
}

/// Readings of the lines on which a term of the model changes: where it is constant, a zero of the line absorbs it.
Rows changed_by(const ReportInput& whole, const OwnTerm& term) {
  constexpr double kConstant = 1e-9;  // of its largest value
  const Eigen::MatrixXd columns = whole.regressors.columns(whole.model.effects[term.effect], term.value).of;
  const double largest = columns.size() == 0 ? 0.0 : columns.cwiseAbs().maxCoeff();
  Rows changed;
  for (const auto& line : lines_of(whole.regressors.data())) {
    const Rows& rows = line.second;
    const auto changes = [&](std::size_t k) {
      const Eigen::RowVectorXd step =
          columns.row(static_cast<Eigen::Index>(k)) - columns.row(static_cast<Eigen::Index>(rows.front()));
      return step.cwiseAbs().maxCoeff() > kConstant * largest;
    };
    if (columns.cols() > 0 && std::ranges::any_of(rows, changes))
      changed.insert(changed.end(), rows.begin(), rows.end());
  }
  std::ranges::sort(changed);
  return changed;
}

/// The part on which each own term of the model changes, by its number; nothing where one does on several, for it has
/// one value.
std::optional<std::vector<std::size_t>> parts_of_own(const ReportInput& whole, const std::vector<Rows>& parts) {
  std::vector<std::size_t> of_own;
  for (const OwnTerm& term : whole.own) {
    const Rows rows = changed_by(whole, term);
    const auto part = std::ranges::find_if(parts, [&](const Rows& one) { return includes(one, rows); });
    if (part == parts.end()) return std::nullopt;
    of_own.push_back(static_cast<std::size_t>(part - parts.begin()));
  }
  return of_own;
}

/// Causes of all parts, proved ones first; then what else was found in one of them; then what was listed before.
std::vector<RankedCandidate> joined_order(const std::vector<const Part*>& parts,
                                          const std::vector<RankedCandidate>& before) {
  std::vector<RankedCandidate> order;
  const auto add = [&](const RankedCandidate& one, const std::string& line) {
    if (std::ranges::any_of(order, [&](const auto& known) { return same_candidate(known.effect, one.effect); })) return;
    order.push_back(one);
    order.back().apart = line;
  };
  for (const Standing standing : {Standing::proved, Standing::likely, Standing::possible})
    for (const Part* part : parts)
      for (const RankedCandidate& one : part->answer.order)
        if (one.standing == standing && (one.in_answer() || one.found)) add(one, part->line);
  for (RankedCandidate one : before) {
    one.standing = Standing::possible;
    one.found = false;
    if (order.size() < kMostListed) add(one, "");
  }
  return order;
}

/// As answer_of(): causes explain all in part where they explain half of what is above noise.
Verdict verdict_of_parts(const ReportInput& whole, const std::vector<RankedCandidate>& order) {
  const bool any_proved = std::ranges::find(order, Standing::proved, &RankedCandidate::standing) != order.end();
  const Standing standing = any_proved ? Standing::proved : Standing::likely;
  LinearProblem all = whole.problem;
  for (const RankedCandidate& one : order)
    if (one.standing == standing) all = joined_with(all, columns_on(whole.regressors, one.effect, one.choice));
  if (share_explained(whole, all) < kPartExplained) return Verdict::unexplained_structure;
  return any_proved ? Verdict::partly_explained : Verdict::likely_effect;
}

}  // namespace

std::size_t axes_moved(const Observations& data) { return std::set<Axis>(data.axis.begin(), data.axis.end()).size(); }

Result<Found> found_in(const Model& model, const Regressors& regressors, const Base& base,
                       const DiagnoseOptions& options) {
  const Observations& data = regressors.data();
  if (data.size() <= options.largest_search)
    return searched(model, regressors, base, all_candidates(model, regressors), options);
  const Observations part = searched_part(data, options.largest_search);
  const Regressors part_regressors(part);
  ECS_TRY(part_base, base_of(model, part_regressors, options.plain));
  return searched(model, part_regressors, part_base, all_candidates(model, part_regressors), options);
}

std::vector<OwnTerm> own_terms_of(const Found& found, const Base& base) {
  std::vector<OwnTerm> own;
  for (const Choice& term : found.solution.own)
    own.push_back({base.own[term.family - found.candidates_tried], term.nonlinear});
  return own;
}

std::vector<Rows> parts_of_lines(const Observations& data, const std::vector<std::string>& apart) {
  std::vector<Rows> parts(apart.size() + 1);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto line = std::ranges::find(apart, line_of_reading(data, k));
    parts[line == apart.end() ? 0 : static_cast<std::size_t>(line - apart.begin()) + 1].push_back(k);
  }
  return parts;
}

Result<std::optional<JudgedApart>> judged_apart(const ReportInput& whole, const Answer& answer) {
  const Observations& data = whole.regressors.data();
  if (answer.explained || !answer.other_unit.empty() || !data.paths.empty() || !data.through_chain.empty() ||
      are_scattered_points(data))
    return std::nullopt;
  ECS_TRY(not_explained, lines_not_explained(whole));
  if (not_explained.empty()) return std::nullopt;
  JudgedApart judged{answer, whole.own};
  for (const auto& [name, part] : not_explained) judged.answer.apart.push_back(name);
  const std::vector<Rows> rows = parts_of_lines(data, judged.answer.apart);
  const auto of_own = parts_of_own(whole, rows);
  if (!of_own) return std::nullopt;
  ECS_TRY(others, judged_alone(whole, rows.front(), ""));
  if (!others || !others->answer.explained) return std::nullopt;
  if (std::ranges::none_of(others->answer.order, &RankedCandidate::in_answer)) return std::nullopt;
  std::vector<const Part*> parts{&*others};
  for (const auto& [name, part] : not_explained) parts.push_back(&part);
  judged.answer.order = joined_order(parts, answer.order);
  judged.answer.verdict = verdict_of_parts(whole, judged.answer.order);
  for (std::size_t i = 0; i < of_own->size(); ++i) {
    const std::vector<OwnTerm>& own = parts[(*of_own)[i]]->own;
    const auto found = std::ranges::find(own, judged.own[i].effect, &OwnTerm::effect);
    if (found != own.end()) judged.own[i].value = found->value;
  }
  return std::optional(std::move(judged));
}

}  // namespace ecs::model
