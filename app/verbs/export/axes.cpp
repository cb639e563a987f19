#include "app/verbs/export/axes.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {
namespace {

bool is_axis_name(std::string_view name) {
  const auto fits = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.size() <= 16 && std::all_of(name.begin(), name.end(), fits);
}

/// "X=AX1,Y=AX2", pair by pair; no axis where a pair is none. Empty: no pairs.
std::vector<std::pair<std::optional<Axis>, std::string_view>> pairs_in(std::string_view axes) {
  std::vector<std::pair<std::optional<Axis>, std::string_view>> pairs;
  if (axes.empty()) return pairs;
  for (const std::string_view word : split(axes, ',')) {
    const std::string_view pair = trimmed(word);
    if (pair.size() > 2 && pair[1] == '=')
      pairs.emplace_back(axis_of(static_cast<char>(pair[0] & ~0x20)), pair.substr(2));
    else
      pairs.emplace_back(std::nullopt, pair);
  }
  return pairs;
}

}  // namespace

void take_siemens_arguments(Verb& verb, SiemensArguments& arguments) {
  verb.text("--axes", arguments.axes, "axes of the control; default X=AX1,Y=AX2,Z=AX3")
      .integer("--encoder", arguments.encoder, "measuring system 0 or 1 of $AA_ENC_COMP; default 0", 0, 1)
      .choice("--cec-sign", arguments.cec_sign, {"subtracts", "adds"},
              "what the control does with a cross value; default subtracts, as it does with encoder values");
}

Result<controllers::SiemensOptions> siemens_options(const SiemensArguments& arguments) {
  controllers::SiemensOptions options;
  options.encoder = arguments.encoder;
  options.cec_adds = arguments.cec_sign == "adds";
  for (const auto& [axis, name] : pairs_in(arguments.axes)) {
    if (!axis || !is_axis_name(name))
      return problem(ProblemKind::usage,
                     fmt::format("--axes: expected X=NAME,Y=NAME,Z=NAME, as in X=AX1, found \"{}\"", arguments.axes));
    options.axis_name[index_of(*axis)] = std::string(name);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && lower(options.axis_name[index_of(a)]) == lower(options.axis_name[index_of(b)]))
        return problem(ProblemKind::usage, fmt::format("--axes: {} and {} have the same name {}", letter_of(a),
                                                       letter_of(b), options.axis_name[index_of(a)]));
  return options;
}

void take_twincat_arguments(Verb& verb, TwinCatArguments& arguments) {
  verb.choice("--ssfk-sign", arguments.sign, {"subtracts", "adds"},
              "what TwinCAT does with a value; default subtracts, as its manual computes; lists of ours say it");
}

Result<controllers::TwinCatOptions> twincat_options(const TwinCatArguments& arguments, const std::string& axes) {
  constexpr long long kMostAxes = 65'534;
  controllers::TwinCatOptions options;
  if (!arguments.sign.empty()) options.adds = arguments.sign == "adds";
  for (const auto& [axis, name] : pairs_in(axes)) {
    const auto number = integer_in(name);
    if (!axis || !number || *number < 1 || *number > kMostAxes)
      return problem(ProblemKind::usage,
                     fmt::format("--axes: expected X=NUMBER,Y=NUMBER,Z=NUMBER, as in X=1, found \"{}\"", axes));
    options.axis_number[index_of(*axis)] = static_cast<int>(*number);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && options.axis_number[index_of(a)] == options.axis_number[index_of(b)])
        return problem(ProblemKind::usage, fmt::format("--axes: {} and {} have the same number {}", letter_of(a),
                                                       letter_of(b), options.axis_number[index_of(a)]));
  return options;
}

}  // namespace ecs::app
