#include "app/cli/keyboard.hpp"

#include <array>
#include <cerrno>

#include <poll.h>
#include <unistd.h>

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

}  // namespace ecs::app
