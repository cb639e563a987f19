#include "commissioning/logbook/observed.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

thread_local const ObservedFiles* observed_by_thread = nullptr;

std::filesystem::path whole(const std::filesystem::path& path) {
  std::error_code error;
  const auto absolute = std::filesystem::absolute(path, error);
  return error ? path : absolute.lexically_normal();
}

bool is_within(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return !folder.empty() && end == folder.end();
}

void take(LogOwner& owner, const LogOwner& found) {
  const bool other = !owner.machine.empty() && !found.machine.empty() && owner.machine != found.machine;
  if (other) return;
  if (owner.machine.empty()) owner.machine = found.machine;
  if (owner.serial_number.empty()) owner.serial_number = found.serial_number;
}

}  // namespace

ObservedFiles::ObservedFiles() : before_(std::exchange(observed_by_thread, this)) {
  left_out_.push_back(whole(settings_file()).parent_path());
  if (const auto state = state_folder()) left_out_.push_back(whole(*state));
}

ObservedFiles::~ObservedFiles() { observed_by_thread = before_; }

const ObservedFiles* ObservedFiles::current() { return observed_by_thread; }

void ObservedFiles::was_read(const std::filesystem::path& path, std::string_view content) {
  const std::filesystem::path at = whole(path);
  if (std::any_of(left_out_.begin(), left_out_.end(), [&](const auto& folder) { return is_within(at, folder); }))
    return;
  const auto same = [&](const SeenFile& seen) { return seen.name == path.string(); };
  if (std::any_of(inputs_.begin(), inputs_.end(), same)) return;
  if (std::any_of(outputs_.begin(), outputs_.end(), same)) return;  // its own, read again
  inputs_.push_back({"input", path.string(), std::make_shared<const std::string>(content)});
}

void ObservedFiles::was_written(const std::filesystem::path& path, std::string_view content) {
  const std::filesystem::path at = whole(path);
  if (std::any_of(left_out_.begin(), left_out_.end(), [&](const auto& folder) { return is_within(at, folder); }))
    return;
  std::erase_if(outputs_, [&](const SeenFile& seen) { return seen.name == path.string(); });
  outputs_.push_back({"output", path.string(), std::make_shared<const std::string>(content)});
}

std::vector<SeenFile> ObservedFiles::files() const {
  std::vector<SeenFile> all = inputs_;
  all.insert(all.end(), outputs_.begin(), outputs_.end());
  return all;
}

bool is_measurement_set(std::string_view content) {
  std::size_t begin = 0;
  while (begin < content.size()) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view line = trimmed(content.substr(begin, end - begin));
    begin = end + 1;
    if (line.empty() || line.starts_with('#')) continue;
    const std::string names = fmt::format(",{},", lower(line));
    return names.find(",sense,") != std::string::npos && names.find(",reading,") != std::string::npos;
  }
  return false;
}

LogOwner owner_of(const std::vector<SeenFile>& files) {
  LogOwner owner;
  for (const SeenFile& file : files) take(owner, owner_in(*file.content));
  if (!owner.machine.empty()) return owner;
  const Unwatched not_an_input;
  for (const SeenFile& file : files)
    for (const char* beside : {"parameters.toml", "machine.toml"})
      if (const auto content = read_file(std::filesystem::path(file.name).parent_path() / beside))
        take(owner, owner_in(*content));
  return owner;
}

Instrument instrument_of(const std::vector<SeenFile>& files) {
  for (const SeenFile& file : files)
    if (const Instrument found = instrument_in_header(*file.content); is_known(found)) return found;
  const Unwatched not_an_input;
  const auto in_use = instrument_in_use();
  return in_use ? in_use->value_or(Instrument{}) : Instrument{};
}

}  // namespace ecs::commissioning
