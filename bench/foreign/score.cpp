// Runs the program on every case of a folder and counts what is right.
#include "bench/foreign/score.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "bench/foreign/linear.hpp"

namespace foreign {
namespace {

using ecs::Json;
using Names = std::set<std::string>;

struct Verdict {
  std::string row;
  std::string name;
  std::string kind;  // of what is hidden, where one word says it
  bool right = false;
  bool named = false;  // anything
  double seconds = 0.0;
  int parameters = 0;  // stated with a set or a standard deviation
  int in_stated_set = 0;
  int near = 0;  // within three Cramér–Rao standard deviations, or of a member of the set
  int unstated = 0;
  std::string line;  // truth → answer
  std::string parameter_line;
};

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 65536> block{};
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), pipe)) text.append(block.data(), got);
  pclose(pipe);
  return text;
}

std::string word(const Json& object, const char* key) {
  const auto at = object.find(key);
  return at != object.end() && at->is_string() ? at->get<std::string>() : "";
}

// A squareness and a rotation belong to no axis of the set alone, offsets of a sense neither.
std::string comparable(const std::string& name) {
  const std::size_t first = name.find(':');
  const std::string id = name.substr(0, first);
  if (id == "set_up_rotation" || id == "squareness" || id == "offset") return id + name.substr(name.rfind(':'));
  return name;
}

std::string name_in(const Json& candidate) {
  const std::string code = word(candidate, "code");
  const std::string id = word(candidate, "effect");
  const bool by_code = id == "angular" || id == "squareness" || id == "set_up_rotation";
  return comparable(id + ":" + word(candidate, "axis") + ":" + (by_code ? code : word(candidate, "sense")));
}

Names names_in(const Json& list) {
  Names names;
  for (const Json& name : list) names.insert(comparable(name.get<std::string>()));
  return names;
}

bool same_details(const Json& hidden, const Json& candidate) {
  const std::string id = word(hidden, "effect");
  if (id == "cyclic") return word(hidden, "approach") == word(candidate, "approach");
  const std::string sensor = word(candidate, "sensor");
  if (id == "thermal_drift") return word(hidden, "sensor") == sensor;
  return true;
}

struct Answer {
  std::string verdict;
  std::vector<Json> candidates;
  std::vector<Json> named;
  Names where;
};

Answer answer_in(const Json& json) {
  Answer answer;
  answer.verdict = word(json, "verdict");
  for (const Json& candidate : json.value("candidates", Json::array())) {
    answer.candidates.push_back(candidate);
    if (candidate.value("named", false) || word(candidate, "standing") == "likely") answer.named.push_back(candidate);
  }
  for (const Json& place : json.value("where", Json::array())) answer.where.insert(word(place, "variable"));
  return answer;
}

Names group_of(const Json& candidate) {
  Names group = names_in(candidate.value("indistinguishable_from", Json::array()));
  group.insert(name_in(candidate));
  return group;
}

// The named candidate that stands for a hidden effect, or null.
const Json* stands_for(const Json& hidden, const std::vector<Json>& named, const Names& rivals) {
  const std::string truth = comparable(word(hidden, "name"));
  for (const Json& candidate : named)
    if (name_in(candidate) == truth && same_details(hidden, candidate)) return &candidate;
  for (const Json& candidate : named)
    if (rivals.contains(name_in(candidate)) && group_of(candidate).contains(truth)) return &candidate;
  return nullptr;
}

bool says_causes(const Answer& answer) {
  return answer.verdict == "missing_effect" || answer.verdict == "likely_effect" ||
         answer.verdict == "partly_explained";
}

bool right_names(const Json& truth, const Answer& answer, const Names& rivals) {
  const Json& hidden = truth.at("hidden");
  if (answer.verdict == "adequate") return truth.at("oracle_p").get<double>() > 0.01;
  if (!says_causes(answer)) return false;
  std::set<const Json*> found;
  for (const Json& effect : hidden)
    if (const Json* candidate = stands_for(effect, answer.named, rivals)) found.insert(candidate);
  return found.size() == hidden.size() && answer.named.size() == hidden.size();
}

bool right_group(const Json& truth, const Answer& answer, const Names& required, const Names& allowed) {
  if (answer.candidates.empty() || !says_causes(answer)) return false;
  Names must = required;
  must.insert(comparable(word(truth.at("hidden").front(), "name")));
  const Names group = group_of(answer.candidates.front());
  return std::includes(group.begin(), group.end(), must.begin(), must.end()) &&
         std::all_of(group.begin(), group.end(),
                     [&](const std::string& name) { return must.contains(name) || allowed.contains(name); });
}

struct ParameterVerdict {
  bool stated = true;
  bool in_stated_set = false;
  bool near = false;
};

// One parameter. Nothing where the answer does not have it or the readings do not determine it.
std::optional<ParameterVerdict> right_parameter(const Json& hidden, const std::string& name, const Json& truth,
                                                const Json& candidate) {
  const double value = truth.at("value").get<double>();
  const Json values = candidate.value("parameters", Json::object());
  if (!values.contains(name) || !values[name].is_number()) return std::nullopt;
  double answer = values[name].get<double>();
  if (name == "position_mm" && hidden.contains("interval_mm")) {
    const bool right = answer >= hidden["interval_mm"][0].get<double>() - 1e-6 &&
                       answer <= hidden["interval_mm"][1].get<double>() + 1e-6;
    return ParameterVerdict{true, right, right};
  }
  if (truth.at("sigma").is_null()) return std::nullopt;
  if (word(hidden, "effect") == "thermal_bend" && word(hidden, "sensor") != word(candidate, "sensor")) answer = -answer;
  const double reach = 3.0 * truth.at("sigma").get<double>();
  const Json sets = candidate.value("parameters_set", Json::object());
  if (sets.is_object() && sets.contains(name) && sets[name].is_array())
    for (const Json& member : sets[name])
      if (member.is_number() && std::abs(member.get<double>() - value) <= reach)
        return ParameterVerdict{true, true, true};
  if (name.starts_with("phase")) answer = value + std::remainder(answer - value, 2.0 * std::numbers::pi);
  const Json sigmas = candidate.value("sigma", Json::object());
  const bool stated = sigmas.is_object() && sigmas.contains(name) && sigmas[name].is_number();
  const double off = std::abs(answer - value);
  return ParameterVerdict{stated, stated && off <= 3.0 * sigmas[name].get<double>(), off <= reach};
}

void score_parameters(const Json& truth, const Answer& answer, Verdict& verdict) {
  for (const Json& hidden : truth.at("hidden")) {
    const Json* candidate = stands_for(hidden, answer.named, {});
    if (candidate == nullptr) continue;
    for (const auto& [name, value] : hidden.at("parameters").items()) {
      if (name == "amplitude2_um" || name == "phase2_rad" || name == "phase_rad") continue;  // follow the period
      const auto parameter = right_parameter(hidden, name, value, *candidate);
      if (!parameter) continue;
      (parameter->stated ? verdict.parameters : verdict.unstated) += 1;
      if (parameter->stated) {
        verdict.in_stated_set += parameter->in_stated_set ? 1 : 0;
        verdict.near += parameter->near ? 1 : 0;
      }
      if (parameter->stated ? parameter->in_stated_set : parameter->near) continue;
      verdict.parameter_line += fmt::format("  {} {} {}: {:.5g} ± {:.2g} → {} ± {}\n", verdict.name,
                                            word(hidden, "name"), name, value.at("value").get<double>(),
                                            value.at("sigma").is_null() ? 0.0 : value.at("sigma").get<double>(),
                                            candidate->at("parameters").at(name).dump(),
                                            candidate->value("sigma", Json::object()).value(name, Json()).dump());
    }
  }
}

std::string in_words(const Json& truth) {
  std::string text;
  for (const Json& hidden : truth.at("hidden")) {
    text += (text.empty() ? "" : " + ") + word(hidden, "name");
    text += fmt::format(" (SNR {:.1f}", hidden.at("snr").get<double>());
    if (word(hidden, "effect") == "cyclic")
      text += fmt::format(", period {:.4g}, {}", hidden["parameters"]["period_mm"]["value"].get<double>(),
                          word(hidden, "approach"));
    text += ")";
  }
  if (text.empty()) text = word(truth, "structure").empty() ? "nothing" : word(truth, "structure");
  for (const Json& rival : truth.at("required_rivals")) text += " = " + rival.get<std::string>();
  return text + fmt::format(" [{}, {} readings, {} runs]", word(truth.at("noise"), "law"),
                            truth.at("readings").get<int>(), truth.at("runs").get<int>());
}

std::string in_words(const Answer& answer) {
  std::string text = answer.verdict.empty() ? "no answer" : answer.verdict;
  for (const Json& candidate : answer.named) {
    text += " " + name_in(candidate);
    if (word(candidate, "effect") == "cyclic") text += " " + candidate.at("parameters").dump();
  }
  if (!answer.candidates.empty()) {
    if (answer.named.empty()) text += " (first " + name_in(answer.candidates.front()) + ")";
    for (const std::string& rival : names_in(answer.candidates.front().value("indistinguishable_from", Json::array())))
      text += " = " + rival;
  }
  for (const std::string& place : answer.where) text += " @" + place;
  return text;
}

// The free term of the base, the structure, the hidden effect or, of a blank, the law of the noise.
std::string kind_of(const Json& truth) {
  const std::string free_base = word(truth, "free_base");
  if (!free_base.empty()) return "base with " + free_base;
  if (!word(truth, "structure").empty()) return word(truth, "structure");
  const Json& hidden = truth.at("hidden");
  if (hidden.empty()) return word(truth.at("noise"), "law") + " noise";
  return hidden.size() == 1 ? word(hidden.front(), "effect") : "";
}

Verdict score_case(const std::filesystem::path& folder, const std::string& program) {
  Verdict verdict;
  verdict.name = folder.filename().string();
  const auto text = ecs::read_file(folder / "truth.json");
  const Json truth = Json::parse(text.value_or("{}"), nullptr, false);
  verdict.row = word(truth, "row");
  const double start = ecs::steady_s();
  const std::string output = output_of(fmt::format(
      "cd {} && timeout 300 {} model diagnose model.toml data.csv --machine machine.toml --json 2>/dev/null",
      quoted(folder.string()), quoted(program)));
  verdict.seconds = ecs::steady_s() - start;
  const Json json = Json::parse(output, nullptr, false);
  if (truth.is_discarded() || verdict.row.empty() || !json.is_object() || !json.contains("verdict")) {
    verdict.line = "no answer: " + output.substr(0, 200);
    return verdict;
  }
  const Answer answer = answer_in(json);
  verdict.kind = kind_of(truth);
  verdict.named = !answer.named.empty();
  Names required = names_in(truth.at("required_rivals"));
  const Names allowed = names_in(truth.at("allowed_rivals"));
  const bool structure = answer.verdict == "unexplained_structure";
  if (verdict.row == "blank")
    verdict.right = answer.verdict == "adequate" && answer.named.empty();
  else if (verdict.row == "outside")
    verdict.right = structure;
  else if (verdict.row == "bad_run")
    verdict.right = structure && answer.where.contains("run");
  else if (verdict.row == "confounded")
    verdict.right = right_group(truth, answer, required, allowed);
  else {
    required.insert(allowed.begin(), allowed.end());
    verdict.right = right_names(truth, answer, required);
  }
  if (verdict.right) score_parameters(truth, answer, verdict);
  const bool oracle = truth.at("oracle_right").get<bool>();
  verdict.line = fmt::format("{}{} → {}", in_words(truth), oracle ? "" : " (oracle wrong too)", in_words(answer));
  return verdict;
}

std::string kinds_line(const std::string& row, const std::vector<Verdict>& cases) {
  std::map<std::string, std::pair<int, int>> kinds;
  for (const Verdict& verdict : cases) {
    if (verdict.kind.empty()) continue;
    kinds[verdict.kind].first += verdict.right ? 1 : 0;
    ++kinds[verdict.kind].second;
  }
  std::string line;
  for (const auto& [kind, counts] : kinds)
    line += fmt::format("{}{} {}/{}", line.empty() ? "" : ", ", kind, counts.first, counts.second);
  return line.empty() ? "" : fmt::format("{}: {}\n", row, line);
}

std::string report(std::vector<Verdict> verdicts) {
  std::map<std::string, std::vector<Verdict>> by_row;
  for (Verdict& verdict : verdicts) by_row[verdict.row].push_back(std::move(verdict));
  std::string table = fmt::format("{:<18}{:>12}{:>8}{:>18}{:>8}{:>14}{:>8}{:>10}{:>10}{:>9}\n", "row", "right", "%",
                                  "95 % interval", "named", "in their set", "near", "unstated", "median s", "worst s");
  std::string wrong;
  std::string kinds;
  for (const auto& each : by_row) {
    const std::string& row = each.first;
    const std::vector<Verdict>& cases = each.second;
    const auto count = [&](auto&& f) {
      int sum = 0;
      for (const Verdict& verdict : cases) sum += f(verdict);
      return sum;
    };
    const int total = static_cast<int>(cases.size());
    const int right = count([](const Verdict& v) { return v.right ? 1 : 0; });
    const auto [low, high] = clopper_pearson(right, total);
    std::vector<double> seconds;
    for (const Verdict& verdict : cases) seconds.push_back(verdict.seconds);
    std::sort(seconds.begin(), seconds.end());
    table += fmt::format(
        "{:<18}{:>12}{:>8.1f}{:>18}{:>8}{:>14}{:>8}{:>10}{:>10.2f}{:>9.2f}\n", row, fmt::format("{}/{}", right, total),
        100.0 * right / total, fmt::format("{:.1f} to {:.1f}", 100.0 * low, 100.0 * high),
        count([](const Verdict& v) { return v.named ? 1 : 0; }),
        fmt::format("{}/{}", count([](const Verdict& v) { return v.in_stated_set; }),
                    count([](const Verdict& v) { return v.parameters; })),
        count([](const Verdict& v) { return v.near; }), count([](const Verdict& v) { return v.unstated; }),
        seconds[seconds.size() / 2], seconds.back());
    kinds += kinds_line(row, cases);
    for (const Verdict& verdict : cases)
      if (!verdict.right) wrong += fmt::format("{}: {}\n", verdict.name, verdict.line);
    for (const Verdict& verdict : cases) wrong += verdict.parameter_line;
  }
  return table + "\nBy kind:\n" + kinds + "\nWrong:\n" + wrong;
}

}  // namespace

ecs::Result<std::string> score_folder(const std::filesystem::path& folder, const std::string& ecs_program, int jobs) {
  std::error_code failed;
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed))
    if (std::filesystem::exists(entry.path() / "truth.json")) cases.push_back(entry.path());
  if (failed || cases.empty()) return ecs::problem(ecs::ProblemKind::bad_input, "No cases in " + folder.string() + ".");
  std::sort(cases.begin(), cases.end());
  const std::string program = std::filesystem::absolute(ecs_program).string();
  std::vector<Verdict> verdicts(cases.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (int k = 0; k < std::max(1, jobs); ++k)
    threads.emplace_back([&] {
      for (std::size_t at = next++; at < cases.size(); at = next++) verdicts[at] = score_case(cases[at], program);
    });
  for (std::thread& thread : threads) thread.join();
  return report(std::move(verdicts));
}

}  // namespace foreign
