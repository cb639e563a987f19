// A model frozen with the limits by which it will be accepted, and judged by readings that it has not seen. Does not
// live here: fitting (model/fit), the logbook, which may not be there (commissioning/session/records.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/records.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {

// --- limits, as a person writes them

struct AcceptanceLimit {
  double rms_um = 0.0;             ///< √(mean r²) over all readings of the group; um/m of rotations
  std::optional<double> max_um{};  ///< largest |r|
};

/// How a hold-out is divided, `[[group]]`: readings with one value of `by` are a group.
struct HeldOutGroups {
  std::string by;                   ///< a column; or all, day, half, magnitude, sector, sense, sign
  std::vector<std::string> values;  ///< that are held out; empty: whatever the files hold
  std::optional<Axis> axis{};       ///< rotary, of magnitude, sector and sign; absent: the one that moves
  double sector_deg = 90.0;         ///< divides 360
  double share = 0.0;               ///< at least, of the fitted and the held-out readings together
  std::size_t readings = 10;        ///< in a group, at least
  std::optional<AcceptanceLimit> inside, beyond;
  int line = 0;  ///< of the table
};

struct JudgingLimits {
  bool zero_of_each_run = false;  ///< residuals count from their mean in each run of a line; else they stay as they are
  struct Known {
    std::string effect;
    int line = 0;
  };
  std::vector<Known> known;                                      ///< effects that need not prove themselves
  std::map<std::string, model::ValueRange, std::less<>> inside;  ///< by column, in place of the fitted range
  std::vector<HeldOutGroups> groups;
};

/// Refuses, all at once with line and column: unknown keys, values of another type, limits that are not above 0, shares
/// and counts out of range, values given twice, no group.
[[nodiscard]] Result<JudgingLimits> parse_judging_limits(std::string_view text, const std::string& file);

// --- what is frozen

struct FrozenFile {
  std::string file;  ///< from the folder of the freeze
  std::string sha256;
  friend bool operator==(const FrozenFile&, const FrozenFile&) = default;
};
/// To which the readings of a curve reached when the model was fitted.
struct FittedRange {
  std::string curve;   ///< "EX X", "circle XY"
  std::string column;  ///< "x_mm", "approach", "t_air_degC"; "time_s" counts from the model's origin
  double least = 0.0;
  double greatest = 0.0;
  friend bool operator==(const FittedRange&, const FittedRange&) = default;
};
/// The model without one of the effects that were added to it, the others fitted to the same readings.
struct ModelWithout {
  std::string effect;
  std::string model;  ///< as a file
  friend bool operator==(const ModelWithout&, const ModelWithout&) = default;
};
struct FrozenModel {
  int freeze = 1;    ///< format of the file
  std::string time;  ///< "2026-05-04T09:30:00Z"
  std::string program;
  std::string program_sha256;
  FrozenFile model, machine, map;  ///< without a name: none
  std::vector<FrozenFile> data;
  FrozenFile limits;
  std::string limits_text;
  std::string machine_name, serial_number;  ///< as the data say
  std::size_t readings = 0;
  double rms_um = 0.0;            ///< of the model as it stands, over them
  std::string axes;               ///< that were moved: "XY", "C"
  std::vector<std::string> runs;  ///< SHA-256 of the rows of each run of a line
  std::vector<FittedRange> ranges;
  std::vector<ModelWithout> without;
  friend bool operator==(const FrozenModel&, const FrozenModel&) = default;
};

/// JSON with a hash of its own over all the rest.
[[nodiscard]] std::string to_json(const FrozenModel& frozen);
/// Refuses what is no such file, or was changed since it was written.
[[nodiscard]] Result<FrozenModel> parse_frozen_model(std::string_view text, const std::string& file);

struct FreezeArguments {
  ModelArguments of;
  std::string limits, output;
  static cli::Fields<FreezeArguments> fields();
};
/// Writes the output. Refuses a model with values still to be fitted, and limits that name an effect it does not have.
[[nodiscard]] Result<FrozenModel> freeze(MessageSink& messages, const FreezeArguments& arguments);

/// SHA-256 of the program that runs.
[[nodiscard]] Result<std::string> running_program_sha256();

// --- judging

/// By which the logbook knows an opening.
inline constexpr const char* kJudgeVerb = "model judge";

struct JudgedGroup {
  std::string by, value;
  bool beyond = false;  ///< of the conditions to which the model was fitted; else inside
  double rms_um = 0.0, max_um = 0.0;
  AcceptanceLimit limit;
  std::size_t readings = 0;
  std::vector<std::string> conditions;  ///< that lie beyond, in words
  [[nodiscard]] bool holds() const { return rms_um <= limit.rms_um && (!limit.max_um || max_um <= *limit.max_um); }
};

/// Whether an effect predicts the hold-out better than the model without it: one-sided t-test of the sums by which it
/// lowers the squared residuals of stretches of readings (Diebold and Mariano 1995; Ibragimov and Mueller 2010).
struct JudgedEffect {
  std::string effect;
  double rms_without_um = 0.0, rms_um = 0.0;  ///< over the readings on which it acts
  std::size_t readings = 0;                   ///< 0: it acts on none, and is not judged
  std::size_t stretches = 0;
  std::optional<double> p_value;  ///< nothing: fewer than two stretches
  [[nodiscard]] bool better() const;
  /// It predicts better, by chance or not.
  [[nodiscard]] bool helps() const { return rms_um < rms_without_um; }
};

/// Level of that test: the largest round one up to which a t-test of independent normal values of any variances keeps
/// its level (two-sided 0.0833, Bakirov and Székely 2005).
inline constexpr double kJudgedLevel = 0.04;

struct Judgement {
  FrozenModel frozen;
  std::vector<JudgedGroup> groups;
  std::vector<JudgedEffect> effects;
  bool zero_of_each_run = false;
  std::string unit;  ///< "um", "um/m"
  /// Entries of the logbook: former openings of this freeze or these files; looks at these files before the freeze.
  /// Nothing: no logbook is kept of this machine.
  std::optional<std::vector<RecordedUse>> openings, seen;
  std::map<std::string, std::string> file_of;  ///< held-out files and the freeze by their SHA-256
  std::vector<std::string> notes;

  [[nodiscard]] bool holds() const;
};

/// Residuals of the frozen model in the readings of these files, nothing fitted to them. Refuses, before a residual is
/// looked at: program, model, machine or map changed since; files or runs that the model was fitted to; another machine
/// or axis; values that are missing or not held out; groups with too few readings, or of a kind without a limit.
[[nodiscard]] Result<Judgement> judge(MessageSink& messages, const std::string& freeze_file,
                                      const std::vector<std::string>& held_out, const ImportArguments& import);

/// @param with, without  residuals, as `data` has its readings
[[nodiscard]] JudgedEffect judged_effect(const model::Observations& data, const std::vector<double>& with,
                                         const std::vector<double>& without);

// --- what freezing and judging share

/// "EX X", "circle XY".
[[nodiscard]] std::string judged_curve(const model::Observations& data, std::size_t k);
/// Letters of the axes that moved.
[[nodiscard]] std::string judged_axes(const model::Observations& data, std::size_t k);
/// Readings of one run of one line, or of one path; canonical order.
[[nodiscard]] std::vector<std::vector<std::size_t>> runs_of_lines(const model::Observations& data);
/// SHA-256 of what a run's rows say, whatever its number. @param rows  canonical order
[[nodiscard]] std::string sha256_of_run(const model::Observations& data, const std::vector<std::size_t>& rows);
/// One condition of a reading, by the column of a FittedRange; kNotMeasured where it has none.
[[nodiscard]] double condition_of(const model::Observations& data, std::size_t k, const std::string& column);
/// Residuals of the model with its values held.
[[nodiscard]] Result<model::Fit> fit_held(const model::Model& model, const model::Observations& data);

}  // namespace ecs::commissioning
