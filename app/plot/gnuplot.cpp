#include "app/plot/gnuplot.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/interrupt.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

using namespace std::chrono_literals;

constexpr auto kDrawingLimit = 60s;

/// A file in memory without a name; closes itself.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("ecs-plot", MFD_CLOEXEC)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] int number() const { return file_; }

  [[nodiscard]] bool fill(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(file_, text.data(), text.size());
      if (written <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return ::lseek(file_, 0, SEEK_SET) == 0;
  }

  [[nodiscard]] std::string content() const {
    const off_t size = ::lseek(file_, 0, SEEK_END);
    std::string text(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t got = ::pread(file_, text.data() + done, text.size() - done, static_cast<off_t>(done));
      if (got <= 0) break;
      done += static_cast<std::size_t>(got);
    }
    text.resize(done);
    return text;
  }

 private:
  int file_ = -1;
};

auto failed(const std::string& what) { return problem(ProblemKind::output, fmt::format("gnuplot: {}", what)); }

Result<pid_t> spawned(const MemoryFile& in, const MemoryFile& out, const MemoryFile& errors) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in.number(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, out.number(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, errors.number(), STDERR_FILENO);
  char program[] = "gnuplot", no_start_files[] = "-d";
  char* const words[] = {program, no_start_files, nullptr};
  pid_t child = -1;
  const int fault = ::posix_spawnp(&child, program, &actions, nullptr, words, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (fault == ENOENT) return failed("not found; plots need it: install the package gnuplot-nox");
  if (fault != 0) return failed(std::strerror(fault));
  return child;
}

/// Its wait status; a child that outstays its time is killed.
Result<int> ended(pid_t child) {
  int status = 0;
  for (const auto end = std::chrono::steady_clock::now() + kDrawingLimit; ::waitpid(child, &status, WNOHANG) == 0;) {
    const bool late = std::chrono::steady_clock::now() > end;
    if (late || interrupted()) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return failed(late ? "did not finish within 60 s" : "stopped");
    }
    std::this_thread::sleep_for(5ms);
  }
  return status;
}

Result<std::string> drawn(const std::string& script) {
  MemoryFile in, out, errors;
  if (!in.fill(script) || out.number() < 0 || errors.number() < 0) return failed(std::strerror(errno));
  const auto child = spawned(in, out, errors);
  if (!child) return tl::unexpected(child.error());
  const auto status = ended(*child);
  if (!status) return tl::unexpected(status.error());
  std::string picture = out.content();
  if (*status != 0 || picture.empty()) return failed(std::string(trimmed(errors.content())));
  return picture;
}

}  // namespace

Result<PlotFormat> plot_format_of(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".svg") return PlotFormat::svg;
  if (extension == ".png") return PlotFormat::png;
  return problem(ProblemKind::usage, fmt::format("{}: a plot ends in .svg or .png", path.string()));
}

Result<void> write_plot(const std::filesystem::path& path, const PlotFigure& figure) {
  const auto format = plot_format_of(path);
  if (!format) return tl::unexpected(format.error());
  const auto picture = drawn(plot_script(figure, *format));
  if (!picture) return tl::unexpected(picture.error());
  return write_file(path, *picture);
}

}  // namespace ecs::app
