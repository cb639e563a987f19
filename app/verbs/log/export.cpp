// `ecs log export`: the logbook as text, one JSON object a line; the files that an entry keeps; a calibration
// certificate.
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "app/verbs/log/log_source.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "commissioning/certificate/gather.hpp"
#include "commissioning/certificate/xml.hpp"
#include "commissioning/logbook/place.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/logbook/view.hpp"

namespace ecs::app {
namespace {

struct UncertaintyWord {
  const char* name;
  const char* help;
};
/// Those of `laser stats`.
constexpr std::array<UncertaintyWord, 8> kUncertaintyWords{{
    {"--instrument-um-per-m", "of the instrument, expanded, in proportion to the length"},
    {"--instrument-um", "of the instrument, expanded, the constant part"},
    {"--misalignment-mm", "lateral offset of beam and axis over the measured length"},
    {"--environment-um", "environmental variation error EVE: range of a drift test"},
    {"--temperature-range", "range of the error of the machine's temperature [degC]"},
    {"--off-20", "the machine's temperature less 20 degC"},
    {"--expansion", "expansion coefficient of the correction [um/m/degC]"},
    {"--expansion-range", "range of the expansion coefficient [um/m/degC]"},
}};

struct ExportLogArguments : LogArguments {
  const std::string& output = output_file("-o,--output", "file for all entries, one JSON object a line");
  const std::string& entry = text("--entry", "number of the entry whose files are wanted");
  const std::string& folder = text("--files", "folder for the files of --entry");
  const std::string& dcc = output_file("--dcc", "a Digital Calibration Certificate (XML) of what was measured");
  const std::string& schema =
      text("--schema", "folder with the schemas of the certificate; by default $ECS_DCC_SCHEMA");
  const bool& all = flag("--all", "certify every measurement, not only those since the last certificate");
  const std::string& laboratory = text("--laboratory", "who calibrates");
  const std::string& city = text("--city", "of the laboratory");
  const std::string& country = text("--country", "of the laboratory, two letters (ISO 3166-1)");
  const std::string& customer = text("--customer", "who owns the machine");
  const std::string& person = text("--person", "who answers for it; by default the operator");
  const std::string& sign = text("--sign", "private key (PEM) to sign with: needs the program xmlsec1");
  const std::string& signer = text("--signer", "certificate (PEM) of that key, kept in the signature");
  std::array<const std::optional<double>*, kUncertaintyWords.size()> uncertainty = uncertainty_options();

  [[nodiscard]] std::vector<std::string> uncertainty_words() const {
    std::vector<std::string> words;
    for (std::size_t k = 0; k < kUncertaintyWords.size(); ++k)
      if (*uncertainty[k]) words.insert(words.end(), {kUncertaintyWords[k].name, shortest(**uncertainty[k])});
    return words;
  }

 private:
  std::array<const std::optional<double>*, kUncertaintyWords.size()> uncertainty_options() {
    std::array<const std::optional<double>*, kUncertaintyWords.size()> all_of_them{};
    group("Uncertainty of the certificate (ISO 230-2 annex A, k = 2)");
    for (std::size_t k = 0; k < kUncertaintyWords.size(); ++k)
      all_of_them[k] = &optional_number(kUncertaintyWords[k].name, kUncertaintyWords[k].help);
    group({});
    return all_of_them;
  }
};

/// "2_EXX.csv": the place in the entry and the last part of the name.
std::string file_name(std::size_t place, const LogFile& file) {
  return fmt::format("{}_{}", place + 1, std::filesystem::path(file.name).filename().string());
}

Result<std::vector<std::string>> files_written(const Logbook& book, const LogbookEntry& entry,
                                               const std::filesystem::path& folder) {
  const std::vector<LogFile> files = files_of(entry);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < files.size(); ++k)
    if (files[k].kept) names.push_back((folder / file_name(k, files[k])).string());
  ECS_DO(none_there(names, "give another folder"));
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (std::size_t k = 0; k < files.size(); ++k) {
    if (!files[k].kept) continue;
    ECS_TRY(content, book.original(files[k].sha256));
    ECS_DO(write_file(folder / file_name(k, files[k]), content));
  }
  return names;
}

/// What became of a certificate.
struct WrittenCertificate {
  Certificate certificate;
  std::string sha256;
  std::string schema;  ///< version that it was validated against; empty: it was not
};

Result<void> check_words(const ExportLogArguments& arguments) {
  if (arguments.output.empty() && arguments.entry.empty() && arguments.dcc.empty())
    return problem(ProblemKind::usage, "give -o FILE for all entries, --entry NUMBER --files FOLDER, or --dcc FILE");
  if (arguments.entry.empty() != arguments.folder.empty())
    return problem(ProblemKind::usage, "--entry and --files go together");
  const std::string& country = arguments.country;
  if (!country.empty() &&
      (country.size() != 2 || country.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos))
    return problem(ProblemKind::usage, fmt::format("--country: expected two capitals such as DE, found {}", country));
  if (!arguments.signer.empty() && arguments.sign.empty())
    return problem(ProblemKind::usage, "--signer: give the key with --sign");
  return {};
}

void log_certificate(const Logbook& book, const ExportLogArguments& arguments, const WrittenCertificate& written,
                     const std::string& xml) {
  const auto owner = book.owner();
  if (!owner) return;
  LogRecord record;
  record.kind = "certificate";
  record.machine = owner->machine;
  record.serial_number = owner->serial_number;
  record.summary = fmt::format("{}, {} lines, {}", written.certificate.identifier, written.certificate.lines.size(),
                               written.schema.empty() ? "not validated" : "validated against DCC " + written.schema);
  record.content = one_line(Json{{"identifier", written.certificate.identifier},
                                 {"sha256", written.sha256},
                                 {"schema_version", written.certificate.schema_version},
                                 {"validated", !written.schema.empty()},
                                 {"signed", written.certificate.to_be_signed}});
  record.files.push_back({"output", arguments.dcc, std::make_shared<const std::string>(xml)});
  (void)record_in(book.path(), std::move(record));
}

Result<WrittenCertificate> certified(VerbContext& context, const ExportLogArguments& arguments, const Logbook& book) {
  CertificateWishes wishes;
  wishes.laboratory = arguments.laboratory;
  wishes.city = arguments.city;
  wishes.country = arguments.country;
  wishes.customer = arguments.customer;
  wishes.person = arguments.person.empty() ? operator_name() : arguments.person;
  wishes.all = arguments.all;
  wishes.to_be_signed = !arguments.sign.empty();
  wishes.uncertainty = arguments.uncertainty_words();
  std::optional<SchemaFolder> schema;
  if (const std::string folder = schema_folder_or_empty(arguments.schema); !folder.empty()) {
    ECS_TRY(found, schema_in(folder));
    schema = std::move(found);
    wishes.schema_version = schema->version;
  }
  ECS_TRY(certificate, certificate_of(book, wishes, run_again(), now_utc()));
  WrittenCertificate written{std::move(certificate), {}, {}};
  std::string xml = dcc_xml(written.certificate);
  if (wishes.to_be_signed) {
    ECS_TRY(with_signature, signed_by(xml, arguments.sign, arguments.signer));
    xml = std::move(with_signature);
  }
  if (schema) {
    ECS_DO(valid_by_schema(xml, *schema, arguments.dcc));
    written.schema = schema->version;
  } else {
    context.console.note("not validated: name the folder of the published schema with --schema or ECS_DCC_SCHEMA");
  }
  ECS_DO(write_file(arguments.dcc, xml));
  written.sha256 = sha256_hex(xml);
  log_certificate(book, arguments, written, xml);
  return written;
}

Cell certificate_cell(const std::optional<WrittenCertificate>& written, const std::string& file) {
  if (!written) return null_cell();
  return record_cell(
      "certificate {identifier} with {lines} lines written to {file}: DCC {schema_version}, {validated_text}, SHA-256 "
      "{sha256}\n{remarks}",
      {{"file", word_cell(file)},
       {"identifier", word_cell(written->certificate.identifier)},
       {"schema_version", word_cell(written->certificate.schema_version)},
       {"validated", {!written->schema.empty(), {}}},
       {"validated_text", shown_cell(written->schema.empty() ? "NOT VALIDATED" : "valid by its schema")},
       {"signed", {written->certificate.to_be_signed, {}}},
       {"sha256", word_cell(written->sha256)},
       {"logbook_hash", {written->certificate.logbook_hash, {}}},
       {"previous",
        {written->certificate.previous ? Json(written->certificate.previous->identifier) : Json(nullptr), {}}},
       {"lines", count_cell(written->certificate.lines.size())},
       {"remarks", lines_cell(written->certificate.remarks, "- ")}});
}

Result<Outcome> export_log(VerbContext& context, const ExportLogArguments& arguments) {
  ECS_DO(check_words(arguments));
  ECS_TRY(book, chosen_logbook(context, arguments));
  std::vector<std::string> names;
  if (!arguments.entry.empty()) {
    const auto number = integer_in(arguments.entry);
    ECS_TRY(entry, number ? book.entry(*number) : problem(ProblemKind::usage, "--entry: expected a number"));
    ECS_TRY(written, files_written(book, entry, arguments.folder));
    names = std::move(written);
  }
  std::size_t count = 0;
  if (!arguments.output.empty()) {
    ECS_TRY(entries, book.entries());
    std::string lines;
    for (const LogbookEntry& entry : entries) lines += one_line(whole_entry_cell(entry).json) + "\n";
    ECS_DO(write_file(arguments.output, lines));
    count = entries.size();
  }
  std::optional<WrittenCertificate> certificate;
  if (!arguments.dcc.empty()) {
    ECS_TRY(written, certified(context, arguments, book));
    certificate = std::move(written);
  }
  const std::string entries_text =
      arguments.output.empty() ? "" : fmt::format("{} entries written to {}\n", count, arguments.output);
  const std::string files_text =
      names.empty() ? "" : fmt::format("{} files written to {}\n", names.size(), arguments.folder);
  return outcome_of(record_cell("{entries_text}{files_text}{certificate}",
                                {{"log", word_cell(book.path().string())},
                                 {"output", text_cell(arguments.output)},
                                 {"entries", count_cell(count)},
                                 {"files", {names, {}}},
                                 {"certificate", certificate_cell(certificate, arguments.dcc)},
                                 {"entries_text", shown_cell(entries_text)},
                                 {"files_text", shown_cell(files_text)}}));
}

}  // namespace

extern const VerbDefinition kLogExport = verb<ExportLogArguments>(
    "log export", "every entry as text, the files of one entry, or a Digital Calibration Certificate",
    "ecs log export -o log.jsonl\n  ecs log export --entry 12 --files entry12/\n  ecs log export --dcc certificate.xml "
    "--schema "
    "schemas/ --laboratory \"Example Ltd\" --customer Works --instrument-um-per-m 0.5",
    export_log);

}  // namespace ecs::app
