// A data set with a known hidden cause: folder of machine, model, data and the truth, sealed or plain.
// Does not live here: who makes such folders (ecs-emulator hide), how an answer is scored (diagnose_score.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::bench {

enum class CaseKind : std::uint8_t { single, pair, blank, out_of_library, confounded };
[[nodiscard]] std::string_view name_of(CaseKind kind);

/// A hidden cause.
struct HiddenEffect {
  std::string name;      ///< "effect:axis:sense-or-code"
  std::string approach;  ///< "both", "forward", "reverse"; "" where it does not matter
  std::string sensor;    ///< "" where there is none
  std::map<std::string, double> parameters;
  double snr = 0.0;  ///< rms beyond what the model absorbs over the noise; 0: unknown
};

struct Truth {
  std::vector<HiddenEffect> effects;        ///< one, two or none
  std::vector<std::string> group;           ///< of a confounded case: all that cannot be distinguished
  std::vector<std::string> group_optional;  ///< may stand in it as well
  std::vector<std::string> variables;       ///< of structure outside the library: what it depends on
  std::string text;                         ///< what was hidden, in words
  std::string noise_law;                    ///< of a blank made for it; "": the usual one
  double snr = 0.0;                         ///< of the weakest hidden effect
  double noise_um = 0.0;                    ///< of one reading
  double true_model_rms_um = 0.0;           ///< of all readings with the true effects added; 0: unknown
};

struct Case {
  CaseKind kind = CaseKind::blank;
  std::string name;
  model::Model model;
  params::Machine machine;
  laser::MeasurementSet data;
  Truth truth;
};

/// The effects of its model among `cyclic`, `progressive`, `warm_up` and `reversal_spike` that are left free: their
/// curve, or their period, time constant or length.
[[nodiscard]] std::vector<std::string> free_in_base(const Case& one);

/// Folders below `root` that hold a case, in the order of their names.
[[nodiscard]] std::vector<std::filesystem::path> case_folders(const std::filesystem::path& root);

/// machine.toml, model.toml, data.csv and truth.sealed or truth.json.
[[nodiscard]] Result<Case> read_case(const std::filesystem::path& folder);

}  // namespace ecs::bench
