#include "commissioning/certificate/gather.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "base/child_program.hpp"
#include "base/date.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "commissioning/logbook/observed.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kDay = 10;  // of "2026-05-04T09:30:00Z"

struct StatedValue {
  const char* key;  ///< in the answer of `laser stats`
  const char* name;
};
constexpr std::array<StatedValue, 10> kValues{{
    {"A", "bidirectional accuracy of positioning A"},
    {"A_forward", "accuracy of positioning, forward"},
    {"A_reverse", "accuracy of positioning, reverse"},
    {"E", "bidirectional systematic error of positioning E"},
    {"E_forward", "systematic error of positioning, forward"},
    {"E_reverse", "systematic error of positioning, reverse"},
    {"M", "mean bidirectional error of positioning M"},
    {"R", "bidirectional repeatability of positioning R"},
    {"B", "reversal error B"},
    {"B_mean", "mean reversal error"},
}};

std::string text_at(const Json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : std::string();
}

std::optional<double> value_at(const Json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_number()
             ? std::optional(object[key].get<double>())
             : std::nullopt;
}

CertifiedCurve curve_of(const Json& targets, const char* key, std::string name, const std::string& unit) {
  CertifiedCurve curve{std::move(name), unit, {}, {}};
  for (const Json& target : targets) {
    const auto position = value_at(target, "position_mm");
    const auto mean = value_at(target, key);
    if (!position || !mean) continue;
    curve.position_mm.push_back(*position);
    curve.value.push_back(*mean);
  }
  return curve;
}

CertifiedLine line_of(const Json& line, const LogFile& file) {
  CertifiedLine one;
  const bool compensated = line.contains("compensated") && line["compensated"] == true;
  const std::string unit = dsi_unit(text_at(line, "unit"));
  one.compensated = compensated;
  one.name = fmt::format("{} ({} along {}), {}", text_at(line, "component"), text_at(line, "sense"),
                         text_at(line, "axis"), compensated ? "with the compensation active" : "without compensation");
  one.description =
      fmt::format("readings {}, SHA-256 {}", std::filesystem::path(file.name).filename().string(), file.sha256);
  if (const std::string targets = text_at(line, "unit_of_targets"); !targets.empty())
    one.position_unit = dsi_unit(targets);
  const Json uncertainty = line.contains("uncertainty") ? line["uncertainty"] : Json();
  for (const StatedValue& stated : kValues)
    if (const auto value = value_at(line, stated.key))
      one.values.push_back({fmt::format("{} (ISO 230-2)", stated.name), fmt::format("iso230-2_{}", stated.key), *value,
                            unit, value_at(uncertainty, stated.key)});
  if (line.contains("targets") && line["targets"].is_array())
    for (const auto& [key, name] :
         {std::pair("mean_forward", "mean error, forward"), std::pair("mean_reverse", "mean error, reverse")})
      if (CertifiedCurve curve = curve_of(line["targets"], key, name, unit); !curve.value.empty())
        one.curves.push_back(std::move(curve));
  return one;
}

/// When it was measured: `# date:` of its header, else when it came into the logbook.
std::string day_of(const Logbook& book, const LogFile& file, const LogbookEntry& entry) {
  constexpr std::string_view kDate = "# date:";
  const auto content = book.original(file.sha256);
  const std::size_t at = content ? content->find(kDate) : std::string::npos;
  if (at != std::string::npos) {
    const std::size_t begin = at + kDate.size();
    const std::string date(trimmed(std::string_view(*content).substr(begin, content->find('\n', begin) - begin)));
    if (is_iso_date(date)) return date.substr(0, kDay);
  }
  return entry.time.substr(0, kDay);
}

/// The measurement set of an entry: what an import wrote, else what was read.
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

/// Adds the lines of one set; what cannot be certified is said. @return whether there was one
bool add_lines(Certificate& certificate, const Logbook& book, const LogFile& file, const CertificateWishes& wishes,
               const RunVerb& run) {
  const auto content = book.original(file.sha256);
  const std::string name = std::filesystem::path(file.name).filename().string();
  if (!content) {
    certificate.remarks.push_back(fmt::format("{} is not certified: {}", name, content.error().message));
    return false;
  }
  KeptFiles kept("/");
  kept.put(name, *content);
  std::vector<std::string> words{"laser", "stats", name};
  words.insert(words.end(), wishes.uncertainty.begin(), wishes.uncertainty.end());
  const auto said = run(words);
  const Json answer = said ? Json::parse(*said, nullptr, false) : Json();
  std::size_t before = certificate.lines.size();
  if (answer.is_object() && answer.contains("lines") && answer["lines"].is_array())
    for (const Json& line : answer["lines"])
      if (CertifiedLine one = line_of(line, file); !one.values.empty()) certificate.lines.push_back(std::move(one));
  if (certificate.lines.size() == before)
    certificate.remarks.push_back(
        fmt::format("{} is not certified: {}", name, said ? "it holds no line of ISO 230-2" : said.error().message));
  return certificate.lines.size() > before;
}

/// Of the machine, for an identifier.
std::string short_name(const LogOwner& owner) {
  std::string name = owner.serial_number.empty() ? owner.machine : owner.serial_number;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  return name.empty() ? "machine" : name;
}

Result<void> add_history(Certificate& certificate, const Logbook& book) {
  const auto last = book.last_of("certificate");
  if (!last) return tl::unexpected(last.error());
  if (*last) {
    const Json content = Json::parse((*last)->content, nullptr, false);
    if (content.is_object())
      certificate.previous = PreviousCertificate{text_at(content, "identifier"), text_at(content, "sha256")};
  }
  const auto active = book.activations();
  if (!active) return tl::unexpected(active.error());
  if (!active->empty())
    certificate.active_image = text_at(Json::parse(active->back().content, nullptr, false), "image_sha256");
  return {};
}

}  // namespace

Result<Certificate> certificate_of(const Logbook& book, const CertificateWishes& wishes, const RunVerb& run,
                                   const std::string& now) {
  const auto owner = book.owner();
  if (!owner) return tl::unexpected(owner.error());
  const auto entries = book.entries();
  if (!entries) return tl::unexpected(entries.error());
  if (entries->empty()) return problem(ProblemKind::refused, "the logbook is empty: there is nothing to certify");
  Certificate certificate;
  certificate.schema_version = wishes.schema_version;
  certificate.country = wishes.country;
  certificate.program = program_version_and_commit();
  certificate.machine = owner->machine;
  certificate.serial_number = owner->serial_number;
  certificate.laboratory = wishes.laboratory;
  certificate.city = wishes.city;
  certificate.customer = wishes.customer;
  certificate.person = wishes.person;
  certificate.to_be_signed = wishes.to_be_signed;
  certificate.logbook_hash = entries->back().hash;
  certificate.issue_date = now.substr(0, kDay);
  certificate.identifier = fmt::format("ECS-{}-{}-{}", short_name(*owner), entries->back().number + 1,
                                       certificate.logbook_hash.substr(0, 8));
  if (const auto known = add_history(certificate, book); !known) return tl::unexpected(known.error());
  std::int64_t after = 0;
  for (const LogbookEntry& entry : *entries)
    if (entry.kind == "certificate" && !wishes.all) after = entry.number;
  for (const LogbookEntry& entry : *entries) {
    if (entry.kind != "measurement" || entry.number <= after) continue;
    const auto set = set_of(book, entry);
    if (!set || !add_lines(certificate, book, *set, wishes, run)) continue;
    const std::string day = day_of(book, *set, entry);
    if (certificate.begin_date.empty() || day < certificate.begin_date) certificate.begin_date = day;
    certificate.end_date = std::max(certificate.end_date, day);
    if (!entry.instrument.empty()) certificate.instrument = instrument_in_json(entry.instrument);
  }
  if (certificate.lines.empty()) {
    std::vector<Problem> why{{ProblemKind::refused,
                              after > 0
                                  ? "nothing was measured since the last certificate; --all certifies everything again"
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
                       {"xmlsec1", "install the package xmlsec1, or leave --sign out", 30.0})
           : tl::unexpected(done.error());
  std::filesystem::remove(draft, error);
  return answer;
}

}  // namespace ecs::commissioning
