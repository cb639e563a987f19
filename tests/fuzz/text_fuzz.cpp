// libFuzzer over the parsers of texts: machines, parameters, models, plans, part programs, errors of the workshop and
// what the program keeps in files. Whatever the bytes are, a Result comes back; a problem has words and, of a file, its
// name; what was read is finite; where there is a writer, what was read is written and read again as the same.
// ECS_FUZZ_READER in the environment is the id of a parser; the seeds of each are in corpus/<id>, files as they are.
// Does not live here: readings and maps (import_fuzz.cpp), what modules read (modules/*/tests/*_fuzz.cpp).
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/answer_table.hpp"
#include "base/json.hpp"
#include "commissioning/measurements/table.hpp"
#include "commissioning/unit/datum_recording.hpp"
#include "commissioning/unit/status.hpp"
#include "ecs_emulator/errors/true_errors.hpp"
#include "ecs_emulator/part_programs/reader.hpp"
#include "ecs_emulator/settings/emulator.hpp"
#include "laser/map/recipe.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/diagonals.hpp"
#include "laser/standards/gauge_blocks.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"
#include "tests/fuzz/parsers.hpp"
#include "volume/rotary_errors.hpp"

namespace {

using namespace ecs;
using namespace ecs::fuzz;

const std::filesystem::path kFolder = "/nowhere";  // no file that a text names is found

void circle_test(std::string_view text) {
  const auto read = laser::parse_circle_test(text, kFile);
  if (!was_read(read)) return;
  check(read->radius_mm > 0.0 && read->plane[0] != read->plane[1]);
  check_finite(read->radius_mm);
  check_finite(read->feed_mm_min);
  check_finite(read->start_angle_deg);
  all_finite(read->centre_mm);
  for (const laser::CircleReading& reading : read->readings)
    all_finite(std::array{reading.angle_deg, reading.deviation_um});
}

void diagonals(std::string_view text) {
  const auto read = laser::parse_diagonals(text, kFile);
  if (!was_read(read)) return;
  all_finite(read->span_mm);
  const auto results = laser::diagonal_results_of(*read);
  if (!was_read(results, false)) return;
  for (const laser::DiagonalValues& diagonal : results->diagonals)
    all_finite(std::array{diagonal.length_mm, diagonal.growth_um_per_m, diagonal.growth_sigma});
  for (const laser::DiagonalSquareness& one : results->squareness) all_finite(std::array{one.um_per_m, one.sigma});
}

void gauge_blocks(std::string_view text) {
  const auto read = laser::parse_gauge_blocks(text, kFile);
  if (!was_read(read)) return;
  check(!read->readings.empty());
  for (const laser::BlockReading& reading : read->readings) {
    check(reading.nominal_mm > 0.0 && reading.U_um >= 0.0);
    check_finite(laser::error_um_of(*read, reading));
  }
}

void map_recipe(std::string_view text) {
  const auto read = laser::parse_map_recipe(text, kFile, kFolder);
  if (!was_read(read)) return;
  for (const laser::ComponentRecipe& one : read->components) {
    check(!one.files.empty());
    check_finite(one.smoothing_mm);
    check_finite(one.increment_mm);
  }
}

void rotary_errors(std::string_view text) {
  const auto chain = kinematics::joint_chain_of("XYACTZ");
  const auto read = volume::parse_rotary_errors(text, kFile, *chain);
  if (!was_read(read)) return;
  for (const volume::RotaryTable& table : read->tables) {
    check(!table.p_deg.empty() && table.p_deg.size() == table.error.size());
    check(std::is_sorted(table.p_deg.begin(), table.p_deg.end()));
    all_finite(table.p_deg);
    all_finite(table.error);
    all_finite(table.u);
    for (const double angle : {-3600.0, 0.0, 12.5, 7200.0}) check_finite(volume::value_at(table, angle));
  }
  for (const auto& location : read->location) all_finite(location);
  for (const auto& location : read->location_u) all_finite(location);
  const auto again = volume::parse_rotary_errors(volume::rotary_csv(*read, "fuzzed"), kFile, *chain);
  if (again) check(again->tables.size() == read->tables.size());  // angles are written with six digits
}

void check_machine(const params::Machine& machine) {
  for (const auto& axis : machine.axes) {
    if (!axis) continue;
    check(axis->travel_mm[0] < axis->travel_mm[1] && axis->resolution_um > 0.0);
    all_finite(axis->travel_mm);
    all_finite(std::array{axis->datum_mm, axis->resolution_um});
    all_finite(axis->measurement_line_mm);
    all_finite(std::array{axis->screw_pitch_mm, axis->scale_pitch_mm, axis->expansion_um_per_m_degC});
  }
  for (const auto& axis : machine.rotary) {
    if (!axis) continue;
    all_finite(axis->travel_deg);
    all_finite(axis->direction);
    all_finite(axis->pivot_mm);
  }
}

void machine(std::string_view text) {
  const auto read = params::parse_machine(text, kFile);
  check(read.has_value() == params::parse_rotary_machine(text, kFile).has_value());
  if (!was_read(read)) return;
  check_machine(read->machine);
  for (const Problem& warning : read->warnings) check(has_words(warning, true));
  check(params::chain_of(read->machine).has_value());
  static_cast<void>(params::parameters_toml(params::default_parameters_for(read->machine)));
}

void rotary_machine(std::string_view text) {
  const auto read = params::parse_rotary_machine(text, kFile);
  if (!was_read(read)) return;
  check_machine(read->machine);
  check(params::joint_chain_of(*read).has_value());
  for (const auto& axis : read->rotary) {
    if (!axis) continue;
    const double length = std::hypot(axis->direction[0], axis->direction[1], axis->direction[2]);
    check(axis->travel_deg[0] < axis->travel_deg[1] && std::abs(length - 1.0) < 1e-9);
  }
  static_cast<void>(params::joint_machine_of(read->machine));
}

void parameters(std::string_view text) {
  const auto read = params::parse_parameters(text, kFile);
  if (!was_read(read)) return;
  const auto again = params::parse_parameters(params::parameters_toml(read->parameters, read->identity), kFile);
  check(again && again->has_end && again->parameters == read->parameters && again->identity == read->identity);
}

void check_effect(const model::EffectInstance& effect) {
  for (const auto* values : {&effect.parameters, &effect.fitted})
    for (const auto& [name, value] : *values) check_finite(value);
  for (const model::UserParameter& one : effect.user)
    all_finite(std::array{one.value, one.start, one.least, one.greatest});
  check(effect.curve.p_mm.size() == effect.curve.value.size());
  all_finite(effect.curve.p_mm);
  all_finite(effect.curve.value);
  check(!model::to_text(effect).empty());
}

/// The order of a user effect's parameters means nothing; a table keeps none.
std::vector<model::EffectInstance> in_order(std::vector<model::EffectInstance> effects) {
  for (model::EffectInstance& effect : effects)
    std::sort(effect.user.begin(), effect.user.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return effects;
}

void model_file(std::string_view text) {
  const auto read = model::parse_model(text, kFile, kFolder);
  if (!was_read(read)) return;
  for (const auto* effects : {&read->effects, &read->candidates})
    for (const model::EffectInstance& effect : *effects) check_effect(effect);
  const auto again = model::parse_model(model::to_toml(*read), kFile, kFolder);
  check(again && in_order(again->effects) == in_order(read->effects));
  check(in_order(again->candidates) == in_order(read->candidates));
  check(again->known == read->known && again->history == read->history);
  check(again->compensated_readings == read->compensated_readings);
}

void add_request(std::string_view text) {
  const auto read = model::parse_add_request(text);
  if (was_read(read, false)) check(read->id != nullptr);
}

void program(std::string_view text) {
  const auto read = emulator::parse_program(text, kFile);
  if (!was_read(read)) return;
  const auto& blocks = read->blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const emulator::ProgramBlock& block = blocks[i];
    if (block.repeat > 0 || block.loop_end) check(block.partner < blocks.size() && blocks[block.partner].partner == i);
    all_finite(block.target_mm);
    all_finite(block.centre_mm);
    all_finite(std::array{block.dwell_s, block.radius_mm, block.feed_mm_min, block.spindle_rpm});
  }
}

void workshop_machine(std::string_view text) {
  const auto read = emulator::parse_workshop_machine(text, kFile, kFolder);
  if (!was_read(read)) return;
  check_machine(read->machine);
  check_finite(read->settings.load_kg);
  all_finite(read->settings.tool_offset_mm);
  check(!read->settings.serial_number.empty() && read->settings.serial_number.size() <= 16);
  for (const emulator::AxisSettings& axis : read->settings.axes) check(axis.dac_um_per_count != 0.0);
}

void true_errors(std::string_view text) {
  const auto read = emulator::TrueErrors::parse(text, kFile, kFolder);
  if (!was_read(read)) return;
  emulator::MachineState state;
  state.position_mm = {12.5, -40.0, 300.0};
  state.time_s = 60.0;
  for (const double value : read->at(state)) check_finite(value);
  for (const double value : read->reading_scatter()) check(std::isfinite(value) && value >= 0.0);
  for (const auto& [sensor, degC] : read->temperatures(3600.0)) check_finite(degC);
}

void snapshot(std::string_view text) {
  const auto read = commissioning::parse_snapshot(text, kFile);
  if (!was_read(read)) return;
  for (const auto& value : read->selected)
    if (value) check_finite(value->value);
  check(json_in(one_line(commissioning::status_cell(*read).json)).is_object());
  const std::string written =
      commissioning::json_with_registers(*read).dump(1, ' ', false, Json::error_handler_t::replace);
  const auto again = commissioning::parse_snapshot(written, kFile);
  check(again && again->identity_registers == read->identity_registers);
  check(again->status_registers == read->status_registers && again->pointer_registers == read->pointer_registers);
  check(again->event_blocks == read->event_blocks);
  for (std::size_t i = 0; i < read->selected.size(); ++i)
    check(again->selected[i].has_value() == read->selected[i].has_value());
}

void recording(std::string_view text) {
  const auto read = commissioning::parse_recording(text, kFile);
  if (!was_read(read)) return;
  check(read->sample_period_us > 0.0 && read->um_per_count != 0.0);
  for (std::size_t i = 0; i < read->samples.size(); ++i) all_finite(std::array{read->time_s(i), read->position_mm(i)});
  all_finite(commissioning::speeds_mm_min(*read));
  static_cast<void>(commissioning::events_of(*read));
  const auto again = commissioning::parse_recording(commissioning::to_csv(*read), kFile);
  check(again && again->samples == read->samples && again->axis == read->axis && again->taken == read->taken);
  check(again->sample_period_us == read->sample_period_us && again->um_per_count == read->um_per_count);
}

void plan(std::string_view text) {
  const auto read = commissioning::parse_plan(text, kFile);
  if (!was_read(read)) return;
  check(!read->empty());
  for (const commissioning::PlannedMeasurement& one : *read) {
    check(!one.name.empty() && one.name.find('/') == std::string::npos);
    all_finite(std::array{one.published_before, one.published_after});
  }
}

const AddedParsers kTexts{
    {"circle_test", circle_test},
    {"gauge_blocks", gauge_blocks},
    {"diagonals", diagonals},
    {"map_recipe", map_recipe},
    {"rotary_errors", rotary_errors},
    {"machine", machine},
    {"rotary_machine", rotary_machine},
    {"parameters", parameters},
    {"model", model_file},
    {"add_request", add_request},
    {"program", program},
    {"workshop_machine", workshop_machine},
    {"true_errors", true_errors},
    {"snapshot", snapshot},
    {"recording", recording},
    {"plan", plan},
};

/// Numbers, words and texts in quotes.
std::vector<std::pair<std::size_t, std::size_t>> words_of(const std::string& text) {
  const auto belongs = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_+-.\"", c); };
  std::vector<std::pair<std::size_t, std::size_t>> words;
  for (std::size_t begin = 0; begin < text.size(); ++begin) {
    std::size_t end = begin;
    while (end < text.size() && text[end] != '\0' && belongs(text[end])) ++end;
    if (end > begin) words.emplace_back(begin, end - begin);
    begin = end;
  }
  return words;
}

constexpr std::string_view kValues[] = {
    "0",       "-1",   "1e300", "-1e300",  "1e-300",     "4e-324",     "nan",     "inf",        "0.5",
    "65536",   "1e10", "1e19",  "true",    "2147483648", "4294967296", "\"\"",    "\"x\"",      "\"\\\\\"",
    "\"\\n\"", "[]",   "[1.0]", "[1e300]", "{}",         "1979-05-27", "\"a b\"", "\"\\u0001\""};

/// One value in place of another, a line twice, or a line less.
void change(std::string& text, std::minstd_rand& random) {
  const auto words = words_of(text);
  if (words.empty()) return;
  const auto [begin, length] = words[random() % words.size()];
  const std::size_t line = text.rfind('\n', begin) + 1;
  const std::string whole = text.substr(line, text.find('\n', begin) - line) + '\n';
  const auto [from, count] = words[random() % words.size()];
  switch (random() % 8) {
    case 0:
      text.insert(line, whole);
      return;
    case 1:
      text.erase(line, whole.size());
      return;
    case 2:
    case 3:
      text.replace(begin, length, text.substr(from, count));
      return;
    default:
      text.replace(begin, length, kValues[random() % std::size(kValues)]);
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Half of the time bytes, half of the time values and lines: what bytes seldom make of a text.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  random.discard(1 + seed % 8);
  if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  std::string text(reinterpret_cast<const char*>(data), size);
  for (std::size_t times = 1 + random() % 2; times > 0; --times) change(text, random);
  text.resize(std::min(text.size(), most));
  std::copy(text.begin(), text.end(), data);
  return text.empty() ? LLVMFuzzerMutate(data, 0, most) : text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const char* const given = std::getenv("ECS_FUZZ_READER");
  static const auto parser = std::find_if(parsers().begin(), parsers().end(),
                                          [](const Parser& one) { return given != nullptr && one.id == given; });
  check(parser != parsers().end());
  parser->run(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
