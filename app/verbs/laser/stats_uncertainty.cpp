#include "app/verbs/laser/stats_uncertainty.hpp"

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr double kMostUncertain = 1e6;

struct UncertainQuantity {
  const char* symbol;
  std::optional<double> laser::Iso230Uncertainty::*U;
};
constexpr UncertainQuantity kUncertainQuantities[] = {{"A", &laser::Iso230Uncertainty::A},
                                                      {"A_forward", &laser::Iso230Uncertainty::A_forward},
                                                      {"A_reverse", &laser::Iso230Uncertainty::A_reverse},
                                                      {"E", &laser::Iso230Uncertainty::E},
                                                      {"E_forward", &laser::Iso230Uncertainty::E_forward},
                                                      {"E_reverse", &laser::Iso230Uncertainty::E_reverse},
                                                      {"M", &laser::Iso230Uncertainty::M},
                                                      {"R", &laser::Iso230Uncertainty::R},
                                                      {"R_forward", &laser::Iso230Uncertainty::R_forward},
                                                      {"R_reverse", &laser::Iso230Uncertainty::R_reverse},
                                                      {"B", &laser::Iso230Uncertainty::B},
                                                      {"B_mean", &laser::Iso230Uncertainty::B_mean}};

}  // namespace

UncertaintyOptions::UncertaintyOptions(Verb& verb) {
  const auto option = [&](const char* name, double& into, const char* help, double least = 0.0) {
    verb.number(name, into, help, Need::optional, least, kMostUncertain);
  };
  verb.group("Uncertainty (ISO 230-2 annex A, k = 2)");
  option("--instrument-um-per-m", instrument_um_per_m, "of the instrument, expanded, in proportion to the length");
  option("--instrument-um", instrument_um, "of the instrument, expanded, the constant part");
  option("--misalignment-mm", misalignment_mm, "lateral offset of beam and axis over the measured length");
  option("--environment-um", environment_um, "environmental variation error EVE: range of a drift test");
  option("--temperature-range", temperature_range_degC, "range of the error of the machine's temperature [degC]");
  option("--off-20", off_20_degC, "the machine's temperature less 20 degC", -kMostUncertain);
  option("--expansion", expansion_um_per_m_degC, "expansion coefficient of the correction [um/m/degC]");
  option("--expansion-range", expansion_range_um_per_m_degC, "range of the expansion coefficient [um/m/degC]");
  verb.group("");
}

bool UncertaintyOptions::given() const {
  return instrument_um_per_m > 0.0 || instrument_um > 0.0 || misalignment_mm > 0.0 || environment_um > 0.0 ||
         temperature_range_degC > 0.0 || (expansion_range_um_per_m_degC > 0.0 && off_20_degC != 0.0);
}

Cell uncertainty_cell(const laser::Iso230& iso, const UncertaintyOptions& options) {
  if (!options.given()) return null_cell("");
  const auto uncertainty = laser::iso230_uncertainty_of(iso, options);
  if (!uncertainty) return null_cell("  no uncertainty: the options are for lengths at two targets or more\n");
  Json parts = Json::array();
  std::string text = "  uncertainty (k = 2)";
  AnswerFields fields{{"coverage_factor", {laser::kCoverage, {}}},
                      {"length_mm", {number_or_null(uncertainty->length_mm), {}}}};
  const char* separator = ": ";
  for (const UncertainQuantity& quantity : kUncertainQuantities) {
    const auto& U = *uncertainty.*quantity.U;
    fields.push_back({quantity.symbol, {number_or_null(U), {}}});
    if (U && std::string_view(quantity.symbol).size() == 1) {
      text += fmt::format("{}U({}) {:.2f}", separator, quantity.symbol, *U);
      separator = ", ";
    }
  }
  text += " um\n";
  for (const laser::UncertaintyPart& part : uncertainty->parts) {
    parts.push_back({{"name", part.name}, {"U_um", number_or_null(part.U_um)}});
    text += fmt::format("    {:<28} {:>8.2f} um\n", part.name, part.U_um);
  }
  fields.push_back({"parts", {std::move(parts), {}}});
  return {object_of(fields), std::move(text)};
}

}  // namespace ecs::app
