// `ecs log export`: the logbook as text, one JSON object a line; the files that an entry keeps; a calibration
// certificate.
#include <filesystem>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "modules/logbook/certificate.hpp"
#include "modules/logbook/log_verbs.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/recorder.hpp"

namespace ecs::app {
namespace {

/// Those of `laser stats`, where they were given.
struct GivenUncertainty {
  std::optional<double> instrument_um_per_m, instrument_um, misalignment_mm, environment_um, temperature_range, off_20,
      expansion, expansion_range;
  static Fields<GivenUncertainty> fields() {
    using U = GivenUncertainty;
    return Fields<U>{
        {"--instrument-um-per-m", &U::instrument_um_per_m, "of the instrument, expanded, in proportion to the length"},
        {"--instrument-um", &U::instrument_um, "of the instrument, expanded, the constant part"},
        {"--misalignment-mm", &U::misalignment_mm, "lateral offset of beam and axis over the measured length"},
        {"--environment-um", &U::environment_um, "environmental variation error EVE: range of a drift test"},
        {"--temperature-range", &U::temperature_range, "range of the error of the machine's temperature [degC]"},
        {"--off-20", &U::off_20, "the machine's temperature less 20 degC"},
        {"--expansion", &U::expansion, "expansion coefficient of the correction [um/m/degC]"},
        {"--expansion-range", &U::expansion_range, "range of the expansion coefficient [um/m/degC]"}}
        .under("Uncertainty of the certificate (ISO 230-2 annex A, k = 2)");
  }
  /// As words of a command line.
  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> words;
    GivenUncertainty given = *this;
    for (const cli::Argument& one : fields_of<GivenUncertainty>().arguments_for(given))
      if (const auto& value = *std::get<std::optional<double>*>(one.into))
        words.insert(words.end(), {one.name, shortest(*value)});
    return words;
  }
};

struct ExportLogRequest : CertificateWishes {
  LogChoice book;
  std::string output, entry, folder, dcc, schema, sign, signer;
  GivenUncertainty given;
  static Fields<ExportLogRequest> fields() {
    using R = ExportLogRequest;
    return {&R::book,
            {"-o,--output", &R::output, "file for all entries, one JSON object a line", Is::output},
            {"--entry", &R::entry, "number of the entry whose files are wanted"},
            {"--files", &R::folder, "folder for the files of --entry"},
            {"--dcc", &R::dcc, "a Digital Calibration Certificate (XML) of what was measured", Is::output},
            {"--schema", &R::schema, "folder with the schemas of the certificate; by default $ECS_DCC_SCHEMA"},
            {"--all", &R::all, "certify every measurement, not only those since the last certificate"},
            {"--laboratory", &R::laboratory, "who calibrates"},
            {"--city", &R::city, "of the laboratory"},
            {"--country", &R::country, "of the laboratory, two letters (ISO 3166-1)"},
            {"--customer", &R::customer, "who owns the machine"},
            {"--person", &R::person, "who answers for it; by default the operator"},
            {"--sign", &R::sign, "private key (PEM) to sign with: needs the program xmlsec1"},
            {"--signer", &R::signer, "certificate (PEM) of that key, kept in the signature"},
            &R::given};
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

Result<void> check_words(const ExportLogRequest& request) {
  if (request.output.empty() && request.entry.empty() && request.dcc.empty())
    return problem(ProblemKind::usage, "give -o FILE for all entries, --entry NUMBER --files FOLDER, or --dcc FILE");
  if (request.entry.empty() != request.folder.empty())
    return problem(ProblemKind::usage, "--entry and --files go together");
  const std::string& country = request.country;
  if (!country.empty() &&
      (country.size() != 2 || country.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos))
    return problem(ProblemKind::usage, fmt::format("--country: expected two capitals such as DE, found {}", country));
  if (!request.signer.empty() && request.sign.empty())
    return problem(ProblemKind::usage, "--signer: give the key with --sign");
  return {};
}

void log_certificate(const Logbook& book, const ExportLogRequest& request, const WrittenCertificate& written,
                     const std::string& xml) {
  const auto owner = book.owner();
  if (!owner) return;
  LogRecord made{
      .kind = "certificate",
      .machine = owner->machine,
      .serial_number = owner->serial_number,
      .summary = fmt::format("{}, {} lines, {}", written.certificate.identifier, written.certificate.lines.size(),
                             written.schema.empty() ? "not validated" : "validated against DCC " + written.schema),
      .content = one_line(Json{{"identifier", written.certificate.identifier},
                               {"sha256", written.sha256},
                               {"schema_version", written.certificate.schema_version},
                               {"validated", !written.schema.empty()},
                               {"signed", written.certificate.to_be_signed}}),
      .files = {{"output", request.dcc, std::make_shared<const std::string>(xml)}}};
  record_all({std::move(made)}, book.path());
}

Result<WrittenCertificate> certified(VerbContext& context, const ExportLogRequest& request, const Logbook& book) {
  CertificateWishes wishes = request;
  if (wishes.person.empty()) wishes.person = operator_name();
  wishes.to_be_signed = !request.sign.empty();
  wishes.uncertainty = request.given.words();
  std::optional<SchemaFolder> schema;
  if (const std::string folder = schema_folder_or_empty(request.schema); !folder.empty()) {
    ECS_TRY(found, schema_in(folder));
    schema = std::move(found);
    wishes.schema_version = schema->version;
  }
  ECS_TRY(certificate, certificate_of(book, wishes, run_again(), now_utc()));
  WrittenCertificate written{std::move(certificate), {}, {}};
  std::string xml = dcc_xml(written.certificate);
  if (wishes.to_be_signed) {
    ECS_TRY(with_signature, signed_by(xml, request.sign, request.signer));
    xml = std::move(with_signature);
  }
  if (schema) {
    ECS_DO(valid_by_schema(xml, *schema, request.dcc));
    written.schema = schema->version;
  } else {
    context.console.note("not validated: name the folder of the published schema with --schema or ECS_DCC_SCHEMA");
  }
  ECS_DO(write_file(request.dcc, xml));
  written.sha256 = sha256_hex(xml);
  log_certificate(book, request, written, xml);
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

Result<Outcome> export_log(VerbContext& context, const ExportLogRequest& request) {
  ECS_DO(check_words(request));
  ECS_TRY(book, chosen_logbook(context, request.book));
  std::vector<std::string> names;
  if (!request.entry.empty()) {
    const auto number = integer_in(request.entry);
    ECS_TRY(entry, number ? book.entry(*number) : problem(ProblemKind::usage, "--entry: expected a number"));
    ECS_TRY(written, files_written(book, entry, request.folder));
    names = std::move(written);
  }
  std::size_t count = 0;
  if (!request.output.empty()) {
    ECS_TRY(entries, book.entries());
    std::string lines;
    for (const LogbookEntry& entry : entries) lines += one_line(whole_entry_cell(entry).json) + "\n";
    ECS_DO(write_file(request.output, lines));
    count = entries.size();
  }
  std::optional<WrittenCertificate> certificate;
  if (!request.dcc.empty()) {
    ECS_TRY(written, certified(context, request, book));
    certificate = std::move(written);
  }
  const std::string entries_text =
      request.output.empty() ? "" : fmt::format("{} entries written to {}\n", count, request.output);
  const std::string files_text =
      names.empty() ? "" : fmt::format("{} files written to {}\n", names.size(), request.folder);
  return outcome_of(record_cell("{entries_text}{files_text}{certificate}",
                                {{"log", word_cell(book.path().string())},
                                 {"output", text_cell(request.output)},
                                 {"entries", count_cell(count)},
                                 {"files", {names, {}}},
                                 {"certificate", certificate_cell(certificate, request.dcc)},
                                 {"entries_text", shown_cell(entries_text)},
                                 {"files_text", shown_cell(files_text)}}));
}

}  // namespace

extern const std::vector<Action> kLogExporting{action(
    "log export", "every entry as text, the files of one entry, or a Digital Calibration Certificate",
    "ecs log export -o log.jsonl\n  ecs log export --entry 12 --files entry12/\n  ecs log export --dcc certificate.xml "
    "--schema "
    "schemas/ --laboratory \"Example Ltd\" --customer Works --instrument-um-per-m 0.5",
    export_log)};

}  // namespace ecs::app
