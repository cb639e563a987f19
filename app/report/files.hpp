// Which files a report is made of: named on the command line, or found by their usual names in folders.
// Does not live here: reading them (content.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "base/result.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::app {

/// As typed; empty: not given.
struct ReportArguments {
  std::vector<std::string> places, data, circle, header;
  std::string output, before, after, machine, map, params, model, diagnosis, status, date;
  int blanks = static_cast<int>(model::DiagnoseOptions{}.noise_replicates);
  static Fields<ReportArguments> fields() {
    using R = ReportArguments;
    return {{"PLACE", &R::places,
             "a plan, or folders that hold plan.toml, before/, after/, machine.toml, map.csv, parameters.toml, "
             "model.toml, diagnosis.json, status.json, circles/"},
            {"-o,--output", &R::output, "the page", Is::output, Need::required},
            {"--before", &R::before, "folder of NAME.csv, measured without compensation"},
            {"--after", &R::after, "folder of NAME.csv, measured with compensation"},
            {"--machine", &R::machine, "the machine (.toml)"},
            {"--map", &R::map, "the error map (.csv)"},
            {"--params", &R::params, "the unit's parameters (.toml)"},
            {"--model", &R::model, "error model (.toml): fitted, diagnosed, predicted against achieved"},
            {"--data", &R::data, "readings for the model; without: those of its senses in --before"},
            {"--diagnosis", &R::diagnosis, "answer of `ecs model diagnose --json`; without: diagnosed here"},
            {"--circle", &R::circle, "circular test (.csv), as `ecs test circle` takes it"},
            {"--status", &R::status, "state of the unit, as `ecs utility status --save` keeps it"},
            {"--header", &R::header, "key=value of the head of the page, such as customer=…; wins over files"},
            {"--date", &R::date, "of the report; without: the last date in the files"},
            {"--blanks", &R::blanks, "simulated data sets of noise alone for the diagnosis", Range{50, 20'000}}};
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

}  // namespace ecs::app
