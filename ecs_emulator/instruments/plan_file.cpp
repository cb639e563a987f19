#include "ecs_emulator/instruments/plan_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/toml_reader.hpp"

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
  /// The value under `key`, or the table where it is missing.
  static const toml::node& place_of(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    return node != nullptr ? *node : table;
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
      reader_.complain(place_of(row, "phase"), fmt::format("phase: expected before, after or both, got \"{}\"", phase));
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

}  // namespace ecs::emulator
