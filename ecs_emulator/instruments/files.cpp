#include "ecs_emulator/instruments/files.hpp"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/settings/reader.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;

/// Reads one plan; what is wrong stays in the reader.
class PlanReader {
 public:
  PlanReader(const std::string& file, const PlanChoice& choice) : reader_(file), choice_(choice) {}

  Result<std::vector<std::string>> read(std::string_view text) {
    ECS_TRY(table, reader_.parsed(text));
    reader_.only(table, {"name", "runs", "feed_mm_min", "measure"}, "plan");
    Json common = Json::object();
    put_text(common, "plan_name", reader_.word(table, "name").value_or(""));
    put_text(common, "date", choice_.date);
    put_text(common, "engineer", choice_.engineer);
    put_number(common, "feed", table, "feed_mm_min");
    if (const auto runs = reader_.number(table, "runs")) {
      if (!table.get("runs")->is_integer()) reader_.complain(*table.get("runs"), "runs: expected a whole number");
      common["runs"] = static_cast<long long>(*runs);
    }
    std::vector<std::string> requests;
    if (!table.contains("measure")) reader_.complain(1, "expected at least one [[measure]] table");
    for (const toml::table* row : reader_.children(table, "measure")) take(*row, common, requests);
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    return requests;
  }

 private:
  static std::string upper(std::string_view axis) {
    std::string name(axis);
    for (char& c : name) c = c >= 'x' && c <= 'z' ? static_cast<char>(c - 'x' + 'X') : c;
    return name;
  }
  static void put_text(Json& request, const char* key, const std::string& text) {
    if (!text.empty()) request[key] = text;
  }
  void put_number(Json& request, const char* key, const toml::table& table, std::string_view name) {
    if (const auto value = reader_.number(table, name)) request[key] = *value;
  }
  void put_word(Json& request, const char* key, const toml::table& table, std::string_view name) {
    put_text(request, key, reader_.word(table, name).value_or(""));
  }

  void take(const toml::table& row, const Json& common, std::vector<std::string>& requests) {
    reader_.only(row,
                 {"name", "title", "axis", "sense", "instrument", "from_mm", "to_mm", "step_mm", "parked_mm", "phase",
                  "on_the_fly", "reversed", "slope", "published_before", "published_after"},
                 "measure");
    const std::string name = reader_.word(row, "name").value_or("");
    const std::string phase = reader_.word(row, "phase").value_or("both");
    if (name.empty() || name.find('/') != std::string::npos)
      reader_.complain(place_of(row, "name"), "name: expected a name for the file, without a slash");
    if (phase != "both" && phase != "before" && phase != "after")
      reader_.complain(place_of(row, "phase"), "phase: expected before, after or both, got \"{}\"", phase);
    Json request = common;
    request["action"] = "measure";
    put_word(request, "axis", row, "axis");
    put_word(request, "sense", row, "sense");
    put_word(request, "instrument", row, "instrument");
    put_number(request, "from", row, "from_mm");
    put_number(request, "to", row, "to_mm");
    put_number(request, "step", row, "step_mm");
    if (const auto* parked = reader_.child(row, "parked_mm"))
      for (const auto& [axis, node] : *parked)
        if (const auto place_mm = reader_.number(*parked, axis.str())) request["parked"][upper(axis.str())] = *place_mm;
    if (const toml::node* fly = row.get("on_the_fly")) {
      if (!fly->is_boolean()) reader_.complain(*fly, "on_the_fly: expected true or false");
      request["on_the_fly"] = fly->value_or(false);
    }
    if (const auto reversed = reader_.number(row, "reversed")) {
      if (*reversed != 0.0 && *reversed != 1.0) reader_.complain(*row.get("reversed"), "reversed: expected 0 or 1");
      request["reversed"] = static_cast<int>(*reversed);
    }
    if (choice_.moved) request["moved"] = true;
    request["output"] = Json::array({(choice_.folder / (name + ".csv")).string()});
    if (phase == "both" || phase == choice_.phase || choice_.phase.empty()) requests.push_back(request.dump());
  }

  TomlReader reader_;
  const PlanChoice& choice_;
};

}  // namespace

Result<std::vector<std::string>> requests_of(const std::filesystem::path& plan, const PlanChoice& choice) {
  ECS_TRY(text, read_file(plan));
  return PlanReader(plan.string(), choice).read(text);
}

namespace {

/// The same set with metadata under the names of a Renishaw file.
laser::MeasurementSet in_renishaw_words(laser::MeasurementSet set) {
  const std::map<std::string, std::string> words{{"machine", "Machine"}, {"serial_number", "Serial No"},
                                                 {"date", "Date"},       {"engineer", "By"},
                                                 {"plan", "TITLE"},      {"feed_mm_min", "Velocity"}};
  for (auto& entry : set.metadata)
    if (const auto word = words.find(entry.key); word != words.end()) entry.key = word->second;
  return set;
}

Result<void> write_text(const std::filesystem::path& path, const Result<std::string>& text) {
  if (text) return write_file(path, *text);
  Problem problem = text.error();
  problem.message = fmt::format("{}: {}", path.string(), problem.message);
  return tl::unexpected(std::move(problem));
}

}  // namespace

Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set) {
  const std::string name = lower(path.filename().string());
  const std::string extension = lower(path.extension().string());
  if (extension == ".csv") return laser::write_measurement_set(path, set);
  if (extension == ".ren") return write_text(path, laser::to_renishaw_table(set));
  if (extension == ".dat") return write_text(path, laser::to_iso230_assignments(set));
  if (name.ends_with(".env.pos")) return write_text(path, laser::to_sios_environment(laser::environment_of(set)));
  if (extension == ".pos") return write_text(path, laser::to_api_pos(set));
  if (extension == ".rtx")
    return write_text(path, laser::to_renishaw_dynamic(in_renishaw_words(set), path.filename().string()));
  const std::string renishaw = laser::renishaw_extension(set);
  if (extension == renishaw) return write_text(path, laser::to_renishaw_run(in_renishaw_words(set)));
  return problem(ProblemKind::usage,
                 "{}: expected a name that ends in .csv, {}, .ren, .pos, .dat, .rtx or .env.pos for this measurement",
                 path.string(), renishaw);
}

}  // namespace ecs::emulator
