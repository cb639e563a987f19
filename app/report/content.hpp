// The content of a report, read and computed, before any of it is laid out.
// Does not live here: which files (files.hpp), what follows from it (judgement.hpp), pages
// (page.hpp). Only for .cpp files (heavy headers).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "app/report/diagnosis.hpp"
#include "app/report/files.hpp"
#include "app/report/prediction.hpp"
#include "commissioning/measurements/table.hpp"
#include "commissioning/models/what_if.hpp"
#include "commissioning/standards/circle.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/volume/work.hpp"
#include "laser/map/error_map.hpp"
#include "model/diagnosis/ladder.hpp"
#include "params/check.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {

/// A file that went into the report, as it was then.
struct ReportedFile {
  std::string role;  ///< "plan", "before", "map", …
  std::string name;
  std::string sha256;
};

struct ReportedMap {
  laser::ErrorMap map;
  std::string sha256;  ///< of the file
  std::optional<std::uint32_t>
      check;  ///< CRC-32 that the unit reports for it; needs parameters and the unit's serial number
  std::vector<std::string> objections;  ///< why it cannot be sent with these parameters
  std::vector<std::string> remarks;
};

struct ReportedParameters {
  params::ParametersFile file;
  std::vector<params::Finding> findings;
};

/// The error model beside the measurements.
struct ReportedModel {
  model::Model model;   ///< as its file has it
  model::Model fitted;  ///< the same with the values of the fit to these readings
  std::string data;     ///< which readings, in words
  std::size_t readings = 0;
  std::vector<model::EffectFit> effects;
  model::WhatIf what_if;
  std::vector<AfterDirection> directions;
};

/// The error vector over the travels, predicted before and after compensation. Nothing was measured across the volume.
struct ReportedVolume {
  PreparedVolume prepared;
  volume::VolumeAnswer answer;
  volume::VolumeUncertainty uncertainty;
  std::vector<Component> declared_zero;  ///< not measured: each as uncertain as UncertaintySettings says
  std::size_t components = 0;            ///< in the map, or declared zero
  [[nodiscard]] bool from_map() const { return prepared.errors_from == "the map"; }
};

struct ReportContent {
  std::vector<std::pair<std::string, std::string>> header;  ///< "customer", "Huddersfield …"; what is not empty
  std::string date;                                         ///< of the report; empty: not given
  std::vector<TableRow> rows;
  bool has_before = false;  ///< a folder was given
  bool has_after = false;
  bool planned = false;           ///< a plan was given
  std::vector<Problem> problems;  ///< files that fit no row; those of rows are in the rows
  std::optional<params::Machine> machine;
  std::optional<ReportedMap> map;
  std::optional<ReportedParameters> parameters;
  std::vector<PredictedRow> predicted;  ///< one for each row; empty without map and parameters
  std::string no_prediction;            ///< why not
  std::optional<ReportedVolume> volume;
  std::string no_volume;  ///< why not
  std::vector<CircleWork> circles;
  std::optional<ReportedModel> model;
  std::optional<ReportedDiagnosis> diagnosis;
  std::optional<StatusSnapshot> status;
  std::vector<ReportedFile> files;
};

/// Reads everything. Files that are missing or unfit among the measurements leave their rows; any other unreadable file
/// is a problem, and files of different machines are refused, with every one that differs.
[[nodiscard]] Result<ReportContent> report_content(VerbContext& context, const ReportArguments& arguments);

/// The value of a header entry; empty if there is none.
[[nodiscard]] std::string header_value(const ReportContent& content, std::string_view key);

}  // namespace ecs::app
