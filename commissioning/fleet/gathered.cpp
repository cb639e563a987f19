#include "commissioning/fleet/gathered.hpp"

#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/fleet/results_file.hpp"

namespace ecs::commissioning {
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
          fmt::format("{}:{}: {} cut or unreadable line{} left out: run `ecs fleet diagnose` "
                      "again",
                      files[f], lines.first_unreadable, lines.unreadable, lines.unreadable == 1 ? "" : "s"));
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
        gathered.conflicts.push_back(fmt::format(
            "{}: {} has other contents than in {}: give each machine an id of its own, or leave old results "
            "out",
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
    const auto word = [&](const char* key) {
      return one.is_object() && one.contains(key) && one[key].is_string() ? one[key].get<std::string>() : std::string();
    };
    if (word("id").empty() || word("cause").empty()) return tl::unexpected(no_results(file, 1));
    named.push_back({word("id"), word("cause"), std::nullopt, word("type"), word("batch")});
  }
  return named;
}

Result<void> write_results(const std::string& path, const std::vector<FleetResult>& results) {
  std::string text;
  for (const FleetResult& result : results) text += to_line(result) + '\n';
  return write_file(path, text);
}

}  // namespace ecs::commissioning
