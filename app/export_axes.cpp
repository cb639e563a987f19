#include "app/export_axes.hpp"

#include <algorithm>

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

}  // namespace

void take_siemens_arguments(Verb& verb, SiemensArguments& arguments) {
  verb.text("--axes", arguments.axes, "machine axes of the control; default X=AX1,Y=AX2,Z=AX3")
      .integer("--encoder", arguments.encoder, "measuring system 0 or 1 of $AA_ENC_COMP; default 0", 0, 1)
      .choice("--cec-sign", arguments.cec_sign, {"subtracts", "adds"},
              "what the control does with a cross value; default subtracts, as it does with encoder values");
}

Result<laser::SiemensOptions> siemens_options(const SiemensArguments& arguments) {
  laser::SiemensOptions options;
  options.encoder = arguments.encoder;
  options.cec_adds = arguments.cec_sign == "adds";
  if (arguments.axes.empty()) return options;
  for (const std::string_view word : split(arguments.axes, ',')) {
    const std::string_view pair = trimmed(word);
    const auto axis = pair.size() > 2 && pair[1] == '=' ? axis_of(static_cast<char>(pair[0] & ~0x20)) : std::nullopt;
    if (!axis || !is_axis_name(pair.substr(2)))
      return problem(ProblemKind::usage,
                     fmt::format("--axes: expected X=NAME,Y=NAME,Z=NAME, as in X=AX1, found \"{}\"", pair));
    options.axis_name[index_of(*axis)] = std::string(pair.substr(2));
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && lower(options.axis_name[index_of(a)]) == lower(options.axis_name[index_of(b)]))
        return problem(ProblemKind::usage, fmt::format("--axes: {} and {} have the same name {}", letter_of(a),
                                                       letter_of(b), options.axis_name[index_of(a)]));
  return options;
}

}  // namespace ecs::app
