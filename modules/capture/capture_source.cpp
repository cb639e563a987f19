#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/capture/capture.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {
namespace {

constexpr int kUsualRuns = 3;

tl::unexpected<Problem> wrong_usage(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

/// One row of a plan, as far as it says how to measure; the workshop and the table read the same file.
class PlanRow {
 public:
  explicit PlanRow(const std::string& file) : reader_(file) {}

  Result<devices::CapturePlan> read(std::string_view text, const std::string& name, devices::CaptureLine& line) {
    ECS_TRY(table, reader_.parsed(text));
    const auto rows = reader_.children(table, "measure");
    std::string names;
    for (const toml::table* row : rows) {
      const std::string its_name = reader_.word(*row, "name").value_or("");
      names += (names.empty() ? "" : ", ") + its_name;
      if (its_name != name) continue;
      take(table, *row, line);
      if (!reader_.clean()) return tl::unexpected(reader_.all());
      devices::CapturePlan plan;
      plan.metadata = {{"measurement", its_name}};
      if (const auto title = reader_.word(*row, "title")) plan.metadata.push_back({"title", *title});
      if (const auto of = reader_.word(table, "name")) plan.metadata.push_back({"plan", *of});
      return plan;
    }
    return wrong_usage(
        fmt::format("--row: {} contains no measurement \"{}\"; it has: {}", reader_.file(), name, names));
  }

 private:
  void take(const toml::table& all, const toml::table& row, devices::CaptureLine& line) {
    const std::string axis = reader_.word(row, "axis").value_or("");
    const std::string sense = reader_.word(row, "sense").value_or("");
    const auto moved = axis.size() == 1 ? axis_of(axis[0]) : std::nullopt;
    const auto read = sense_named(sense);
    if (!moved) reader_.complain(row, "axis: expected X, Y or Z, found \"{}\"", axis);
    if (!read) reader_.complain(row, "sense: expected EX EY EZ EA EB or EC, found \"{}\"", sense);
    line.axis = moved.value_or(Axis::X);
    line.sense = read.value_or(Sense::EX);
    line.from_mm = needed(row, "from_mm");
    line.to_mm = needed(row, "to_mm");
    line.step_mm = needed(row, "step_mm");
    line.feed_mm_min = reader_.number(all, "feed_mm_min");
    if (const auto runs = reader_.number(all, "runs"))
      line.runs = static_cast<int>(std::clamp<double>(*runs, 1.0, kMostRuns));
    const toml::table* parked = reader_.child(row, "parked_mm");
    for (const Axis other : kAllAxes) {
      const std::string key(1, static_cast<char>(letter_of(other) - 'X' + 'x'));
      if (parked != nullptr) line.parked_mm[index_of(other)] = reader_.number(*parked, key).value_or(0.0);
    }
  }
  double needed(const toml::table& row, std::string_view key) {
    const auto value = reader_.number(row, key);
    if (!value && !row.contains(key)) reader_.complain(row, "{} is missing", key);
    return value.value_or(0.0);
  }

  TomlReader reader_;
};

/// What the command line says wins over the plan's row.
Result<void> override_line(const CaptureTargets& arguments, devices::CaptureLine& line) {
  ImportArguments words;
  words.axis = arguments.axis;
  words.sense = arguments.sense;
  words.parked = arguments.parked;
  ECS_TRY(given, import_options(words));
  if (given.axis) line.axis = *given.axis;
  if (given.sense) line.sense = *given.sense;
  if (!arguments.parked.empty()) line.parked_mm = given.parked_mm;
  if (arguments.from_mm) line.from_mm = *arguments.from_mm;
  if (arguments.to_mm) line.to_mm = *arguments.to_mm;
  if (arguments.step_mm) line.step_mm = *arguments.step_mm;
  if (arguments.runs > 0) line.runs = arguments.runs;
  if (arguments.feed_mm_min) line.feed_mm_min = arguments.feed_mm_min;
  line.moved = arguments.moved;
  line.one_way = arguments.one_way;
  return {};
}

std::string lacking(const CaptureTargets& arguments) {
  std::string names;
  const auto need = [&names](bool given, const char* name) {
    if (!given) names += std::string(names.empty() ? "" : ", ") + name;
  };
  need(!arguments.axis.empty(), "--axis");
  need(!arguments.sense.empty(), "--sense");
  need(arguments.from_mm.has_value(), "--from");
  need(arguments.to_mm.has_value(), "--to");
  need(arguments.step_mm.has_value(), "--step");
  return names;
}

Result<devices::CapturePlan> plan_of_list(const CaptureTargets& arguments) {
  if (arguments.from_mm || arguments.to_mm || arguments.step_mm || arguments.runs > 0 || !arguments.plan.empty())
    return wrong_usage("--targets gives the whole list: omit --plan, --from, --to, --step and --runs");
  ECS_TRY(targets, laser::read_measurement_set(arguments.targets));
  ECS_TRY(stops, devices::stops_of_targets(targets));
  devices::CapturePlan plan{{{"targets", arguments.targets}}, std::move(stops)};
  for (const laser::MetadataEntry& entry : targets.metadata)
    if (entry.key != "content") plan.metadata.push_back(entry);
  return plan;
}

Result<devices::CapturePlan> plan_of_line(const CaptureTargets& arguments) {
  devices::CaptureLine line;
  line.runs = kUsualRuns;
  devices::CapturePlan plan;
  if (!arguments.plan.empty()) {
    if (arguments.row.empty()) return wrong_usage("--plan needs --row NAME to choose one of its measurements");
    ECS_TRY(text, read_file(arguments.plan));
    ECS_TRY(read, PlanRow(arguments.plan).read(text, arguments.row, line));
    plan = std::move(read);
  } else if (const std::string names = lacking(arguments); !names.empty()) {
    return wrong_usage(
        fmt::format("measurement not specified. Missing: {}; or give --plan PLAN.toml --row NAME, or --targets "
                    "FILE.csv, or --resume FILE.part",
                    names));
  }
  ECS_DO(override_line(arguments, line));
  ECS_TRY(stops, devices::stops_of(line));
  plan.stops = std::move(stops);
  return plan;
}

}  // namespace

cli::Fields<CaptureTargets> CaptureTargets::fields() {
  using A = CaptureTargets;
  using cli::Words;
  return {{"--axis", &A::axis, "moving axis", Words{"X", "Y", "Z"}},
          {"--sense", &A::sense, "measured component", Words{"EX", "EY", "EZ", "EA", "EB", "EC"}},
          {"--from", &A::from_mm, "first target [mm]"},
          {"--to", &A::to_mm, "last target [mm]"},
          {"--step", &A::step_mm, "step between targets [mm]"},
          {"--moved", &A::moved,
           "space the targets unequally, as ISO 230-2 requires, so that no periodic error is hidden by equal steps"},
          {"--runs", &A::runs, "number of passes forward and back; 0: as in --plan, or 3 (ISO 230-2 requires 5)",
           cli::Range{0, kMostRuns}},
          {"--one-way", &A::one_way, "record no readings on the way back"},
          {"--parked", &A::parked, "positions of the other axes, as in y=-1400,z=0 [mm]"},
          {"--feed", &A::feed_mm_min, "feed between the targets [mm/min], recorded with the data"},
          {"--targets", &A::targets, "target list (CSV) written by `ecs model next --targets`"},
          {"--plan", &A::plan, "plan file with [[measure]] tables, as for `laser table`"},
          {"--row", &A::row, "name of the [[measure]] table in --plan"},
          {"--machine", &A::machine, "machine file; its name is recorded with the data"},
          {"--compensated", &A::compensated,
           "whether the unit compensates during the measurement; recorded with the data", Words{"yes", "no"}},
          {"--note", &A::notes, "KEY=VALUE to record with the data, as in operator=AB; may be repeated"}};
}

Result<devices::CapturePlan> capture_plan(const CaptureTargets& arguments) {
  auto plan = arguments.targets.empty() ? plan_of_line(arguments) : plan_of_list(arguments);
  if (!plan) return plan;
  std::vector<laser::MetadataEntry> first;
  if (!arguments.machine.empty()) {
    ECS_TRY(machine, params::read_machine(arguments.machine));
    first.push_back({"machine", machine.machine.name});
  }
  for (const std::string& note : arguments.notes) {
    const std::size_t equals = note.find('=');
    const std::string key(trimmed(std::string_view(note).substr(0, equals)));
    if (equals == std::string::npos || key.empty() || key.find(':') != std::string::npos || key.starts_with("capture"))
      return wrong_usage(fmt::format("--note: expected KEY=VALUE, as in operator=AB, got \"{}\"", note));
    first.push_back({key, std::string(trimmed(std::string_view(note).substr(equals + 1)))});
  }
  plan->metadata.insert(plan->metadata.begin(), first.begin(), first.end());
  if (!arguments.compensated.empty())
    for (laser::Reading& stop : plan->stops) stop.compensated = arguments.compensated == "yes";
  return plan;
}

namespace {

constexpr double kPatience_s = 2.0;  ///< for a line that a trigger asks for and that is not there yet
constexpr double kAnyAge_s = 1e12;

class GaugeSource final : public ReadingSource {
 public:
  explicit GaugeSource(devices::DevicePort port) : sensor_(std::move(port), 1e9) {}

  void ask(double now_s) override {
    before_ = sensor_.answers();
    give_up_s_ = now_s + sensor_.port().device().report.timeout_ms * 1e-3 + 0.1;
    sensor_.ask_now();
    sensor_.attend(now_s);
  }
  Shown shown(double now_s) override {
    if (!sensor_.port().present()) return {Shown::Kind::none, 0.0, "the gauge is unplugged"};
    sensor_.attend(now_s);
    if (!sensor_.polled() || sensor_.answers() > before_) {
      const devices::Values values = sensor_.values(now_s, kAnyAge_s);
      if (const auto found = values.find(devices::Quantity::reading_um); found != values.end())
        return {Shown::Kind::value, found->second, {}};
    }
    if (now_s < give_up_s_) return {};
    return {Shown::Kind::none, 0.0,
            "the gauge gives no value: check that it is switched on and that its description is right"};
  }
  void attend(double now_s) override {
    if (!sensor_.polled()) sensor_.attend(now_s);
  }
  devices::PortChange look(double now_s) override { return sensor_.look(now_s); }
  std::string hindrance() const override { return sensor_.port().hindrance(); }
  std::string name() const override { return name_of(sensor_.port()); }

 private:
  devices::Sensor sensor_;
  int before_ = 0;
  double give_up_s_ = 0.0;
};

class FileSource final : public ReadingSource {
 public:
  FileSource(std::string path, int descriptor, bool fifo, bool following)
      : path_(std::move(path)), descriptor_(descriptor), fifo_(fifo), following_(following) {}
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource() override { ::close(descriptor_); }

  void ask(double now_s) override { give_up_s_ = now_s + kPatience_s; }
  Shown shown(double now_s) override {
    attend(now_s);
    auto line = following_ ? last_ : next_line();
    if (!line && now_s < give_up_s_ && (fifo_ || following_)) return {};
    if (!line && !fifo_ && !following_)
      return {Shown::Kind::ended, 0.0, fmt::format("{} has no further reading", path_)};
    if (!line) return {Shown::Kind::late, 0.0, fmt::format("no reading from {} within {} s", path_, kPatience_s)};
    if (const auto number = last_number_in(*line)) return {Shown::Kind::value, *number, {}};
    return {Shown::Kind::none, 0.0, fmt::format("{}: expected a number, got \"{}\"", path_, *line)};
  }
  void attend(double) override {
    while (following_) {
      auto line = next_line();
      if (!line) return;
      last_ = std::move(line);
    }
  }
  std::size_t lines_read() const override { return fifo_ || following_ ? 0 : lines_; }
  bool leave_out(std::size_t lines) override {
    while (lines_ < lines)
      if (!next_line()) return false;
    return true;
  }
  std::string name() const override { return (following_ ? "display followed in " : "readings of ") + path_; }

 private:
  std::optional<std::string> next_line() {
    while (true) {
      const bool more = take_what_is_there();
      std::size_t end = buffer_.find('\n');
      if (end == std::string::npos) {
        if (more) continue;
        if (fifo_ || following_ || buffer_.empty()) return std::nullopt;  // a line in the making may yet grow
        end = buffer_.size();
      }
      const std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      const std::string text(trimmed(std::string_view(line).substr(0, line.find('#'))));
      if (text.empty()) continue;
      ++lines_;
      return text;
    }
  }
  bool take_what_is_there() {
    std::array<char, 4096> piece{};
    const ssize_t count = ::read(descriptor_, piece.data(), piece.size());
    if (count > 0) buffer_.append(piece.data(), static_cast<std::size_t>(count));
    return count > 0;
  }

  std::string path_;
  int descriptor_;
  bool fifo_;
  bool following_;
  std::string buffer_;
  std::size_t lines_ = 0;
  std::optional<std::string> last_;
  double give_up_s_ = 0.0;
};

class CommandSource final : public ReadingSource {
 public:
  explicit CommandSource(std::string command) : command_(std::move(command)) {}

  void ask(double) override {}
  Shown shown(double) override {
    FILE* pipe = ::popen(command_.c_str(), "re");
    if (pipe == nullptr) return {Shown::Kind::none, 0.0, fmt::format("{}: {}", command_, std::strerror(errno))};
    std::string text;
    std::array<char, 512> piece{};
    while (std::fgets(piece.data(), piece.size(), pipe) != nullptr && text.size() < 65536) text += piece.data();
    const int status = ::pclose(pipe);
    const auto number = last_number_in(text);
    if (status == 0 && number) return {Shown::Kind::value, *number, {}};
    return {Shown::Kind::none, 0.0,
            status != 0 ? fmt::format("{}: it failed (status {})", command_, status)
                        : fmt::format("{}: expected a number in its output, got \"{}\"", command_, trimmed(text))};
  }
  std::string name() const override { return "display: " + command_; }

 private:
  std::string command_;
};

Result<std::unique_ptr<ReadingSource>> source_of_file(const std::string& path, bool following) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  const bool fifo = kind == std::filesystem::file_type::fifo;
  // Opened for writing too, a FIFO does not end when one writer of several has gone.
  const int descriptor = ::open(path.c_str(), (fifo ? O_RDWR : O_RDONLY) | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 || kind == std::filesystem::file_type::directory) {
    const int why = descriptor < 0 ? errno : EISDIR;
    if (descriptor >= 0) ::close(descriptor);
    return problem_at(path, 0, 0, "the readings cannot be opened: {}", std::strerror(why));
  }
  return std::make_unique<FileSource>(path, descriptor, fifo, following);
}

}  // namespace

std::optional<double> last_number_in(std::string_view line) {
  std::optional<double> last;
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t begin = line.find_first_of("+-.0123456789", at);
    if (begin == std::string_view::npos) return last;
    const std::size_t end = line.find_first_not_of("+-.0123456789eE", begin);
    if (const auto number = number_in(line.substr(begin, end - begin))) last = number;
    at = end;
  }
  return last;
}

std::unique_ptr<ReadingSource> gauge_source(devices::DevicePort port) {
  return std::make_unique<GaugeSource>(std::move(port));
}
Result<std::unique_ptr<ReadingSource>> file_source(const std::string& path) { return source_of_file(path, false); }
Result<std::unique_ptr<ReadingSource>> following_source(const std::string& path) { return source_of_file(path, true); }
std::unique_ptr<ReadingSource> command_source(std::string command) {
  return std::make_unique<CommandSource>(std::move(command));
}

}  // namespace ecs::commissioning
