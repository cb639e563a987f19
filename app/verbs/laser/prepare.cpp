// `ecs laser prepare`: one measured line as a file of its own, without what is left out.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/prepared_lines.hpp"
#include "commissioning/measurements/fields.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

struct PrepareArguments : VerbArguments {
  const std::vector<std::string>& files = texts("FILE", "files that measured the line; joined", Need::required);
  const std::string& line = text("--line", "which line, where they hold several: \"EX along X at Y -1400, Z 0\"");
  const std::string& place =
      text("--place", "where the other axes stood, where the files state it wrongly: y=-1400,z=0");
  const std::vector<std::string>& runs = texts("--leave-out-run", "a run to leave out, with the reason: 3=vibration");
  const std::vector<std::string>& readings =
      texts("--leave-out-reading", "a reading of the line to leave out, from 1: \"17=beam broken\"");
  const std::string& output = output_file("-o,--output", "measurement CSV to write", Need::required);
  ImportOptions import{*this};
};

/// "3=vibration", "3".
struct LeftOut {
  int number = 0;
  std::string reason;
};
Result<LeftOut> left_out_in(const std::string& word, const char* option) {
  const std::size_t equals = word.find('=');
  const auto number = integer_in(word.substr(0, equals));
  if (!number || *number < 1 || *number > 1'000'000'000)
    return problem(ProblemKind::usage,
                   fmt::format("{}: expected a number from 1, or number=reason; found \"{}\"", option, word));
  return LeftOut{static_cast<int>(*number), equals == std::string::npos ? std::string() : word.substr(equals + 1)};
}

Result<Outcome> prepare(VerbContext&, const PrepareArguments& arguments) {
  ECS_DO(check_output_not_input(arguments.output, arguments.files));
  commissioning::PreparedLineRequest request{arguments.files, arguments.import, arguments.line, arguments.place, {}};
  for (const std::string& word : arguments.runs) {
    ECS_TRY(run, left_out_in(word, "--leave-out-run"));
    request.left_out.runs[run.number] = run.reason;
  }
  for (const std::string& word : arguments.readings) {
    ECS_TRY(reading, left_out_in(word, "--leave-out-reading"));
    request.left_out.readings[static_cast<std::size_t>(reading.number) - 1] = reading.reason;
  }
  ECS_TRY(set, commissioning::prepared_line(request));
  ECS_DO(laser::write_measurement_set(arguments.output, set));
  AnswerFields fields{{"output", word_cell(arguments.output)},
                      {"count", shown_cell(fmt::format("{}", set.readings.size()))}};
  append(fields, set_fields(set));
  return outcome_of(record_cell("{lines}{count} readings written to {output}", fields));
}

}  // namespace

extern const VerbDefinition kLaserPrepare = verb<PrepareArguments>(
    "laser prepare", "a measured line as a file of its own: joined, corrected, without what is left out",
    "ecs laser prepare EXX.csv --line \"EX along X at Y -1400, Z 0\" --leave-out-run 3=vibration -o exx_line.csv",
    prepare);

}  // namespace ecs::app
