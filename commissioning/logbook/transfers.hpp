// What went to a unit: images that were sent, and what became active; bytes written into its memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {

/// Two entries: the transfer, and the activation; `rollback` in its place where that image was active before the one
/// that it replaces. A transfer that failed, or that found the image active, is one entry.
void record_transfer(const SentImage& sent);

/// Bytes written into the unit's memory, or, with a problem, perhaps a part of them.
struct MemoryWritten {
  std::string serial_number;
  std::uint32_t address = 0;
  std::span<const std::uint8_t> bytes;
  std::string problem;  ///< why it failed; empty: it did not
};
void record_memory_write(const MemoryWritten& one);

}  // namespace ecs::commissioning
