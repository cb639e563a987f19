// The content of a report: which files, named on the command line or found by their usual names in folders; what they
// say, read and computed before any of it is laid out; what the unit would leave of the errors measured before, by the
// core that it runs; what follows: whether the limits hold, what is worst, what to do next. Does not live here: pages
// and pictures (page.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "app/names/commissioning.hpp"
#include "base/result.hpp"
#include "commissioning/measurements/table.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/what_if.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/volume/work.hpp"
#include "laser/map/error_map.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"
#include "modules/report/diagnosis.hpp"
#include "modules/standards/circle_work.hpp"
#include "params/check.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"
#include "params/position_unit.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::app {

/// As typed; empty: not given.
struct ReportArguments {
  std::vector<std::string> places, data, circle, header;
  std::string output, before, after, machine, map, params, model, diagnosis, status, date;
  int blanks = static_cast<int>(model::DiagnoseOptions{}.noise_replicates);
  static Fields<ReportArguments> fields() {
    using R = ReportArguments;
    return {{"PLACE", &R::places,
             "plan, or folders that contain plan.toml, before/, after/, machine.toml, map.csv, parameters.toml, "
             "model.toml, diagnosis.json, status.json, circles/"},
            {"-o,--output", &R::output, "HTML page to write", Is::output, Need::required},
            {"--before", &R::before, "folder with NAME.csv files measured without compensation"},
            {"--after", &R::after, "folder with NAME.csv files measured with compensation"},
            {"--machine", &R::machine, "machine file (.toml)"},
            {"--map", &R::map, "error map (.csv)"},
            {"--params", &R::params, "parameters of the unit (.toml)"},
            {"--model", &R::model, "error model (.toml): its fit, diagnosis and prediction are reported"},
            {"--data", &R::data, "readings for the model; default: files of --before with its components"},
            {"--diagnosis", &R::diagnosis, "answer of `ecs model diagnose --json`; default: diagnosed now"},
            {"--circle", &R::circle, "circular test (.csv), as for `ecs test circle`"},
            {"--status", &R::status, "state of the unit, saved by `ecs utility status --save`"},
            {"--header", &R::header, "key=value for the head of the page, such as customer=…; overrides files"},
            {"--date", &R::date, "date of the report; default: the last date in the files"},
            {"--blanks", &R::blanks, "number of simulated noise-only data sets for the diagnosis", Range{50, 20'000}}};
  }
};

/// Empty: there is none.
struct ReportFiles {
  std::filesystem::path plan;
  std::filesystem::path before;  ///< folder
  std::filesystem::path after;   ///< folder
  std::filesystem::path machine;
  std::filesystem::path map;
  std::filesystem::path params;
  std::filesystem::path model;
  std::filesystem::path diagnosis;
  std::filesystem::path status;
  std::vector<std::filesystem::path> circles;
};

/// In a folder: plan.toml, before/, after/, machine.toml, map.csv, parameters.toml, model.toml, diagnosis.json,
/// status.json, circles/ with *.csv; of several folders the last that has the file. An option wins over what is found.
/// A `bad_input` problem for a place that is neither a plan nor a folder, and if there is no folder of measurements at
/// all.
[[nodiscard]] Result<ReportFiles> report_files(const ReportArguments& arguments);

/// The measurement files of a folder, NAME of each NAME.csv that is a plain file, sorted.
[[nodiscard]] std::vector<std::string> measurement_names_in(const std::filesystem::path& folder);

/// One measurement. Bands and rms of all readings, slope removed as in the table; rms about their mean. um.
struct PredictedRow {
  std::optional<double> band;  ///< predicted; absent for rotations, squares and rows without readings before
  std::optional<double> rms;
  std::optional<double> rms_after;  ///< measured
};

struct Predicted {
  std::vector<PredictedRow> rows;      ///< as many as the table has
  std::optional<std::uint32_t> check;  ///< CRC-32 of the image as that unit holds it, which it reports as checksum;
                                       ///< absent where neither map nor `unit` says the unit's serial number
};

/// Every reading taken before plus the compensation at its place and approach; standing axes as if moved forward last.
/// Refused with the reasons of laser::image_of(), or where the map is not for the parameters.
/// @param unit  that holds the map; nullptr: not known
[[nodiscard]] Result<Predicted> predicted_rows(const std::vector<TableRow>& rows, const laser::ErrorMap& map,
                                               const UnitParameters& parameters, const protocol::Identity* unit);

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

/// In which positions of the machine are shown; mm where no parameters were given.
[[nodiscard]] const params::PositionUnit& position_unit_of(const ReportContent& content);

/// The value of a header entry; empty if there is none.
[[nodiscard]] std::string header_value(const ReportContent& content, std::string_view key);

/// Adds model and diagnosis to the content, where a model or a diagnosis was given. Without --data the readings are
/// those before compensation of the senses and axes on which the model's effects act; of all, if these are none.
[[nodiscard]] Result<void> add_model(VerbContext& context, const ReportArguments& arguments, const ReportFiles& files,
                                     ReportContent& content);

enum class RowVerdict {
  within,       ///< not above its limit
  above,        ///< above it
  no_limit,     ///< measured after compensation, nothing to compare with
  before_only,  ///< not measured after compensation, nor planned
  missing,      ///< planned, and a file is missing or unfit
};
[[nodiscard]] RowVerdict verdict_of(const TableRow& row);
/// Only of a positioning error ISO 230-2 states conditions.
[[nodiscard]] inline bool is_positioning(const TableRow& row) {
  return !is_rotation(row.planned.sense) && direction_of(row.planned.sense) == row.planned.axis;
}
/// "within", "above", "no limit", "before only", "missing"
[[nodiscard]] std::string_view word_for(RowVerdict verdict);

struct Judgement {
  std::size_t after = 0;            ///< rows measured after compensation
  std::size_t judged = 0;           ///< of them, with a limit
  std::size_t within = 0;           ///< of these, within it
  std::size_t missing = 0;          ///< rows with a missing or unfit file
  const TableRow* worst = nullptr;  ///< closest to its limit, or above it most; without limits the largest band left
  std::string sentence;             ///< the verdict, plain
  std::string worst_sentence;       ///< empty without `worst`
  std::vector<std::string> next;    ///< what is open, most urgent first; empty: nothing
};

/// @param content  must outlive the answer
[[nodiscard]] Judgement judgement_of(const ReportContent& content);

/// Decimals in which all bands of a row are shown.
[[nodiscard]] int decimals_of(const TableRow& row);

}  // namespace ecs::app
