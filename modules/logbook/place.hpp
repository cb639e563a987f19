// Which file is the logbook of a machine, and whether one is kept at all. What files say of whose they are and what
// measured: the header of a measured file or a map; the measuring instrument of an entry with the certificate that
// covers it, with the names that OPC 40210 gives to the calibration of a measuring device.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

/// $ECS_LOGBOOK, else `logbook` in the settings: "off"; a file *.ecslog, which then takes every entry; a folder with a
/// logbook for each machine. Without either the folder `logbooks` of the state folder.
struct LogbookSetting {
  bool off = false;
  std::filesystem::path file;    ///< empty: one for each machine
  std::filesystem::path folder;  ///< empty: off, or `file`
};
[[nodiscard]] Result<LogbookSetting> logbook_setting();

/// The logbook of that machine, or where it would begin: named after machine, and after serial number too where another
/// machine has that name. Nothing where the folder is wanted and nothing names the machine.
[[nodiscard]] Result<std::optional<std::filesystem::path>> logbook_of(const LogbookSetting& setting,
                                                                      const LogOwner& owner);

/// Every logbook of the setting, the one written last first.
[[nodiscard]] std::vector<std::filesystem::path> logbooks(const LogbookSetting& setting);

/// $ECS_OPERATOR, else `operator` in the settings, else the login name.
[[nodiscard]] std::string operator_name();

/// Whose file it is, by what it says: a machine file, parameters, a measurement file, a map. Empty: it does not say.
[[nodiscard]] LogOwner owner_in(std::string_view content);

struct HeaderLine {
  std::string key;         ///< in lower case
  std::string_view value;  ///< without blanks around it
};

/// As far as lines begin with #; those without a colon are left out. Views into `content`.
[[nodiscard]] std::vector<HeaderLine> header_lines(std::string_view content);

struct Instrument {
  std::string name;
  std::string manufacturer;
  std::string serial_number;
  std::string calibration_certificate;  ///< number of the certificate
  std::string calibration_date;         ///< ISO 8601
  std::optional<int> calibration_interval_days;
  std::string valid_until;  ///< ISO 8601; empty: date and interval give it, or it is unknown
  friend bool operator==(const Instrument&, const Instrument&) = default;
};

/// Empty where nothing is known.
[[nodiscard]] bool is_known(const Instrument& instrument);

/// Stated, else date plus interval; empty: unknown.
[[nodiscard]] std::string valid_until(const Instrument& instrument);
/// Whether a certificate covers it on that day; nothing: it does not say.
[[nodiscard]] std::optional<bool> calibrated_on(const Instrument& instrument, const std::string& day);

/// A JSON object {"name", "serial_number", "calibrated", "calibration_date", …}, empty text where nothing is known.
[[nodiscard]] std::string instrument_json(const Instrument& instrument, const std::string& day);
[[nodiscard]] Instrument instrument_in_json(std::string_view json);

/// From the header of a measurement file, `# instrument: …`, `# instrument_serial_number: …`, `# calibration_date: …`.
[[nodiscard]] Instrument instrument_in_header(std::string_view content);

/// The instrument in use: `$ECS_INSTRUMENT`, else `instrument` in the settings, names its file, else instrument.toml
/// beside the settings. Nothing where there is no such file.
[[nodiscard]] std::string instrument_file();
[[nodiscard]] Result<std::optional<Instrument>> instrument_in_use();
[[nodiscard]] std::string to_toml(const Instrument& instrument);
[[nodiscard]] Result<Instrument> parse_instrument(std::string_view text, const std::string& file);

}  // namespace ecs::commissioning
