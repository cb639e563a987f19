#include "app/cli/console.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "base/text.hpp"

namespace ecs::app {
namespace {

class DescriptorKeyboard final : public Keyboard {
 public:
  explicit DescriptorKeyboard(int descriptor) : descriptor_(descriptor) {}

  std::optional<std::string> line() override {
    while (buffer_.find('\n') == std::string::npos && !ended_ && take_what_is_there()) continue;
    const std::size_t end = buffer_.find('\n');
    if (end == std::string::npos && !(ended_ && !buffer_.empty())) return std::nullopt;
    std::string text = buffer_.substr(0, end);
    buffer_.erase(0, end == std::string::npos ? end : end + 1);
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  bool ended() const override { return ended_ && buffer_.empty(); }

 private:
  /// False: nothing is there now.
  bool take_what_is_there() {
    pollfd wanted{descriptor_, POLLIN, 0};
    if (::poll(&wanted, 1, 0) <= 0 || wanted.revents == 0) return false;
    std::array<char, 4096> piece{};
    const ssize_t count = ::read(descriptor_, piece.data(), piece.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return false;
    if (count <= 0) {
      ended_ = true;
      return false;
    }
    buffer_.append(piece.data(), static_cast<std::size_t>(count));
    return true;
  }

  int descriptor_;
  std::string buffer_;
  bool ended_ = false;
};

}  // namespace

std::shared_ptr<Keyboard> keyboard_of(int descriptor) { return std::make_shared<DescriptorKeyboard>(descriptor); }
std::shared_ptr<Keyboard> keyboard_of_stdin() { return keyboard_of(STDIN_FILENO); }

namespace {

constexpr int kBarCells = 30;
constexpr std::size_t kLongestMessage = 4000;  // of a line: two screens of 24 × 80; a file can hold a name of megabytes
constexpr std::string_view kRed = "31", kYellow = "33", kPlain;

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

std::string bar_of(double fraction) {
  const int full = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarCells);
  return std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(kBarCells - full), '.');
}

}  // namespace

ConsoleOptions options_of_stderr() {
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  const char* kind = std::getenv("TERM");
  const bool dumb = kind == nullptr || std::string_view(kind) == "dumb";
  return {terminal, terminal && !dumb && ::isatty(STDOUT_FILENO) == 1, terminal && !dumb && !is_set("NO_COLOR"),
          nullptr};
}

void Console::say(std::string_view colour, std::string_view text) {
  end_progress();
  erase_block();
  const std::string harmless = shown(text);
  for (const std::string_view whole : lines_of(harmless)) {
    const std::string line = cut_line(whole, kLongestMessage);
    if (options_.colour && !colour.empty())
      *messages_ << "\033[" << colour << 'm' << message_prefix << line << "\033[0m\n";
    else
      *messages_ << message_prefix << line << '\n';
  }
  draw_block();
  messages_->flush();
}

void Console::note(std::string_view text) {
  if (!quiet) say(kPlain, text);
}
void Console::warn(std::string_view text) { say(kYellow, fmt::format("warning: {}", text)); }
void Console::show(const Problem& problem) { say(kRed, to_text(problem)); }

void Console::print(std::string_view text) {
  if (json) return;
  end_progress();
  *out_ << shown(text) << '\n';
  out_->flush();
}

void Console::print_json(std::string_view object) {
  if (!json) return;
  *out_ << object << '\n';
  out_->flush();
}

void Console::answer(std::string_view text, std::string_view json_object) {
  end_progress();
  const std::string chosen = json ? std::string(json_object) : shown(text);
  if (chosen.empty()) return;
  if (!json) *out_ << message_prefix;
  *out_ << chosen;
  if (chosen.back() != '\n') *out_ << '\n';
  out_->flush();
}

void Console::progress(std::string_view label, double fraction, double seconds_left) {
  if (!options_.messages_on_terminal || quiet) return;
  const auto now = std::chrono::steady_clock::now();
  if (bar_shown_ && now - bar_drawn_ < std::chrono::milliseconds(100)) return;
  bar_shown_ = true;
  bar_drawn_ = now;
  *messages_ << fmt::format("\r{}{} [{}] {:3.0f} %  {:.0f} s left \033[K", message_prefix, shown(label),
                            bar_of(fraction), 100.0 * std::clamp(fraction, 0.0, 1.0), std::max(0.0, seconds_left));
  messages_->flush();
}

void Console::end_progress() {
  if (!bar_shown_) return;
  *messages_ << "\r\033[K";
  messages_->flush();
  bar_shown_ = false;
}

bool Console::shows_blocks() const {
  return options_.messages_on_terminal && options_.answers_on_terminal && !quiet && !json;
}

void Console::erase_block() {
  if (!block_.empty()) *messages_ << fmt::format("\033[{}A\r\033[J", block_.size());
}

void Console::draw_block() {
  for (const std::string& line : block_) *messages_ << line << '\n';
}

void Console::show_block(const std::vector<std::string>& lines) {
  erase_block();
  block_.clear();
  for (const std::string& line : lines) block_.push_back(shown(line));
  draw_block();
  messages_->flush();
}

void Console::end_block() {
  erase_block();
  block_.clear();
  messages_->flush();
}

bool Console::output_is_whole() {
  out_->flush();
  return out_->good();
}

}  // namespace ecs::app
