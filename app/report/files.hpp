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
struct ReportArguments : VerbArguments {
  const std::vector<std::string>& places =
      texts("PLACE",
            "a plan, or folders that hold plan.toml, before/, after/, machine.toml, map.csv, parameters.toml, "
            "model.toml, diagnosis.json, status.json, circles/");
  const std::string& output = output_file("-o,--output", "the page", Need::required);
  const std::string& before = text("--before", "folder of NAME.csv, measured without compensation");
  const std::string& after = text("--after", "folder of NAME.csv, measured with compensation");
  const std::string& machine = text("--machine", "the machine (.toml)");
  const std::string& map = text("--map", "the error map (.csv)");
  const std::string& params = text("--params", "the unit's parameters (.toml)");
  const std::string& model = text("--model", "error model (.toml): fitted, diagnosed, predicted against achieved");
  const std::vector<std::string>& data =
      texts("--data", "readings for the model; without: those of its senses in --before");
  const std::string& diagnosis = text("--diagnosis", "answer of `ecs model diagnose --json`; without: diagnosed here");
  const std::vector<std::string>& circle = texts("--circle", "circular test (.csv), as `ecs test circle` takes it");
  const std::string& status = text("--status", "state of the unit, as `ecs utility status --save` keeps it");
  const std::vector<std::string>& header =
      texts("--header", "key=value of the head of the page, such as customer=…; wins over files");
  const std::string& date = text("--date", "of the report; without: the last date in the files");
  const int& blanks = integer("--blanks", "simulated data sets of noise alone for the diagnosis",
                              static_cast<int>(model::DiagnoseOptions{}.noise_replicates), 50, 20'000);
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
