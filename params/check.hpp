// Cross-checks of a parameter set before it meets a machine: every finding at once, each with what to do.
// The range of a single field lives in fields.hpp; whether a map fits the parameters is not judged here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/parameters.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::params {

enum class Severity {
  warning,  ///< may be meant; look at it
  error,    ///< the unit would refuse it, compensate wrongly or move the machine dangerously
};
[[nodiscard]] std::string_view name_of(Severity severity);

struct Finding {
  std::vector<std::string> keys;  ///< the fields at fault, first the one to change
  Severity severity = Severity::error;
  std::string message;  ///< what is wrong and what to do
  friend bool operator==(const Finding&, const Finding&) = default;
};

/// Every finding, errors first. Fields of absent axes are not judged.
/// @param machine  the machine the unit stands on, if known: travel, resolution and axes are compared with it
[[nodiscard]] std::vector<Finding> check(const UnitParameters& parameters, const Machine* machine = nullptr);

/// What the file itself leaves open: no closing line, or an axis of which it gives nothing (an error: it may have lost
/// its end).
[[nodiscard]] std::vector<Finding> check_file(const ParametersFile& file);
/// "axis.X.deadband_um is not given: the default 5 um is used", one line a key that the file leaves out.
[[nodiscard]] std::vector<std::string> defaults_taken(const ParametersFile& file);
/// The same, but one line that counts them if there are more than a few.
[[nodiscard]] std::vector<std::string> defaults_in_short(const ParametersFile& file);

[[nodiscard]] bool has_errors(const std::vector<Finding>& findings);
/// `error: axis.X.deadband_um: …`, one line each; empty without findings.
[[nodiscard]] std::string to_text(const std::vector<Finding>& findings);

/// Modules that one rack takes (thesis 5.2): at most 5 memory, 8 encoder or 5 resolver modules; a resolver module takes
/// two slots, and five of them with one memory module fill the eleven that the basic system leaves free.
[[nodiscard]] bool rack_holds(int memory_modules, int encoder_modules, int resolver_modules);

}  // namespace ecs::params
