// `ecs log list` and `show`: what was done at a machine, and one entry of it whole. `compare`: what has worn between
// two days. Which logbook is meant. `verify` and `replay`: whether the logbook is as it was written, and whether the
// active map follows from it. `instrument`: what measures, from its own calibration certificate or a file of ours.
// `export`: the logbook as text, one JSON object a line; the files that an entry keeps; a calibration certificate.

#include <filesystem>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "app/cli/program.hpp"
#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/unit/transfer.hpp"
#include "modules/logbook/certificate.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/recorder.hpp"
#include "modules/logbook/replay.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::app {
namespace {

/// Which logbook a verb reads.
struct LogChoice {
  std::string log, machine;
  static Fields<LogChoice> fields() {
    using C = LogChoice;
    return {{"--log", &C::log, "logbook file (.ecslog); default: that of --machine, else the last one written"},
            {"--machine", &C::machine, "name or serial number of the machine, or its machine file or parameters"}};
  }
};

bool is_of(const LogOwner& owner, const std::string& machine, const LogOwner& in_file) {
  if (!in_file.machine.empty() || !in_file.serial_number.empty()) return belongs(owner, in_file);
  return owner.machine == machine || owner.serial_number == machine;
}

tl::unexpected<Problem> none_found(const LogbookSetting& setting, const std::string& machine) {
  const std::string where = setting.file.empty() ? setting.folder.string() : setting.file.string();
  return problem_at(
      where, 0, 0,
      machine.empty()
          ? "no logbook yet: one is started when verbs or screens work on a machine (modules/logbook/README.md)"
          : fmt::format("no logbook of {} in that folder", machine));
}

/// Refused where the file is the logbook of another machine than --machine.
Result<Logbook> chosen_logbook(VerbContext& context, const LogChoice& choice) {
  LogOwner wanted;
  if (const auto content = choice.machine.empty() ? problem(ProblemKind::usage, "") : read_file(choice.machine))
    wanted = owner_in(*content);
  std::vector<std::filesystem::path> files{choice.log};
  LogbookSetting setting;
  if (choice.log.empty()) {
    ECS_TRY(set, logbook_setting());
    if (set.off)
      return problem(ProblemKind::usage,
                     "no logbook is kept, because ECS_LOGBOOK or `logbook` in the settings is off: name a logbook file "
                     "with --log");
    setting = set;
    files = logbooks(setting);
  }
  std::vector<std::string> others;
  std::optional<Logbook> chosen;
  for (const auto& file : files) {
    auto book = Logbook::open_to_read(file);
    if (!book && files.size() == 1) return book;
    const auto owner = book ? book->owner() : tl::unexpected(book.error());
    if (!owner) {
      context.console.warn(to_text(owner.error()));
      continue;
    }
    if (!choice.machine.empty() && !is_of(*owner, choice.machine, wanted)) {
      if (!choice.log.empty())
        return problem_at(choice.log, 0, 0, "this is the logbook of {}, not of {}", in_words(*owner), choice.machine);
      continue;
    }
    if (!chosen)
      chosen = std::move(*book);
    else
      others.push_back(in_words(*owner));
  }
  if (!chosen) return none_found(setting, choice.machine);
  if (!others.empty() && choice.machine.empty())
    context.console.note(
        fmt::format("using the most recently written of {} logbooks, {}: --machine selects another one",
                    others.size() + 1, chosen->path().string()));
  return std::move(*chosen);
}

/// Runs a verb of this program with --json and answers what it says on stdout.
RunVerb run_again() {
  return [](const std::vector<std::string>& words) -> Result<std::string> {
    std::vector<std::string> with_json = words;
    with_json.emplace_back("--json");
    std::ostringstream out, messages;
    const int code = run_same_program(with_json, out, messages);
    if (code <= kDoesNotHold) return out.str();
    const Json answer = Json::parse(out.str(), nullptr, false);
    const auto error = answer.is_object() ? answer.find("error") : answer.end();
    const bool has = answer.is_object() && error != answer.end() && error->is_object() && error->contains("message");
    if (!has) return problem(ProblemKind::refused, messages.str());
    return problem_at(text_at(*error, "file"), 0, 0, text_at(*error, "message"));
  };
}

struct ListLogRequest {
  LogChoice book;
  std::string kind, since;
  int last = 0;
  static Fields<ListLogRequest> fields() {
    using R = ListLogRequest;
    return {&R::book,
            {"--kind", &R::kind, "show entries of one kind: measurement, map, activation, diagnosis, report …"},
            {"--since", &R::since, "show entries of this day and later: 2026-03-12"},
            {"--last", &R::last, "number of the last entries to show; 0: all", Range{0, 1'000'000}}};
  }
};

Result<Outcome> list_log(VerbContext& context, const ListLogRequest& request) {
  if (const auto wrong = wrong_date(request.since)) return problem(ProblemKind::usage, "--since: " + *wrong);
  ECS_TRY(book, chosen_logbook(context, request.book));
  ECS_TRY(entries, book.entries(true));
  ECS_TRY(owner, book.owner());
  name_users_of_inputs(entries);
  std::erase_if(entries, [&](const LogbookEntry& entry) {
    return (!request.kind.empty() && entry.kind != request.kind) || entry.time < request.since;
  });
  const std::size_t all = entries.size();
  if (const auto last = static_cast<std::size_t>(request.last); last > 0 && all > last)
    entries.erase(entries.begin(), entries.end() - static_cast<std::ptrdiff_t>(last));
  return outcome_of(record_cell("{owner}\n{entries}", "log"_is(book.path().string()),
                                "machine"_is(text_cell(owner.machine)),
                                "serial_number"_is(text_cell(owner.serial_number)),
                                "owner"_shown(fmt::format("logbook of {}: {}", in_words(owner), book.path().string())),
                                "entries"_is(list_cell(entries, log_entry_cell, log_list_head()))));
}

struct ShowLogRequest {
  LogChoice book;
  int number = 0;
  static Fields<ShowLogRequest> fields() {
    using R = ShowLogRequest;
    return {&R::book, {"NUMBER", &R::number, "number of the entry", Range{1, 1'000'000'000}, Need::required}};
  }
};

Result<Outcome> show_log(VerbContext& context, const ShowLogRequest& request) {
  ECS_TRY(book, chosen_logbook(context, request.book));
  ECS_TRY(entry, book.entry(request.number));
  ECS_TRY(entries, book.entries(true));
  name_users_of_inputs(entries);
  const auto named = std::ranges::find(entries, entry.number, &LogbookEntry::number);
  return outcome_of(whole_entry_cell(entry, named == entries.end() ? entry.summary : named->summary));
}

struct CompareLogRequest {
  LogChoice book;
  std::string from, to;
  static Fields<CompareLogRequest> fields() {
    using R = CompareLogRequest;
    return {&R::book,
            {"FROM", &R::from, "first day to compare: 2025-03-12", Need::required},
            {"TO", &R::to, "later day to compare", Need::required}};
  }
};

Result<Outcome> compare_log(VerbContext& context, const CompareLogRequest& request) {
  ECS_TRY(book, chosen_logbook(context, request.book));
  ECS_TRY(comparison, compared(book, request.from, request.to, run_again()));
  return outcome_of(comparison_of_log_cell(comparison));
}

struct VerifyLogRequest {
  LogChoice book;
  std::string hash;
  static Fields<VerifyLogRequest> fields() {
    using R = VerifyLogRequest;
    return {&R::book, {"--hash", &R::hash, "hash that an entry must have, as stated in a report or certificate"}};
  }
};

Result<Outcome> verify_log(VerbContext& context, const VerifyLogRequest& request) {
  const auto book = chosen_logbook(context, request.book);
  LogVerdict verdict;
  std::string path = request.book.log;
  if (book) {
    verdict = book->verified(request.hash);
    path = book->path().string();
  } else if (book.error().kind == ProblemKind::bad_input && !request.book.log.empty() &&
             is_damaged_logbook(request.book.log)) {
    verdict.first = 1;
    verdict.why = fmt::format("the file cannot be read as a logbook: it {}", book.error().message);
  } else {
    return tl::unexpected(book.error());
  }
  return outcome_of(verdict_cell(verdict, path, request.hash), verdict.whole() ? kDone : kDoesNotHold);
}

struct ReplayRequest {
  LogChoice book;
  bool unit = false;
  static Fields<ReplayRequest> fields() {
    using R = ReplayRequest;
    return {&R::book, {"--unit", &R::unit, "compare with the image in the connected unit"}};
  }
};

/// Refused where the unit is another machine's.
Result<std::string> image_of_unit(VerbContext& context, const Logbook& book) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(owner, book.owner());
  if (const LogOwner of{identity.machine, identity.serial_number}; !belongs(owner, of))
    return problem(ProblemKind::refused, "{} is the logbook of {}; the unit belongs to {}", book.path().string(),
                   in_words(owner), in_words(of));
  const auto image = read_active_image(unit.client(), progress_bar(context, "image"));
  context.console.end_progress();
  if (!image) return tl::unexpected(image.error());
  if (!*image) return problem(ProblemKind::refused, "the unit contains no image");
  return std::string((*image)->begin(), (*image)->end());
}

Result<Outcome> replay_log(VerbContext& context, const ReplayRequest& request) {
  ECS_TRY(book, chosen_logbook(context, request.book));
  std::string active;
  if (request.unit) {
    ECS_TRY(image, image_of_unit(context, book));
    active = std::move(image);
  }
  ECS_TRY(replay, replayed(book, run_again(), active));
  return outcome_of(replay_cell(replay), replay.same ? kDone : kDoesNotHold);
}

struct InstrumentRequest {
  std::string file;
  bool use = false, force = false;
  int interval = 0;
  static Fields<InstrumentRequest> fields() {
    using R = InstrumentRequest;
    return {
        {"FILE", &R::file,
         "Digital Calibration Certificate (.xml) of the instrument, or an instrument file (.toml); if not given, the "
         "instrument is shown"},
        {"--use", &R::use, "use it from now on: entries of measurements then refer to it"},
        {"--interval-days", &R::interval, "interval between calibrations [days]; 0: as in the file", Range{0, 36'500}},
        {"--force", &R::force, "replace the instrument in use"}};
  }
};

Result<Instrument> read_instrument(const std::string& file) {
  ECS_TRY(content, read_file(file));
  return trimmed(content).starts_with('<') ? instrument_in_dcc(content, file) : parse_instrument(content, file);
}

Result<Outcome> instrument(VerbContext&, const InstrumentRequest& request) {
  const std::string in_use = instrument_file();
  if (request.file.empty() && request.use) return problem(ProblemKind::usage, "--use: give the file");
  if (request.file.empty() && !disc::exists(in_use))
    return problem(ProblemKind::usage,
                   "no instrument is set. Set one with its certificate or an instrument file: `ecs log instrument FILE "
                   "--use`");
  ECS_TRY(found, read_instrument(request.file.empty() ? in_use : request.file));
  if (request.interval > 0) found.calibration_interval_days = request.interval;
  if (request.use) {
    if (!request.force && would_overwrite(in_use, {request.file}))
      return problem(ProblemKind::usage, in_use + " contains the instrument in use: --force replaces it");
    disc::make_folders(std::filesystem::path(in_use).parent_path());
    ECS_DO(write_file(in_use, to_toml(found)));
  }
  const Json object = Json::parse(instrument_json(found, now_utc()), nullptr, false);
  std::string text;
  if (object.is_object())
    for (const auto& [key, value] : object.items())
      if (!value.is_null())
        text += fmt::format("{:<26} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  if (request.use) text += fmt::format("kept in {}\n", in_use);
  return outcome_of({object_of("instrument"_is(object), "file"_is(request.use ? Json(in_use) : Json(nullptr))), text});
}

/// Those of `laser stats`, where they were given.
struct GivenUncertainty {
  std::optional<double> instrument_um_per_m, instrument_um, misalignment_mm, environment_um, temperature_range, off_20,
      expansion, expansion_range;
  static Fields<GivenUncertainty> fields() {
    using U = GivenUncertainty;
    return Fields<U>{
        {"--instrument-um-per-m", &U::instrument_um_per_m,
         "expanded uncertainty of the instrument, length-proportional part"},
        {"--instrument-um", &U::instrument_um, "expanded uncertainty of the instrument, constant part"},
        {"--misalignment-mm", &U::misalignment_mm, "lateral offset between beam and axis over the measured length"},
        {"--environment-um", &U::environment_um, "environmental variation error EVE: range of a drift test"},
        {"--temperature-range", &U::temperature_range, "range of the error of the measured machine temperature [degC]"},
        {"--off-20", &U::off_20, "machine temperature minus 20 degC"},
        {"--expansion", &U::expansion, "expansion coefficient used [um/(m degC)]"},
        {"--expansion-range", &U::expansion_range, "range of the expansion coefficient [um/(m degC)]"}}
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
            {"-o,--output", &R::output, "file for all entries, one JSON object per line", Is::output},
            {"--entry", &R::entry, "number of the entry whose files are exported"},
            {"--files", &R::folder, "folder for the files of --entry"},
            {"--dcc", &R::dcc, "Digital Calibration Certificate (XML) of the measurements", Is::output},
            {"--schema", &R::schema, "folder with the schemas of the certificate; default: $ECS_DCC_SCHEMA"},
            {"--all", &R::all, "certify every measurement, not only those since the last certificate"},
            {"--laboratory", &R::laboratory, "name of the calibration laboratory"},
            {"--city", &R::city, "city of the laboratory"},
            {"--country", &R::country, "country code of the laboratory, two letters (ISO 3166-1)"},
            {"--customer", &R::customer, "owner of the machine"},
            {"--person", &R::person, "responsible person; default: the operator"},
            {"--sign", &R::sign, "private key (PEM) to sign with: needs the program xmlsec1"},
            {"--signer", &R::signer, "certificate (PEM) of that key, included in the signature"},
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
  disc::make_folders(folder);
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
    return problem(ProblemKind::usage, "--entry and --files must be given together");
  const std::string& country = request.country;
  if (!country.empty() &&
      (country.size() != 2 || country.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos))
    return problem(ProblemKind::usage, "--country: expected two capitals such as DE, got \"{}\"", country);
  if (!request.signer.empty() && request.sign.empty())
    return problem(ProblemKind::usage, "--signer: give the key with --sign");
  return {};
}

void log_certificate(const Logbook& book, const ExportLogRequest& request, const WrittenCertificate& written,
                     const std::string& xml) {
  const auto owner = book.owner();
  if (!owner) return;
  LogRecord made{.kind = "certificate",
                 .machine = owner->machine,
                 .serial_number = owner->serial_number,
                 .summary = fmt::format(
                     "{}, {} measured line{}, {}", written.certificate.identifier, written.certificate.lines.size(),
                     written.certificate.lines.size() == 1 ? "" : "s",
                     written.schema.empty() ? "not validated against the DCC schema (digital calibration certificate)"
                                            : "validated against DCC " + written.schema),
                 .content = one_line(
                     object_of("identifier"_is(written.certificate.identifier), "sha256"_is(written.sha256),
                               "schema_version"_is(written.certificate.schema_version),
                               "validated"_is(!written.schema.empty()), "signed"_is(written.certificate.to_be_signed))),
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
    context.console.note(
        "certificate not validated: give the folder of the published schema with --schema or ECS_DCC_SCHEMA");
  }
  ECS_DO(write_file(request.dcc, xml));
  written.sha256 = sha256_hex(xml);
  log_certificate(book, request, written, xml);
  return written;
}

Cell certificate_cell(const std::optional<WrittenCertificate>& written, const std::string& file) {
  if (!written) return null_cell();
  return record_cell(
      "certificate {identifier} written to {file}: measured lines {lines}, DCC {schema_version} "
      "(digital calibration certificate), {validated_text}, "
      "SHA-256 {sha256}\n{remarks}",
      "file"_is(file), "identifier"_is(written->certificate.identifier),
      "schema_version"_is(written->certificate.schema_version), "validated"_is(!written->schema.empty()),
      "validated_text"_shown(written->schema.empty() ? "not validated, because no schema is given (--schema)"
                                                     : "valid according to the DCC schema"),
      "signed"_is(written->certificate.to_be_signed), "sha256"_is(written->sha256),
      "logbook_hash"_is(written->certificate.logbook_hash),
      "previous"_is(written->certificate.previous ? Json(written->certificate.previous->identifier) : Json(nullptr)),
      "lines"_is(written->certificate.lines.size()), "remarks"_is(lines_cell(written->certificate.remarks, "- ")));
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
    for (const LogbookEntry& entry : entries) lines += one_line(whole_entry_cell(entry, entry.summary).json) + "\n";
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
      names.empty() ? "" : fmt::format("files written to {}: {}\n", request.folder, names.size());
  return outcome_of(record_cell("{entries_text}{files_text}{certificate}", "log"_is(book.path().string()),
                                "output"_is(text_cell(request.output)), "entries"_is(count), "files"_is(names),
                                "certificate"_is(certificate_cell(certificate, request.dcc)),
                                "entries_text"_shown(entries_text), "files_text"_shown(files_text)));
}

}  // namespace

extern const std::vector<Action> kLog{
    action("log list", "list every entry of the logbook of a machine",
           "ecs log list --machine machine.toml --kind activation", list_log),
    action("log show", "show one entry in full: files with their hashes, instrument, answer", "ecs log show 12",
           show_log),
    action("log compare", "show the wear between two days: curves, causes and volume side by side",
           "ecs log compare 2025-03-12 2026-03-12", compare_log),
    action("log export", "write every entry as text, the files of one entry, or a Digital Calibration Certificate",
           "ecs log export -o log.jsonl\n  ecs log export --entry 12 --files entry12/\n  ecs log export --dcc "
           "certificate.xml --schema schemas/ --laboratory \"Example Ltd\" --customer Works --instrument-um-per-m 0.5",
           export_log),
    action("log verify", "check every entry against its hash and the previous entry; exit 1 at the first mismatch",
           "ecs log verify --hash 3f0c…", verify_log),
    action("log replay", "derive the active map again from the raw readings and compare it bit for bit",
           "ecs log replay --json", replay_log, {.link = Link::reads}),
    action("log instrument", "set or show the measuring instrument and its calibration, from its certificate",
           "ecs log instrument laser-certificate.xml --use --interval-days 365", instrument)};

}  // namespace ecs::app
