// What can go wrong with a link, in kinds that a program may act on. The messages: protocol/client/link.cpp.
#pragma once

namespace ecs::protocol {

/// What the last problem of a link was. Each has a message of its own.
enum class LinkFailure {
  none,
  no_such_port,  ///< or no such host
  no_permission,
  not_a_serial_port,
  port_in_use,
  no_connection,  ///< TCP refused or not reachable
  no_answer,
  garbled,    ///< bad CRC, or a reply that is no reply to the request
  stale,      ///< only late replies to earlier requests
  exception,  ///< the unit answered with a Modbus exception
  disconnected,
  cancelled,
};

}  // namespace ecs::protocol
