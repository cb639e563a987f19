#include "app/verbs/laser/import_arguments.hpp"

#include <fmt/format.h>

namespace ecs::app {

void take_import_options(Verb& verb, ImportArguments& arguments) {
  verb.choice("--axis", arguments.axis, {"X", "Y", "Z"}, "the axis that was moved, where the file does not say")
      .choice("--sense", arguments.sense, {"EX", "EY", "EZ", "EA", "EB", "EC"}, "what was measured, if not in the file")
      .text("--parked", arguments.parked, "where the other axes stood, as in y=-1400,z=0 [mm]")
      .choice("--encoding", arguments.encoding, {"UTF-8", "Windows-1252", "GBK", "ISO-8859-1", "Shift-JIS", "UTF-16"},
              "code page; by itself if not given")
      .flag("--accept-truncated", arguments.accept_truncated, "take what is left of a file that ends too early")
      .flag("--table-holds-errors", arguments.table_holds_errors, "a .REN table holds errors, not compensation")
      .text("--target-unit", arguments.target_unit, "unit of the targets where it is not the usual one, as in in")
      .text("--reading-unit", arguments.reading_unit,
            "unit of the readings where it is not the usual one, as in um, arcsec")
      .text("--channel", arguments.channel, "the channel of a log that holds several")
      .text("--columns", arguments.columns,
            "read a table: FIELD=COLUMN[unit]*factor, as in x_mm=1[in],reading=3*0.001,run=2,approach=4")
      .integer("--skip", arguments.skip, "lines before the table", 0, 1'000'000)
      .integer("--rows", arguments.rows, "rows of the table to take; 0: all", 0, 1'000'000)
      .text("--delimiter", arguments.delimiter,
            "one character, or blank, tab, comma, semicolon; by itself if not given")
      .choice("--decimal", arguments.decimal, {"point", "comma"}, "decimal sign of the table; both if not given")
      .choice("--values", arguments.values, {"error", "actual", "compensation"},
              "what the readings of the table are; error if not given")
      .text("--profile", arguments.profile, "import options saved under this name, or a path");
}

Result<laser::Imported> read_with_notes(VerbContext& context, const std::string& file,
                                        const ImportArguments& arguments) {
  auto imported = read_measurements(file, arguments);
  if (!imported) return imported;
  context.console.note(fmt::format("{}: {}", file, imported->format->title));
  for (const std::string& note : imported->set.notes) context.console.note(fmt::format("{}: {}", file, note));
  return imported;
}

}  // namespace ecs::app
