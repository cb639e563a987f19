#include "app/report/files.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace ecs::app {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}
bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

/// Found, not named: a FIFO that nobody writes into would be waited for.
bool is_plain_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

struct UsualName {
  fs::path ReportFiles::*into;
  const char* name;
  bool folder;
};
constexpr UsualName kUsualNames[] = {
    {&ReportFiles::plan, "plan.toml", false},     {&ReportFiles::before, "before", true},
    {&ReportFiles::after, "after", true},         {&ReportFiles::machine, "machine.toml", false},
    {&ReportFiles::map, "map.csv", false},        {&ReportFiles::params, "parameters.toml", false},
    {&ReportFiles::model, "model.toml", false},   {&ReportFiles::diagnosis, "diagnosis.json", false},
    {&ReportFiles::status, "status.json", false},
};

void take_folder(ReportFiles& files, const fs::path& folder) {
  for (const UsualName& usual : kUsualNames) {
    const fs::path path = folder / usual.name;
    if (usual.folder ? is_folder(path) : is_plain_file(path)) files.*(usual.into) = path;
  }
  for (const std::string& name : measurement_names_in(folder / "circles"))
    files.circles.push_back(folder / "circles" / (name + ".csv"));
}

void take_option(fs::path& into, const std::string& given) {
  if (!given.empty()) into = given;
}

}  // namespace

Result<ReportFiles> report_files(const ReportArguments& arguments) {
  ReportFiles files;
  std::vector<Problem> problems;
  for (const std::string& place : arguments.places) {
    if (is_folder(place)) {
      take_folder(files, place);
    } else if (is_file(place)) {
      files.plan = place;
    } else {
      problems.push_back({ProblemKind::bad_input, "expected a plan or a folder, found nothing", place, 0, 0, {}});
    }
  }
  for (const auto& [into, given] : {std::pair{&files.before, &arguments.before}, {&files.after, &arguments.after}}) {
    take_option(*into, *given);
    if (!given->empty() && !is_folder(*given))
      problems.push_back({ProblemKind::bad_input, "expected a folder of measurements", *given, 0, 0, {}});
  }
  take_option(files.machine, arguments.machine);
  take_option(files.map, arguments.map);
  take_option(files.params, arguments.params);
  take_option(files.model, arguments.model);
  take_option(files.diagnosis, arguments.diagnosis);
  take_option(files.status, arguments.status);
  if (!arguments.circle.empty()) files.circles.assign(arguments.circle.begin(), arguments.circle.end());
  if (problems.empty() && files.before.empty() && files.after.empty())
    problems.push_back({ProblemKind::bad_input,
                        "expected measurements: a folder that holds before/ or after/, or --before and --after",
                        arguments.places.empty() ? "" : arguments.places.front(),
                        0,
                        0,
                        {}});
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return files;
}

std::vector<std::string> measurement_names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".csv" && is_plain_file(entry->path()))
      names.push_back(entry->path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace ecs::app
