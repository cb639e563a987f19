// `ecs report`: one self-contained HTML page of a commissioning. What the module brings.

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/report/page.hpp"

namespace ecs::app {
namespace {

constexpr int kUnfitFile = 3;

Json band_of(const std::optional<MeasuredPhase>& phase) {
  return phase ? number_or_null(phase->readings.band) : Json(nullptr);
}

Json row_json(const ReportContent& content, std::size_t i) {
  const TableRow& row = content.rows[i];
  Json problems = Json::array();
  for (const Problem& one : row.problems) problems.push_back(problem_json(one));
  return object_of(
      "name"_is(row.planned.name), "title"_is(row.planned.title), "unit"_is(laser::unit_of(row.planned.sense)),
      "before"_is(band_of(row.before)), "after"_is(band_of(row.after)),
      "predicted"_is(content.predicted.empty() ? Json(nullptr) : number_or_null(content.predicted[i].band)),
      "ratio"_is(row.ratio()), "limit"_is(row.planned.published_after), "verdict"_is(word_for(verdict_of(row))),
      "problems"_is(std::move(problems)));
}

/// What a report may hold and this one was not given.
Json absent_from(const ReportContent& content) {
  Json absent = Json::array();
  for (const auto& [there, what] : {std::pair{content.planned, "plan"},
                                    {content.has_before, "before"},
                                    {content.has_after, "after"},
                                    {content.machine.has_value(), "machine"},
                                    {content.map.has_value(), "map"},
                                    {content.parameters.has_value(), "parameters"},
                                    {content.model.has_value(), "model"},
                                    {content.diagnosis.has_value(), "diagnosis"},
                                    {content.status.has_value(), "status"},
                                    {!content.circles.empty(), "circles"}})
    if (!there) absent.push_back(what);
  return absent;
}

std::optional<Problem> unfit_files(const ReportContent& content) {
  std::vector<Problem> all = content.problems;
  for (const TableRow& row : content.rows) all.insert(all.end(), row.problems.begin(), row.problems.end());
  if (all.empty()) return std::nullopt;
  return folded(std::move(all));
}

/// By direction and for the vector; null: not predicted.
Json volume_json(const std::optional<ReportedVolume>& volume) {
  if (!volume) return nullptr;
  Json before = Json::object(), after = Json::object();
  const auto put = [](Json& into, const std::string& name, double largest_um, double rms_um) {
    into[name] = object_of("largest_um"_is(largest_um), "rms_um"_is(rms_um));
  };
  for (auto& [size, into] : {std::pair<const volume::ErrorSize&, Json&>{volume->answer.before.all, before},
                             {volume->answer.after.all, after}}) {
    for (const Axis axis : kAllAxes)
      if (volume->answer.grid.exists[index_of(axis)])
        put(into, std::string(1, letter_of(axis)), size.largest_along_um[index_of(axis)],
            size.rms_along_um[index_of(axis)]);
    put(into, "length", size.largest_um, size.rms_um);
  }
  return object_of("from"_is(volume->prepared.errors_from), "places"_is(volume->answer.grid.places()),
                   "uncertainty_95_um"_is(object_of("largest"_is(volume->uncertainty.largest_95_um),
                                                    "rms"_is(volume->uncertainty.rms_95_um))),
                   "predicted_before"_is(std::move(before)), "predicted_after"_is(std::move(after)));
}

Json circles_json(const ReportContent& content) {
  Json circles = Json::array();
  for (const CircleWork& circle : content.circles) {
    double worst_um = 0.0;
    for (const laser::CirclePass& pass : circle.values.passes) worst_um = std::max(worst_um, pass.G_um);
    Json causes = Json::array();
    for (const model::CircleFaultFound& fault : circle.diagnosis.faults)
      causes.push_back(object_of("name"_is(fault.name), "share"_is(fault.share)));
    circles.push_back(object_of("file"_is(circle.file.string()), "plane"_is(laser::plane_name(circle.test.plane)),
                                "G_um"_is(worst_um), "causes"_is(std::move(causes))));
  }
  return circles;
}

struct Page {
  std::string html;
  bool replaced = false;  ///< another file of that name was there
};

Cell report_cell(const ReportContent& content, const Judgement& j, const std::string& output, const Page& page) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < content.rows.size(); ++i) rows.push_back(row_json(content, i));
  const auto& map = content.map;
  const auto unfit = unfit_files(content);
  return record_cell(
      "{verdict}\n{worst_sentence}{volume}{next}report written to {report} ({kilobytes} kB{replaced})\n",
      "report"_is(output), "bytes"_is(page.html.size()), "sha256"_is(sha256_hex(page.html)),
      "replaced"_is(page.replaced, ", replaced", ""), "machine"_is(text_cell(header_value(content, "machine"))),
      "serial_number"_is(text_cell(header_value(content, "serial_number"))), "date"_is(text_cell(content.date)),
      "map_sha256"_is(map ? cell_of(map->sha256) : null_cell()),
      "block_check"_is(map && map->check ? cell_of(fmt::format("{:08X}", *map->check)) : null_cell()),
      "verdict"_is(j.sentence), "measured_after"_is(j.after), "judged"_is(j.judged), "within"_is(j.within),
      "missing"_is(j.missing), "worst"_is(j.worst != nullptr ? cell_of(j.worst->planned.name) : null_cell()),
      "diagnosis"_is(content.diagnosis ? cell_of(content.diagnosis->verdict) : null_cell()),
      "volume"_is(volume_json(content.volume), content.volume ? volume_sentence(*content.volume) + "\n" : ""),
      "circles"_is(circles_json(content)), "next"_is(lines_cell(j.next, "- ")), "absent"_is(absent_from(content)),
      "rows"_is(std::move(rows)), "error"_is(unfit ? Cell{problem_json(*unfit), {}} : shown_cell()),
      "kilobytes"_shown((page.html.size() + 500) / 1000),
      "worst_sentence"_shown(j.worst_sentence.empty() ? "" : j.worst_sentence + "\n"));
}

Result<void> check_page_not_source(const ReportArguments& request, const ReportFiles& files,
                                   const ReportContent& content) {
  std::vector<std::string> inputs = request.data;
  for (const auto* path :
       {&files.plan, &files.machine, &files.map, &files.params, &files.model, &files.diagnosis, &files.status})
    if (!path->empty()) inputs.push_back(path->string());
  for (const TableRow& row : content.rows)
    for (const auto* phase : {&row.before, &row.after})
      if (*phase) inputs.push_back((*phase)->file.string());
  for (const auto& file : files.circles) inputs.push_back(file.string());
  return check_output_not_input(request.output, inputs);
}

Result<Outcome> report(VerbContext& context, const ReportArguments& request) {
  if (disc::is_folder(request.output))
    return problem(ProblemKind::usage, "-o {} is a folder: give a file name, as in {}", request.output,
                   (std::filesystem::path(request.output) / "report.html").lexically_normal().string());
  ECS_TRY(files, report_files(request));
  if (!request.data.empty() && files.model.empty())
    return problem(ProblemKind::usage, "--data gives readings for an error model, but there is none: give --model");
  ECS_TRY(content, report_content(context, request));
  ECS_DO(check_page_not_source(request, files, content));
  const Judgement judgement = judgement_of(content);
  const Page page{report_page(content, judgement), disc::exists(request.output)};
  ECS_DO(write_file(request.output, page.html));
  return outcome_of(report_cell(content, judgement, request.output, page), unfit_files(content) ? kUnfitFile : kDone);
}

const std::vector<Action> kReport{action("report", "write the report of a commissioning as one HTML page",
                                         "ecs report plan.toml --before before/ --after after/ --map map.csv --params "
                                         "parameters.toml -o report.html\n  ecs report commissioning/ -o report.html",
                                         report, {.logged = Logged::when_written, .kind = "report"})};

}  // namespace

const Module& report_module() {
  static const Module module{.verbs = {{"volume", &kReport}}, .synonyms = {{"MORE", "report"}}};
  return module;
}

}  // namespace ecs::app
