#include "base/file_watch.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>
#include <utility>

namespace ecs {
namespace {

thread_local FileWatch* watch_of_thread = nullptr;

}  // namespace

FileWatch::FileWatch() : before_(std::exchange(watch_of_thread, this)) {}
FileWatch::~FileWatch() { watch_of_thread = before_; }

Unwatched::Unwatched() : before_(std::exchange(watch_of_thread, nullptr)) {}
Unwatched::~Unwatched() { watch_of_thread = before_; }

FileWatch* FileWatch::current() { return watch_of_thread; }

Result<std::string> FileWatch::content(const std::filesystem::path& path) {
  return problem_at(path.string(), 0, 0, "no such file");
}

bool is_there(const std::filesystem::path& path) {
  if (FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc())
    return watch->content(path).has_value();
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

std::string head_of(const std::filesystem::path& path, std::size_t bytes) {
  if (FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc())
    return watch->content(path).value_or("").substr(0, bytes);
  std::string head(bytes, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  return head;
}

}  // namespace ecs
