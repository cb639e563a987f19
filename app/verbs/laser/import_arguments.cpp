#include "app/verbs/laser/import_arguments.hpp"

#include <fmt/format.h>

namespace ecs::app {

void take_import_options(Verb& verb, ImportArguments& arguments, const std::string& sense_option) {
  verb.choice("--axis", arguments.axis, {"X", "Y", "Z", "A", "B", "C"},
              "the axis that was moved, where the file does not say")
      .choice(sense_option, arguments.sense, {"EX", "EY", "EZ", "EA", "EB", "EC"},
              "what was measured, if not in the file")
      .text("--parked", arguments.parked, "where the other axes stood, as in y=-1400,z=0 [mm]")
      .text("--columns", arguments.columns,
            "read a table: FIELD=COLUMN[unit]*factor, as in x_mm=1[in],reading=3*0.001,run=2,approach=4")
      .text("--profile", arguments.profile, "import options saved under this name, or a path");
  verb.group("More about a measurement file")
      .choice("--encoding", arguments.encoding, {"UTF-8", "Windows-1252", "GBK", "ISO-8859-1", "Shift-JIS", "UTF-16"},
              "code page; by itself if not given")
      .text("--target-unit", arguments.target_unit,
            "unit of the targets where it is not the usual one, as in in, arcsec")
      .text("--reading-unit", arguments.reading_unit,
            "unit of the readings where it is not the usual one, as in um, arcsec")
      .flag("--accept-truncated", arguments.accept_truncated, "take what is left of a file that ends too early")
      .flag("--table-holds-errors", arguments.table_holds_errors, "a .REN table holds errors, not compensation");
  verb.group("With --columns")
      .integer("--skip", arguments.skip, "lines before the table", 0, 1'000'000)
      .integer("--rows", arguments.rows, "rows of the table to take; 0: all", 0, 1'000'000)
      .text("--delimiter", arguments.delimiter,
            "one character, or blank, tab, comma, semicolon; by itself if not given")
      .choice("--decimal", arguments.decimal, {"point", "comma"}, "decimal sign of the table; both if not given")
      .choice("--values", arguments.values, {"error", "actual", "compensation"},
              "what the readings of the table are; error if not given")
      .flag("--keep-set-up", arguments.keep_set_up, "shift and rotation of measured_x_mm, ... stay in");
  verb.group("Of a log, and of a run with readings at rest")
      .text("--channel", arguments.channel, "the channel of a log that holds several")
      .text("--channels", arguments.channels, "several channels joined by time, as in x_mm=ENC[mm],reading=AI1[um]")
      .choice("--join", arguments.join, {"linear", "nearest", "previous"},
              "how channels meet in time; linear if not given")
      .number("--max-gap", arguments.max_gap_s, "the greatest gap [s] over which they are joined; 5 usual intervals")
      .number("--at-rest", arguments.at_rest_mm, "only rows whose position stays within this [mm]")
      .flag("--average", arguments.average, "readings at rest become one, their mean")
      .text("--environment", arguments.environment, "air and temperatures over time: .pos, or a table with headings")
      .number("--environment-every", arguments.environment_every_s, "between its rows, where it has no time [s]")
      .group({});
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
