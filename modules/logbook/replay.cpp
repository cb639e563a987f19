#include "modules/logbook/replay.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "core/memory_image.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
namespace {

/// Verbs whose answer depends on their words and files alone.
constexpr const char* kRepeatable[] = {"laser import", "laser process", "laser prepare", "laser normalise", "map build",
                                       "params new",   "params set",    "model new",     "model fit",       "model add",
                                       "model undo",   "model remove",  "model decide"};

bool is_repeatable(const std::vector<std::string>& words) {
  return words.size() >= 2 && std::any_of(std::begin(kRepeatable), std::end(kRepeatable), [&](const char* verb) {
           return fmt::format("{} {}", words[0], words[1]) == verb;
         });
}

/// The input of the activation that is a map, or one that is a parameter file.
template <class Reads>
const LogFile* input_that(const Logbook& book, const std::vector<LogFile>& files, const Reads& reads) {
  for (const LogFile& file : files) {
    if (file.role != "input" || !file.kept) continue;
    const auto content = book.original(file.sha256);
    if (content && reads(*content, file.name)) return &file;
  }
  return nullptr;
}

bool reads_as_map(const std::string& content, const std::string& name) {
  const auto map = laser::parse_map_csv(content, name);
  return map && (!map->tables.empty() || !map->header.declared_zero.empty());
}

bool reads_as_parameters(const std::string& content, const std::string& name) {
  return name.ends_with(".toml") && params::parse_parameters(content, name).has_value();
}

Result<std::string> image_text(const std::string& csv, const UnitParameters& parameters, const std::string& like) {
  ECS_TRY(map, laser::parse_map_csv(csv, "the map derived again"));
  ECS_TRY(image, laser::image_of(map, parameters));
  const std::vector<std::uint8_t> active(like.begin(), like.end());
  std::vector<std::uint8_t> bytes = std::move(image.bytes);
  if (const auto identity = ImageView(active).identity()) {
    ECS_TRY(addressed, laser::with_identity(std::move(bytes), *identity));
    bytes = std::move(addressed);
  }
  return std::string(bytes.begin(), bytes.end());
}

/// What became active, and from which files.
struct Activation {
  LogbookEntry entry;
  std::string image;
  laser::ImageContent content;
  std::optional<LogFile> map, parameters;
};

Result<Activation> read_activation(const Logbook& book, const LogbookEntry& entry) {
  const std::vector<LogFile> files = files_of(entry);
  const auto image = std::find_if(files.begin(), files.end(), [](const LogFile& f) { return f.role == "image"; });
  if (image == files.end()) return problem(ProblemKind::refused, fmt::format("entry {} names no image", entry.number));
  ECS_TRY(bytes, book.original(image->sha256));
  ECS_TRY(content, laser::content_of(std::vector<std::uint8_t>(bytes.begin(), bytes.end())));
  Activation found{entry, std::move(bytes), std::move(content), {}, {}};
  if (const LogFile* map = input_that(book, files, reads_as_map)) found.map = *map;
  if (const LogFile* parameters = input_that(book, files, reads_as_parameters)) found.parameters = *parameters;
  return found;
}

bool has_map(const Activation& one) {
  return !one.content.map.tables.empty() || !one.content.map.header.declared_zero.empty();
}

/// Where the files that were sent are not known (a screen, a batch, parameters sent beside their map): the newest map
/// before it whose image has the tables of this one.
Result<std::optional<LogFile>> map_before(const Logbook& book, const Activation& one) {
  ECS_TRY(entries, book.entries());
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    if (entry->number >= one.entry.number) continue;
    for (const LogFile& file : files_of(*entry)) {
      if (!file.kept || file.role == "image" || !file.name.ends_with(".csv")) continue;
      const auto csv = book.original(file.sha256);
      if (!csv || !reads_as_map(*csv, file.name)) continue;
      const auto image = image_text(*csv, one.content.parameters, one.image);
      if (image && *image == one.image) return std::optional(file);
    }
  }
  return std::optional<LogFile>();
}

}  // namespace

void KeptFiles::put(const std::string& name, std::string content) { files_[place_of(name)] = std::move(content); }

const std::string* KeptFiles::find(const std::string& name) const {
  const auto found = files_.find(place_of(name));
  return found == files_.end() ? nullptr : &found->second;
}

Result<std::string> KeptFiles::content(const std::filesystem::path& path) {
  if (const std::string* found = find(path.string())) return *found;
  return problem_at(path.string(), 0, 0, "no such file in the logbook's entry");
}

void KeptFiles::was_written(const std::filesystem::path& path, std::string_view content) {
  put(path.string(), std::string(content));
}

std::string KeptFiles::place_of(const std::filesystem::path& path) const {
  return (path.is_absolute() ? path : folder_ / path).lexically_normal().string();
}

Result<void> Derivation::know_entries() {
  if (entries_) return {};
  ECS_TRY(entries, book_.entries());
  entries_ = std::move(entries);
  return {};
}

Result<std::string> Derivation::file(const std::string& sha256, const std::string& name, std::int64_t before) {
  if (const auto found = done_.find(sha256); found != done_.end()) return found->second;
  ECS_DO(know_entries());
  for (auto entry = entries_->rbegin(); entry != entries_->rend(); ++entry) {
    if (entry->number >= before || !is_repeatable(words_of(*entry))) continue;
    const auto files = files_of(*entry);
    if (std::none_of(files.begin(), files.end(),
                     [&](const LogFile& file) { return file.role == "output" && file.sha256 == sha256; }))
      continue;
    return made_again(*entry, sha256);
  }
  auto content = book_.original(sha256);
  if (!content) return content;
  raw.push_back({name, sha256});
  done_[sha256] = *content;
  return content;
}

Result<std::string> Derivation::made_again(const LogbookEntry& entry, const std::string& sha256) {
  const std::vector<LogFile> files = files_of(entry);
  const std::vector<std::string> words = words_of(entry);
  KeptFiles kept(folder_of(entry));
  {
    const Unwatched book_alone;
    for (const LogFile& one : files) {
      if (one.role != "input") continue;
      auto content = file(one.sha256, one.name, entry.number);
      if (!content) return content;
      kept.put(one.name, std::move(*content));
    }
  }
  const auto answer = run_(words);
  const std::string verb = fmt::format("{}", fmt::join(words, " "));
  std::string wanted;
  for (const LogFile& one : files) {
    if (one.role != "output") continue;
    const std::string* content = answer ? kept.find(one.name) : nullptr;
    if (content == nullptr) {
      const std::string why = answer ? "it did not write " + one.name : to_text(answer.error());
      return problem(ProblemKind::refused,
                     fmt::format("entry {} cannot be done again: `ecs {}`: {}", entry.number, verb, why));
    }
    derived.push_back({entry.number, verb, one.name, one.sha256, sha256_hex(*content) == one.sha256});
    done_[one.sha256] = *content;
    if (one.sha256 == sha256) wanted = *content;
  }
  return wanted;
}

Result<Replay> replayed(const Logbook& book, const RunVerb& run, const std::string& active) {
  ECS_TRY(activations, book.activations());
  std::optional<Activation> last;
  for (auto entry = activations.rbegin(); entry != activations.rend() && !last; ++entry) {
    ECS_TRY(one, read_activation(book, *entry));
    if (!has_map(one))
      return problem(ProblemKind::refused,
                     fmt::format("entry {}: the image that is active holds parameters but no map", entry->number));
    last = std::move(one);
  }
  if (!last)
    return tl::unexpected(Problem{ProblemKind::refused,
                                  "no map was made active while this logbook was kept: there is nothing to derive",
                                  book.path().string(),
                                  0,
                                  0,
                                  {}});
  if (!last->map) {
    ECS_TRY(found, map_before(book, *last));
    last->map = std::move(found);
  }
  if (!last->map)
    return problem(
        ProblemKind::refused,
        fmt::format("entry {}: no map in this logbook gives the image that became active: it was made elsewhere",
                    last->entry.number));
  Replay replay;
  replay.activation = last->entry.number;
  Derivation derivation(book, run);
  ECS_TRY(csv, derivation.file(last->map->sha256, last->map->name, last->entry.number));
  UnitParameters parameters = last->content.parameters;
  if (last->parameters) {
    ECS_TRY(text, derivation.file(last->parameters->sha256, last->parameters->name, last->entry.number));
    ECS_TRY(read, params::parse_parameters(text, last->parameters->name));
    parameters = read.parameters;
  } else {
    replay.notes.emplace_back(
        "the parameters are those of the active image: the logbook does not say which file they were");
  }
  ECS_TRY(image, image_text(csv, parameters, last->image));
  replay.map_sha256 = sha256_hex(image);
  replay.active_sha256 = sha256_hex(active.empty() ? last->image : active);
  replay.same = replay.map_sha256 == replay.active_sha256;
  replay.derived = std::move(derivation.derived);
  replay.raw = std::move(derivation.raw);
  if (std::none_of(replay.derived.begin(), replay.derived.end(),
                   [&](const DerivedFile& one) { return one.sha256 == last->map->sha256; }))
    replay.notes.push_back(
        fmt::format("{} was not made while this logbook was kept: it is taken as it was sent", last->map->name));
  return replay;
}

}  // namespace ecs::commissioning
