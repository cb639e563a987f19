// What the bytes of a unit's memory mean: commit records, images, parameters, table directory, header. Total: any bytes
// are decoded as far as they go, and what is wrong with them is said; in words and as JSON.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/memory/dump.hpp"
#include "core/memory_image.hpp"

namespace ecs::commissioning {

struct CommitSlot {
  Address address = 0;
  bool blank = true;             ///< never written
  std::optional<Commit> commit;  ///< nothing: blank or corrupt
  bool active = false;
};
/// "sequence 7, bank A, 4096 bytes, check 1234ABCD", "blank" or "corrupt".
[[nodiscard]] std::string text_of(const CommitSlot& slot);

/// One row of the table directory.
struct DecodedTable {
  std::uint32_t number = 0;
  Address entry_address = 0;
  bool known_codes = false;  ///< component and approach are ones that exist
  TableEntry entry;          ///< component and approach meaningless unless known_codes
  Address values_address = 0;
  bool readable = false;       ///< all values lie within the bytes
  std::vector<double> values;  ///< um or um/m; empty unless readable
  double least = 0.0;          ///< of the values
  double most = 0.0;
  std::string fault;  ///< in words; empty: none
  [[nodiscard]] double end_mm() const {
    return entry.start_mm + entry.increment_mm * (entry.count > 0 ? static_cast<double>(entry.count - 1) : 0.0);
  }
};

/// Whom an image is addressed to.
struct DecodedIdentity {
  std::string serial_number;
  std::string machine;
  std::uint32_t configuration = 0;
  friend bool operator==(const DecodedIdentity&, const DecodedIdentity&) = default;
};

struct DecodedImage {
  std::string region;
  Address address = 0;
  std::uint32_t bytes = 0;  ///< that the prefix announces; 0: none
  bool active = false;      ///< the active commit record names it
  std::uint16_t format = 0;
  std::optional<DecodedIdentity> identity;  ///< nothing in format 1
  ImageVerdict verdict;
  std::optional<UnitParameters> parameters;
  std::vector<DecodedTable> tables;
  std::string header;
  std::vector<std::string> faults;  ///< in words
};

struct DecodedMemory {
  std::array<CommitSlot, 2> commits{};
  bool has_commits = false;  ///< the dump holds the commit records
  std::vector<DecodedImage> images;
  std::vector<std::string> faults;  ///< of the whole: damage of the file, the commit names other bytes
  std::vector<std::string> notes;   ///< that no map has been sent yet
  [[nodiscard]] bool sound() const;
  /// The active image, else the only one; nullptr if neither.
  [[nodiscard]] const DecodedImage* main_image() const;
};

[[nodiscard]] DecodedMemory decoded(const MemoryDump& dump);

/// "TXYZ (code F4495741)"; the code alone where its parameters are not those. @pre it has an identity
[[nodiscard]] std::string configuration_text(const DecodedImage& image);

/// "EXX forward"; "EXX" for a table for both approaches.
[[nodiscard]] std::string name_of(const DecodedTable& table);

/// @param with_bytes  in the text, names and meaning beside the bytes of prefix, parameters and directory
[[nodiscard]] Cell memory_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes);

/// A status file, or a memory dump with what it says.
struct StatusFile {
  std::string name;
  std::optional<StatusSnapshot> snapshot;  ///< a dump may have none
  std::vector<std::string> memory;         ///< lines of a dump; empty: a status file
};
/// By its first bytes: a status file (JSON), else a memory dump.
[[nodiscard]] Result<StatusFile> read_status_file(const std::string& path);

}  // namespace ecs::commissioning
