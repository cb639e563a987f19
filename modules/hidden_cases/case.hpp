// One hidden case: a machine with background errors that its model declares, one, two or no effects that it does not,
// and readings; its folder: machine.toml, model.toml, data.csv, map.csv where a map was active, truth.sealed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/hidden_cases/measure.hpp"
#include "modules/hidden_cases/structure.hpp"

namespace ecs::emulator {

enum class CaseKind : std::uint8_t { blank, single, pair, out_of_library, confounded };
inline constexpr std::array<std::string_view, 5> kCaseKindNames{"blank", "single", "pair", "out_of_library",
                                                                "confounded"};
[[nodiscard]] constexpr std::string_view name_of(CaseKind kind) {
  return kCaseKindNames[static_cast<std::size_t>(kind)];
}
/// `out-of-library` is understood too.
[[nodiscard]] std::optional<CaseKind> case_kind_named(std::string_view name);

/// What is asked for; what is absent is drawn.
struct HiddenCaseRequest {
  std::uint64_t seed = 1;
  std::optional<CaseKind> kind;
  const EffectDefinition* effect = nullptr;  ///< the first of those that are hidden
  std::optional<double> snr;
  std::optional<std::size_t> readings;
  bool free_base = false;  ///< any effect may be in the base model, and no nonlinear parameter of it is given
  NoiseLaw noise = NoiseLaw::usual;
  bool xytz = false;  ///< the XYTZ machine under the thesis's printed equation (27)
};

struct HiddenEffect {
  PlacedEffect effect;
  double rms_um = 0.0;  ///< of its contribution, all readings
  double snr = 0.0;     ///< rms of what the base model cannot absorb of it / sigma of one reading
};

struct HiddenCase {
  std::uint64_t seed = 1;
  CaseKind kind = CaseKind::blank;
  Scene scene;                       ///< as it really was
  Scene recorded;                    ///< as the sensors show it
  std::vector<PlacedEffect> base;    ///< the base model, with its true sizes
  bool free_base = false;            ///< its nonlinear parameters are not given
  std::vector<HiddenEffect> hidden;  ///< by falling snr
  Structure structure;
  double structure_snr = 0.0;
  std::vector<std::string> group;  ///< names that do the same on this design
  Noise noise;
  std::vector<double> readings;  ///< as displayed
  double true_model_rms_um = 0.0;
  std::string text;
};

/// `usage` problem where what is asked for cannot be had: an effect that takes no part in such a kind, readings or snr
/// out of range, or a combination for which no design is found.
[[nodiscard]] Result<HiddenCase> draw_hidden_case(const HiddenCaseRequest& request);

/// File name → content.
[[nodiscard]] std::map<std::string, std::string> files_of(const HiddenCase& hidden);
/// The truth as JSON (docs/emulator.md).
[[nodiscard]] std::string truth_of(const HiddenCase& hidden);

/// Writes folders of cases, seeds counting up: one case into `folder` itself, several into folder/0001, 0002 …
/// Whole or not at all: everything is made beside the folder and renamed. Refuses a folder that exists and is not
/// empty.
/// @return one line per case that gives nothing of the truth away
[[nodiscard]] Result<std::vector<std::string>> write_hidden_cases(const HiddenCaseRequest& request, int count,
                                                                  const std::filesystem::path& folder);

}  // namespace ecs::emulator
