// [[artefact]] of the errors file: what squares and straight edges have of their own (docs/emulator.md).
#include <fmt/format.h>

#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

bool gives_form(const toml::table& table) {
  return table.contains("formula") || table.contains("points") || table.contains("csv");
}

void read_artefact(ErrorsReading& reading, const toml::table& table) {
  TomlReader& reader = reading.reader;
  reader.only(table, {"axis", "sense", "angle_um_per_m", "formula", "points", "csv"}, "artefact");
  const std::string axis_word = reader.word(table, "axis").value_or(""),
                    sense_word = reader.word(table, "sense").value_or("");
  const auto axis = axis_word.size() == 1 ? axis_of(axis_word.front()) : std::nullopt;
  const auto sense = sense_named(sense_word);
  if (!axis) return reader.complain(table, fmt::format("artefact: axis: expected X, Y or Z, got \"{}\"", axis_word));
  if (!sense || is_rotation(*sense) || direction_of(*sense) == *axis)
    return reader.complain(table, fmt::format("artefact: sense: expected EX, EY or EZ other than along {}, got \"{}\"",
                                              letter_of(*axis), sense_word));
  if (!gives_form(table) && !table.contains("angle_um_per_m"))
    return reader.complain(table, "artefact: expected angle_um_per_m, or a form by formula, points or csv");
  Artefact artefact{*axis, *sense, reader.number(table, "angle_um_per_m").value_or(0.0), std::nullopt,
                    static_cast<int>(table.source().begin.line)};
  if (gives_form(table)) {
    artefact.form = curve_in(reading, table, "artefact");
    if (!artefact.form) return;
  }
  demand(reading, table, "artefact", *axis);
  reading.parts.artefacts.push_back(std::move(artefact));
}

}  // namespace

void read_artefacts(ErrorsReading& reading) {
  for (const toml::table* table : reading.reader.children(reading.file, "artefact")) read_artefact(reading, *table);
}

}  // namespace ecs::emulator
