// Tables of controls (tests/fuzz/import_fuzz.cpp says how).

#include "laser/map/csv.hpp"
#include "modules/controllers/format.hpp"
#include "tests/fuzz/parsers.hpp"

namespace {

using namespace ecs;
using namespace ecs::controllers;
using namespace ecs::fuzz;
using namespace ecs::laser;

/// Tables that were read make a map, and that map can be written and read again.
void use(const Result<ControllerTables>& tables) {
  if (!was_read(tables, false)) return;
  std::size_t points = 0;
  for (const MapTable& table : tables->tables) {
    points += table.position_mm.size();
    check(!table.position_mm.empty() && table.position_mm.size() == table.compensation.size());
    all_finite(table.compensation);
    all_finite(table.position_mm);
    check(std::is_sorted(table.position_mm.begin(), table.position_mm.end(), std::less_equal<>()));
  }
  if (points > 2000) return;
  const ReadMap read = map_of(*tables);
  all_finite(read.squareness);
  const auto again = parse_map_csv(to_map_csv(read.map), "map.csv");
  check(!again || again->tables.size() == read.map.tables.size());
}

/// The same choices for the options of whichever format: a word of each, or none.
const AddedReader kTables{[](std::string_view id, std::uint8_t choice, std::string_view bytes) {
  const ControllerFormat* const format = controller_format(id);
  if (format == nullptr) return false;
  OptionValues values(format->read_options);
  values.set("axis", "X");
  values.set("counts-per-mm", "1000");
  const std::size_t word = (choice & 1u) + ((choice & 16u) != 0 ? 2u : 0u);
  for (const FormatOption& option : format->read_options) {
    if (!option.words.empty() && word > 0)
      values.set(option.name, std::string(option.words[word % option.words.size()]));
    if (option.is_flag && (choice & 8u) != 0) values.set(option.name, "1");
  }
  use(format->read({"fuzz", bytes, bytes, true, values}));
  return true;
}};

}  // namespace
