// One field after the other, into the registers of a block or out of them: what a number, a text or a set of axes looks
// like on the line. Which fields a block has: unit_registers.cpp.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/axis.hpp"
#include "core/bytes.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// Appends each field to the registers.
class FieldWriter {
 public:
  template <class T>
  requires std::is_integral_v<T>
  void number(const T& value, std::string_view) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (int shift = 8 * static_cast<int>(sizeof(T)) - 16; shift >= 0; shift -= 16)
      out_.push_back(static_cast<std::uint16_t>(bits >> shift));
  }
  template <class E>
  void one_of(const E& value, std::uint16_t, std::string_view) {
    out_.push_back(static_cast<std::uint16_t>(value));
  }
  void real(const double& value, std::string_view name) { number(std::bit_cast<std::uint64_t>(value), name); }
  void flag(const bool& value, std::string_view) { out_.push_back(value ? 1 : 0); }
  void approach(const Approach& value) { out_.push_back(static_cast<std::uint16_t>(static_cast<std::int16_t>(value))); }
  void axes(const PerAxis<bool>& set);
  void letter(const bool& present, Axis axis) {
    out_.push_back(present ? static_cast<unsigned char>(letter_of(axis)) : 0);
  }
  void rotary_letter(const char& letter) { out_.push_back(static_cast<unsigned char>(letter)); }
  /// Cut to `bytes`, never inside a UTF-8 character; zero-padded.
  void text(const std::string& value, std::size_t bytes, std::string_view);
  /// Registers from here to the end of a block of `count` stay 0.
  void rest(std::size_t count) { out_.resize(count, 0); }
  template <std::size_t N>
  void octets(const std::array<std::uint8_t, N>& value) {
    for (std::size_t i = 0; i < N; i += 2) out_.push_back(load_big<std::uint16_t>(value, i));
  }
  /// CRC-32 over what was written after the echo, high byte first.
  void check();
  /// Room for the keyed check, see sealed().
  void keyed() { out_.resize(out_.size() + kKeyedCheckRegisters, 0); }

  Registers out_;
};

/// Takes each field from the registers; the first that cannot be is kept as a sentence.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint16_t> registers) : in_(registers) {}

  template <class T>
  requires std::is_integral_v<T>
  void number(T& value, std::string_view) {
    std::make_unsigned_t<T> bits = 0;
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i)
      bits = static_cast<std::make_unsigned_t<T>>((static_cast<std::uint64_t>(bits) << 16) | next());
    value = static_cast<T>(bits);
  }
  template <class E>
  void one_of(E& value, std::uint16_t count, std::string_view name) {
    const std::uint16_t word = next();
    if (word >= count) return fail(fmt::format("{}: expected a number below {}, got {}", name, count, word));
    value = static_cast<E>(word);
  }
  void real(double& value, std::string_view name);
  void flag(bool& value, std::string_view name);
  void approach(Approach& value);
  void axes(PerAxis<bool>& set);
  void letter(bool& present, Axis axis);
  void rotary_letter(char& letter);
  void text(std::string& value, std::size_t bytes, std::string_view name);
  template <std::size_t N>
  void octets(std::array<std::uint8_t, N>& value) {
    for (std::size_t i = 0; i < N; i += 2) store_big(value, i, next());
  }
  void rest(std::size_t) {}
  void check() {}  ///< see check_agrees()
  void keyed() {}  ///< see seal_agrees()

  std::string problem_;  ///< empty: every field was good

 private:
  std::uint16_t next();
  void fail(std::string sentence) {
    if (problem_.empty()) problem_ = std::move(sentence);
  }
  std::span<const std::uint16_t> in_;
};

}  // namespace ecs::protocol
