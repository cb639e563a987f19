// Whom an image is addressed to, and whether that is this unit.
#include <algorithm>
#include <array>
#include <cstring>

#include <zlib.h>

#include "core/memory_image.hpp"

namespace ecs {
namespace {

std::string_view text_in(ByteView image, std::uint32_t at, std::size_t most) noexcept {
  const auto* const first = reinterpret_cast<const char*>(image.data() + kIdentityOffset + at);
  return {first, static_cast<std::size_t>(std::find(first, first + most, '\0') - first)};
}

void put_text(Bytes identity, std::uint32_t at, std::string_view text, std::size_t most) noexcept {
  std::memcpy(identity.data() + at, text.data(), std::min(text.size(), most));
}

bool printable(std::string_view text) noexcept {
  return std::none_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7F;
  });
}

}  // namespace

std::uint32_t configuration_hash(const UnitParameters& parameters) noexcept {
  std::array<std::uint8_t, 5 + kAxes + 1> bytes{};
  std::copy(parameters.configuration.begin(), parameters.configuration.end(), bytes.begin());
  for (std::size_t a = 0; a < kAxes; ++a) bytes[5 + a] = parameters.axis_present[a] ? 1 : 0;
  bytes.back() = static_cast<std::uint8_t>(parameters.convention);
  return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

std::string_view machine_in_identity(std::string_view name) noexcept {
  if (name.size() <= kMostMachineBytes) return name;
  std::size_t end = kMostMachineBytes;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
  return name.substr(0, end);
}

void write_identity(Bytes image, const ImageIdentity& identity) noexcept {
  const Bytes block = image.subspan(kIdentityOffset, kIdentityBytes);
  std::fill(block.begin(), block.end(), std::uint8_t{0});
  put_text(block, identity_at::serial_number, identity.serial_number, kMostSerialNumberBytes);
  put_text(block, identity_at::machine, machine_in_identity(identity.machine), kMostMachineBytes);
  store_big(block, identity_at::configuration, identity.configuration);
}

std::optional<ImageIdentity> ImageView::identity() const noexcept {
  if (format() == kFormatWithoutIdentity) return std::nullopt;
  return ImageIdentity{text_in(image_, identity_at::serial_number, kMostSerialNumberBytes),
                       text_in(image_, identity_at::machine, kMostMachineBytes),
                       load_big<std::uint32_t>(image_, kIdentityOffset + identity_at::configuration)};
}

std::string_view text_of(IdentityFault fault) noexcept {
  switch (fault) {
    case IdentityFault::none:
      return "is for this unit";
    case IdentityFault::not_stated:
      return "does not say which unit it is for";
    case IdentityFault::other_serial_number:
      return "is for the unit with another serial number";
    case IdentityFault::other_machine:
      return "is for another machine than the active map";
    case IdentityFault::other_configuration:
      return "is for another configuration than the active map";
  }
  return "unknown";
}

OwnIdentity own_identity(std::string_view serial_number, ByteView active) noexcept {
  OwnIdentity own{{serial_number, {}, 0}, false};
  if (active.empty()) return own;
  const ImageView view(active);
  const auto parameters = view.parameters();
  if (view.table_count() == 0 || !parameters) return own;
  own.has_map = true;
  own.identity.configuration = configuration_hash(*parameters);
  if (const auto stated = view.identity()) own.identity.machine = stated->machine;
  return own;
}

IdentityFault identity_fault(ByteView image, const OwnIdentity& own) noexcept {
  const ImageView view(image);
  const auto stated = view.identity();
  const auto parameters = view.parameters();
  if (!stated || !parameters || stated->serial_number.empty()) return IdentityFault::not_stated;
  if (!printable(stated->serial_number) || !printable(stated->machine)) return IdentityFault::not_stated;
  if (stated->serial_number != own.identity.serial_number.substr(0, kMostSerialNumberBytes))
    return IdentityFault::other_serial_number;
  const bool other_name = !own.identity.machine.empty() && stated->machine != own.identity.machine;
  if (own.has_map && other_name) return IdentityFault::other_machine;
  const std::uint32_t expected = own.has_map ? own.identity.configuration : configuration_hash(*parameters);
  return stated->configuration == expected ? IdentityFault::none : IdentityFault::other_configuration;
}

}  // namespace ecs
