// Model files: the effects that a machine is believed to have, as TOML; the map that was active; components known from
// elsewhere; the ladder of effects added so far. Does not live here: fitting (fit.hpp), the effects
// (model/effects/definition.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "model/data/observations.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {

/// One rung of the ladder: what was added, and how far the error fell.
struct LadderStep {
  std::string effect;          ///< to_text() of the effect; "" for the start
  std::string data;            ///< the file it was fitted to
  double rms_before_um = 0.0;  ///< this, rms and peak without the outliers of the fit
  double rms_um = 0.0;
  double peak_um = 0.0;
  double noise_um = 0.0;
  std::optional<double> held_out_rms_um;  ///< fitted on one part, tested on the other
  int outliers = 0;                       ///< readings left out
  friend bool operator==(const LadderStep&, const LadderStep&) = default;
};

struct Model {
  std::vector<EffectInstance> effects;
  std::vector<EffectInstance>
      candidates;                      ///< `[[candidate]]`: user effects that a diagnosis is to try, not yet believed
  std::string map_file;                ///< as written in the file; empty: no map was active
  std::optional<laser::ErrorMap> map;  ///< read from it
  bool map_taken_out = false;          ///< of the last fit: it is of the machine without the map (observations_of)
  std::vector<KnownComponent> known;
  std::vector<LadderStep> history;
  std::optional<Origin> origin;        ///< `[origin]`: of the last fit; kept while an effect counts from it
  int compensated_readings = 0;        ///< of the last fit: taken with an error map active; what it left, no map's
  std::string name;                    ///< the user's, for people
  std::vector<EffectInstance> undone;  ///< not in the file: effects taken back in this run
};

/// Whether an effect of the model counts time or a temperature from its origin.
[[nodiscard]] bool counts_from_origin(const Model& model);

/// The readings with the map, the known components and the origin of a model; rows given twice count once. Where some
/// were taken with the map and others without, or a fit has seen both, the map is taken out of those with it: all are
/// then the error of the machine without compensation, beside which faults of the map act. Else they are as measured.
[[nodiscard]] Observations observations_of(const laser::MeasurementSet& set, const Model& model,
                                           const std::optional<params::Machine>& machine);
/// The same with every row.
[[nodiscard]] Observations all_observations_of(const laser::MeasurementSet& set, const Model& model,
                                               const std::optional<params::Machine>& machine);
/// The readings as they were measured, nothing taken out of them.
[[nodiscard]] Observations as_measured(Observations data);
/// Keeps with a fitted model how its readings were compensated.
void take_compensation(Model& model, const Observations& data);

/// Reads a model; every wrong key, value and place in one pass. The map file is sought beside the model.
/// @param name  the file as problems name it
[[nodiscard]] Result<Model> parse_model(std::string_view text, const std::string& name,
                                        const std::filesystem::path& folder);
[[nodiscard]] Result<Model> read_model(const std::filesystem::path& path);

/// The file again: `parameters` as they were given, `fitted` and curves of the last fit, the ladder.
[[nodiscard]] std::string to_toml(const Model& model);
/// They write the same file.
[[nodiscard]] inline bool operator==(const Model& a, const Model& b) { return to_toml(a) == to_toml(b); }
/// Writes it; the map file's name is made relative to the new place where the folder differs.
[[nodiscard]] Result<void> write_model(const std::filesystem::path& path, const Model& model,
                                       const std::filesystem::path& read_from = {});

}  // namespace ecs::model
