// A diagnosis as the report shows it, from `ecs model diagnose --json` or from the diagnosis itself.
// Does not live here: the diagnosis (model/diagnosis/diagnose.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/models/view.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::app {

struct ReportedEffect {
  std::string place;                             ///< "cyclic:X:EX, reverse"
  std::string title;                             ///< "Periodic error"
  std::vector<commissioning::EffectFact> facts;  ///< cause, what to check, how it is compensated …
  bool named = false;                            ///< part of the answer: proved, or likely
  std::string but;                               ///< of what is likely: what is not excluded
  std::vector<std::string> parameters;           ///< "period 8.00 ± 0.02 mm"
  std::optional<double> rms_after_um;
  std::optional<double> explained;
  std::optional<double> held_out_before_um;
  std::optional<double> held_out_after_um;
  std::vector<std::string> rivals;
  std::string because;
  std::string next_measurement;
};

struct ReportedDependence {
  std::string variable;
  double strength = 0.0;
};

struct ReportedDiagnosis {
  std::string
      verdict;  ///< as in JSON: adequate, missing_effect, partly_explained, unexplained_structure, likely_effect …
  std::string headline;  ///< the answer in words; of an answer saved without one the verdict with the ids named
  std::size_t readings = 0;
  double rms_um = 0.0;
  std::optional<double> rms_after_um;
  double noise_um = 0.0;
  std::size_t noise_replicates = 0;
  std::vector<ReportedEffect> effects;  ///< named ones first
  std::vector<ReportedDependence> where;
  std::vector<std::string> left;  ///< "direction: odd. …", what is told of what is left beside the effects
  std::string formula;            ///< that takes most of it; empty: none
  std::vector<std::string> notes;
};

/// "period 8.003 ± 0.012 mm", digits as far as the sigma goes. @param name  as model files have it, "period_mm"
[[nodiscard]] std::string parameter_text(std::string_view name, std::string_view unit, double value,
                                         const std::optional<double>& sigma);

[[nodiscard]] ReportedDiagnosis reported(const model::Diagnosis& diagnosis);
/// Refuses what is no answer of `ecs model diagnose --json`.
[[nodiscard]] Result<ReportedDiagnosis> parse_diagnosis(std::string_view json, const std::string& name);
[[nodiscard]] Result<ReportedDiagnosis> read_diagnosis(const std::filesystem::path& path);

}  // namespace ecs::app
