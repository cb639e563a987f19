#include "commissioning/measurements/capture_source.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/text.hpp"
#include "commissioning/measurements/device_choice.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kPatience_s = 2.0;  ///< for a line that a trigger asks for and that is not there yet
constexpr double kAnyAge_s = 1e12;

class GaugeSource final : public ReadingSource {
 public:
  explicit GaugeSource(devices::DevicePort port) : sensor_(std::move(port), 1e9) {}

  void ask(double now_s) override {
    before_ = sensor_.answers();
    give_up_s_ = now_s + sensor_.port().device().report.timeout_ms * 1e-3 + 0.1;
    sensor_.ask_now();
    sensor_.attend(now_s);
  }
  Shown shown(double now_s) override {
    if (!sensor_.port().present()) return {Shown::Kind::none, 0.0, "the gauge is unplugged"};
    sensor_.attend(now_s);
    if (!sensor_.polled() || sensor_.answers() > before_) {
      const devices::Values values = sensor_.values(now_s, kAnyAge_s);
      if (const auto found = values.find(devices::Quantity::reading_um); found != values.end())
        return {Shown::Kind::value, found->second, {}};
    }
    if (now_s < give_up_s_) return {};
    return {Shown::Kind::none, 0.0, "the gauge shows nothing: is it switched on, is its description right?"};
  }
  void attend(double now_s) override {
    if (!sensor_.polled()) sensor_.attend(now_s);
  }
  devices::PortChange look(double now_s) override { return sensor_.look(now_s); }
  std::string hindrance() const override { return sensor_.port().hindrance(); }
  std::string name() const override { return name_of(sensor_.port()); }

 private:
  devices::Sensor sensor_;
  int before_ = 0;
  double give_up_s_ = 0.0;
};

class FileSource final : public ReadingSource {
 public:
  FileSource(std::string path, int descriptor, bool fifo, bool following)
      : path_(std::move(path)), descriptor_(descriptor), fifo_(fifo), following_(following) {}
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource() override { ::close(descriptor_); }

  void ask(double now_s) override { give_up_s_ = now_s + kPatience_s; }
  Shown shown(double now_s) override {
    attend(now_s);
    auto line = following_ ? last_ : next_line();
    if (!line && now_s < give_up_s_ && (fifo_ || following_)) return {};
    if (!line && !fifo_ && !following_)
      return {Shown::Kind::ended, 0.0, fmt::format("{} holds no further reading", path_)};
    if (!line) return {Shown::Kind::late, 0.0, fmt::format("no reading came from {} within {} s", path_, kPatience_s)};
    if (const auto number = last_number_in(*line)) return {Shown::Kind::value, *number, {}};
    return {Shown::Kind::none, 0.0, fmt::format("{}: expected a number, got \"{}\"", path_, *line)};
  }
  void attend(double) override {
    while (following_) {
      auto line = next_line();
      if (!line) return;
      last_ = std::move(line);
    }
  }
  std::string name() const override { return (following_ ? "display followed in " : "readings of ") + path_; }

 private:
  std::optional<std::string> next_line() {
    while (true) {
      const bool more = take_what_is_there();
      std::size_t end = buffer_.find('\n');
      if (end == std::string::npos) {
        if (more) continue;
        if (fifo_ || following_ || buffer_.empty()) return std::nullopt;  // a line in the making may yet grow
        end = buffer_.size();
      }
      const std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      const std::string text(trimmed(std::string_view(line).substr(0, line.find('#'))));
      if (!text.empty()) return text;
    }
  }
  bool take_what_is_there() {
    std::array<char, 4096> piece{};
    const ssize_t count = ::read(descriptor_, piece.data(), piece.size());
    if (count > 0) buffer_.append(piece.data(), static_cast<std::size_t>(count));
    return count > 0;
  }

  std::string path_;
  int descriptor_;
  bool fifo_;
  bool following_;
  std::string buffer_;
  std::optional<std::string> last_;
  double give_up_s_ = 0.0;
};

class CommandSource final : public ReadingSource {
 public:
  explicit CommandSource(std::string command) : command_(std::move(command)) {}

  void ask(double) override {}
  Shown shown(double) override {
    FILE* pipe = ::popen(command_.c_str(), "re");
    if (pipe == nullptr) return {Shown::Kind::none, 0.0, fmt::format("{}: {}", command_, std::strerror(errno))};
    std::string text;
    std::array<char, 512> piece{};
    while (std::fgets(piece.data(), piece.size(), pipe) != nullptr && text.size() < 65536) text += piece.data();
    const int status = ::pclose(pipe);
    const auto number = last_number_in(text);
    if (status == 0 && number) return {Shown::Kind::value, *number, {}};
    return {Shown::Kind::none, 0.0,
            status != 0 ? fmt::format("{}: it failed (status {})", command_, status)
                        : fmt::format("{}: expected a number in its output, got \"{}\"", command_, trimmed(text))};
  }
  std::string name() const override { return "display: " + command_; }

 private:
  std::string command_;
};

Result<std::unique_ptr<ReadingSource>> source_of_file(const std::string& path, bool following) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  const bool fifo = kind == std::filesystem::file_type::fifo;
  // Opened for writing too, a FIFO does not end when one writer of several has gone.
  const int descriptor = ::open(path.c_str(), (fifo ? O_RDWR : O_RDONLY) | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 || kind == std::filesystem::file_type::directory) {
    const int why = descriptor < 0 ? errno : EISDIR;
    if (descriptor >= 0) ::close(descriptor);
    return problem_at(path, 0, 0, fmt::format("the readings cannot be opened: {}", std::strerror(why)));
  }
  return std::make_unique<FileSource>(path, descriptor, fifo, following);
}

}  // namespace

std::optional<double> last_number_in(std::string_view line) {
  std::optional<double> last;
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t begin = line.find_first_of("+-.0123456789", at);
    if (begin == std::string_view::npos) return last;
    const std::size_t end = line.find_first_not_of("+-.0123456789eE", begin);
    if (const auto number = number_in(line.substr(begin, end - begin))) last = number;
    at = end;
  }
  return last;
}

std::unique_ptr<ReadingSource> gauge_source(devices::DevicePort port) {
  return std::make_unique<GaugeSource>(std::move(port));
}
Result<std::unique_ptr<ReadingSource>> file_source(const std::string& path) { return source_of_file(path, false); }
Result<std::unique_ptr<ReadingSource>> following_source(const std::string& path) { return source_of_file(path, true); }
std::unique_ptr<ReadingSource> command_source(std::string command) {
  return std::make_unique<CommandSource>(std::move(command));
}

}  // namespace ecs::commissioning
