// Which files a report is made of: named on the command line, or found by their usual names in folders.
// Does not live here: reading them (content.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::app {

/// As typed; empty: not given.
struct ReportArguments {
  std::vector<std::string> places;  ///< plan files and folders
  std::string output;
  std::string before;
  std::string after;
  std::string machine;
  std::string map;
  std::string params;
  std::string model;
  std::vector<std::string> data;
  std::string diagnosis;
  std::string status;
  std::vector<std::string> header;  ///< "key=value"
  std::string date;
  int blanks = 400;
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
};

/// In a folder: plan.toml, before/, after/, machine.toml, map.csv, parameters.toml, model.toml, diagnosis.json,
/// status.json; of several folders the last that has the file. An option wins over what is found. A `bad_input` problem
/// for a place that is neither a plan nor a folder, and if there is no folder of measurements at all.
[[nodiscard]] Result<ReportFiles> report_files(const ReportArguments& arguments);

/// The measurement files of a folder, NAME of each NAME.csv that is a plain file, sorted.
[[nodiscard]] std::vector<std::string> measurement_names_in(const std::filesystem::path& folder);

}  // namespace ecs::app
