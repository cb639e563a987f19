#include "laser/import/import.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {
namespace {

Result<Imported> wrapped(FileFormat format, Result<MeasurementSet> set) {
  if (!set) return tl::unexpected(std::move(set.error()));
  return Imported{format, std::move(*set), {}};
}

Result<Imported> environment_of(std::string_view text, const std::string& file_name) {
  auto records = parse_sios_environment(text, file_name);
  if (!records) return tl::unexpected(std::move(records.error()));
  Imported imported{FileFormat::sios_environment, {}, std::move(*records)};
  imported.set.source = file_name;
  return imported;
}

Result<Imported> parsed_text(FileFormat format, std::string_view text, const std::string& file_name,
                             const ImportOptions& options) {
  switch (format) {
    case FileFormat::renishaw_run:
      return wrapped(format, parse_renishaw_run(text, file_name, options));
    case FileFormat::renishaw_table:
      return wrapped(format, parse_renishaw_table(text, file_name, options));
    case FileFormat::api_pos:
      return wrapped(format, parse_api_pos(text, file_name, options));
    case FileFormat::iso230_assignments:
      return wrapped(format, parse_iso230_assignments(text, file_name, options));
    case FileFormat::sios_environment:
      return environment_of(text, file_name);
    case FileFormat::renishaw_dynamic:
      return wrapped(format, parse_renishaw_dynamic(text, file_name, options));
    case FileFormat::plate:
      return wrapped(format, parse_plate(text, file_name, options));
    case FileFormat::height_map:
      return wrapped(format, parse_height_map(text, file_name, options));
    case FileFormat::channel_log:
      return wrapped(format, parse_channel_log(text, file_name, options));
    case FileFormat::mapped_columns:
    case FileFormat::measurement_csv:
      break;
  }
  return wrapped(FileFormat::measurement_csv, parse_measurement_set(text, file_name));
}

/// The unit in which a reader took the errors of a file.
double usual_reading_factor(FileFormat format, Sense sense) {
  constexpr double kPerMrad = 1000.0;  // and um per mm
  if (is_rotation(sense)) return kPerMrad;
  return format == FileFormat::renishaw_run ? 1.0 : kPerMrad;
}

/// Other units than the file's usual ones.
Result<Imported> rescaled(Result<Imported> imported, const ImportOptions& options) {
  if (!imported || (!options.target_unit && !options.reading_unit)) return imported;
  const auto wrong = [&](std::string message) -> Result<Imported> {
    return tl::unexpected(Problem{ProblemKind::usage, std::move(message), imported->set.source, 0, 0, {}});
  };
  if (imported->format == FileFormat::measurement_csv || imported->format == FileFormat::sios_environment)
    return wrong(fmt::format("{}: its units are fixed", name_of(imported->format)));
  if (imported->format == FileFormat::iso230_assignments && options.reading_unit)
    return wrong("the file holds positions: give the unit of the targets, it is that of the readings too");
  if (options.target_unit && options.target_unit->kind != UnitKind::length)
    return wrong(fmt::format("{} is no unit of length", options.target_unit->name));
  for (Reading& reading : imported->set.readings) {
    if (options.target_unit) {
      reading.position_mm[index_of(reading.axis)] *= options.target_unit->factor;
      if (imported->format == FileFormat::iso230_assignments) reading.error *= options.target_unit->factor;
    }
    if (!options.reading_unit) continue;
    const bool angle = is_rotation(reading.sense);
    if (options.reading_unit->kind != (angle ? UnitKind::angle : UnitKind::length))
      return wrong(fmt::format("{} is no unit of {}", options.reading_unit->name, ecs::name_of(reading.sense)));
    const double inside = options.reading_unit->factor * (angle ? 1.0 : 1000.0);
    reading.error *= inside / usual_reading_factor(imported->format, reading.sense);
  }
  if (options.target_unit) imported->set.notes.push_back(fmt::format("targets taken as {}", options.target_unit->name));
  if (options.reading_unit)
    imported->set.notes.push_back(fmt::format("readings taken as {}", options.reading_unit->name));
  return imported;
}

}  // namespace

Result<Imported> parse_any(std::string_view bytes, const std::string& file_name, const ImportOptions& options) {
  if (!options.mapping && format_of(bytes, file_name) == FileFormat::renishaw_dynamic)
    return rescaled(parsed_text(FileFormat::renishaw_dynamic, bytes, file_name, options), options);
  const auto text = decoded(bytes, file_name, options.encoding);
  if (!text) return tl::unexpected(text.error());
  const auto format = options.mapping ? FileFormat::mapped_columns : format_of(text->text, file_name);
  if (!format) return problem_at(file_name, 0, 0, explanation_of(text->text));
  auto imported = format == FileFormat::mapped_columns
                      ? wrapped(*format, parse_columns(text->text, file_name, *options.mapping, options))
                      : rescaled(parsed_text(*format, text->text, file_name, options), options);
  if (imported && text->encoding != Encoding::utf8)
    imported->set.notes.push_back(fmt::format("not UTF-8: read as {}", name_of(text->encoding)));
  return imported;
}

Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_any(*bytes, path.string(), options);
}

Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name) {
  if (options.axis) return *options.axis;
  return tl::unexpected(Problem{
      ProblemKind::usage, "the file does not say which axis moved: give the axis X, Y or Z", file_name, 0, 0, {}});
}

Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name) {
  const Sense sense = options.sense.value_or(static_cast<Sense>(index_of(axis)));
  if (!is_rotation(sense)) return sense;
  return tl::unexpected(
      Problem{ProblemKind::usage,
              fmt::format("the file holds lengths: expected the sense EX, EY or EZ, found {}", ecs::name_of(sense)),
              file_name,
              0,
              0,
              {}});
}

Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm) {
  Vector3 position = options.parked_mm;
  position[index_of(axis)] = target_mm;
  return position;
}

void number_rows(MeasurementSet& set) {
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].row = static_cast<int>(i) + 1;
}

}  // namespace ecs::laser
