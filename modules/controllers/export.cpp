#include "modules/controllers/export.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::commissioning {

Result<ErrorsAt> errors_for(MessageSink& messages, const ExportArguments& arguments, const ExportWork& work) {
  if (arguments.model.empty()) return controllers::errors_of_map(work.source);
  ECS_TRY(model, model::read_model(arguments.model));
  ECS_TRY(machine, machine_in(messages, arguments.machine));
  return errors_of_model(model, *machine, arguments.model);
}

namespace {

namespace fs = std::filesystem;

/// One file on its way: where it goes, the new content beside it, and what was there.
struct Staged {
  std::string name;  ///< as it was given
  fs::path target;   ///< where a symbolic link leads
  fs::path beside;
  std::optional<std::string> old;
};

tl::unexpected<Problem> output_problem(const std::string& path, std::string why) {
  return tl::unexpected(Problem{ProblemKind::output, std::move(why), path, 0, 0, {}});
}

/// Takes away what was staged and not renamed.
class StagedFiles {
 public:
  StagedFiles() = default;
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;
  ~StagedFiles() {
    for (const Staged& one : all) disc::remove(one.beside);
  }
  std::vector<Staged> all;
};

Result<void> check_target(const Staged& one, const StagedFiles& before) {
  std::error_code ignored;
  const auto status = fs::status(one.target, ignored);
  if (fs::is_directory(status))
    return output_problem(one.name, "cannot write: a folder of that name exists; no file was changed");
  if (fs::is_other(status))
    return output_problem(one.name, "cannot write: it is not a regular file; no file was changed");
  const auto place = [&](const Staged& staged) { return fs::weakly_canonical(staged.target, ignored); };
  for (const Staged& other : before.all)
    if (place(other) == place(one))
      return output_problem(one.name,
                            fmt::format("cannot write: {} leads to the same file; no file was changed", other.name));
  return {};
}

Result<void> stage(const OutputFile& file, StagedFiles& staged) {
  std::error_code ignored;
  Staged one{file.path, led_to(file.path), {}, std::nullopt};
  if (auto fits = check_target(one, staged); !fits) return fits;
  if (fs::exists(one.target, ignored)) {
    auto old = read_file(one.target);
    if (!old)
      return output_problem(
          file.path,
          fmt::format("the existing files cannot be saved in case another file fails ({}); no file was changed",
                      old.error().message));
    one.old = std::move(*old);
  }
  one.beside = one.target.string() + fmt::format(".new-{}", ::getpid());
  staged.all.push_back(one);
  const auto written = [&] {
    const Unwatched unseen;  // its name is that of a moment
    return write_file(one.beside, file.content);
  }();
  if (!written) return output_problem(file.path, written.error().message + "; no file was changed");
  if (one.old) fs::permissions(one.beside, fs::status(one.target, ignored).permissions(), ignored);
  return {};
}

/// What a failure in the middle leaves: everything as it was, or named what is not.
std::string taken_back(const std::vector<Staged>& all, std::size_t renamed) {
  std::vector<std::string> stuck;
  for (std::size_t i = 0; i < renamed; ++i) {
    const Staged& one = all[i];
    const bool back = one.old ? write_file(one.target, *one.old).has_value() : disc::remove(one.target);
    if (!back) stuck.push_back(one.name);
  }
  if (stuck.empty() && renamed == 0) return "no file was changed";
  if (stuck.empty()) return "the previous files were restored: no file has changed";
  return fmt::format(
      "{} could not be restored and contain{} the new content, the others their old content: do not use them together",
      fmt::join(stuck, ", "), stuck.size() == 1 ? "s" : "");
}

}  // namespace

Result<std::vector<WrittenFile>> write_together(const std::vector<OutputFile>& files) {
  std::vector<WrittenFile> written;
  FileWatch* const watch = FileWatch::current();
  if (files.size() == 1 || (watch != nullptr && watch->replaces_disc())) {
    for (const OutputFile& file : files) {
      const bool there = is_there(file.path);
      ECS_DO(write_file(file.path, file.content));
      written.push_back({file.path, there});
    }
    return written;
  }
  StagedFiles staged;
  for (const OutputFile& file : files) ECS_DO(stage(file, staged));
  for (std::size_t i = 0; i < staged.all.size(); ++i) {
    const Staged& one = staged.all[i];
    if (std::rename(one.beside.c_str(), one.target.c_str()) != 0) {
      const std::string why = std::strerror(errno);
      return output_problem(one.name, fmt::format("cannot write: {}; {}", why, taken_back(staged.all, i)));
    }
    if (watch != nullptr) watch->was_written(one.name, files[i].content);
    written.push_back({one.name, one.old.has_value()});
  }
  return written;
}

std::vector<std::string> left_from_before(const std::string& folder, const std::vector<WrittenFile>& written,
                                          const std::function<bool(std::string_view)>& is_ours) {
  std::vector<std::string> left;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const std::string name = at->path().filename().string();
    const auto is_it = [&](const WrittenFile& file) { return fs::path(file.path).filename() == name; };
    if (is_ours(name) && !at->is_directory(ignored) && std::none_of(written.begin(), written.end(), is_it))
      left.push_back(name);
  }
  std::sort(left.begin(), left.end());
  return left;
}

namespace {

constexpr std::array<std::string_view, kAxes + 1> kDirections{"X", "Y", "Z", "length"};
constexpr double kWorse_um = 0.05;     ///< smaller increases are not visible in the table
constexpr double kShiftShown = 0.005;  ///< smaller ones would be shown as 0.00

Cell table_cell(const controllers::ExportedTable& t) {
  const bool shifted = std::abs(t.shift) >= kShiftShown;
  return record_cell(
      "{component:<4} {table:<37} {points:>6} {map_points:>6} {largest:>8} {deviation_from_unit:>8}  {unit}\n{shift}",
      "component"_is(t.component), "table"_is(t.what), "points"_is(t.points),
      "map_points"_is(t.map_points, t.map_points == 0 ? "-" : std::to_string(t.map_points)), "largest"_is(t.largest, 2),
      "deviation_from_unit"_is(t.deviation, 2),
      "shift"_is(t.shift, shifted ? fmt::format("     shifted by {:.2f} {} to be zero at the reference position\n",
                                                t.shift, t.unit)
                                  : ""),
      "unit"_is(t.unit));
}

Cell tables_cell(const std::vector<controllers::ExportedTable>& tables) {
  Cell list = list_cell(tables, table_cell,
                        fmt::format("{0:<42} {1:>13}\n{0:<4} {2:<37} {3:>6} {4:>6} {5:>8} {6:>8}\n", "",
                                    "points of the", "table", "table", "map", "largest", "differs"));
  list.text +=
      "largest: largest value of the table; differs: largest difference from the compensation by the ECS unit\n";
  return list;
}

/// In the text a paragraph for each reason, in the order in which the reasons come up.
Cell not_carried_cell(const std::vector<controllers::LeftBehind>& all) {
  Cell list = list_cell(all, [](const controllers::LeftBehind& one) {
    return record_cell({}, "what"_is(one.what), "largest"_is(one.largest, 1), "unit"_is(one.unit), "why"_is(one.why));
  });
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const controllers::LeftBehind& one : all) {
    auto at = std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == one.why; });
    if (at == reasons.end()) at = reasons.insert(reasons.end(), {one.why, ""});
    at->second += fmt::format("{}{} {:.1f} {}", at->second.empty() ? "" : ", ", one.what, one.largest, one.unit);
  }
  list.text = reasons.empty() ? "every component of the map is exported\n" : "NOT EXPORTED (largest values)\n";
  for (const auto& [why, what] : reasons) list.text += paragraph(fmt::format("{}: {}", what, why), 2, 4);
  return list;
}

Cell size_cell(const controllers::ResidualSize& size, std::size_t direction) {
  return record_cell("{largest_um:>7} /{rms_um:>7}", "largest_um"_is(size.largest_um[direction], 1),
                     "rms_um"_is(size.rms_um[direction], 1));
}

/// By direction in JSON, a line for each direction in the text.
Cell residual_row_cell(const controllers::ResidualRow& row, const PerAxis<bool>& present) {
  Json before = Json::object(), unit = Json::object(), control = Json::object();
  std::string text, where = row.where;
  for (std::size_t d = 0; d <= kAxes; ++d) {
    if (d < kAxes && !present[d]) continue;
    const std::string direction(kDirections[d]);
    const Cell of_none = size_cell(row.before, d), of_map = size_cell(row.unit, d),
               of_export = size_cell(row.control, d);
    before[direction] = of_none.json;
    unit[direction] = of_map.json;
    control[direction] = of_export.json;
    text += fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", where, d == kAxes ? "vector" : direction,
                        of_none.text, of_map.text, of_export.text);
    where.clear();
  }
  return {object_of("where"_is(row.where), "places"_is(row.places), "not_compensated"_is(before), "whole_map"_is(unit),
                    "this_export"_is(control)),
          text};
}

Cell residual_cell(const ExportReport& report) {
  const PerAxis<bool>& present = report.work.source.parameters.axis_present;
  const Cell rows = list_cell(
      report.residuals, [&](const controllers::ResidualRow& row) { return residual_row_cell(row, present); },
      fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", "", "along", "not compensated", "with ECS unit",
                  "with this export"));
  Cell cell = record_cell(
      "remaining error, predicted from {from}: largest / rms, um\n{rows}both approaches; on a line, the other axes are "
      "where the map was measured; errors are counted from\nthe reference position of the axes, as after setting a "
      "work "
      "offset there\n",
      "from"_is(report.work.errors_from), "rows"_is(rows));
  std::vector<std::string> worse;
  for (const controllers::ResidualRow& row : report.residuals)
    if (row.control.largest_um[kAxes] > row.before.largest_um[kAxes] + kWorse_um) worse.push_back("the " + row.where);
  if (!worse.empty())
    cell.text +=
        paragraph(fmt::format("note: over {} the remaining error is larger with this export than without "
                              "compensation: the exported tables correct errors that partly cancelled others.",
                              fmt::join(worse, " and ")));
  std::vector<std::string> left;
  for (const controllers::LeftBehind& one : report.made.not_carried) left.push_back(one.what);
  if (!left.empty() && std::ranges::any_of(report.residuals, [](const controllers::ResidualRow& row) {
        return row.control.largest_um[kAxes] > row.unit.largest_um[kAxes] + kWorse_um;
      }))
    cell.text += paragraph(fmt::format("More remains with this export than with the ECS unit, because it lacks {}.",
                                       fmt::join(left, ", ")));
  if (report.work.errors_from == "the map")
    cell.text += paragraph(
        "From the map itself: errors that are not in the map are taken as zero, and poor repeatability is not "
        "included. "
        "--model predicts from an error model.");
  return cell;
}

Cell settings_cell(const std::vector<std::string>& settings) {
  Cell cell{settings, settings.empty() ? "" : "to set in the control:\n"};
  for (const std::string& line : settings) cell.text += paragraph(line, 2, 4);
  return cell;
}

}  // namespace

Cell written_files_cell(const std::vector<WrittenFile>& files) {
  return list_cell(files, [](const WrittenFile& file) {
    return Cell{file.path, fmt::format("{}: {}\n", file.replaced ? "replaced" : "written", file.path)};
  });
}

Cell replaced_files_cell(const std::vector<WrittenFile>& files) {
  Cell cell{Json::array(), {}};
  for (const WrittenFile& file : files)
    if (file.replaced) cell.json.push_back(file.path);
  return cell;
}

Cell export_cell(const ExportReport& report) {
  std::vector<std::string> notes = report.made.notes;
  notes.insert(notes.end(), report.work.notes.begin(), report.work.notes.end());
  Cell written = written_files_cell(report.written);
  if (report.written.empty()) written.text = fmt::format("not saved: give {} to save it\n", report.output_hint);
  return record_cell(
      "{control} from {map}\n\n{tables}\n{not_carried}\n{residual}\n{settings}{notes}{written}",
      "control"_is(report.control), "map"_is(report.work.map_name),
      "files"_is(list_cell(report.made.files,
                           [](const controllers::ExportFile& file) {
                             return record_cell({}, "name"_is(file.name), "bytes"_is(file.content.size()));
                           })),
      "written"_is(written), "replaced"_is(replaced_files_cell(report.written)),
      "tables"_is(tables_cell(report.made.tables)), "not_carried"_is(not_carried_cell(report.made.not_carried)),
      "settings"_is(settings_cell(report.made.settings)), "residual"_is(residual_cell(report)),
      "notes"_is(paragraphs_cell(notes, "note: ")));
}

}  // namespace ecs::commissioning
