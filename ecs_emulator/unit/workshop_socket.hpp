// The workshop's door: a Unix socket with one JSON object a line, requests in, answers out.
// Does not live here: what the requests mean (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>

#include "base/process.hpp"
#include "base/result.hpp"

namespace ecs::emulator {

/// Answers a request; may send progress lines before.
using WorkshopHandler =
    std::function<std::string(const std::string& request, const std::function<void(const std::string&)>& report)>;

class WorkshopSocket {
 public:
  /// A socket file that nobody listens on any more is replaced; one that is in use is an `output` problem.
  [[nodiscard]] static Result<WorkshopSocket> listen_at(const std::filesystem::path& path);
  WorkshopSocket(WorkshopSocket&&) noexcept = default;
  WorkshopSocket& operator=(WorkshopSocket&&) noexcept = default;
  ~WorkshopSocket();  ///< removes the socket file

  [[nodiscard]] std::vector<pollfd> poll_fds() const;
  /// Does all there is to do without waiting; requests are answered in the order of their arrival, one at a time.
  void serve_ready(const WorkshopHandler& handler);
  /// While a request is carried out: whoever sent it has closed the line and waits for no answer.
  [[nodiscard]] bool visitor_left() const;

 private:
  struct Visitor {
    Descriptor line;
    std::string received;
    bool gone = false;
  };
  WorkshopSocket(Descriptor listener, std::filesystem::path path);
  void let_in();
  void hear(Visitor& visitor);
  void answer(Visitor& visitor, const WorkshopHandler& handler);

  Descriptor listener_;
  std::filesystem::path path_;
  std::vector<Visitor> visitors_;
  int served_ = -1;  ///< line of the visitor whose request is carried out
};

/// The client's side: one request, its answer. Progress lines go to `report`. `link` problem if nobody answers.
[[nodiscard]] Result<std::string> ask_workshop(const std::filesystem::path& socket, const std::string& request,
                                               const std::function<void(const std::string&)>& report = {});

}  // namespace ecs::emulator
