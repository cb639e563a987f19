// What lies where in memory, by name: commit records, prefix, parameters, table directory, values of the tables in
// their unit, header; and which bytes of an image carry which field.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/memory/bytes.hpp"
#include "commissioning/memory/decode.hpp"
#include "core/memory_image.hpp"

namespace ecs::commissioning {

/// A field, a value of a table, a commit record: "prefix.total_bytes", "axis.X.deadband_um", "EXX forward at -3500 mm".
struct NamedPlace {
  Address first = 0;
  std::uint32_t bytes = 0;
  std::string name{};
  std::string value{};  ///< with its unit; empty: the bytes are the value
};

/// Prefix, parameters, identity and table directory of an image, by address. Where the bytes end, the list ends.
/// @param region  the bytes it was decoded from
[[nodiscard]] std::vector<NamedPlace> fields_of(const DecodedImage& image, const DumpRegion& region);

/// Offset of each parameter in the parameter block, and its length: `first` 512 where it is not stored.
struct FieldPlace {
  std::uint32_t first = 0;
  std::uint32_t bytes = 0;
};
/// In the order of params::fields(). Found by encoding: a field lies where the bytes change with it.
[[nodiscard]] const std::vector<FieldPlace>& parameter_places();

/// A field, all values of a table, the header.
struct NamedStretch : NamedPlace {
  bool table = false;
  TableEntry entry{};  ///< of a table
  [[nodiscard]] bool contains(Address address) const { return address >= first && address - first < bytes; }
};

class MemoryNames {
 public:
  MemoryNames() = default;
  /// Decodes what is known.
  explicit MemoryNames(const MemoryBytes& memory);

  [[nodiscard]] std::optional<NamedPlace> at(const MemoryBytes& memory, Address address) const;
  [[nodiscard]] const std::vector<NamedStretch>& all() const { return stretches_; }
  /// Beginning of the next stretch with a name after `address`, or of the one before it; nothing: there is none.
  [[nodiscard]] std::optional<Address> next(Address address) const;
  [[nodiscard]] std::optional<Address> previous(Address address) const;
  [[nodiscard]] const NamedStretch* stretch_at(Address address) const;
  /// What a region holds, in words: "active map of 12,345 bytes, made active as no. 3"; empty: nothing known.
  [[nodiscard]] std::string content_of(const MemoryRegion& region) const;
  /// Where the image begins that the unit uses; nothing: there is none, or it is not known yet.
  [[nodiscard]] std::optional<Address> active_image() const { return active_; }
  /// The bytes that the names come from.
  [[nodiscard]] static std::vector<Stretch> structure(const MemoryBytes& memory);

 private:
  struct Content {
    Address region = 0;
    std::string text;
  };
  std::vector<NamedStretch> stretches_;  ///< by address
  std::vector<Content> contents_;
  std::optional<Address> active_;
};

/// The number under the cursor as the unit could mean it: "u8 69  s16 17731  u32 1162695753  f64 1.5".
[[nodiscard]] std::string numbers_at(const MemoryBytes& memory, Address address);

}  // namespace ecs::commissioning
