#include "commissioning/lengths/controller.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/lengths/view.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/recent_files.hpp"
#include "commissioning/session/shell_word.hpp"
#include "laser/map/csv.hpp"

namespace ecs::commissioning {
namespace {

/// A plan is the same file without what is measured.
bool is_plan(std::string_view text) { return text.find("deviation_um") == std::string_view::npos; }

/// What a plan asks for, set-up by set-up.
std::vector<std::string> lines_of_plan(const model::LengthTest& test, const std::string& machine) {
  std::vector<std::string> out{
      fmt::format("{}: a plan of {} lengths{}, nothing measured yet", test.source, test.readings.size(),
                  test.minutes ? fmt::format(", {:.1f} minutes", *test.minutes) : std::string())};
  for (std::size_t s = 0; s < test.set_ups.size(); ++s) {
    const model::LengthSetUp& set_up = test.set_ups[s];
    std::set<std::string> tools;
    std::size_t count = 0;
    for (const model::LengthReading& reading : test.readings) {
      if (reading.set_up != s) continue;
      tools.insert(test.tools[reading.tool].name);
      ++count;
    }
    out.push_back(fmt::format("  set-up {}: {} {:.6g}, {:.6g}, {:.6g}: {} lengths, tools {}", set_up.name,
                              model::word_of(set_up.instrument), set_up.place[0], set_up.place[1], set_up.place[2],
                              count, fmt::join(tools, ", ")));
  }
  for (const model::LengthTool& tool : test.tools)
    out.push_back(fmt::format("  tool {}: reflector at {:.6g}, {:.6g}, {:.6g} mm", tool.name, tool.offset_mm[0],
                              tool.offset_mm[1], tool.offset_mm[2]));
  out.emplace_back("Measure row by row and add the column deviation_um; of the emulated machine:");
  out.push_back("  " + shell_command({"ecs-emulator", "lengths", path_word(test.source), "--machine",
                                      path_word(machine), "-o", "lengths.csv"}));
  return out;
}

/// What of the answer is not about options of the verb.
std::vector<std::string> lines_of_fit(const LengthsWork& work) {
  std::vector<std::string> lines = owned_lines_of(lengths_cell(work, "", "").text);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with("map not written"); });
  return lines;
}

Result<LengthsView> fitted(const LengthsArguments& arguments) {
  ECS_TRY(text, read_file(arguments.file));
  LengthsView view;
  if (is_plan(text)) {
    ECS_TRY(plan, model::parse_lengths(text, arguments.file, true));
    view.measured = false;
    view.lines = lines_of_plan(plan, arguments.machine);
    return view;
  }
  ECS_TRY(work, lengths_work(arguments));
  const auto add = [&](const std::string& why_not) {
    if (why_not.empty()) return;
    if (!view.missing.empty()) view.missing.emplace_back();
    view.missing.push_back(why_not);
    ++view.undetermined;
  };
  for (const model::IdentifiedCurve& curve : work.found.curves) add(curve.why_not);
  for (const model::IdentifiedSquareness& square : work.found.squareness) add(square.why_not);
  view.lines = lines_of_fit(work);
  view.work = std::move(work);
  return view;
}

}  // namespace

void LengthsController::fit(const LengthsArguments& arguments) {
  if (running()) return;
  view_.reset();
  fitted_ = arguments;
  message_.clear();
  task_.start(
      "fitting the components", [arguments](JobControl&) { return fitted(arguments); },
      [this](Result<LengthsView> view) {
        if (!view) return message_.say(view.error());
        view_ = std::move(*view);
        for (const std::string& file : {fitted_.params, fitted_.machine, fitted_.file})
          if (!file.empty()) remember_file(file);
      });
}

void LengthsController::plan(const LengthsPlanAsked& asked) {
  if (running()) return;
  planned_.reset();
  asked_ = asked;
  message_.clear();
  const auto work = [asked](JobControl& control) -> Result<LengthsPlanView> {
    ECS_TRY(plan, lengths_plan(asked, [&control] { return control.cancelled.load(); }));
    std::vector<std::string> lines = owned_lines_of(lengths_plan_cell(plan, asked.volume_um, "").text);
    std::erase_if(lines, [](const std::string& line) { return line.starts_with("plan not written"); });
    return LengthsPlanView{std::move(lines), std::move(plan)};
  };
  task_.start("searching the plan with the fewest minutes", work, [this](Result<LengthsPlanView> planned) {
    if (planned)
      planned_ = std::move(*planned);
    else
      message_.say(planned.error());
  });
}

std::string LengthsController::no_map() const {
  if (!view_) return "There is no map yet: nothing was fitted.";
  if (!view_->measured) return "The file is a plan: a map needs what was measured.";
  if (!view_->work.found.whole())
    return "No map while something is not determined: page 2 says which lengths are missing.";
  if (!view_->work.map) return "A map needs the parameters of the unit that it is for: Esc, then name their file.";
  return {};
}

bool LengthsController::stays(const std::string& output, const std::vector<std::string>& inputs) {
  const auto distinct = check_output_not_input(output, inputs);
  if (!distinct) message_.say(distinct.error());
  return distinct.has_value();
}

void LengthsController::save_map(const std::string& map, const std::string& params_out) {
  message_.clear();
  for (const std::string& output : {map, params_out})
    if (!stays(output, {fitted_.file, fitted_.machine, fitted_.params})) return;
  if (const auto done = write_file(map, laser::to_map_csv(*view_->work.map)); !done) return message_.say(done.error());
  const params::ParametersFile& unit = *view_->work.unit;
  if (const auto done = params::write_parameters(params_out, unit.parameters, unit.identity); !done)
    return message_.say(done.error());
  std::vector<std::string> words{"lengths",
                                 "fit",
                                 path_word(fitted_.file),
                                 "--machine",
                                 path_word(fitted_.machine),
                                 "--params",
                                 path_word(fitted_.params)};
  if (!fitted_.knots.empty()) words.insert(words.end(), {"--knots", fitted_.knots});
  words.insert(words.end(), {"-o", path_word(map), "--params-out", path_word(params_out)});
  note_command(std::move(words));
  remember_file(map);
  message_.say(fmt::format("Map written to {}, parameters to {}.", map, params_out));
}

void LengthsController::save_plan(const std::string& path) {
  message_.clear();
  if (!stays(path, {asked_.machine})) return;
  if (const auto done = write_file(path, model::to_csv(planned_->plan.test, true)); !done)
    return message_.say(done.error());
  std::vector<std::string> words{"lengths",     "plan",
                                 "--machine",   path_word(asked_.machine),
                                 "--volume-um", fmt::format("{:.12g}", asked_.volume_um)};
  if (!asked_.knots.empty()) words.insert(words.end(), {"--knots", asked_.knots});
  words.insert(words.end(), {"-o", path_word(path)});
  note_command(std::move(words), planned_->plan.reached ? kDone : kDoesNotHold);
  remember_file(path);
  message_.say(fmt::format("Plan written to {}.", path));
}

}  // namespace ecs::commissioning
