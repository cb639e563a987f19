#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "base/words.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/writers/writers.hpp"
#include "modules/logbook/certificate.hpp"
#include "modules/logbook/recorder.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kDay = 10;  // of "2026-05-04T09:30:00Z"

/// A quantity of ISO 230-2, and its name where the line is none of positioning: the formulas are the same.
struct StatedValue {
  const char* key;  ///< in the answer of `laser stats`
  const char* positioning;
  const char* other;  ///< behind it: ", straightness of …"
};
constexpr std::array<StatedValue, 10> kValues{{
    {"A", "bidirectional accuracy of positioning A", "range with twice the standard deviation on both sides"},
    {"A_forward", "accuracy of positioning, forward", "range with twice the standard deviation, forward"},
    {"A_reverse", "accuracy of positioning, reverse", "range with twice the standard deviation, reverse"},
    {"E", "bidirectional systematic error of positioning E", "range of the means of both approaches"},
    {"E_forward", "systematic error of positioning, forward", "range of the means, forward"},
    {"E_reverse", "systematic error of positioning, reverse", "range of the means, reverse"},
    {"M", "mean bidirectional error of positioning M", "range of the mean of both approaches"},
    {"R", "bidirectional repeatability of positioning R", "repeatability of both approaches"},
    {"B", "reversal error B", "largest reversal"},
    {"B_mean", "mean reversal error", "mean reversal"},
}};

/// What a line is of: what its values are called, and what is taken off before.
enum class LineKind { positioning, rotation, straightness, square };

LineKind kind_of(const laser::Group& group, const std::string& file) {
  const auto named = component_of(std::filesystem::path(file).stem().string());
  const bool along = group.sense == static_cast<Sense>(index_of(group.axis) + (group.rotary ? kAxes : 0));
  if (along) return LineKind::positioning;
  if (is_rotation(group.sense)) return LineKind::rotation;
  if (!group.rotary && named && is_squareness(*named)) return LineKind::square;
  return LineKind::straightness;
}

constexpr WordTable<LineKind, 4> kNouns{
    {"positioning", "angular error motion", "straightness error motion", "straightness along the square"}};

CertifiedCurve curve_of(const Json& targets, const char* key, std::string name, const std::string& unit) {
  CertifiedCurve curve{std::move(name), unit, {}, {}};
  for (const Json& target : targets) {
    const auto position = number_at(target, "position_mm");
    const auto mean = number_at(target, key);
    if (!position || !mean) continue;
    curve.position_mm.push_back(*position);
    curve.value.push_back(*mean);
  }
  return curve;
}

/// "with the compensation active"; nothing is said where the file does not.
const char* state_of(const Json& line) {
  const Json compensated = line.contains("compensated") ? line["compensated"] : Json();
  if (!compensated.is_boolean()) return "compensation not stated";
  return compensated == true ? "with the compensation active" : "without compensation";
}

/// One line of a measurement file, what is taken off it and the answer of `laser stats` for what is left.
struct LineToCertify {  // NOLINT(bugprone-exception-escape): moves of nlohmann::json
  LineKind kind = LineKind::positioning;
  std::optional<laser::ProcessedReadings> levelled;  ///< where a slope was taken off
  std::optional<laser::Squareness> square;           ///< of a square alone
  Json answer;
};

CertifiedLine line_of(const LineToCertify& measured, const LogFile& file) {
  const Json& line = measured.answer;
  const LineKind kind = measured.kind;
  const bool positioning = kind == LineKind::positioning;
  CertifiedLine one;
  const std::string unit = dsi_unit(text_at(line, "unit"));
  const std::string file_name = std::filesystem::path(file.name).filename().string();
  one.name =
      fmt::format("{} ({} along {}), {}",
                  measured.square ? std::filesystem::path(file_name).stem().string() : text_at(line, "component"),
                  text_at(line, "sense"), text_at(line, "axis"), state_of(line));
  one.description = fmt::format("readings {}, SHA-256 {}", file_name, file.sha256);
  one.method = positioning ? "statistics of positioning" : fmt::format("statistics of a line: {}", kNouns.of(kind));
  one.norm = positioning ? "ISO 230-2:2014" : "ISO 230-1:2012";
  if (measured.levelled)
    one.description += fmt::format(". The slope of the set-up, {:.2f} um/m, was removed by least squares",
                                   measured.levelled->level.removed.slope_per_m);
  if (line.contains("notes") && line["notes"].is_array())
    for (const Json& note : line["notes"])
      if (note.is_string()) one.description += ". Note: " + note.get<std::string>();
  if (const std::string targets = text_at(line, "unit_of_targets"); !targets.empty())
    one.position_unit = dsi_unit(targets);
  if (measured.square)
    one.values.push_back({fmt::format("squareness {}, from the slope of the line; it includes the error of the square",
                                      std::filesystem::path(file_name).stem().string()),
                          "iso230-1_squareness",
                          measured.square->um_per_m,
                          dsi_unit("um/m"),
                          {}});
  // The contributions to the uncertainty are those of positioning.
  const Json uncertainty = positioning && line.contains("uncertainty") ? line["uncertainty"] : Json();
  for (const StatedValue& stated : kValues)
    if (const auto value = number_at(line, stated.key))
      one.values.push_back(
          positioning
              ? CertifiedValue{fmt::format("{} (ISO 230-2)", stated.positioning),
                               fmt::format("iso230-2_{}", stated.key), *value, unit, number_at(uncertainty, stated.key)}
              : CertifiedValue{fmt::format("{}: {} (formula of ISO 230-2)", kNouns.of(kind), stated.other),
                               fmt::format("iso230-1_{}", stated.key),
                               *value,
                               unit,
                               {}});
  if (line.contains("targets") && line["targets"].is_array())
    for (const auto& [key, name] :
         {std::pair("mean_forward", "mean error, forward"), std::pair("mean_reverse", "mean error, reverse")})
      if (CertifiedCurve curve = curve_of(line["targets"], key, name, unit); !curve.value.empty())
        one.curves.push_back(std::move(curve));
  return one;
}

/// When it was measured: `# date:` or `# begun:` of its header, else when it came into the logbook, which is said.
std::string day_of(const Logbook& book, const LogFile& file, const LogbookEntry& entry, Certificate& certificate) {
  const auto content = book.original(file.sha256);
  for (const std::string_view key : {"# date:", "# begun:"}) {
    const std::size_t at = content ? content->find(key) : std::string::npos;
    if (at == std::string::npos) continue;
    const std::size_t begin = at + key.size();
    const std::string date(trimmed(std::string_view(*content).substr(begin, content->find('\n', begin) - begin)));
    if (is_iso_date(date)) return date.substr(0, kDay);
  }
  certificate.remarks.push_back(fmt::format("{} states no date: the day of its logbook entry is used",
                                            std::filesystem::path(file.name).filename().string()));
  return entry.time.substr(0, kDay);
}

/// The measurement file of an entry: what an import wrote, else what was read.
std::optional<LogFile> set_of(const Logbook& book, const LogbookEntry& entry) {
  const auto files = files_of(entry);
  for (const char* role : {"output", "input"})
    for (const LogFile& file : files) {
      if (file.role != role || !file.kept) continue;
      const auto content = book.original(file.sha256);
      if (content && is_measurement_set(*content)) return file;
    }
  return std::nullopt;
}

/// `laser stats` of one line on its own.
Result<Json> stats_of(const std::string& name, const laser::MeasurementSet& set, const CertificateWishes& wishes,
                      const RunVerb& run) {
  KeptFiles kept("/");
  kept.put(name, laser::to_csv(set));
  std::vector<std::string> words{"laser", "stats", name};
  words.insert(words.end(), wishes.uncertainty.begin(), wishes.uncertainty.end());
  ECS_TRY(said, run(words));
  const Json answer = json_in(said);
  if (answer.is_object() && answer.contains("lines") && answer["lines"].is_array() && answer["lines"].size() == 1)
    return answer["lines"][0];
  return problem(ProblemKind::bad_input, "it contains no line of ISO 230-2");
}

/// A straightness is what its readings hold beside a straight line, which is how the laser was set up; of a square the
/// slope is the squareness.
Result<LineToCertify> measured_line(const std::string& name, const laser::MeasurementSet& set,
                                    const laser::Group& group, const CertificateWishes& wishes, const RunVerb& run) {
  LineToCertify line;
  line.kind = kind_of(group, name);
  const bool across = line.kind == LineKind::straightness || line.kind == LineKind::square;
  ECS_TRY(processed,
          laser::processed_readings(
              set, group, {across && !group.rotary ? laser::SlopeMethod::least_squares : laser::SlopeMethod::none}));
  ECS_TRY(answer, stats_of(name, processed.after, wishes, run));
  line.answer = std::move(answer);
  if (line.kind == LineKind::square)
    if (auto square = laser::squareness_of(processed.before_curve)) line.square = *square;
  if (across && !group.rotary) line.levelled = std::move(processed);
  return line;
}

/// Adds the lines of one set; what cannot be certified is said. @return whether there was one
bool add_lines(Certificate& certificate, const Logbook& book, const LogFile& file, const Instrument& instrument,
               const CertificateWishes& wishes, const RunVerb& run) {
  const std::string name = std::filesystem::path(file.name).filename().string();
  const auto refuse = [&](const std::string& why) {
    certificate.remarks.push_back(fmt::format("{} is not certified: {}", name, why));
  };
  const auto content = book.original(file.sha256);
  const auto set = content ? laser::parse_measurement_set(*content, name) : tl::unexpected(content.error());
  if (!set) {
    refuse(set.error().message);
    return false;
  }
  const std::size_t before = certificate.lines.size(), remarks = certificate.remarks.size();
  for (const laser::Group& group : laser::groups_of(*set)) {
    const auto line = measured_line(name, *set, group, wishes, run);
    if (!line) {
      refuse(line.error().message);
      continue;
    }
    CertifiedLine one = line_of(*line, file);
    one.instrument = instrument;
    if (!one.values.empty()) certificate.lines.push_back(std::move(one));
  }
  if (certificate.lines.size() > before) return true;
  if (certificate.remarks.size() == remarks) refuse("it contains no line of ISO 230-2");
  return false;
}

/// Of the machine, for an identifier.
std::string short_name(const LogOwner& owner) {
  std::string name = owner.serial_number.empty() ? owner.machine : owner.serial_number;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  return name.empty() ? "machine" : name;
}

Result<void> add_history(Certificate& certificate, const Logbook& book) {
  ECS_TRY(last, book.last_of("certificate"));
  if (last) {
    const Json content = json_in(last->content);
    if (content.is_object())
      certificate.previous = PreviousCertificate{text_at(content, "identifier"), text_at(content, "sha256")};
  }
  ECS_TRY(active, book.activations());
  if (!active.empty()) certificate.active_image = text_at(json_in(active.back().content), "image_sha256");
  return {};
}

}  // namespace

Result<Certificate> certificate_of(const Logbook& book, const CertificateWishes& wishes, const RunVerb& run,
                                   const std::string& now) {
  ECS_TRY(owner, book.owner());
  ECS_TRY(entries, book.entries());
  if (entries.empty()) return problem(ProblemKind::refused, "the logbook is empty: no measurement to certify");
  Certificate certificate;
  certificate.schema_version = wishes.schema_version;
  certificate.country = wishes.country;
  certificate.program = program_version_and_commit();
  certificate.machine = owner.machine;
  certificate.serial_number = owner.serial_number;
  certificate.laboratory = wishes.laboratory;
  certificate.city = wishes.city;
  certificate.customer = wishes.customer;
  certificate.person = wishes.person;
  certificate.to_be_signed = wishes.to_be_signed;
  certificate.logbook_hash = entries.back().hash;
  certificate.issue_date = now.substr(0, kDay);
  certificate.identifier =
      fmt::format("ECS-{}-{}-{}", short_name(owner), entries.back().number + 1, certificate.logbook_hash.substr(0, 8));
  ECS_DO(add_history(certificate, book));
  std::int64_t after = 0;
  for (const LogbookEntry& entry : entries)
    if (entry.kind == "certificate" && !wishes.all) after = entry.number;
  for (const LogbookEntry& entry : entries) {
    if (entry.kind != "measurement" || entry.number <= after) continue;
    const auto set = set_of(book, entry);
    if (!set || !add_lines(certificate, book, *set, instrument_in_json(entry.instrument), wishes, run)) continue;
    const std::string day = day_of(book, *set, entry, certificate);
    if (certificate.begin_date.empty() || day < certificate.begin_date) certificate.begin_date = day;
    certificate.end_date = std::max(certificate.end_date, day);
  }
  if (certificate.lines.empty()) {
    std::vector<Problem> why{{ProblemKind::refused,
                              after > 0
                                  ? "no measurement since the last certificate; --all certifies every measurement again"
                                  : "no measurement in the logbook can be certified",
                              {},
                              0,
                              0,
                              {}}};
    for (const std::string& remark : certificate.remarks) why.push_back({ProblemKind::refused, remark, {}, 0, 0, {}});
    return tl::unexpected(folded(std::move(why)));
  }
  if (wishes.uncertainty.empty())
    certificate.remarks.emplace_back(
        "No contributions to the uncertainty were given: the values are stated without it.");
  else if (std::any_of(certificate.lines.begin(), certificate.lines.end(), [](const CertifiedLine& line) {
             return std::none_of(line.values.begin(), line.values.end(),
                                 [](const CertifiedValue& value) { return value.expanded.has_value(); });
           }))
    certificate.remarks.emplace_back(
        "The contributions to the uncertainty apply to positioning only: other lines are stated without uncertainty.");
  if (wishes.country.empty()) certificate.remarks.emplace_back("The country was not given: the code ZZ means unknown.");
  return certificate;
}

Result<std::string> signed_by(const std::string& xml, const std::string& key, const std::string& signer) {
  std::error_code error;
  std::string draft = (std::filesystem::temp_directory_path(error) / "ecs-dcc-XXXXXX").string();
  const int file = ::mkstemp(draft.data());
  if (file < 0) return problem(ProblemKind::output, "no room for the certificate to be signed in " + draft);
  ::close(file);
  const Unwatched not_an_output;
  auto done = write_file(draft, xml);
  auto answer =
      done ? output_of({"xmlsec1", "--sign", "--privkey-pem", signer.empty() ? key : key + "," + signer, draft}, "",
                       {"xmlsec1", "install the package xmlsec1, or omit --sign", 30.0})
           : tl::unexpected(done.error());
  std::filesystem::remove(draft, error);
  return answer;
}

}  // namespace ecs::commissioning
