// What work on a model begins with: a model, measured files (of lines, circles, diagonals), a machine, read and brought
// together; places to be measured or predicted. Does not live here: the files of circles and diagonals themselves
// (laser/standards), their readings as a measurement set (model/data/path.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/session/message.hpp"
#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// Adds the readings of path files to those of lines: rows and runs are numbered on, notes and what the files say of
/// the machine are kept. `refused` if the files name different machines.
[[nodiscard]] Result<laser::MeasurementSet> joined_with_paths(laser::MeasurementSet lines,
                                                              std::vector<laser::MeasurementSet> paths);

/// The rows of a file; a CSV with the columns of a measurement set but without `reading` is taken with readings 0.
struct Plan {
  laser::MeasurementSet set;
  bool has_readings = true;
};
[[nodiscard]] Result<Plan> plan_in(const std::string& file, const ImportArguments& import);

/// As typed; empty: not given.
struct ModelArguments {
  std::string model;
  std::vector<std::string> data;
  std::string machine;
  ImportArguments import;
  static cli::Fields<ModelArguments> fields(cli::Need data_need = cli::Need::required);
};
inline constexpr const char* kMachineHelp = "machine file (.toml): datum, travels, lever arms, pitches";

struct ModelWork {
  model::Model model;
  std::optional<params::Machine> machine;
  laser::MeasurementSet set;  ///< several files joined
  model::Observations data;
  std::string data_name;      ///< the files, separated by blanks
  std::string data_sha256{};  ///< of their content, one after the other
};

/// Warnings of the file go to `messages`. Empty name: nothing.
[[nodiscard]] Result<std::optional<params::Machine>> machine_in(MessageSink& messages, const std::string& file);

/// The readings of all files, rows numbered on from file to file. Refuses files without readings.
/// @param sha256  if given: of the content of the files, one after the other
[[nodiscard]] Result<laser::MeasurementSet> measured_in(MessageSink& messages, const std::vector<std::string>& files,
                                                        const ImportArguments& import, std::string* sha256 = nullptr);

[[nodiscard]] Result<ModelWork> model_work(MessageSink& messages, const ModelArguments& arguments);

/// Writes a new model of what every measured curve has (model::usual_effects), its sizes to be fitted. A `usage`
/// problem if there is such a file; nothing is left behind where the data cannot be read.
[[nodiscard]] Result<ModelWork> begun_model(MessageSink& messages, const ModelArguments& arguments);

/// What a new model begins with, in words: "offset and slope of what was measured, ...".
[[nodiscard]] std::string usual_in_words(const ModelWork& work);

/// A problem that names no file is one of `file`.
[[nodiscard]] Problem in_file(Problem why, const std::string& file);
template <class Value>
[[nodiscard]] Result<Value> in_file(Result<Value> result, const std::string& file) {
  return std::move(result).map_error([&](Problem why) { return in_file(std::move(why), file); });
}

/// The model with the values of its fit, as a file keeps it; its ladder begins here, if it has none.
[[nodiscard]] model::Model model_to_keep(const model::Model& model, const model::Fit& fit,
                                         const model::Observations& data, const std::string& data_name);

/// Writes a model. A `usage` problem if that would destroy something else: an existing file that is neither the model
/// that was read, nor empty, nor equal to what would be written.
[[nodiscard]] Result<void> keep_model(const std::string& output, const model::Model& model,
                                      const std::string& read_from);

}  // namespace ecs::commissioning
