// `ecs log instrument`: the instrument that measures, from its own calibration certificate or a file of ours.
#include "commissioning/logbook/instrument.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "commissioning/certificate/xml.hpp"

namespace ecs::app {
namespace {

struct InstrumentArguments : VerbArguments {
  const std::string& file =
      text("FILE", "its Digital Calibration Certificate (.xml), or an instrument file (.toml); none: show it");
  const bool& use = flag("--use", "keep it as the instrument in use: entries of measurements name it from then on");
  const int& interval =
      integer("--interval-days", "from one calibration to the next; 0: as the file says", 0, 0, 36'500);
  const bool& force = flag("--force", "replace the instrument in use");
};

Result<Instrument> read_instrument(const std::string& file) {
  ECS_TRY(content, read_file(file));
  return trimmed(content).starts_with('<') ? instrument_in_dcc(content, file) : parse_instrument(content, file);
}

Result<Outcome> instrument(VerbContext&, const InstrumentArguments& arguments) {
  const std::string in_use = instrument_file();
  if (arguments.file.empty() && arguments.use) return problem(ProblemKind::usage, "--use: give the file");
  ECS_TRY(found, read_instrument(arguments.file.empty() ? in_use : arguments.file));
  if (arguments.interval > 0) found.calibration_interval_days = arguments.interval;
  if (arguments.use) {
    ECS_DO(spared({in_use}, arguments.force, {arguments.file}));
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(in_use).parent_path(), error);
    ECS_DO(write_file(in_use, to_toml(found)));
  }
  const Json object = Json::parse(instrument_json(found, now_utc()), nullptr, false);
  std::string text;
  if (object.is_object())
    for (const auto& [key, value] : object.items())
      if (!value.is_null())
        text += fmt::format("{:<26} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  if (arguments.use) text += fmt::format("kept in {}\n", in_use);
  return outcome_of({Json{{"instrument", object}, {"file", arguments.use ? Json(in_use) : Json(nullptr)}}, text});
}

}  // namespace

extern const VerbDefinition kLogInstrument = verb<InstrumentArguments>(
    "log instrument", "the measuring instrument and its calibration, from its own certificate",
    "ecs log instrument laser-certificate.xml --use --interval-days 365", instrument);

}  // namespace ecs::app
