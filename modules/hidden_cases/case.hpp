// One hidden case: a machine with background errors that its model declares, one, two or no effects that it does not,
// and readings; its folder: machine.toml, model.toml, data.csv, map.csv where a map was active, truth.sealed.
// Measuring its scene: what an effect adds to a reading by the place where it acts, the exact machine at every stop,
// the unit that compensates, noise on top. Errors that no library holds: what a diagnosis should call structure, and
// not by the name of an effect. Does not live here: errors that have a name, and their formulas (ecs_emulator/effects),
// the machine itself (ecs_emulator/errors/kinematics.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/words.hpp"
#include "ecs_emulator/random/random.hpp"
#include "modules/hidden_cases/hiding.hpp"
#include "modules/hidden_cases/scene.hpp"

namespace ecs::emulator {

/// What the effect adds to each reading, to first order [um, um/m] (readings).
[[nodiscard]] std::vector<double> contribution(const Scene& scene, const DrawnEffect& effect);

/// How what does not repeat is distributed.
enum class NoiseLaw : std::uint8_t {
  usual,        ///< white, now and then with turbulence over seconds and isolated outliers
  white,        ///< Gaussian, independent
  rounded,      ///< white, and a display whose step is larger than it
  doubled,      ///< white, and every row is in the file twice
  heavy_tails,  ///< Student's t of three degrees of freedom
  slow,         ///< turbulence over minutes, no target measured again
  by_run,       ///< white, and a zero of each run that depends on the one before (first-order autoregression)
  random_walk,  ///< white, and a zero that walks from row to row
};
inline constexpr WordTable<NoiseLaw, 8> kNoiseLaws{
    {"usual", "white", "rounded", "doubled", "heavy-tails", "slow", "by-run", "random-walk"}};

/// What does not repeat.
struct Noise {
  NoiseLaw law = NoiseLaw::usual;
  double sigma_um = 0.5;          ///< of one reading, all of it but the outliers [um, um/m]
  double correlated_share = 0.0;  ///< of the variance: turbulence, or the zero that moves from run to run, row to row
  double correlation_s = 10.0;    ///< of the turbulence
  double outlier_probability = 0.0;
  double per_unit = 1000.0;  ///< the display shows multiples of 1/per_unit
};

/// Without noise: what the exact matrices of the chain, the unit's map and the instrument's own errors make of each
/// stop [um, um/m]. @param extra  added to the component that is measured, one per stop; empty: nothing
[[nodiscard]] std::vector<double> exact_errors(const Scene& scene, const std::vector<DrawnEffect>& effects,
                                               const std::vector<double>& extra);

/// Noise of each reading, in the order of time, by its law; turbulence is a first-order Gauss-Markov process.
[[nodiscard]] std::vector<double> draw_noise(Random& random, const Scene& scene, const Noise& noise);

/// What the sensors show of the weather: noise and resolution of a good thermometer, barometer and hygrometer.
[[nodiscard]] Scene as_recorded(Random& random, Scene scene);

struct Structure {
  std::vector<double> value;           ///< one per stop, size about 1 um; empty: none
  std::vector<std::string> variables;  ///< columns of the data that it depends on: each is a right answer
  std::string text;                    ///< what it is, in words
};

class StructureDrawing;
struct StructureDefinition {
  std::string_view id;
  Needs needs;  ///< of the measurement that can show it
  Structure (*draw)(StructureDrawing& drawing) = nullptr;
  std::size_t least_targets = 0;  ///< of its line
};

/// The emulator's list of them. Hidden cases draw by its order.
[[nodiscard]] const std::vector<StructureDefinition>& structures();
/// Draws one on this scene; without values where the scene has no room for it.
[[nodiscard]] Structure draw_structure(Random& random, const Scene& scene, const Ground& ground,
                                       const StructureDefinition& definition);

enum class CaseKind : std::uint8_t { blank, single, pair, out_of_library, confounded };
inline constexpr WordTable<CaseKind, 5> kCaseKinds{{"blank", "single", "pair", "out_of_library", "confounded"}};

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
  DrawnEffect effect;
  double rms_um = 0.0;  ///< of its contribution, all readings
  double snr = 0.0;     ///< rms of what the base model cannot absorb of it / sigma of one reading
};

struct HiddenCase {
  std::uint64_t seed = 1;
  CaseKind kind = CaseKind::blank;
  Scene scene;                       ///< as it really was
  Scene recorded;                    ///< as the sensors show it
  std::vector<DrawnEffect> base;     ///< the base model, with its true sizes
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
