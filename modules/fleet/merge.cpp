#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "modules/fleet/result.hpp"

namespace ecs::commissioning {
namespace {

/// Nothing where neither the results nor an e-value say it.
std::optional<double> p_value_of(const FleetCause& cause) {
  if (cause.p_value) return cause.p_value;
  if (cause.e_value) return 1.0 / std::max(1.0, *cause.e_value);
  return std::nullopt;
}

double p_value_of(const FleetResult& result) {
  if (result.causes.empty()) return 1.0;
  if (result.p_value) return *result.p_value;
  double least = 1.0;
  for (const FleetCause& cause : result.causes) least = std::min(least, p_value_of(cause).value_or(1.0));
  return least;
}

/// ln n! without lgamma, which writes a global sign: tests of many groups may run beside a diagnosis.
class LnFactorials {
 public:
  explicit LnFactorials(std::size_t most) : ln_(most + 1, 0.0) {
    for (std::size_t n = 1; n <= most; ++n) ln_[n] = ln_[n - 1] + std::log(static_cast<double>(n));
  }
  [[nodiscard]] double ln_choose(std::size_t n, std::size_t k) const { return ln_[n] - ln_[k] - ln_[n - k]; }
  /// Chance that of `drawn` machines at least `hits` have a cause that `with_cause` of `all` have: the upper tail of
  /// the hypergeometric law (Fisher's exact test, one-sided). @pre drawn, with_cause <= all
  [[nodiscard]] double tail(std::size_t all, std::size_t with_cause, std::size_t drawn, std::size_t hits) const {
    const std::size_t least = drawn + with_cause > all ? drawn + with_cause - all : 0;
    if (hits <= least) return 1.0;
    double sum = 0.0;
    for (std::size_t k = hits; k <= std::min(drawn, with_cause); ++k)
      sum += std::exp(ln_choose(with_cause, k) + ln_choose(all - with_cause, drawn - k) - ln_choose(all, drawn));
    return std::min(1.0, sum);
  }

 private:
  std::vector<double> ln_;
};

/// A label of machines by which a cause may be shared.
struct Label {
  const char* by;
  std::string FleetResult::*of_result;
  std::string NamedMachine::*of_named;
};
constexpr Label kLabels[] = {{"type", &FleetResult::type, &NamedMachine::type},
                             {"batch", &FleetResult::batch, &NamedMachine::batch}};

/// A cause against all types and batches, without the machines that a listed group explains.
class CauseCounts {
 public:
  CauseCounts(const std::vector<FleetResult>& results, std::unordered_set<std::string> with_cause)
      : results_(results), with_cause_(std::move(with_cause)), left_out_(results.size()) {}

  void leave_out(const SharedCause& group) {
    for (std::size_t i = 0; i < results_.size(); ++i)
      if (results_[i].*label_named(group.by).of_result == group.value) left_out_[i] = true;
  }

  [[nodiscard]] std::vector<SharedCause> groups(const LnFactorials& factorials) const {
    std::vector<SharedCause> list;
    for (const Label& label : kLabels) {
      std::map<std::string, std::pair<std::size_t, std::size_t>> count;  // all, with the cause
      std::size_t all = 0, with_cause = 0;
      for (std::size_t i = 0; i < results_.size(); ++i) {
        const FleetResult& result = results_[i];
        if (left_out_[i] || !result.error.empty() || (result.*label.of_result).empty()) continue;
        const std::size_t hit = with_cause_.contains(result.id) ? 1 : 0;
        auto& [of_value, hits] = count[result.*label.of_result];
        ++all, ++of_value;
        with_cause += hit, hits += hit;
      }
      for (const auto& [value, counted] : count)
        if (counted.second >= kFewestShared)
          list.push_back({label.by,
                          value,
                          {},
                          counted.second,
                          counted.first,
                          factorials.tail(all, with_cause, counted.first, counted.second),
                          1.0});
    }
    return list;
  }

 private:
  static constexpr std::size_t kFewestShared = 2;  ///< one machine shares nothing
  static const Label& label_named(const std::string& by) { return by == kLabels[0].by ? kLabels[0] : kLabels[1]; }

  const std::vector<FleetResult>& results_;
  std::unordered_set<std::string> with_cause_;
  std::vector<bool> left_out_;
};

/// The likeliest group first; its machines are taken out before the others are looked at again, so that a type is not
/// listed for its one bad batch.
std::vector<SharedCause> shared_causes(const std::vector<FleetResult>& results,
                                       const std::vector<NamedMachine>& named) {
  std::map<std::string, std::unordered_set<std::string>> machines_of;
  for (const NamedMachine& one : named) machines_of[one.cause].insert(one.id);
  std::set<std::pair<std::string, std::string>> values;
  for (const FleetResult& result : results)
    for (const Label& label : kLabels)
      if (result.error.empty() && !(result.*label.of_result).empty()) values.emplace(label.by, result.*label.of_result);
  double tests = static_cast<double>(values.size() * machines_of.size());
  const LnFactorials factorials(results.size());
  std::map<std::string, CauseCounts> counts;
  for (const auto& [cause, ids] : machines_of) counts.emplace(cause, CauseCounts(results, ids));
  std::map<std::string, std::vector<SharedCause>> open;
  for (const auto& [cause, count] : counts) open[cause] = count.groups(factorials);
  std::vector<SharedCause> listed;
  for (double before = 0.0;;) {
    SharedCause best;
    for (const auto& [cause, groups] : open)
      for (const SharedCause& group : groups)
        if (best.cause.empty() || group.p_value < best.p_value) {
          best = group;
          best.cause = cause;
        }
    best.p_holm = std::max(before, std::min(1.0, best.p_value * tests));
    if (best.cause.empty() || best.p_holm > kSharedLevel) return listed;
    before = best.p_holm;
    tests = std::max(1.0, tests - 1.0);
    CauseCounts& count = counts.at(best.cause);
    count.leave_out(best);
    open[best.cause] = count.groups(factorials);
    listed.push_back(std::move(best));
  }
}

}  // namespace

std::vector<double> q_values_of(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  const auto all = static_cast<double>(p_values.size());
  std::vector<double> q(p_values.size(), 1.0);
  double least = 1.0;
  for (std::size_t k = order.size(); k-- > 0;) {
    least = std::min(least, all * p_values[order[k]] / static_cast<double>(k + 1));
    q[order[k]] = least;
  }
  return q;
}

FleetNames fleet_names(const std::vector<FleetResult>& results, double rate) {
  FleetNames names;
  std::vector<double> p_values;
  std::vector<const FleetResult*> answered;
  for (const FleetResult& result : results) {
    if (!result.error.empty()) continue;
    answered.push_back(&result);
    p_values.push_back(p_value_of(result));
    if (result.verdict == "unexplained_structure") names.unexplained.push_back(result.id);
  }
  names.machines = answered.size();
  const std::vector<double> q = q_values_of(p_values);
  const auto rejected =
      std::max<std::ptrdiff_t>(1, std::count_if(q.begin(), q.end(), [&](double one) { return one <= rate; }));
  const double tests_a_name = static_cast<double>(answered.size()) / static_cast<double>(rejected);
  std::vector<std::pair<double, NamedMachine>> named;
  for (std::size_t i = 0; i < answered.size(); ++i) {
    const std::vector<FleetCause>& causes = answered[i]->causes;
    const auto surest = std::min_element(causes.begin(), causes.end(), [](const FleetCause& a, const FleetCause& b) {
      return p_value_of(a).value_or(2.0) < p_value_of(b).value_or(2.0);
    });
    for (auto cause = causes.begin(); cause != causes.end(); ++cause) {
      NamedMachine one{answered[i]->id,   cause->name,        std::nullopt,
                       answered[i]->type, answered[i]->batch, cause->rivals};
      const std::optional<double> p = p_value_of(*cause);
      if (p) one.q_value = cause == surest ? q[i] : std::max(q[i], std::min(1.0, tests_a_name * *p));
      if (one.q_value && *one.q_value <= rate)
        named.emplace_back(*p, std::move(one));
      else
        names.unconfirmed.push_back(std::move(one));
    }
  }
  std::stable_sort(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [p_value, one] : named) names.named.push_back(std::move(one));
  names.groups = shared_causes(results, names.named);
  return names;
}

FleetChanges changes_between(const std::vector<NamedMachine>& before, const std::vector<NamedMachine>& now,
                             const std::vector<std::string>& absent_now) {
  using Names = std::set<std::pair<std::string, std::string>>;
  const std::unordered_set<std::string> absent(absent_now.begin(), absent_now.end());
  const auto names_of = [&](const std::vector<NamedMachine>& list) {
    Names names;
    for (const NamedMachine& one : list)
      if (!absent.contains(one.id)) names.emplace(one.id, one.cause);
    return names;
  };
  const Names old = names_of(before), fresh = names_of(now);
  FleetChanges changes;
  std::map<std::string, FleetChanges::Count> counts;
  const auto add = [&](const Names& these, const Names& others, bool is_new) {
    for (const auto& [id, cause] : these) {
      if (others.contains({id, cause})) continue;
      changes.machines.push_back({id, cause, is_new});
      FleetChanges::Count& count = counts[cause];
      count.cause = cause;
      ++(is_new ? count.is_new : count.gone);
    }
  };
  add(fresh, old, true);
  add(old, fresh, false);
  std::stable_sort(changes.machines.begin(), changes.machines.end(),
                   [](const FleetChange& a, const FleetChange& b) { return a.id < b.id; });
  for (const auto& [cause, count] : counts) changes.causes.push_back(count);
  std::stable_sort(changes.causes.begin(), changes.causes.end(),
                   [](const auto& a, const auto& b) { return a.is_new + a.gone > b.is_new + b.gone; });
  return changes;
}

namespace {

Problem no_results(const std::string& file, int line) {
  return {ProblemKind::bad_input, "expected lines as `ecs fleet diagnose` writes them, found none", file, line, 0, {}};
}

}  // namespace

Result<GatheredResults> gathered_results(const std::vector<std::string>& files) {
  GatheredResults gathered;
  std::unordered_map<std::string, std::pair<std::size_t, std::size_t>> place_of;  // in the list, number of the file
  for (std::size_t f = 0; f < files.size(); ++f) {
    ECS_TRY(text, read_file(files[f]));
    ResultLines lines = result_lines(text, true);
    if (lines.results.empty() && !text.empty()) return tl::unexpected(no_results(files[f], 1));
    if (lines.unreadable > 0)
      gathered.unreadable.push_back(
          fmt::format("{}:{}: {} truncated or unreadable line{} ignored: run `ecs fleet diagnose` again", files[f],
                      lines.first_unreadable, lines.unreadable, lines.unreadable == 1 ? "" : "s"));
    for (auto& one : lines.results) {
      FleetResult& result = one.result;
      if (result.id.empty() || result.doubled) {
        gathered.results.push_back(std::move(result));
        continue;
      }
      const auto [known, is_new] = place_of.try_emplace(result.id, gathered.results.size(), f);
      if (is_new) {
        gathered.results.push_back(std::move(result));
        continue;
      }
      FleetResult& other = gathered.results[known->second.first];
      if (!result.error.empty() && other.error.empty()) continue;
      if (result.error.empty() && other.error.empty() && result.hash != other.hash)
        gathered.conflicts.push_back(
            fmt::format("{}: {} differs from its entry in {}: give each machine its own id, or omit old results",
                        files[f], result.id, files[known->second.second]));
      known->second.second = f;
      other = std::move(result);
    }
  }
  return gathered;
}

Result<std::vector<NamedMachine>> previously_named(const std::string& file, double rate) {
  ECS_TRY(text, read_file(file));
  ResultLines lines = result_lines(text, true);
  if (!lines.results.empty() || text.empty()) {
    std::vector<FleetResult> results;
    for (auto& one : lines.results) results.push_back(std::move(one.result));
    return fleet_names(results, rate).named;
  }
  const Json answer = Json::parse(text, nullptr, false);
  const auto list = answer.is_object() ? answer.find("named") : answer.end();
  if (!answer.is_object() || list == answer.end() || !list->is_array()) return tl::unexpected(no_results(file, 1));
  std::vector<NamedMachine> named;
  for (const Json& one : *list) {
    named.push_back(
        {text_at(one, "id"), text_at(one, "cause"), std::nullopt, text_at(one, "type"), text_at(one, "batch")});
    if (named.back().id.empty() || named.back().cause.empty()) return tl::unexpected(no_results(file, 1));
  }
  return named;
}

Result<void> write_results(const std::string& path, const std::vector<FleetResult>& results) {
  std::string text;
  for (const FleetResult& result : results) text += to_line(result) + '\n';
  return write_file(path, text);
}

}  // namespace ecs::commissioning
