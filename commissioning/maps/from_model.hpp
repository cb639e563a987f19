// `ecs map build --from-model`: the error map that a fitted model compiles to.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/session/message.hpp"
#include "laser/map/error_map.hpp"
#include "model/fit/compiled_model.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct FromModelArguments {
  std::string model;
  std::string machine;
  std::optional<double> increment_mm;  ///< absent: fine enough for the model
  std::string rotary;                  ///< errors of the rotary axes; empty: none
  std::string params;                  ///< empty: `received`, else those that fit the machine
  std::string output;
  std::string params_out;
  std::string image;  ///< memory image
  std::vector<std::string> zero;
  std::string zero_missing;  ///< why every component that the model lacks is declared zero; empty: it is not
  std::string customer;
  std::string engineer;
  std::string date;
  std::optional<params::ParametersFile> received;  ///< of the unit
};

/// The map with what it was made of.
struct MapFromModel {
  model::CompiledModel compiled;
  std::map<Component, std::vector<std::string>> effects;  ///< of each table and squareness
  params::ParametersFile parameters;                      ///< with the model's squareness
  std::vector<std::uint8_t> image;                        ///< where it was asked for
  double increment_mm = 0.0;
  std::vector<std::string> holds_at;  ///< temperatures at which the effects that it leaves out are zero
  std::vector<std::string> notes;
  std::vector<laser::MapFinding> findings;
  bool enter_squareness = false;   ///< it is in no parameter file yet
  std::vector<Component> missing;  ///< needed by the parameters, without an effect, not declared zero
  [[nodiscard]] bool complete() const { return !has_objections(findings); }
};

/// Given or fitted; nothing for an effect of a linear axis that does not come back, or one of a rotary axis.
[[nodiscard]] std::optional<double> period_mm_of(const model::EffectInstance& effect);

/// Of the tables that nobody asked to be finer: a hundredth of the shortest travel, and an eighth of the shortest
/// period, as far as tables stay of sensible length.
[[nodiscard]] double table_increment_mm(const model::Model& model, const params::Machine& machine);

/// The map and what is missing in it; writes nothing.
[[nodiscard]] Result<MapFromModel> planned_map_from_model(MessageSink& messages, const FromModelArguments& arguments);

/// Writes the files that `arguments` names. Refused where no effect of the model can be carried by a map.
[[nodiscard]] Result<MapFromModel> map_from_model(MessageSink& messages, const FromModelArguments& arguments);

[[nodiscard]] Cell from_model_cell(const MapFromModel& built, const FromModelArguments& arguments);

}  // namespace ecs::commissioning
