#include "commissioning/logbook/entry.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::string_view kHashed = "ecs-logbook-1";  // changes with what is hashed

Json content_json(const LogbookEntry& entry) {
  Json content = Json::parse(entry.content, nullptr, false);
  return content.is_object() ? content : Json::object();
}

std::string text_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::string hash_of(const LogbookEntry& entry) {
  std::string bytes;
  const auto add = [&bytes](std::string_view part) { bytes += fmt::format("{}:", part.size()).append(part); };
  add(kHashed);
  add(fmt::format("{}", entry.number));
  for (const std::string* part : {&entry.time, &entry.kind, &entry.machine, &entry.serial_number, &entry.operator_name,
                                  &entry.instrument, &entry.summary, &entry.content, &entry.previous})
    add(*part);
  return sha256_hex(bytes);
}

std::string no_previous() { return std::string(64, '0'); }

std::vector<LogFile> files_of(const LogbookEntry& entry) {
  std::vector<LogFile> files;
  const Json content = content_json(entry);
  const auto found = content.find("files");
  if (found == content.end() || !found->is_array()) return files;
  for (const Json& one : *found) {
    if (!one.is_object()) continue;
    LogFile file{text_in(one, "role"), text_in(one, "name"), text_in(one, "sha256"), 0, false};
    if (const auto bytes = one.find("bytes"); bytes != one.end() && bytes->is_number_unsigned())
      file.bytes = bytes->get<std::uint64_t>();
    if (const auto kept = one.find("kept"); kept != one.end() && kept->is_boolean()) file.kept = kept->get<bool>();
    files.push_back(std::move(file));
  }
  return files;
}

std::vector<std::string> words_of(const LogbookEntry& entry) {
  std::vector<std::string> words;
  const Json content = content_json(entry);
  const auto found = content.find("words");
  if (found == content.end() || !found->is_array()) return words;
  for (const Json& word : *found)
    if (word.is_string()) words.push_back(word.get<std::string>());
  return words;
}

std::string folder_of(const LogbookEntry& entry) { return text_in(content_json(entry), "folder"); }

}  // namespace ecs::commissioning
