#include "devices/description.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::devices {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + "\"";
}

std::string list_of(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) out += fmt::format("{}0x{:02x}", out.empty() ? "" : ", ", byte);
  return "[" + out + "]";
}

std::string report_text(const ReportLayout& report) {
  std::string text = "\n[report]\n";
  if (report.feature) text += "type = \"feature\"\n";
  if (report.number != 0) text += fmt::format("id = {}\n", report.number);
  if (report.bytes != 0) text += fmt::format("length = {}\n", report.bytes);
  if (!report.poll.empty()) text += fmt::format("poll = {}\n", list_of(report.poll));
  if (report.poll_number != 0) text += fmt::format("poll_id = {}\n", report.poll_number);
  if (report.replies != 1) text += fmt::format("replies = {}\n", report.replies);
  return text + fmt::format("timeout_ms = {}\n", report.timeout_ms);
}

std::string field_text(const ReportField& field) {
  std::string text = fmt::format(
      "\n[[field]]\nquantity = \"{}\"\nbyte = {}\nlength = {}\norder = \"{}\"\nsigned = {}\n", name_of(field.quantity),
      field.byte, field.bytes, field.big_endian ? "big" : "little", field.is_signed);
  text += fmt::format("scale = {}\noffset = {}\n", shortest(field.scale), shortest(field.offset));
  if (field.absent) text += fmt::format("absent = {}\n", *field.absent);
  if (!field.starts.empty()) text += fmt::format("starts = {}\n", list_of(field.starts));
  return text;
}

bool starts_with(const Bytes& report, const Bytes& head) {
  return report.size() >= head.size() && std::equal(head.begin(), head.end(), report.begin());
}

std::optional<std::int64_t> raw_in(const ReportField& field, const Bytes& report) {
  const auto count = static_cast<std::size_t>(field.bytes);
  if (report.size() < field.byte + count) return std::nullopt;
  std::uint64_t raw = 0;
  for (std::size_t k = 0; k < count; ++k) raw = raw << 8U | report[field.byte + (field.big_endian ? k : count - 1 - k)];
  const std::uint64_t top = std::uint64_t{1} << (8 * count - 1);
  const auto value = static_cast<std::int64_t>(raw);
  return field.is_signed && (raw & top) != 0 ? value - static_cast<std::int64_t>(top << 1U) : value;
}

const Bytes* reply_of(const ReportField& field, const std::vector<Bytes>& replies) {
  if (field.starts.empty()) return replies.empty() ? nullptr : &replies.front();
  const auto found = std::find_if(replies.begin(), replies.end(),
                                  [&](const Bytes& reply) { return starts_with(reply, field.starts); });
  return found == replies.end() ? nullptr : &*found;
}

}  // namespace

std::string_view name_of(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::trigger:
      return "trigger";
    case DeviceKind::environment:
      return "environment";
    case DeviceKind::gauge:
      break;
  }
  return "gauge";
}

std::string_view name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::air_degC:
      return "air_degC";
    case Quantity::material_degC:
      return "material_degC";
    case Quantity::pressure_hPa:
      return "pressure_hPa";
    case Quantity::humidity_pct:
      return "humidity_pct";
    case Quantity::reading_um:
      break;
  }
  return "reading_um";
}

std::string to_toml(const DeviceDescription& device) {
  std::string text = fmt::format("name = {}\nkind = \"{}\"\n", quoted(device.name), name_of(device.kind));
  if (!device.source.empty()) text += fmt::format("source = {}\n", quoted(device.source));
  text += "\n[match]\n";
  if (!device.match.ids.empty())
    text += fmt::format("vendor_id = 0x{:04x}\nproduct_id = 0x{:04x}\n", device.match.ids.front().vendor_id,
                        device.match.ids.front().product_id);
  if (device.match.serial) text += fmt::format("serial = {}\n", quoted(*device.match.serial));
  if (device.match.path) text += fmt::format("path = {}\n", quoted(*device.match.path));
  if (device.match.interface) text += fmt::format("interface = {}\n", *device.match.interface);
  if (device.match.usage_page) text += fmt::format("usage_page = 0x{:04x}\n", *device.match.usage_page);
  text += report_text(device.report);
  if (device.kind == DeviceKind::trigger)
    text +=
        fmt::format("\n[trigger]\nbyte = {}\nmask = 0x{:02x}\nactive = \"{}\"\ndebounce_ms = {}\n", device.trigger.byte,
                    device.trigger.mask, device.trigger.active_high ? "high" : "low", device.trigger.debounce_ms);
  for (const ReportField& field : device.fields) text += field_text(field);
  return text;
}

std::optional<bool> held_in(const DeviceDescription& device, const Bytes& report) {
  if (device.report.number != 0 && (report.empty() || report[0] != device.report.number)) return std::nullopt;
  if (report.size() <= device.trigger.byte) return std::nullopt;
  const std::uint8_t mask = device.trigger.mask;
  const auto bits = static_cast<std::uint8_t>(report[device.trigger.byte] & mask);
  return bits == (device.trigger.active_high ? mask : 0);
}

Values values_in(const DeviceDescription& device, const std::vector<Bytes>& replies) {
  Values values;
  for (const ReportField& field : device.fields) {
    const Bytes* reply = reply_of(field, replies);
    const auto raw = reply == nullptr ? std::nullopt : raw_in(field, *reply);
    if (!raw || raw == field.absent) continue;
    values.emplace(field.quantity, static_cast<double>(*raw) * field.scale + field.offset);
  }
  return values;
}

}  // namespace ecs::devices
