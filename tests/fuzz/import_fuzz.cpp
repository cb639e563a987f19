// libFuzzer over every reader of measurement files and maps, and those that modules add: whatever the bytes are, a
// Result comes back, and what was read is finite. ECS_FUZZ_READER in the environment is the id of a format, "any",
// "map" or of a module's reader. The seeds of each are in corpus/<id>.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "laser/analysis/iso230.hpp"
#include "laser/analysis/process.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/map/csv.hpp"
#include "laser/writers/writers.hpp"
#include "tests/fuzz/parsers.hpp"

namespace {

using namespace ecs;
using namespace ecs::laser;

/// The first byte chooses options; the rest is the file.
ImportOptions options_of(std::uint8_t choice) {
  constexpr Sense kSenses[] = {Sense::EX, Sense::EY, Sense::EB};
  ImportOptions options;
  if ((choice & 1u) != 0) options.axis = Axis::X;
  if ((choice & 6u) != 0) options.sense = kSenses[((choice >> 1u) & 3u) - 1];
  options.accept_truncated = (choice & 8u) != 0;
  options.table_holds_errors = (choice & 16u) != 0;
  if ((choice & 32u) != 0) options.target_unit = unit_named("in");
  if ((choice & 64u) != 0) options.reading_unit = unit_named("arcsec");
  if ((choice & 96u) == 96u) options.encoding = Encoding::gbk;
  options.spread_environment = (choice & 128u) == 0;
  options.most_samples = 1000;
  return options;
}

/// What may follow reading; a curve may be refused, never harm.
void use(const MeasurementSet& set) {
  for (const Reading& reading : set.readings) {
    fuzz::check_finite(reading.error);
    fuzz::all_finite(reading.position_mm);
  }
  if (set.readings.size() > 2000) return;
  const auto groups = groups_of(set);
  if (groups.size() > 50) return;
  for (const Group& group : groups) {
    static_cast<void>(iso230_of(set, group));
    const auto curve = averaged(set, group);
    if (!curve) continue;
    Smoothing five;
    five.window_points = 5;
    static_cast<void>(smoothed(*curve, five));
    static_cast<void>(levelled(*curve, SlopeMethod::least_squares));
    static_cast<void>(zeroed_at(*curve, 0.0));
    static_cast<void>(squareness_of(*curve));
    static_cast<void>(rotation_from(*curve, *curve));
  }
  if (!set.readings.empty()) static_cast<void>(to_csv(set));
}

/// One message, and of very many faults the first.
void use(const Problem& problem) { fuzz::check(!problem.message.empty() && problem.also.size() <= 20); }

void any(std::string_view bytes, const ImportOptions& options) {
  const auto imported = parse_any(bytes, "fuzz", options);
  imported ? use(imported->set) : use(imported.error());
}

/// The layout is the first line, the matrix below.
void mapped_matrix(std::string_view bytes, const ImportOptions& options) {
  const std::size_t end = bytes.find('\n');
  const auto axes = matrix_axes(bytes.substr(0, end));
  if (!axes || end == std::string_view::npos) return;
  ImportOptions mapped = options;
  mapped.matrix = MatrixLayout{*axes, options.axis ? "[" : "", options.accept_truncated ? "#*#" : "", "0", ','};
  any(bytes.substr(end + 1), mapped);
}

void file(const FileFormat& format, std::string_view bytes, const ImportOptions& options) {
  if (format.read_environment) {
    static_cast<void>(format.read_environment(bytes, "fuzz"));
    return;
  }
  const auto set = format.read(bytes, "fuzz", options);
  set ? use(*set) : use(set.error());
}

/// The mapping is the first line, the table below: of numbers, or of a log's channels with lines that state targets.
void mapped_columns(std::string_view bytes, const ImportOptions& options) {
  const std::size_t end = bytes.find('\n');
  const auto mapping = column_mapping(bytes.substr(0, end));
  if (!mapping || end == std::string_view::npos) return;
  ImportOptions mapped = options;
  mapped.mapping = *mapping;
  if (!options.spread_environment) {
    mapped.mapping->row_begins = cell_kinds("word date time any").value();
    mapped.mapping->channel_column = 1;
    mapped.mapping->target_lines = unit_named("mm");
  }
  mapped.mapping->values = static_cast<TableValues>(options.table_holds_errors ? 1 : options.accept_truncated ? 2 : 0);
  any(bytes.substr(end + 1), mapped);
}

/// A map that was read is written and read again as the same tables.
void map(std::string_view bytes) {
  const auto read = parse_map_csv(bytes, "map.csv");
  if (!read) return use(read.error());
  const auto again = parse_map_csv(to_map_csv(*read), "map.csv");
  fuzz::check(again && again->tables == read->tables);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const ImportOptions options = options_of(data[0]);
  static const char* const given = std::getenv("ECS_FUZZ_READER");
  static const std::string_view kReader = given == nullptr ? "" : given;
  if (kReader == "any")
    any(bytes, options);
  else if (kReader == "map")
    map(bytes);
  else if (kReader == "mapped_matrix")
    mapped_matrix(bytes, options);
  else if (kReader == "mapped_columns")
    mapped_columns(bytes, options);
  else if (const FileFormat* format = file_format(kReader))
    file(*format, bytes, options);
  else
    fuzz::check(std::any_of(fuzz::readers().begin(), fuzz::readers().end(),
                            [&](fuzz::Reader read) { return read(kReader, data[0], bytes); }));
  return 0;
}
