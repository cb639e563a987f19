#include "commissioning/parameters/controller.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/records.hpp"
#include "core/memory_image.hpp"

namespace ecs::commissioning {
namespace {

/// Every key there is, in the order of the file.
std::vector<std::string> all_keys() {
  std::vector<std::string> keys{std::string(kMachineKey), std::string(kSerialKey)};
  for (const params::Field& field : params::fields()) keys.push_back(field.key);
  return keys;
}

std::string shown(const std::string& value) { return value.empty() ? "nothing" : value; }

/// "X deadband: 0.5 um -> 25 um" as what holds after undo: "X deadband is 0.5 um again (was 25 um)".
std::string taken_back(const std::string& what) {
  const std::size_t colon = what.find(": "), arrow = what.find(" -> ");
  if (colon == std::string::npos || arrow == std::string::npos) return what;
  return fmt::format("{} is {} again (was {})", what.substr(0, colon), what.substr(colon + 2, arrow - colon - 2),
                     what.substr(arrow + 4));
}

/// A draft may be taken up from another folder.
std::string absolute(const std::string& path) {
  return path.empty() ? path : disc::absolute(path).lexically_normal().string();
}

/// A file that cannot make the screen wait.
Result<void> plain_file(const std::string& path) {
  if (path.empty()) return problem(ProblemKind::usage, "expected the name of a file, found nothing");
  if (disc::exists(path) && !disc::is_file(path))
    return problem(ProblemKind::usage, "{}: expected a file, found a folder or a device; choose a file", path);
  return {};
}

}  // namespace

Result<void> ParametersController::open_file(const std::string& path) {
  if (auto plain = plain_file(path); !plain) return plain;
  ECS_TRY(text, read_file_of(FileKind::parameters, path));
  ECS_TRY(read, params::parse_parameters(text, path));
  in_file_ = ParameterSet{read.parameters, read.identity};
  file_text_ = std::move(text);
  file_findings_ = params::check_file(read);
  held_ = {path, {}, *in_file_, read.has_end};
  load(*in_file_, path);
  return {};
}

Result<void> ParametersController::start_from_machine(const std::string& path) {
  if (auto checked = check_with(path); !checked) return checked;
  if (!machine_) return problem(ProblemKind::usage, "expected the name of a machine file, found nothing");
  in_file_.reset();
  file_text_.clear();
  file_findings_.clear();
  const ParameterSet begun{params::default_parameters_for(*machine_), {machine_->name, {}}};
  held_ = {{}, path, begun, true};
  load(begun, "");
  return {};
}

Result<void> ParametersController::take_from_unit(const UnitContent& unit) {
  know_unit(unit);
  if (!unit.parameters)
    return problem(ProblemKind::refused, "not received from {}: {}", title_of(unit), unit.none_because);
  ParameterSet received{*unit.parameters, {set().identity.machine, unit.identity.serial_number}};
  constexpr std::size_t kLongestLetter = 4;  // bytes: a longer name is perhaps cut
  if (const std::string& its = unit.identity.machine;
      received.identity.machine.empty() && its.size() + kLongestLetter <= kMostMachineBytes)
    received.identity.machine = its;
  held_ = {file_between("parameters", ".toml"), {}, {*unit.parameters, {{}, unit.identity.serial_number}}, true};
  if (loaded_) {
    if (unsaved()) set_draft_aside(kParametersDraft);
    edit(std::move(received), "receiving from the unit");
    edited_.settle();
    refresh();
  } else {
    load(std::move(received), "");
  }
  return {};
}

std::optional<Draft> ParametersController::draft() const {
  return loaded_ ? std::nullopt : offered_draft(kParametersDraft);
}

std::string ParametersController::owner_of(const Draft& draft) {
  const auto parsed = parsed_draft(draft.text);
  if (!parsed) return {};
  return parsed->set.identity.machine.empty() ? parsed->file : parsed->set.identity.machine;
}

Result<void> ParametersController::take_up_draft() {
  const auto kept = draft_of(kParametersDraft);
  if (!kept)
    return problem(ProblemKind::refused, "the unsaved work is no longer available: another program has opened it");
  ECS_TRY(draft, parsed_draft(kept->text));
  if (!draft.machine.empty()) (void)check_with(draft.machine);
  in_file_.reset();
  file_text_.clear();
  file_findings_.clear();
  held_ = {};
  if (auto text = read_file(draft.file); !draft.file.empty() && text) {
    if (auto read = params::parse_parameters(*text, draft.file)) {
      held_ = {draft.file, {}, {read->parameters, read->identity}, read->has_end};
      in_file_ = ParameterSet{read->parameters, read->identity};
      file_text_ = std::move(*text);
      file_findings_ = params::check_file(*read);
    }
  }
  loaded_ = true;
  edited_.take_up(std::move(draft.set), std::move(draft.base));
  file_ = draft.file;
  refresh();
  return {};
}

void ParametersController::load(ParameterSet set, std::string file) {
  loaded_ = true;
  edited_.load(std::move(set));
  file_ = std::move(file);
  refresh();
}

void ParametersController::edit(ParameterSet after, std::string what) {
  if (!edited_.did(std::move(what), std::move(after))) return;
  keep_draft();
  refresh();
}

Result<void> ParametersController::change(const std::string& key, const std::string& text) {
  ParameterSet after = set();
  if (auto changed = set_value(key, after, text); !changed) return changed;
  edit(after, fmt::format("{}: {} -> {}", full_label_of(key), shown(value_with_unit(key, value_of(key, set()))),
                          shown(value_with_unit(key, value_of(key, after)))));
  return {};
}

bool ParametersController::cycle(const std::string& key, int by) {
  const auto choices = choices_of(key);
  if (choices.empty()) return false;
  const auto at = std::find(choices.begin(), choices.end(), value_of(key, set()));
  const int count = static_cast<int>(choices.size());
  const int now = at == choices.end() ? 0 : static_cast<int>(at - choices.begin());
  return change(key, choices[static_cast<std::size_t>((now + by + count) % count)]).has_value();
}

void ParametersController::set_default(const std::string& key) { (void)change(key, value_of(key, ParameterSet{})); }

bool ParametersController::take_from_file(const std::string& key) {
  return in_file_ && change(key, value_of(key, *in_file_)).has_value();
}

bool ParametersController::take_from_unit(const std::string& key) {
  if (!has_unit_values() || params::field_named(key) == nullptr) return false;
  return change(key, value_of(key, {*unit_->parameters, {}})).has_value();
}

std::string ParametersController::undo() { return taken_back(stepped(edited_.undo())); }
std::string ParametersController::redo() { return stepped(edited_.redo()); }

std::string ParametersController::stepped(std::optional<std::string> what) {
  if (!what) return {};
  keep_draft();
  refresh();
  return std::move(*what);
}

void ParametersController::keep_draft() const {
  (void)edited_.keep(draft_text({absolute(file_), absolute(machine_path_), set(), edited_.saved()}));
}

void ParametersController::refresh() {
  findings_ = file_findings_;
  for (params::Finding& finding : params::check(set().parameters, machine_ ? &*machine_ : nullptr))
    findings_.push_back(std::move(finding));
  compared_.clear();
  changes_ = 0;
  const std::optional<ParameterSet> held =
      has_unit_values() ? std::optional(ParameterSet{*unit_->parameters, {}}) : std::nullopt;
  for (const std::string& key : all_keys()) {
    const std::string here = value_of(key, set());
    if (here != value_of(key, edited_.saved())) ++changes_;
    const bool in_unit = held && params::field_named(key) != nullptr;
    ComparedKey row{key, here, in_file_ ? value_of(key, *in_file_) : "", in_unit ? value_of(key, *held) : ""};
    if ((in_file_ && row.file != here) || (in_unit && row.unit != here)) compared_.push_back(std::move(row));
  }
}

std::vector<const params::Finding*> ParametersController::findings_of(const std::string& key) const {
  std::vector<const params::Finding*> found;
  for (const params::Finding& finding : findings_)
    if (std::find(finding.keys.begin(), finding.keys.end(), key) != finding.keys.end()) found.push_back(&finding);
  return found;
}

std::size_t ParametersController::errors() const {
  return static_cast<std::size_t>(std::count_if(findings_.begin(), findings_.end(), [](const params::Finding& finding) {
    return finding.severity == params::Severity::error;
  }));
}

std::optional<std::string> ParametersController::was(const std::string& key) const {
  std::string before = value_of(key, edited_.saved());
  if (before == value_of(key, set())) return std::nullopt;
  return before;
}

std::size_t ParametersController::differs_from_file() const {
  if (!in_file_) return 0;
  return static_cast<std::size_t>(
      std::count_if(compared_.begin(), compared_.end(), [](const ComparedKey& row) { return row.file != row.screen; }));
}

std::vector<ComparedKey> ParametersController::differs_from_unit() const {
  std::vector<ComparedKey> differing;
  for (const ComparedKey& row : compared_)
    if (differs_from_unit(row.key)) differing.push_back(row);
  return differing;
}

bool ParametersController::differs_from_unit(const std::string& key) const {
  if (!has_unit_values() || params::field_named(key) == nullptr) return false;
  const auto row = std::find_if(compared_.begin(), compared_.end(), [&](const ComparedKey& c) { return c.key == key; });
  return row != compared_.end() && row->unit != row->screen;
}

Result<void> ParametersController::check_with(const std::string& machine_path) {
  if (machine_path.empty()) {
    machine_.reset();
    machine_path_.clear();
    machine_name_.clear();
  } else {
    if (auto plain = plain_file(machine_path); !plain) return plain;
    ECS_TRY(read, params::read_machine(machine_path));
    machine_ = std::move(read.machine);
    machine_path_ = machine_path;
    machine_name_ = machine_->name.empty() ? machine_path : machine_->name;
  }
  refresh();
  return {};
}

std::string ParametersController::overwrites(const std::string& path) const {
  if (!disc::exists(path)) return {};
  if (path != file_) return fmt::format("{} already exists. Its contents will be overwritten.", path);
  const auto text = read_file(path);
  if (text && *text == file_text_) return {};
  return fmt::format("{} was changed by another program since it was read here; that change will be lost.", path);
}

Result<void> ParametersController::save(const std::string& path) {
  if (auto plain = plain_file(path); !plain) return plain;
  std::string text = params::parameters_toml(set().parameters, set().identity);
  if (auto written = write_file(path, text); !written) return written;
  record({.kind = "parameters",
          .summary = "parameters saved to " + std::filesystem::path(path).filename().string(),
          .files = seen_files({}, {path})});
  note_written(path, set());
  file_text_ = std::move(text);
  file_findings_.clear();
  file_ = path;
  in_file_ = set();
  edited_.settle();
  refresh();
  return {};
}

/// As the command that writes it: from the file where it began, or from its machine file; else with all that it holds.
void ParametersController::note_written(const std::string& path, const ParameterSet& what) {
  const std::string file = path_word(path);
  if (held_.path.empty() && held_.machine.empty()) {
    note_file(path, params::parameters_toml(what.parameters, what.identity));
  } else {
    std::vector<std::string> changed;
    for (const std::string& key : all_keys())
      if (value_of(key, what) != value_of(key, held_.set))
        changed.push_back(fmt::format("{}={}", key, value_of(key, what)));
    const std::string from = held_.path.empty() ? file : path_word(held_.path);
    if (held_.path.empty()) note_command({"params", "new", "--machine", path_word(held_.machine), "-o", file});
    if (changed.empty() && from != file)  // `params set` needs a value: one that the file has
      changed.push_back(fmt::format("{}={}", all_keys().back(), value_of(all_keys().back(), what)));
    if (!changed.empty()) {
      std::vector<std::string> words{"params", "set", from};
      words.insert(words.end(), changed.begin(), changed.end());
      words.insert(words.end(), {"-o", file});
      if (!held_.whole) words.emplace_back("--accept-incomplete");
      note_command(std::move(words));
    }
  }
  held_ = {path, {}, what, true};
}

std::string ParametersController::file_for_commands(const ParameterSet& what) {
  if (held_.path.empty() || held_.set != what) note_written(file_between("parameters", ".toml"), what);
  return path_word(held_.path);
}

void ParametersController::know_unit(UnitContent unit) {
  unit_ = std::move(unit);
  refresh();
}

void ParametersController::sent(const ParameterSet& what, UnitContent after) {
  unit_ = std::move(after);
  edited_.settle(what);
  keep_draft();
  refresh();
}

}  // namespace ecs::commissioning
