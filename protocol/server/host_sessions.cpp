#include "protocol/server/host_sessions.hpp"

#include <algorithm>
#include <random>

namespace ecs::protocol {

HostSession& HostSessions::open(const SessionOpen& host) {
  auto found = std::find_if(sessions_.begin(), sessions_.end(), [&](const HostSession& session) {
    return session.id != 0 && session.host.key == host.key && session.host.number == host.number;
  });
  if (found == sessions_.end()) {
    found = std::min_element(sessions_.begin(), sessions_.end(),
                             [](const HostSession& a, const HostSession& b) { return a.used < b.used; });
    *found = HostSession{number_by_chance(found->id), host, {}, 0};
  }
  found->host = host;
  found->used = ++uses_;
  return *found;
}

HostSession* HostSessions::find(std::uint32_t id) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(),
                                  [id](const HostSession& session) { return id != 0 && session.id == id; });
  if (found == sessions_.end()) return nullptr;
  found->used = ++uses_;
  return &*found;
}

std::uint32_t number_by_chance(std::uint32_t other) {
  std::random_device chance;
  std::uint32_t number = other;
  while (number == other || number == 0) number = chance();
  return number;
}

}  // namespace ecs::protocol
