#include "commissioning/session/message.hpp"

#include <ctime>
#include <deque>
#include <fstream>
#include <mutex>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "base/file.hpp"

namespace ecs::commissioning {

void Message::say(const std::string& text, Tone tone) {
  text_ = text;
  tone_ = tone;
  log_event(tone, text);
}

void Asking::ask(Question question, std::function<void()> on_yes, std::function<void()> on_no) {
  question_ = std::move(question);
  on_yes_ = std::move(on_yes);
  on_no_ = std::move(on_no);
}

void Asking::answer(bool yes) {
  const auto follow = yes ? std::move(on_yes_) : std::move(on_no_);
  *this = {};
  if (follow) follow();
}

namespace {

constexpr std::size_t kKept = 1000;
constexpr std::uintmax_t kMostBytes = 1 << 20;

std::mutex log_mutex;
std::deque<LogEntry> entries;
std::vector<std::string> left;

void append(const std::string& line) {
  const std::filesystem::path path = log_file();
  if (path.empty()) return;
  std::error_code error;
  const bool afresh = std::filesystem::file_size(path, error) > kMostBytes && !error;
  std::ofstream(path, afresh ? std::ios::trunc : std::ios::app) << line;
}

}  // namespace

std::filesystem::path log_file() {
  const auto folder = state_folder();
  return folder ? *folder / "screens.log" : std::filesystem::path();
}

void log_event(Tone tone, const std::string& text) {
  if (text.empty()) return;
  const std::lock_guard lock(log_mutex);
  if (!entries.empty() && entries.back().text == text) return;
  const std::tm now = fmt::localtime(std::time(nullptr));
  entries.push_back({fmt::format("{:%H:%M:%S}", now), tone, text});
  if (entries.size() > kKept) entries.pop_front();
  const char* kind = tone == Tone::bad ? "error" : (tone == Tone::warning ? "warning" : "note");
  append(fmt::format("{:%Y-%m-%d %H:%M:%S} {}: {}\n", now, kind, text));
}

void leave_word(const std::string& text) {
  log_event(Tone::bad, text);
  const std::lock_guard lock(log_mutex);
  left.push_back(text);
}

std::vector<std::string> words_left() {
  const std::lock_guard lock(log_mutex);
  return left;
}

std::vector<LogEntry> logged() {
  const std::lock_guard lock(log_mutex);
  return {entries.begin(), entries.end()};
}

}  // namespace ecs::commissioning
